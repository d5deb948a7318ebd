//! `pt326 diagnose`, `pt326 fit-rig` and `pt326 campaign records`, on recordings of our own rig.

use std::path::Path;

use crate::{arg, folder, pt326, pt326_reading, text};

/// A trace of the paper's experiment without T0, T2 and all that the instrument said, as somebody else would record it.
fn plain_record(dir: &Path) -> String {
    let out = pt326(&["run", "--seed", "3", "--out", arg(dir)]);
    assert!(out.status.success(), "{}", text(&out.stderr));
    let trace = std::fs::read_to_string(dir.join("trace.csv")).unwrap();
    let mut lines = trace.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let places = [place("t_s"), place("t1_c"), place("pa_pct")];
    let rows = lines.map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        places.map(|place| cells[place]).join(",") + "\n"
    });
    format!("time,outlet,heater\n{}", rows.collect::<String>())
}

/// The trace of a run is a recording with all three thermistors: the monitor names the paper's faults as the instrument did.
#[test]
fn a_trace_of_ours_is_diagnosed_as_a_recording() {
    let dir = folder("diagnose-trace");
    let run = pt326(&["run", "--out", arg(&dir)]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let trace = dir.join("trace.csv");
    let out = dir.join("diagnosed");
    let done = pt326(&["diagnose", arg(&trace), "--train", "2:364", "--out", arg(&out)]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(
        said.contains("a trace of this project") && said.contains("the paper's signatures are run as well"),
        "{said}"
    );
    for sentence in ["T2 reads 1.", "T1 sees", "the air flow is"] {
        assert!(said.contains(sentence), "{sentence}: {said}");
    }
    for file in ["trace.csv", "summary.json", "figure6.svg", "report.html"] {
        assert!(out.join(file).exists(), "{file}");
    }
}

#[test]
fn one_thermistor_and_a_truth_are_scored() {
    let dir = folder("diagnose-one");
    let record = dir.join("record.csv");
    std::fs::write(&record, plain_record(&dir)).unwrap();
    let truth = dir.join("truth.csv");
    std::fs::write(&truth, "do,sensor,size,at,for\nclog,t1,0.85,495,10\nair-flow,,1.26,730,25\n").unwrap();
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let common = ["diagnose", arg(&record), "--train", "2:364", "--truth", arg(&truth), "--out", arg(&dir)];
    let done = pt326(&[&common[..], &map[..]].concat());
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.contains("No T0") && said.contains("No T2"), "{said}");
    let score: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("score.json")).unwrap()).unwrap();
    let faults = score["faults"].as_array().unwrap();
    assert!(faults.iter().all(|fault| fault["alarmed"].as_f64().is_some_and(|t| t < 3.0)), "{score:#}");
}

#[test]
fn what_is_wrong_with_a_recording_is_named_by_line_and_column() {
    let dir = folder("diagnose-errors");
    let error = |content: &str, args: &[&str]| {
        let file = dir.join("bad.csv");
        std::fs::write(&file, content).unwrap();
        let done = pt326(&[&["diagnose", arg(&file), "--out", arg(&dir)], args].concat());
        assert!(!done.status.success());
        text(&done.stderr)
    };
    let map = ["--map", "time=t", "--map", "t1=y", "--map", "power=u"];
    let rows = |row: &dyn Fn(usize) -> String| (0..300).map(row).collect::<String>();
    let still = format!("t,u,y\n{}", rows(&|k| format!("{k},50,{}\n", 20 + k % 3)));
    let said = error(&still, &map);
    assert!(said.contains("cannot be identified") && said.contains("50"), "{said}");
    let bad = "t,u,y\n0,1,2\n1,x,3\n";
    let said = error(bad, &map);
    assert!(said.contains("line 3") && said.contains("column 2") && said.contains("`x`"), "{said}");
    let uneven = "t,u,y\n0,1,2\n1,1,3\n2,1,3\n3.5,2,3\n";
    let said = error(uneven, &map);
    assert!(said.contains("line 5") && said.contains("--resample"), "{said}");
    let backwards = "t,u,y\n0,1,2\n2,1,3\n1,1,3\n";
    assert!(error(backwards, &map).contains("line 4"));
    let said = error("a,b\n1,2\n", &[]);
    assert!(said.contains("--map t1=COLUMN") && said.contains("`a`"), "{said}");
    assert!(error(bad, &["--map", "t1=z", "--map", "power=u", "--ts", "1"]).contains("no column `z`"));
}

#[test]
fn live_samples_are_answered_line_by_line() {
    let dir = folder("diagnose-live");
    let record = plain_record(&dir);
    let mut lines = record.lines();
    let header = lines.next().unwrap();
    let rows: Vec<&str> = lines.collect();
    let part = |from: usize, to: usize| format!("{header}\n{}\n", rows[from..to].join("\n"));
    let normal = dir.join("normal.csv");
    std::fs::write(&normal, part(100, 3400)).unwrap();
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let common = ["diagnose", "-", "--live", "--train-on", arg(&normal)];
    let done = pt326_reading(&[&common[..], &map[..]].concat(), &part(3400, 4700));
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.lines().count() > 2 && said.contains("T1"), "{said}");
}

#[test]
fn a_rig_is_fitted_and_runs() {
    let dir = folder("fit-rig");
    let record = dir.join("record.csv");
    let normal: Vec<String> = plain_record(&dir).lines().take(3400).map(str::to_owned).collect();
    std::fs::write(&record, normal.join("\n") + "\n").unwrap();
    let rig = dir.join("rig.toml");
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let done = pt326(&[&["fit-rig", arg(&record), "-o", arg(&rig)], &map[..]].concat());
    assert!(done.status.success(), "{}", text(&done.stderr));
    let fitted: toml::Table = std::fs::read_to_string(&rig).unwrap().parse().unwrap();
    let gain = fitted["rig"]["gain"].as_float().unwrap();
    assert!((gain - 0.3).abs() < 0.06, "{gain} degC per %");
    let run = pt326(&["run", "--scenario", arg(&rig), "--out", arg(&dir.join("run"))]);
    assert!(run.status.success(), "{}", text(&run.stderr));
}

/// The recordings of docs/records.md are nobody's to copy: they are looked for where `PT326_RECORDS` says.
#[test]
fn the_records_say_what_their_page_says() {
    let Ok(records) = std::env::var("PT326_RECORDS") else {
        println!("skipped: no records");
        return;
    };
    let dir = folder("records");
    let done = pt326(&["campaign", "records", &records, "--out", arg(&dir)]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(!said.contains("Not diagnosed") && !said.contains("alarms while nothing was wrong"), "{said}");
}

/// The same harness on a record of our own.
#[test]
fn a_folder_of_records_is_held_against_its_bars() {
    let dir = folder("records-own");
    std::fs::write(dir.join("own.csv"), plain_record(&dir)).unwrap();
    let definition = "name = 'own'\nabout = 'our rig'\nfile = 'own.csv'\ntrain = [2.0, 364.0]\ntruth = [['truth.csv']]\n\
        reading = { map = ['time=time', 't1=outlet', 'power=heater'] }\n[bars]\nsensor = { alarm = 0.0 }\n";
    std::fs::write(dir.join("own.toml"), definition.replace("truth.csv", arg(&dir.join("truth.csv"))))
        .unwrap();
    std::fs::write(dir.join("truth.csv"), "do,sensor,size,at,for\nclog,t1,0.85,495,10\n").unwrap();
    let done = pt326(&["campaign", "records", arg(&dir), "--out", arg(&dir)]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.contains("### own") && said.contains("Missed: T1 clog"), "{said}");
    assert!(dir.join("records.md").exists());
}
