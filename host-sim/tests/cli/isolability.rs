//! `pt326 isolability`.

use super::{arg, folder, pt326, text};

#[test]
fn it_prints_tables_and_writes_a_csv_and_pictures() {
    let dir = folder("isolability");
    let scenario = dir.join("short.toml");
    std::fs::write(&scenario, "duration = 460").expect("scenario");
    let args = ["isolability", "--scenario", arg(&scenario), "--within", "10,0.5", "--out", arg(&dir)];
    let output = pt326(&args);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    let [half, ten] =
        ["Told within 0.5 s from", "Told within 10 s from"].map(|head| table.find(head).expect(head));
    assert!(half < ten && table.contains("t1_offset -"), "{table}");
    assert!(table.lines().all(|line| line.starts_with("Written") || line.chars().count() <= 100), "{table}");

    let csv = std::fs::read_to_string(dir.join("isolability.csv")).expect("csv");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("fault,which,sign,unit,from,within_s,told,size"));
    let sizes: Vec<f64> = lines
        .filter_map(|line| line.strip_prefix("t2_offset,,-,degC,nothing,"))
        .map(|rest| rest.split(',').next_back().and_then(|size| size.parse().ok()).expect("a size"))
        .collect();
    // What takes its time is seen when smaller.
    assert!(sizes.len() == 2 && sizes[0] < sizes[1] && sizes[1] < 0.0, "{sizes:?}");
    for name in ["isolability-0.5s.svg", "isolability-10s.svg"] {
        assert!(dir.join(name).is_file(), "{name}");
    }
}

#[test]
fn a_run_that_is_too_short_is_refused_with_the_reason() {
    let dir = folder("isolability-short");
    let scenario = dir.join("short.toml");
    for (duration, words) in [("100", "learnt no models in 100 s"), ("400", "a duration of")] {
        std::fs::write(&scenario, format!("duration = {duration}")).expect("scenario");
        let output = pt326(&["isolability", "--scenario", arg(&scenario), "--out", arg(&dir)]);
        assert!(output.status.code() == Some(2) && text(&output.stderr).contains(words), "{output:?}");
    }
    let output = pt326(&["isolability", "--within", "0", "--out", arg(&dir)]);
    assert!(output.status.code() == Some(2) && text(&output.stderr).contains("--within has 0"), "{output:?}");
}
