//! `pt326 campaign` as a user calls it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SMALL: &str = r#"
seeds_from = 500
[[cell]]
name = "fault/afs2"
runs = 3
phase = 60.0
sizes = [1.5, -1.5]
fault = [{ do = "offset", sensor = "t2", at = 400.0, for = 10.0 }]
[[cell]]
name = "silence/ramp"
runs = 3
action = [{ at = 400.0, setpoint = 38.0, over = 10.0 }]
[[target]]
cells = "fault/afs2 1.5"
measure = "first-right"
by = "signature"
at_least = 50.0
[[target]]
cells = "silence/*"
measure = "runs-with-alarm"
at_most = 0.0
"#;

fn campaign(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt326")).arg("campaign").args(args).output().expect("pt326 runs")
}

fn succeeds(args: &[&str]) -> String {
    let output = campaign(args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn fails(args: &[&str]) -> String {
    let output = campaign(args);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {}", String::from_utf8_lossy(&output.stdout));
    String::from_utf8(output.stderr).unwrap()
}

/// A fresh folder of this test's own, with the definition in it.
fn folder(name: &str, definition: &str) -> (PathBuf, String) {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("campaign-{name}"));
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).expect("folder");
    let file = dir.join("campaign.toml");
    std::fs::write(&file, definition).expect("definition");
    (dir, file.to_str().unwrap().into())
}

fn results(dir: &Path) -> Vec<Vec<u8>> {
    ["campaign.json", "cells.csv", "runs.csv", "tables.md"]
        .map(|name| std::fs::read(dir.join(name)).expect(name))
        .into()
}

#[test]
fn threads_shards_and_interruptions_change_no_byte() {
    let (dir, file) = folder("same", SMALL);
    let [one, two, part, merged] = ["one", "two", "part", "merged"].map(|name| dir.join(name));
    let path = |dir: &Path| dir.to_str().unwrap().to_owned();
    let table = succeeds(&[&file, "--threads", "1", "--out", &path(&one)]);
    assert!(table.contains("fault/afs2 1.5") && table.contains("silence/ramp"), "{table}");
    let numbers = table.split("\nWritten").next().unwrap();
    assert!(numbers.lines().all(|line| line.chars().count() <= 100), "{table}");

    // Interrupted in the middle of a line, and gone on with by more threads.
    std::fs::create_dir_all(&two).unwrap();
    let whole = std::fs::read(one.join("runs.jsonl")).unwrap();
    let third_line = whole.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(2).unwrap().0;
    std::fs::write(two.join("runs.jsonl"), &whole[..third_line + 40]).unwrap();
    succeeds(&[&file, "--threads", "3", "--out", &path(&two)]);
    assert_eq!(std::fs::read_to_string(two.join("runs.jsonl")).unwrap().lines().count(), 10);

    for shard in ["1/2", "2/2"] {
        succeeds(&[&file, "--shard", shard, "--out", &path(&part)]);
    }
    let parts = ["runs.1-of-2.jsonl", "runs.2-of-2.jsonl"].map(|name| path(&part.join(name)));
    let error = fails(&["merge", &parts[0], "--out", &path(&merged)]);
    assert!(error.contains("part 2 of 2 is missing"), "{error}");
    let again = succeeds(&["merge", &parts[1], &parts[0], "--out", &path(&merged)]);
    let numbers = |text: &str| text.split("\nWritten").next().unwrap().to_owned();
    assert_eq!(numbers(&again), numbers(&table));
    for other in [&two, &merged] {
        assert!(results(other) == results(&one), "{}", other.display());
        let picture = |dir: &Path| std::fs::read(dir.join("delays.svg")).expect("delays.svg");
        assert!(picture(other) == picture(&one), "{}", other.display());
    }
}

#[test]
fn results_of_another_definition_are_refused_until_put_away() {
    let (dir, file) = folder("changed", SMALL);
    let out = dir.join("out").to_str().unwrap().to_owned();
    succeeds(&[&file, "--only", "silence", "--out", &out]);
    std::fs::write(&file, SMALL.replace("setpoint = 38.0", "setpoint = 39.0")).unwrap();
    let error = fails(&[&file, "--only", "silence", "--out", &out]);
    assert!(error.contains("setpoint = 38.0") && error.contains("setpoint = 39.0"), "{error}");
    assert!(error.contains("runs.jsonl") && error.contains("--fresh"), "{error}");
    succeeds(&[&file, "--only", "silence", "--out", &out, "--fresh"]);
}

