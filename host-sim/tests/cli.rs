//! The command as a user calls it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn host_sim(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).args(args).output().expect("host-sim runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A fresh folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).expect("folder");
    dir
}

#[test]
fn run_writes_everything_it_says() {
    let dir = folder("run");
    let out = dir.join("results");
    let output = host_sim(&["run", "--out", out.to_str().unwrap()]);
    let table = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for word in ["AFS2", "MFS1", "MFP", "paper", "Largest control error", "False alarms"] {
        assert!(table.contains(word), "{word}\n{table}");
    }
    for file in [
        "report.html",
        "figure4.svg",
        "figure4.png",
        "figure5.svg",
        "figure5.png",
        "figure6.svg",
        "figure6.png",
    ] {
        let size = std::fs::metadata(out.join(file)).unwrap_or_else(|_| panic!("{file}")).len();
        assert!(size > 5000, "{file} has {size} bytes");
    }
    let trace = std::fs::read_to_string(out.join("trace.csv")).unwrap();
    let lines: Vec<&str> = trace.lines().collect();
    assert_eq!(lines.len(), 7728, "a header and floor(850 / 0.11) rows");
    assert_eq!(
        lines[0],
        "t_s,t0_c,t1_c,t2_c,setpoint_c,u_pid_pct,prbs_pct,pa_pct,y1_c,y2_c,y1m_c,y2m_c,sg1,sg2,bw1,ry1,ry2,rap,ry12,\
         rsg1,rsg2,rbw1,ry1_f,ry2_f,rap_f,ry12_f,rsg1_f,rsg2_f,rbw1_f,s_rap,s_ry12,s_rsg1,s_rsg2,s_rbw1,fdv,fiv,fdv_raw,\
         fiv_raw,mode,truth,alarm,verdict,confidence,magnitude,magnitude_unit,onset_s"
    );
    assert!(lines.iter().all(|line| line.split(',').count() == 46));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["faults"][2]["name"], "MFP");
    assert!(summary["faults"][1]["signature_raw"]["detected_s"].is_null(), "raw residuals miss MFS1: null");
    assert!((summary["baseline"]["rap"]["mean"].as_f64().unwrap() - 41.6).abs() < 1.0);
}

