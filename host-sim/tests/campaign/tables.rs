//! Tables beside that of the cells: against the truth, of runaways, of the trade between settings.

use std::path::Path;

use crate::{folder, results, succeeds};

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
    assert!(table.contains("trade (.svg)"), "{table}");
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

/// A number of the method is varied as a setting is: no chart fires on innovations that are clipped below their allowance.
#[test]
fn numbers_of_the_method_are_varied_by_their_names() {
    let (dir, file) = folder("tuning", TRADE);
    let out = dir.to_str().unwrap();
    let args = [file.as_str(), "--out", out, "--only", "nominal", "--vary", "tuning.charts.clip=0.1"];
    succeeds(&args);
    let results: serde_json::Value = serde_json::from_slice(&results_json(&dir)).unwrap();
    let trade = results["trade"].as_array().unwrap();
    let missed = |setting: &str| {
        let of = trade.iter().find(|t| t["setting"] == setting && t["by"] == "likelihood");
        of.expect(setting)["missed_pct"].as_f64().unwrap()
    };
    assert_eq!((missed(""), missed("tuning.charts.clip=0.1")), (0.0, 100.0));
}

/// Half and twice of each number; one that matters shows in its rows, one that these runs never use does not.
#[test]
fn an_ablation_tells_what_matters_from_what_does_not() {
    let definition = "seeds_from = 700\n[[cell]]\nname = \"offset\"\nruns = 1\n\
                      fault = [{ do = \"offset\", sensor = \"t2\", size = 1.5, at = 400.0, for = 10.0 }]";
    let vary = |name: &str, definition: &str, args: &[&str]| {
        let (dir, file) = folder(name, definition);
        succeeds(&[&[file.as_str(), "--out", dir.to_str().unwrap()], args].concat());
        std::fs::read_to_string(dir.join("vary.md")).unwrap()
    };
    let args = ["--vary", "tuning.charts.clip=0.1", "--vary", "tuning.taught.size_sd=0.4"];
    let text = vary("worth", definition, &args);
    let row = |text: &str, start: &str| text.lines().find(|line| line.starts_with(start)).map(str::to_owned);
    let clip = row(&text, "| `tuning.charts.clip` | 0.1 | 1 |  | +1 |");
    assert!(clip.is_some_and(|row| row.contains("| -1 |")), "no chart reaches its limit: {text}");
    assert!(row(&text, "| `tuning.taught.size_sd` | 0.4 | none |").is_some(), "nothing is taught: {text}");
    assert!(text.contains("**1 of 2: no value has any effect.** `tuning.taught.size_sd`"), "{text}");

    let short = "[[cell]]\nname = \"short\"\nruns = 1\nduration = 1.0";
    let text = vary("ablation", short, &["--ablate", "--threads", "1"]);
    let of_one = |name: &str| text.lines().filter(|line| line.starts_with(&format!("| `{name}` |"))).count();
    assert_eq!((of_one("tuning.charts.clip"), of_one("tuning.alarm.raise")), (2, 2), "{text}");
    assert_eq!(
        text.matches("| none |").count(),
        text.matches("| `tuning.").count(),
        "too short for any: {text}"
    );
}

fn results_json(dir: &Path) -> Vec<u8> {
    std::fs::read(dir.join("campaign.json")).expect("campaign.json")
}