#[test]
fn seeds_do_not_depend_on_what_else_is_run() {
    let (dir, file) = folder("seeds", SMALL);
    let out = dir.join("out").to_str().unwrap().to_owned();
    let table =
        succeeds(&[&file, "--only", "silence", "--sweep", "diagnosis.sigma_factor=3,50.0", "--out", &out]);
    assert!(table.contains("silence/ramp [diagnosis.sigma_factor=50.0]"), "{table}");
    let runs = std::fs::read_to_string(dir.join("out/runs.csv")).unwrap();
    let seeds: Vec<&str> = runs.lines().skip(1).map(|line| line.split(',').nth(3).unwrap()).collect();
    assert_eq!(seeds, ["506", "507", "508", "506", "507", "508"], "after the six of the other cell");
}

#[test]
fn a_wrong_definition_names_the_cell_and_the_key() {
    let cases = [
        (SMALL.replace("phase", "fase"), vec!["line 6", "fase"]),
        (SMALL.replace("sensor = \"t2\", ", ""), vec!["fault/afs2", "sensor", "t0, t1 or t2"]),
        (SMALL.replace("runs = 3", "runs = 0"), vec!["fault/afs2", "runs is 0"]),
        (SMALL.replace("phase = 60.0", "plants = [\"x\"]"), vec!["fault/afs2", "plants", "\"x\""]),
        (SMALL.replace("phase = 60.0", "lags = [1.0]"), vec!["fault/afs2", "lags", "as many as"]),
        (SMALL.replace("phase = 60.0", "config = { pid = { kq = 1 } }"), vec!["fault/afs2", "kq"]),
        (SMALL.replace("phase = 60.0", "config = { pid = { kp = -1 } }"), vec!["fault/afs2", "pid.kp is -1"]),
        (SMALL.replace("first-right", "first"), vec!["line", "first-right"]),
        (
            SMALL.replace("phase = 60.0", "ambient = [30.0, 5.0]"),
            vec!["fault/afs2", "ambient is [30, 5]", "lower"],
        ),
        (
            SMALL.replace("phase = 60.0", "right = [\"t2_ofset\"]"),
            vec!["fault/afs2", "right", "\"t2_ofset\""],
        ),
        (SMALL.replace("phase = 60.0", "setpoint = [25.0, 95.0]"), vec!["fault/afs2", "setpoint is 95"]),
        (SMALL.replace("phase = 60.0", "may_trip = [\"t1_opn\"]"), vec!["line 6", "may_trip", "t1_open"]),
    ];
    for (i, (text, words)) in cases.into_iter().enumerate() {
        let (dir, file) = folder(&format!("wrong-{i}"), &text);
        let error = fails(&[&file, "--out", dir.join("out").to_str().unwrap()]);
        assert!(words.iter().all(|word| error.contains(word)), "{words:?}: {error}");
    }
    let (_, file) = folder("wrong-sweep", SMALL);
    for (sweep, word) in [("diagnosis.sigma=1", "sigma"), ("nothing", "key=value"), ("pid.kp=x", "key=value")]
    {
        let error = fails(&[&file, "--sweep", sweep]);
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn the_printed_default_is_the_default() {
    let printed = succeeds(&["define"]);
    assert!(printed.contains("Seeds 1 to 99999 are for tuning"));
    let (dir, file) = folder("default", &printed);
    let run = |args: &[&str], out: &Path| {
        let common = ["--only", "silence/start-up", "--scale", "0.01", "--out", out.to_str().unwrap()];
        succeeds(&[args, &common].concat());
        results(out)
    };
    assert!(run(&[], &dir.join("a")) == run(&[&file], &dir.join("b")));
}

#[test]
fn the_physics_campaign_says_what_was_said_against_the_truth() {
    let printed = succeeds(&["define", "--physics"]);
    let (dir, file) = folder("physics", &printed);
    let run = |args: &[&str], out: &Path| {
        let common = ["--only", "alike/", "--scale", "0.01", "--out", out.to_str().unwrap()];
        succeeds(&[args, &common].concat())
    };
    let table = run(&["--physics"], &dir.join("a"));
    assert!(table.contains("alike/t1 and t2 +1.5 @ trainer: 1 runs"), "{table}");
    assert!(table.contains("What likelihood said.") && table.contains("by confidence"), "{table}");
    assert!(
        table.split("\nWritten").next().unwrap().lines().all(|line| line.chars().count() <= 100),
        "{table}"
    );
    run(&[&file], &dir.join("b"));
    assert!(results(&dir.join("a")) == results(&dir.join("b")));
    let tables = std::fs::read_to_string(dir.join("a/tables.md")).unwrap();
    assert!(tables.contains("| rig | confidence from | mean, % | right, % | of |"), "{tables}");
    let rigs = std::fs::read_to_string(dir.join("a/rigs.md")).unwrap();
    assert!(rigs.contains("## alike") && rigs.contains("| rig | t1 and t2 +1.5 |"), "{rigs}");
    assert!(rigs.lines().any(|line| line.starts_with("| trainer | ")), "{rigs}");
    let runs = std::fs::read_to_string(dir.join("a/runs.csv")).unwrap();
    assert!(runs.lines().next().unwrap().contains("said_end_name,said_end_right"), "{runs}");
}

#[test]
fn plants_go_by_pattern_and_large_cells_wait_for_a_large_scale() {
    let definition = "arm_at = 5.0\n[[plant]]\nname = \"a 1\"\n[[plant]]\nname = \"b\"\n[[plant]]\nname = \"a 2\"\n\
                      [[cell]]\nname = \"x\"\nruns = 2\nduration = 9.0\nplants = [\"a *\"]\n\
                      [[cell]]\nname = \"long\"\nruns = 1\nduration = 9.0\nfrom_scale = 1.0";
    let (dir, file) = folder("patterns", definition);
    let out = dir.join("out");
    let cells = |scale: &str| {
        let table = succeeds(&[&file, "--scale", scale, "--fresh", "--out", out.to_str().unwrap()]);
        ["x @ a 1:", "x @ a 2:", "x @ b:", "long:"].map(|cell| table.contains(cell))
    };
    assert_eq!(cells("0.5"), [true, true, false, false]);
    assert_eq!(cells("1"), [true, true, false, true]);
}

/// With its settings, and times that are as many samples long.
#[test]
fn a_plant_of_another_instrument_is_as_many_samples_slower() {
    let definition = "[[plant]]\nname = \"oven\"\nrig = { preset = \"oven\" }\ninstrument = \"oven\"\n\
                      [[cell]]\nname = \"x\"\nruns = 1\nduration = 11.0\nplants = [\"oven\"]";
    let (dir, file) = folder("instrument", definition);
    let out = dir.join("run");
    succeeds(&["show", "x @ oven", &file, "--out", out.to_str().unwrap()]);
    let trace = std::fs::read_to_string(out.join("trace.csv")).unwrap();
    let last = trace.lines().last().and_then(|line| line.split(',').next()).unwrap();
    assert_eq!((trace.lines().count(), last), (1 + 100, "198"), "100 samples of 2 s");
    let error =
        fails(&[&folder("no-instrument", &definition.replace("ument = \"oven", "ument = \"kettle")).1]);
    assert!(error.contains("kettle") && error.contains("expected a preset"), "{error}");
}

#[test]
fn one_run_can_be_looked_at() {
    let (dir, file) = folder("show", SMALL);
    let out = dir.join("run");
    succeeds(&["show", "fault/afs2 1.5", &file, "--run", "2", "--out", out.to_str().unwrap()]);
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("\"seed\": 502"), "{summary}");
    let error = fails(&["show", "afs2", &file]);
    assert!(error.contains("fault/afs2 -1.5"), "{error}");
}

#[test]
fn a_run_beyond_the_cell_is_refused() {
    let (dir, file) = folder("beyond", SMALL);
    let show = ["show", "fault/afs2 1.5", &file, "--run", "3", "--out", dir.to_str().unwrap()];
    let error = fails(&show);
    assert!(error.contains("--run 3") && error.contains("from 0 to 2"), "{error}");
}

#[test]
fn a_mistyped_subcommand_is_no_file() {
    for (typed, meant) in [("defin", "define"), ("merg", "merge"), ("sow", "show")] {
        let error = fails(&[typed]);
        assert!(error.contains(&format!("did you mean `pt326 campaign {meant}`")), "{error}");
    }
    let error = fails(&["mine.toml"]);
    assert!(error.contains("mine.toml") && !error.contains("did you mean"), "{error}");
}

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

/// More runs than anyone waits for.
const ENDLESS: &str = "[[cell]]\nname = \"quiet\"\nruns = 1000000\nduration = 10.0\n";

#[cfg(unix)]
#[test]
fn ctrl_c_says_how_to_go_on() {
    let (dir, file) = folder("interrupted", ENDLESS);
    let out = dir.join("out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_pt326"))
        .args(["campaign", &file, "--out", out.to_str().unwrap()])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let finished = || std::fs::read_to_string(out.join("runs.jsonl")).map_or(0, |text| text.lines().count());
    while finished() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "it has ended by itself");
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{message}");
    let kept = finished() - 1;
    assert!(message.contains(&format!("{kept} of 1000000 runs are finished")), "{message}");
    assert!(message.contains("The same command goes on"), "{message}");
}

