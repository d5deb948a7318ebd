//! What docs/porting.md claims.

use std::path::Path;

/// Whether a piece of code is the path of a file or folder of the repository: it has a known ending, or ends as a folder does.
fn is_path(code: &str) -> bool {
    let endings = [".rs", ".toml", ".md", ".js", ".html", ".txt", ".csv", ".x"];
    let one = !code.contains([' ', '<', '*']);
    one && (code.ends_with('/') || endings.iter().any(|ending| code.ends_with(ending)) || code == "check")
}

#[test]
fn every_file_exists_and_holds_what_is_said_to_be_in_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = std::fs::read_to_string(root.join("docs/porting.md")).expect("docs/porting.md");
    // Text and code in turn.
    let parts: Vec<&str> = text.split('`').collect();
    let (mut files, mut items) = (0, 0);
    for i in (1..parts.len()).step_by(2).filter(|i| is_path(parts[*i])) {
        let (path, file) = (parts[i], root.join(parts[i]));
        files += 1;
        assert!(file.exists(), "docs/porting.md names {path}, which is not there");
        if parts[i - 1].split_whitespace().eq(["in"]) {
            items += 1;
            let source = std::fs::read_to_string(&file).expect(path);
            // Lists such as "`a` and `b` in `file`".
            let mut k = i - 2;
            loop {
                assert!(source.contains(parts[k]), "docs/porting.md says that {path} has `{}`", parts[k]);
                if k < 2 || !["and", "or"].contains(&parts[k - 1].trim()) || is_path(parts[k - 2]) {
                    break;
                }
                k -= 2;
            }
        }
    }
    assert!(files > 60 && items > 40, "{files} files, {items} items");
}
