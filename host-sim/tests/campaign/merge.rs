//! `pt326 campaign merge`: only all parts of one campaign make a whole.

use std::path::Path;

use crate::{SMALL, fails, folder, succeeds};

#[test]
fn merge_refuses_what_is_missing_unfinished_or_foreign() {
    let (dir, file) = folder("merge", SMALL);
    let shard = |shard: &str, out: &Path, more: &[&str]| {
        let args = [&file, "--only", "silence", "--shard", shard, "--out", out.to_str().unwrap()];
        succeeds(&[args.as_slice(), more].concat());
        let name = format!("runs.{}.jsonl", shard.replace('/', "-of-"));
        out.join(name).to_str().unwrap().to_owned()
    };
    let [first, second, third] = ["1/3", "2/3", "3/3"].map(|part| shard(part, &dir.join("part"), &[]));
    let merge = |parts: &[&str]| {
        let out = dir.join("merged");
        fails(&[&["merge", "--out", out.to_str().unwrap()], parts].concat())
    };
    let error = merge(&[&second]);
    assert!(error.contains("part 1 of 3 is missing") && error.contains("part 3 of 3 is missing"), "{error}");
    let seeds = shard("3/3", &dir.join("seeds"), &["--seeds-from", "7"]);
    let error = merge(&[&first, &second, &seeds]);
    assert!(error.contains("seeds_from = 7") && error.contains("does not belong to"), "{error}");
    let settings = shard("3/3", &dir.join("settings"), &["--sweep", "pid.kp=2.0"]);
    assert!(merge(&[&first, &second, &settings]).contains("does not belong to"));
    let halves = shard("1/2", &dir.join("halves"), &[]);
    assert!(merge(&[&first, &halves]).contains("one of 2 parts, this one of 3"));

    let changed = |name: &str, change: &dyn Fn(String) -> String| {
        let path = dir.join(name);
        std::fs::write(&path, change(std::fs::read_to_string(&third).unwrap())).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let build = changed("build", &|text| text.replacen("\"build\":\"", "\"build\":\"0", 1));
    assert!(merge(&[&first, &second, &build]).contains("another build"));
    let killed = changed("killed", &|text| text[..text.len() - 9].to_owned());
    assert!(
        merge(&[&first, &second, &killed]).contains("has 0 of 1 runs"),
        "{}",
        merge(&[&first, &second, &killed])
    );
    let strange = changed("strange", &|text| text.replacen("\"run\":2", "\"run\":1", 1));
    assert!(merge(&[&first, &second, &strange]).contains("not of part 3 of 3"));
}