/// Two rigs, a case that trips and one that heats on.
const RUNAWAY: &str = r#"
[[plant]]
name = "weak"
rig = { gain = 0.25 }
[[plant]]
name = "usual"
[[cell]]
name = "runaway/t1 open"
runs = 2
duration = 20.0
may_trip = ["t1_open"]
plants = ["weak", "usual"]
fault = [{ do = "open", sensor = "t1", at = 10.0, for = 99.0 }]
[[cell]]
name = "runaway/t2 open"
runs = 2
duration = 20.0
plants = ["weak", "usual"]
fault = [{ do = "open", sensor = "t2", at = 10.0, for = 99.0 }]
[[target]]
cells = "runaway/t1 open*"
each = true
measure = "off-delay-max"
at_most = 0.25
[[target]]
cells = "runaway/t2 open*"
measure = "off-delay-max"
at_most = 0.25
[[target]]
cells = "runaway/*"
measure = "tripped-otherwise"
at_most = 0.0
[[target]]
cells = "runaway/*"
measure = "tripped"
at_most = 50.0
"#;

#[test]
fn runaway_cells_have_a_table_of_their_own() {
    let (dir, file) = folder("runaway", RUNAWAY);
    let told = succeeds(&[&file, "--out", dir.to_str().unwrap()]);
    assert!(told.lines().all(|line| line.chars().count() <= 100 || line.starts_with("Written")), "{told}");
    assert!(told.contains("Targets: 3 of 4 met") && told.contains("runaway.md"), "{told}");
    let read = |name| std::fs::read_to_string(dir.join(name)).expect(name);
    let table = read("runaway.md");
    assert!(table.contains("| case | weak | usual |"), "{table}");
    let row = table.lines().find(|line| line.starts_with("| t1 open |")).unwrap();
    assert_eq!(row.matches(" s; t1_open").count(), 2, "{row}");
    let row = table.lines().find(|line| line.starts_with("| t2 open |")).unwrap();
    assert_eq!(row.matches("; never off |").count(), 2, "{row}");
    assert!(!read("tables.md").contains("\n| runaway/"), "told once");
    assert!(read("runs.csv").lines().next().unwrap().contains("overshoot_max_c,trip,tripped_s,off_delay_s"));
}

