//! What a definition says, and what is wrong with one.

use std::path::Path;

use crate::{SMALL, fails, folder, results, succeeds};

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
fn a_mistyped_subcommand_is_no_file() {
    for (typed, meant) in [("defin", "define"), ("merg", "merge"), ("sow", "show")] {
        let error = fails(&[typed]);
        assert!(error.contains(&format!("did you mean `pt326 campaign {meant}`")), "{error}");
    }
    let error = fails(&["mine.toml"]);
    assert!(error.contains("mine.toml") && !error.contains("did you mean"), "{error}");
}