/// What the trace says can be checked with the trace alone: residuals, filter, symptoms.
#[test]
fn the_trace_is_consistent() {
    let dir = folder("consistent");
    assert!(host_sim(&["run", "--seed", "5", "--out", dir.to_str().unwrap()]).status.success());
    let trace = std::fs::read_to_string(dir.join("trace.csv")).unwrap();
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap();
    let mut lines = trace.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |row: &Vec<&str>, name: &str| row[column(name)].parse::<f64>().ok();
    let normal = |residual: &str, key: &str| summary["baseline"][residual][key].as_f64().unwrap();
    let keep = (-0.6f64 * 0.11).exp();
    let mut checked = 0;
    for pair in rows.windows(2) {
        for (residual, feature) in [("rap", "pa_pct"), ("rsg1", "sg1"), ("rsg2", "sg2"), ("rbw1", "bw1")] {
            let name_f = format!("{residual}_f");
            let Some(before) = number(&pair[0], &name_f) else { continue };
            let (Some(r), Some(r_f)) = (number(&pair[1], residual), number(&pair[1], &name_f)) else {
                continue;
            };
            let scale = normal(residual, "sigma");
            assert!(
                (r - (number(&pair[1], feature).unwrap() - normal(residual, "mean"))).abs() < 1e-3 * scale
            );
            assert!((r_f - (keep * before + (1.0 - keep) * r)).abs() < 0.02 * scale, "{residual}");
            let middle = normal(residual, "mean_f") - normal(residual, "mean");
            let distance = (r_f - middle) / normal(residual, "sigma_f");
            let symptom = number(&pair[1], &format!("s_{residual}")).unwrap();
            if (distance.abs() - 3.0).abs() > 0.01 {
                assert_eq!(
                    symptom,
                    if distance.abs() > 3.0 { distance.signum() } else { 0.0 },
                    "{residual} {distance}"
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 10_000, "{checked}");
}

/// The trace alone knows onsets to a tick only: the summary beside it is used, if it is of the same run.
#[test]
fn replay_gives_the_delays_of_the_run() {
    let dir = folder("delays");
    let run = |args: &[&str], out: &Path| {
        let output = host_sim(&[args, &["--out", out.to_str().unwrap()]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let faults = |out: &Path| {
        let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&summary).unwrap()["faults"].clone()
    };
    let [first, replayed, alone, other] = ["first", "replayed", "alone", "other"].map(|name| dir.join(name));
    run(&["run"], &first);
    let trace = first.join("trace.csv");
    run(&["replay", trace.to_str().unwrap()], &replayed);
    assert_eq!(faults(&replayed), faults(&first));

    std::fs::create_dir_all(&alone).unwrap();
    std::fs::copy(&trace, alone.join("trace.csv")).unwrap();
    let copy = alone.join("trace.csv");
    let printed = run(&["replay", copy.to_str().unwrap()], &dir.join("replayed alone"));
    assert!(printed.contains("onsets to a tick only"), "{printed}");
    run(&["run", "--fault-size", "2"], &other);
    let summary = std::fs::read_to_string(other.join("summary.json")).unwrap();
    std::fs::write(alone.join("summary.json"), summary.replace("384.5", "383.5")).unwrap();
    let printed = run(&["replay", copy.to_str().unwrap()], &dir.join("replayed beside another"));
    assert!(printed.contains("onsets to a tick only"), "{printed}");
}

/// The instrument behind a pipe is the instrument in the run.
#[test]
fn core_answers_bad_lines_with_exit_code_2() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .arg("core")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(b"2160,2160,2160\n2160,oops,2160\n").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stdout).lines().count(), 2);
    let message = text(&output.stderr);
    assert!(
        message.contains("line 2") && message.contains("oops") && message.contains("0 to 4095"),
        "{message}"
    );
}

#[test]
fn printed_defaults_are_accepted_back() {
    let dir = folder("defaults");
    for kind in ["config", "scenario"] {
        let file = dir.join(format!("{kind}.toml"));
        let printed = host_sim(&[kind]).stdout;
        assert!(text(&printed).contains('#'), "commented");
        std::fs::write(&file, printed).unwrap();
        let out = dir.join(kind);
        let output =
            host_sim(&["run", &format!("--{kind}"), file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let trace = |kind: &str| std::fs::read(dir.join(kind).join("trace.csv")).unwrap();
    assert!(trace("config") == trace("scenario"), "both are the default run");
}

#[test]
fn errors_name_file_line_and_key() {
    let dir = folder("errors");
    let file = dir.join("bad.toml");
    let cases = [
        ("--config", "[pid]\nkp = -1\n", ["bad.toml", "pid.kp is -1", "expected 0 to 1000"]),
        ("--config", "[pid]\nkp = \"x\"\n", ["bad.toml", "line 2", "kp"]),
        ("--scenario", "[rig]\ngian = 0.3\n", ["bad.toml", "line 2", "gian"]),
    ];
    for (flag, content, words) in cases {
        std::fs::write(&file, content).unwrap();
        let output = host_sim(&["run", flag, file.to_str().unwrap(), "--out", dir.to_str().unwrap()]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(words.iter().all(|w| message.contains(w)), "{message}");
    }
    let output = host_sim(&["run", "--fault-size", "huge"]);
    assert!(text(&output.stderr).contains("small, nominal, large"));
    let output = host_sim(&["run", "--config", "no-such-file.toml"]);
    assert!(text(&output.stderr).contains("no-such-file.toml"));
}

/// A negative factor turns every fault round; the paper's tables do not know T2 reading low.
#[test]
fn faults_can_be_negative() {
    let dir = folder("negative");
    let output =
        host_sim(&["run", "--fault-size", "-1", "--disturbance", "none", "--out", dir.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["truth"][0]["size"], -1.5);
    assert!(summary["faults"][0]["signature"]["detected_s"].is_null());
}