/// One nominal fault, something that must not alarm, and time in which nothing is done.
const TRADE: &str = r#"
seeds_from = 700
[[cell]]
name = "nominal/afs2"
runs = 2
fault = [{ do = "offset", sensor = "t2", size = 1.5, at = 400.0, for = 10.0 }]
[[cell]]
name = "silence/ramp"
runs = 1
action = [{ at = 400.0, setpoint = 38.0, over = 10.0 }]
[[cell]]
name = "hours/lively"
runs = 2
duration = 500.0
"#;

#[test]
fn variations_come_each_by_itself_and_their_trade_is_told() {
    let (dir, file) = folder("trade", TRADE);
    let out = dir.to_str().unwrap();
    let vary = ["--vary", "diagnosis.sigma_factor=40.0,50.0", "--vary", "diagnosis.filter_cutoff=0.3"];
    let table = succeeds(&[&[file.as_str(), "--out", out], vary.as_slice()].concat());
    assert!(table.contains("trade (.svg and .png)"), "{table}");
    let results: serde_json::Value = serde_json::from_slice(&results_json(&dir)).unwrap();
    let trade = results["trade"].as_array().unwrap();
    let settings: Vec<&str> = trade.iter().step_by(2).map(|t| t["setting"].as_str().unwrap()).collect();
    let wanted =
        ["", "diagnosis.filter_cutoff=0.3", "diagnosis.sigma_factor=40.0", "diagnosis.sigma_factor=50.0"];
    assert_eq!(settings, wanted);
    for t in trade {
        assert_eq!(t["disturbed_runs"], 1, "the ramp alone: {t}");
        let hours = t["undisturbed"]["hours"].as_f64().unwrap();
        assert!(
            (hours - 2.0 * 140.0 / 3600.0).abs() < 0.01,
            "two runs, watched from 360 s to 500 s: {hours}"
        );
        assert_eq!(t["faults"][0]["name"], "nominal/afs2");
    }
    let missed: Vec<f64> =
        trade.iter().filter(|t| t["by"] == "signature").map(|t| t["missed_pct"].as_f64().unwrap()).collect();
    assert_eq!((missed[0], missed[3]), (0.0, 100.0), "50 standard deviations are out of reach");
    let tables = std::fs::read_to_string(dir.join("tables.md")).unwrap();
    assert!(
        tables.contains("| `diagnosis.sigma_factor=50.0` |") && tables.contains("| as delivered |"),
        "{tables}"
    );
    assert!(!tables.contains("Settings of the likelihood diagnosis"), "they do not touch it: {tables}");
}

fn results_json(dir: &Path) -> Vec<u8> {
    std::fs::read(dir.join("campaign.json")).expect("campaign.json")
}
