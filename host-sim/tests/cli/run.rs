//! `pt326 run`, its files, and what all commands share: errors and defaults.

use std::path::Path;

use crate::{SHORT, arg, folder, pt326, succeeds_into_a_closed_pipe, text};

#[test]
fn run_writes_everything_it_says() {
    let dir = folder("run");
    let out = dir.join("results");
    let output = pt326(&["run", "--out", out.to_str().unwrap()]);
    let table = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for word in ["AFS2", "MFS1", "MFP", "paper", "Largest control error", "False alarms"] {
        assert!(table.contains(word), "{word}\n{table}");
    }
    for file in ["report.html", "figure4.svg", "figure5.svg", "figure6.svg"] {
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
         fiv_raw,mode,truth,alarm,verdict,confidence,magnitude,magnitude_unit,onset_s,supply,fan_pct,taught,advice,shelve"
    );
    assert!(lines.iter().all(|line| line.split(',').count() == lines[0].split(',').count()));
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
    assert!(pt326(&["run", "--seed", "5", "--out", dir.to_str().unwrap()]).status.success());
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

#[test]
fn printed_defaults_are_accepted_back() {
    let dir = folder("defaults");
    for kind in ["config", "scenario"] {
        let file = dir.join(format!("{kind}.toml"));
        let printed = pt326(&[kind]).stdout;
        assert!(text(&printed).contains('#'), "commented");
        std::fs::write(&file, printed).unwrap();
        let out = dir.join(kind);
        let output =
            pt326(&["run", &format!("--{kind}"), file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
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
        ("--scenario", "duration = \"x\"\n", ["bad.toml", "line 1", "expected a number"]),
        ("--scenario", "[[fault]]\ndo = 3\n", ["bad.toml", "line 2", "expected a word in quotes"]),
        ("--scenario", "[[fault]]\ndo = \"ofset\"\n", ["bad.toml", "line 2", "unknown word `ofset`"]),
        ("--scenario", "[rig]\ngian = 0.3\n", ["bad.toml", "line 2", "gian"]),
    ];
    for (flag, content, words) in cases {
        std::fs::write(&file, content).unwrap();
        let output = pt326(&["run", flag, file.to_str().unwrap(), "--out", dir.to_str().unwrap()]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(words.iter().all(|w| message.contains(w)), "{message}");
        assert!(
            !message.contains("f32") && !message.contains("f64") && !message.contains("variant"),
            "{message}"
        );
    }
    let output = pt326(&["run", "--fault-size", "huge"]);
    assert!(text(&output.stderr).contains("small, nominal, large"));
    let output = pt326(&["run", "--config", "no-such-file.toml"]);
    assert!(text(&output.stderr).contains("no-such-file.toml"));
}

/// A negative factor turns every fault round; the paper's tables do not know T2 reading low.
#[test]
fn faults_can_be_negative() {
    let dir = folder("negative");
    let output =
        pt326(&["run", "--fault-size", "-1", "--disturbance", "none", "--out", dir.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["truth"][0]["size"], -1.5);
    assert!(summary["faults"][0]["signature"]["detected_s"].is_null());
}

fn trace(dir: &Path) -> Vec<u8> {
    std::fs::read(dir.join("trace.csv")).expect("a trace")
}

#[test]
fn earlier_results_are_kept_and_the_same_run_again_leaves_no_copies() {
    let dir = folder("earlier");
    let scenario = dir.join("short.toml");
    std::fs::write(&scenario, SHORT).unwrap();
    let out = dir.join("out");
    let run = |seed| {
        let output = pt326(&["run", "--scenario", arg(&scenario), "--seed", seed, "--out", arg(&out)]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let first = run("1");
    assert!(!first.contains("earlier results"), "{first}");
    let written = trace(&out);
    assert!(!run("1").contains("earlier results"), "the same run again is nothing new");
    let second = run("2");
    assert!(second.contains("The earlier results are now in") && second.contains("earlier-1"), "{second}");
    assert!(trace(&out.join("earlier-1")) == written && trace(&out) != written);
    let moved = std::fs::read_dir(out.join("earlier-1")).unwrap().count();
    let kept = std::fs::read_dir(&out).unwrap().count() - 1;
    assert_eq!(moved, kept, "everything that a run writes is moved");
    assert!(run("1").contains("earlier-2"), "and nothing is ever overwritten");
}

#[test]
fn a_folder_that_cannot_be_written_to_is_told_before_the_work() {
    let dir = folder("unwritable");
    let file = dir.join("file");
    std::fs::write(&file, "no folder").unwrap();
    for out in [file.clone(), file.join("below")] {
        let output = pt326(&["run", "--out", arg(&out)]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains("can't write to the folder") && error.contains(arg(&out)), "{error}");
        assert!(output.stdout.is_empty(), "nothing was run: {}", text(&output.stdout));
    }
}

#[test]
fn a_closed_pipe_ends_it_quietly_with_all_files_written() {
    let dir = folder("closed-run");
    let scenario = dir.join("short.toml");
    std::fs::write(&scenario, SHORT).unwrap();
    let out = dir.join("out");
    succeeds_into_a_closed_pipe(&["run", "--scenario", arg(&scenario), "--out", arg(&out)]);
    assert!(out.join("report.html").exists());
    succeeds_into_a_closed_pipe(&[
        "replay",
        arg(&out.join("trace.csv")),
        "--out",
        arg(&dir.join("replayed")),
    ]);
    succeeds_into_a_closed_pipe(&["repeat", "--scenario", arg(&scenario), "--seeds", "2"]);
    for printed in ["config", "scenario", "--help"] {
        succeeds_into_a_closed_pipe(&[printed]);
    }
    succeeds_into_a_closed_pipe(&["campaign", "define"]);
}

#[test]
fn there_is_no_colour_in_a_pipe_and_colour_where_it_is_forced() {
    let dir = folder("colour");
    let scenario = dir.join("hot.toml");
    std::fs::write(
        &scenario,
        "duration = 30.0\nfault = [{ do = \"open\", sensor = \"t1\", at = 20.0, for = 5.0 }]\n",
    )
    .unwrap();
    let out = dir.join("out");
    let args = ["run", "--scenario", arg(&scenario), "--out", arg(&out)];
    let plain = text(&pt326(&args).stdout);
    assert!(plain.contains("TRIPPED") && !plain.contains('\x1b'), "{plain}");
    let forced = text(&crate::command(&args).env("CLICOLOR_FORCE", "1").output().unwrap().stdout);
    assert!(forced.contains("\x1b["), "{forced}");
    assert_eq!(anstream::adapter::strip_str(&forced).to_string(), plain);
    let none = crate::command(&args).env("NO_COLOR", "1").output().unwrap().stdout;
    assert_eq!(text(&none), plain);
}
