//! `pt326 diagnose`, `pt326 fit-rig` and `pt326 campaign records`, on recordings of our own rig.

use std::fmt::Write as _;
use std::path::Path;

use fdi_core::{Celsius, Command, Config, Instrument};
use firmware_logic::control_loop::TickRecord;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::log_line::{LogLine, VERSION};
use pt326_host::experiment::sample;
use pt326_rig::fault::{Fault, Sensor, Verb};
use pt326_rig::{Disturbance, Rig, RigConfig};

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
    // The page says what the terminal says, and what is read stays where it is though it is among results.
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let alarms = said.lines().find(|line| line.contains(" watched")).unwrap();
    let count = alarms.rsplit(' ').nth(1).unwrap();
    assert!(page.contains(&format!("{count} alarms, the first at")), "{alarms}");
    let beside = pt326(&["diagnose", arg(&trace), "--train", "2:364", "--out", arg(&dir)]);
    assert!(beside.status.success() && trace.exists() && !dir.join("earlier-1").exists());
    assert!(dir.join("diagnosed/trace.csv").exists());
}

/// Nothing wrong was found in nothing.
#[test]
fn a_recording_of_which_nothing_is_judged_has_an_exit_code_of_its_own() {
    let dir = folder("diagnose-not-judged");
    let out = arg(&dir).to_owned();
    let heater = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/heater.csv");
    let done = pt326(&["diagnose", heater, "--train", "0:6000", "--out", &out]);
    let said = text(&done.stdout);
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert!(said.starts_with("Nothing could be judged") && !said.contains("0 alarms"), "{said}");
}

/// The log of a board that is armed before tick `armed`, as the page and `pt326 board --record` save it: T2 is calibrated, and 420 s later
/// it reads 1.5 degC too high. Until the board is armed T1 reads 2 degC too high.
fn log_of_a_board(seconds: f64, armed: u32) -> String {
    let mut config = Config::default();
    config.sensors.t2.offset = Celsius(-2.0);
    let offset = |sensor, size, at, time| Fault::new(Verb::Offset, Some(sensor), Some(size), at, time);
    let begin = f64::from(armed) * 0.11;
    let faults = [offset(Sensor::T1, 2.0, 0.0, begin), offset(Sensor::T2, 1.5, begin + 420.0, 60.0)];
    let mut rig = Rig::new(&RigConfig::default(), Disturbance::Calm, 0.11, 1, &faults);
    let mut instrument = Instrument::new(&config).unwrap();
    let mut log = format!("{}\n", LogLine::Start { version: VERSION });
    firmware_logic::log_line::settings(&config, |line| writeln!(log, "{line}").unwrap());
    for k in 0..(seconds / 0.11) as u32 {
        if k == armed {
            instrument.command(Command::Arm).unwrap();
        }
        let raw = sample(&mut rig);
        let tick = instrument.control(raw);
        let report = instrument.diagnose(&tick, tick.drive);
        rig.advance(f64::from(tick.drive.0));
        writeln!(log, "{}", TickLine::new(&TickRecord::new(raw, tick, tick.drive), &report)).unwrap();
    }
    log
}

/// What was before a board learnt may be anything, such as a thermistor that is about to be mended.
#[test]
fn what_a_board_has_learnt_from_is_learnt_from() {
    let dir = folder("diagnose-armed-late");
    let [log, out] = ["board.log", "diagnosed"].map(|name| dir.join(name));
    std::fs::write(&log, log_of_a_board(600.0, 800)).unwrap();
    let done = pt326(&["diagnose", arg(&log), "--out", arg(&out)]);
    let said = text(&done.stdout);
    let learnt = said.contains("Learnt: 88 to 4") || said.contains("Learnt: 89 to 4");
    assert!(learnt && said.contains("T2 reads 1."), "{said}{}", text(&done.stderr));
}

/// By the board's settings; of a part of it by the defaults, which is said.
#[test]
fn the_log_of_a_board_is_diagnosed_as_a_recording() {
    let dir = folder("diagnose-board");
    let [log, out] = ["board.log", "diagnosed"].map(|name| dir.join(name));
    let text_of = log_of_a_board(500.0, 3);
    let said_of = |lines: &str| {
        std::fs::write(&log, lines).unwrap();
        let done = pt326(&["diagnose", arg(&log), "--out", arg(&out)]);
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stdout)
    };
    let whole = said_of(&text_of);
    assert!(whole.contains("Taken for a board's log") && whole.contains("T2 reads 1."), "{whole}");
    assert!(!whole.contains("does not begin"), "{whole}");
    // T2 as it is calibrated reads 2 °C less: 33 °C in place of 35.
    let colder = |said: &str| ["32.", "33."].iter().any(|t2| said.contains(&format!("°C too high: {t2}")));
    let part: String = text_of.lines().skip(400).map(|line| format!("{line}\n")).collect();
    let late = said_of(&part);
    assert!(
        late.contains("does not begin with the start of the board") && late.contains("T2 reads 1."),
        "{late}"
    );
    assert!(colder(&whole) && !colder(&late), "{whole}\n{late}");
    let other = text_of.replace(&format!("log format {VERSION}"), "log format 4");
    std::fs::write(&log, other).unwrap();
    let refused = pt326(&["diagnose", arg(&log), "--out", arg(&out)]);
    let why = text(&refused.stderr);
    assert!(!refused.status.success() && why.contains("line 1: log format 4, expected 5"), "{why}");
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
    let page = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(page.contains("Held against the truth") && page.contains("False alarms"), "{page}");
}

/// The page about a recording: what was measured over what was expected, each alarm with its sentence, what was learnt, the map; nothing of what
/// the recording lacks.
#[test]
fn a_page_about_a_recording_is_about_the_recording() {
    let dir = folder("diagnose-page");
    let record = dir.join("record.csv");
    std::fs::write(&record, plain_record(&dir)).unwrap();
    let out = dir.join("out");
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let done =
        pt326(&[&["diagnose", arg(&record), "--train", "2:364", "--out", arg(&out)], &map[..]].concat());
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let sentence = said
        .lines()
        .find(|line| line.contains("T1 clogged"))
        .and_then(|line| line.split_once(" s  "))
        .map(|(_, line)| line.split_once(" (so named").map_or(line, |(sentence, _)| sentence))
        .unwrap();
    for part in [
        "<b>T1</b> (°C)",
        "class='band'",
        "class='alarm'",
        "class='train'",
        "What was learnt",
        "95 % interval",
        "--map time=time --map t1=outlet --map power=heater --full-power 100 --fan true",
        sentence,
    ] {
        assert!(page.contains(part), "{part}");
    }
    for part in ["tube", "False alarms", "NaN", "fdv", "src=", "http:", "https:", "<script"] {
        assert!(!page.contains(part), "{part}");
    }
    assert!(!out.join("figure4.svg").exists() && page.len() < 1_000_000);
    assert!(said.contains("all is as expected again") && !said.contains("fdv"), "{said}");
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
    let backwards = format!("t,u,y\n{}", rows(&|k| format!("{},50,20\n", k % 7)));
    assert!(error(&backwards, &map).contains("line 9"));
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

/// A line that is no sample, or an impossible one, ends nothing: it is told where it stands, counted, and the fault behind it is found.
#[test]
fn live_lines_that_are_no_samples_are_told_counted_and_passed_over() {
    let dir = folder("diagnose-live-odd");
    let record = plain_record(&dir);
    let (header, rows) = record.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().collect();
    let normal = dir.join("normal.csv");
    std::fs::write(&normal, format!("{header}\n{}\n", rows[100..3400].join("\n"))).unwrap();
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let common = ["diagnose", "-", "--live", "--train-on", arg(&normal)];
    let long = "9".repeat(200_000);
    let mut lines = vec![header];
    lines.extend(&rows[3400..3450]);
    lines.extend(["374.1,x,50", "374.2,1", "", "# a pause", &long, "374.3,1e30,50", "374.4,\u{1b}[31m,50"]);
    lines.extend(&rows[3450..4700]);
    let done = pt326_reading(&[&common[..], &map[..]].concat(), &(lines.join("\n") + "\n"));
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    for told in [
        "standard input, line 52, column 2 (outlet) is `x`",
        "standard input, line 53: 2 cells, expected 3",
        "standard input, line 56: a line of more than 65536 bytes",
        "line 57: no T1 is so",
        "1301 samples, 4 lines left out, 0 times silent, 1 of T1",
    ] {
        assert!(said.contains(told), "{told}: {said}");
    }
    assert!(said.contains("T1 sees") || said.contains("T1 reads"), "{said}");
    assert!(!said.contains('\u{1b}'), "{said}");
    // Nothing at all, a header without the columns, or no sample behind it is an error.
    let error = |input: &str| {
        let done = pt326_reading(&[&common[..], &map[..]].concat(), input);
        assert_eq!(done.status.code(), Some(2), "{input}");
        text(&done.stderr)
    };
    assert!(error("").contains("expected a header"));
    assert!(
        error("a,b,c\n1,2,3\n").contains("no column `time`") || error("a,b,c\n1,2,3\n").contains("no column")
    );
    assert!(error(&format!("{header}\nx\n")).contains("none of 1 lines was a sample"));
}

/// One row of a recording that no rig can have given neither says what the unit is nor hides the fault behind it; it is told.
#[test]
fn an_odd_row_of_a_recording_is_told() {
    let dir = folder("diagnose-odd");
    let record = plain_record(&dir);
    let mut rows: Vec<&str> = record.lines().collect();
    let (time, _) = rows[3500].split_once(',').unwrap();
    let row = format!("{time},1e30,41");
    rows[3500] = &row;
    let odd = dir.join("odd.csv");
    std::fs::write(&odd, rows.join("\n") + "\n").unwrap();
    let map = ["--map", "time=time", "--map", "t1=outlet", "--map", "power=heater"];
    let done = pt326(&[&["diagnose", arg(&odd), "--train", "2:364", "--out", arg(&dir)], &map[..]].concat());
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(
        said.contains("as error codes of a sensor are: 1, taken as missing.") && said.contains("T1 clogged"),
        "{said}"
    );
    assert!(!said.contains("One unit of T1 counts for"), "{said}");
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

/// The recordings of docs/evidence/records.md are nobody's to copy: they are looked for where `PT326_RECORDS` says.
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
