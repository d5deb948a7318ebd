//! The same hot end in the forms that loggers write: each must come to the same samples, and what was not taken as it stands is said.

use std::fmt::Write as _;
use std::sync::OnceLock;

use pt326_host::recording::map::Role;
use pt326_host::recording::{Reading, Recording};

use crate::{arg, folder, pt326, pt326_reading, text};

/// Ts of the preset, s.
const TS: f64 = 0.5;

/// Temperature to a tenth, and power as a share to a thousandth, as a printer logs them; with faults from 60 % on.
fn hot_end() -> &'static [(f64, f64)] {
    static ROWS: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let dir = folder("forms-hotend");
        let out = pt326(&["run", "--preset", "hotend", "--seed", "3", "--out", arg(&dir)]);
        assert!(out.status.success(), "{}", text(&out.stderr));
        let trace = std::fs::read_to_string(dir.join("trace.csv")).unwrap();
        let rows = trace.lines().skip(1).map(|line| {
            let cell = |i: usize| line.split(',').nth(i).unwrap().parse::<f64>().unwrap();
            ((cell(2) * 10.0).round() / 10.0, (cell(7) * 10.0).round() / 1000.0)
        });
        rows.collect()
    })
}

/// A table of some rows, each written by `row` from its number, temperature and power.
fn table(header: &str, count: usize, row: impl Fn(usize, f64, f64) -> String) -> String {
    let rows = hot_end()[..count].iter().enumerate().map(|(k, (t1, pwm))| row(k, *t1, *pwm) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}

fn parse(text: &str) -> Recording {
    Recording::parse("log".into(), text, &Reading::default()).unwrap_or_else(|error| panic!("{error:#}"))
}

/// Largest difference of T1 (degC) and of the power (% of the full one) to the hot end's, where there is a sample.
fn difference(recording: &Recording) -> (f64, f64) {
    let samples = &recording.heaters[0].samples;
    let full = f64::from(recording.units.full_power);
    samples.iter().zip(hot_end()).fold((0.0, 0.0), |(t, p): (f64, f64), (sample, (t1, pwm))| {
        let of = |x: Option<f32>, y: f64| x.map_or(0.0, |x| (f64::from(x) - y).abs());
        (t.max(of(sample.t[1], *t1)), p.max(of(sample.power.map(|p| p / full as f32), *pwm)))
    })
}

#[test]
fn times_and_numbers_of_all_kinds_are_the_same_samples() {
    let stamp = |k: usize, more: f64| {
        let s = 36_000.0 + TS * k as f64 + more;
        format!("{:02}:{:02}:{:06.3}", (s / 3600.0) as u32, (s / 60.0) as u32 % 60, s % 60.0)
    };
    let comma = |x: f64| x.to_string().replace('.', ",");
    for (what, text) in [
        ("seconds", table("time,temp,pwm", 900, |k, t, p| format!("{},{t},{p}", TS * k as f64))),
        ("ms", table("time,temp,pwm", 900, |k, t, p| format!("{},{t},{p}", 500 * k))),
        (
            "unix, ns",
            table("time,temp,pwm", 900, |k, t, p| {
                format!("{},{t},{p}", 1_714_557_600_000_000_000 + 500_000_000 * k as u64)
            }),
        ),
        ("ISO", table("time,temp,pwm", 900, |k, t, p| format!("2024-05-01T{}Z,{t},{p}", stamp(k, 0.0)))),
        ("date", table("time,temp,pwm", 900, |k, t, p| format!("2024-05-01 {},{t},{p}", stamp(k, 0.0)))),
        ("US", table("time,temp,pwm", 900, |k, t, p| format!("5/13/2024 {},{t},{p}", stamp(k, 0.0)))),
        ("clock", table("time,temp,pwm", 900, |k, t, p| format!("{},{t},{p}", stamp(k, 0.0)))),
        (
            "comma",
            table("Zeit/time;temp [°C];duty [%]", 900, |k, t, p| {
                format!("{};{};{}", comma(TS * k as f64), comma(t), comma(p))
            }),
        ),
        (
            "counts",
            table("t_ms\tset\ttemperature\tPWM", 900, |k, t, p| {
                format!("{}\t180\t{t}\t{}", 500 * k, (255.0 * p).round())
            }),
        ),
        (
            "percent",
            table("t,heater power,setpoint,heater temp", 900, |k, t, p| {
                format!("{}s,{} %,180,{t} °C", TS * k as f64, 100.0 * p)
            }),
        ),
        (
            "Fahrenheit",
            table("time,temp_F,pwm", 900, |k, t, p| format!("{},{:.3},{p}", TS * k as f64, 1.8 * t + 32.0)),
        ),
        ("CRLF", table("time,temp,pwm", 900, |k, t, p| format!("{},{t},{p}\r", TS * k as f64))),
        (
            "kiln",
            table("INFO oven: start", 900, |k, t, p| {
                let time = format!("2024-05-01 {}", stamp(k, 0.0).replace('.', ","));
                format!("{time} INFO oven: temp ={t}, target=180, pid={p}, heat_on={p}, run_id={k}")
            }),
        ),
        (
            "JSON, a line each",
            table("", 900, |k, t, p| {
                format!("{{\"time\": {}, \"temp\": {t}, \"duty\": {p}}}", TS * k as f64)
            }),
        ),
        (
            "seconds only",
            table("time,temp,pwm", 900, |k, t, p| format!("2024-05-01 {},{t},{p}", &stamp(k, 0.0)[..8])),
        ),
    ] {
        let recording = parse(&text);
        assert!((recording.sample_time - TS).abs() < 1e-9, "{what}: {} s", recording.sample_time);
        assert_eq!((recording.len(), recording.sessions.len()), (900, 1), "{what}");
        let (t, p) = difference(&recording);
        assert!(t < 1e-3 && p < 0.003, "{what}: {t} degC, {p} of the power");
        assert!(
            recording.remarks[0].starts_with("Columns are taken for what they are called; the same: --map "),
            "{:?}",
            recording.remarks
        );
    }
}

/// The arguments that it tells give the same recording.
#[test]
fn the_arguments_that_are_told_say_the_same() {
    let text =
        table("Time (ms);set point;Block temp [°C];Duty", 300, |k, t, p| format!("{};180;{t};{p}", 500 * k));
    let guessed = parse(&text);
    assert_eq!(
        guessed.remarks[0],
        "Columns are taken for what they are called; the same: --map 'time=Time (ms)' --map 't1=Block temp [°C]' --map power=Duty --full-power 1 --fan false"
    );
    let map = ["time=Time (ms)", "t1=Block temp [°C]", "power=Duty"].map(str::to_owned).to_vec();
    let how = Reading { map, full_power: Some(1.0), fan: Some(false), ..Reading::default() };
    let told = Recording::parse("log".into(), &text, &how).unwrap();
    assert_eq!(told.heaters[0].samples, guessed.heaters[0].samples);
    assert_eq!((told.units, told.heaters[0].inputs), (guessed.units, guessed.heaters[0].inputs));
}

#[test]
fn jitter_is_brought_to_a_grid_and_said() {
    let late = |k: usize| 0.15 * TS * f64::from((k as u32).wrapping_mul(0x9E37_79B9) >> 24) / 64.0;
    let text = table("time,temp,pwm", 900, |k, t, p| format!("{:.4},{t},{p}", TS * k as f64 + late(k)));
    let recording = parse(&text);
    assert_eq!(recording.sample_time, TS);
    assert!(
        recording.remarks.iter().any(|said| said.contains("uneven, 0.3") && said.contains("a grid of 0.5 s")),
        "{:?}",
        recording.remarks
    );
    // It heats by 2 degC in a sample.
    let (t, _) = difference(&recording);
    assert!(t < 1.6, "{t} degC");
}

#[test]
fn a_time_that_falls_back_or_leaps_begins_another_session() {
    for (what, second) in [("back", 0.0), ("on", 5000.0)] {
        let time = |k: usize| if k < 300 { TS * k as f64 } else { second + TS * (k - 300) as f64 };
        let text = table("time,temp,pwm", 600, |k, t, p| format!("{},{t},{p}", time(k)));
        let recording = parse(&text);
        let [first, then] = recording.sessions.as_slice() else { panic!("{what}: {:?}", recording.sessions) };
        assert_eq!((first.clone(), then.len()), (0..300, 300), "{what}");
        let samples = &recording.heaters[0].samples;
        assert!(
            samples[300..then.start].iter().all(|sample| sample.t[1].is_none() && sample.power.is_none())
        );
        assert_eq!(samples[then.start].t[1], Some(hot_end()[300].0 as f32), "{what}");
        assert!(
            recording.remarks.iter().any(|said| said.contains("begin anew 1 times (line 302 at")),
            "{:?}",
            recording.remarks
        );
    }
    // What is told twice is told once.
    let time = |k: usize| TS * (if k < 300 { k } else { k - 1 }) as f64;
    let recording = parse(&table("time,temp,pwm", 600, |k, t, p| format!("{},{t},{p}", time(k))));
    assert_eq!((recording.sessions.len(), recording.len()), (1, 599));
    // A gap that is no more than that stays where it is.
    let time = |k: usize| TS * (if k < 300 { k } else { k + 50 }) as f64;
    let recording = parse(&table("time,temp,pwm", 600, |k, t, p| format!("{},{t},{p}", time(k))));
    assert_eq!((recording.sessions.len(), recording.len()), (1, 650));
    assert!(recording.remarks.contains(&"50 of 650 samples are missing.".into()), "{:?}", recording.remarks);
    // What falls back all the time is no time.
    let text = table("time,temp,pwm", 600, |k, t, p| format!("{},{t},{p}", k % 7));
    let error = Recording::parse("log".into(), &text, &Reading::default()).unwrap_err().to_string();
    assert!(error.starts_with("log, line 9: time 0 comes after 6, expected a later one"), "{error}");
}

/// A printer's log with two starts, of which the first ends in a shutdown: the log goes on and repeats what was measured last.
fn klipper_log() -> String {
    let mut log = "Start printer at Wed May  1 10:00:00 2024 (1714550400.0 90.0)\n".to_owned();
    let stats = |log: &mut String, at: f64, t1: f64, pwm: f64| {
        let _ = writeln!(
            log,
            "Stats {at:.1}: gcodein=0  mcu: mcu_awake=0.001 freq=16000147 heater_bed: target=60 temp={:.1} pwm={:.3} mcu: temp=31.3 \
             print_time=0.007 buffer_time=0.000 print_stall=0 extruder: target=180 temp={t1:.1} pwm={pwm:.3}",
            60.0 + 0.1 * (at % 7.0).floor(),
            0.2 + 0.01 * (at % 5.0).floor(),
        );
    };
    for (k, (t1, pwm)) in hot_end()[..1500].iter().enumerate() {
        let at = if k < 600 { 100.0 } else { 4000.0 } + TS * k as f64;
        if k == 600 {
            log += "Transition to shutdown state: Heater extruder not heating at expected rate\n";
            (0..60)
                .for_each(|i| stats(&mut log, 400.0 + TS * f64::from(i), hot_end()[599].0, hot_end()[599].1));
            log += "Start printer at Wed May  1 11:00:00 2024 (1714554000.0 4290.0)\n";
            (0..4).for_each(|i| stats(&mut log, at - TS * f64::from(4 - i), 0.0, 0.0));
        }
        stats(&mut log, at, *t1, *pwm);
    }
    log
}

#[test]
fn a_printers_log_has_its_starts_its_bed_and_nothing_of_the_shutdown() {
    let recording = parse(&klipper_log());
    assert!(
        recording.remarks[0]
            .starts_with("Taken for Klipper's log; the same: --map time=t_s --map t1=extruder_temp"),
        "{:?}",
        recording.remarks
    );
    let columns: Vec<_> =
        recording.heaters.iter().map(|heater| heater.map.column(Role::T1).unwrap()).collect();
    assert_eq!(columns, ["extruder_temp", "heater_bed_temp"]);
    let [first, second] = recording.sessions.as_slice() else { panic!("{:?}", recording.sessions) };
    assert_eq!((first.clone(), second.len()), (0..600, 904));
    let samples = &recording.heaters[0].samples[second.clone()];
    assert!(samples[..4].iter().all(|sample| sample.t[1].is_none()), "{:?}", &samples[..4]);
    assert_eq!(samples[4].t[1], Some(hot_end()[600].0 as f32));
    assert!(
        recording.remarks.iter().any(|said| said.starts_with("4 temperatures at the beginning are 0")),
        "{:?}",
        recording.remarks
    );
}

/// The same as a table, where nothing says that there was a shutdown.
#[test]
fn a_power_that_is_frozen_with_its_temperature_is_not_judged() {
    let frozen = |k: usize| k.min(599);
    let text = table("t_s,extruder_temp,extruder_pwm", 900, |k, _, _| {
        let (t1, pwm) = hot_end()[frozen(k)];
        format!("{},{t1},{pwm}", TS * k as f64)
    });
    let recording = parse(&text);
    assert!(
        recording.remarks.iter().any(|said| said.starts_with("300 samples at the end of a session repeat")),
        "{:?}",
        recording.remarks
    );
    assert!(recording.heaters[0].samples[600..].iter().all(|sample| sample.power.is_none()));
}

/// Two logs of one heater, of which one never comes to full power, are of one unit.
#[test]
fn a_recording_and_what_it_is_trained_on_have_the_same_units() {
    let counts = |most: f64| {
        move |k: usize, t: f64, p: f64| {
            format!("{},{t},{}", TS * k as f64 * 1.003, (255.0 * p.min(most)).round())
        }
    };
    let text = table("time,temp,pwm", 600, counts(1.0));
    let normal = ("normal".into(), table("time,temp,pwm", 600, counts(0.3)));
    let (this, other) =
        Recording::with_other(("log".into(), &text), Some(normal), &Reading::default()).unwrap();
    let other = other.unwrap();
    assert_eq!((this.units, this.sample_time), (other.units, other.sample_time));
    assert_eq!(this.units.full_power, 255.0);
}

/// Lines with times: what is missing is missing, what falls back is another session, and each thing said is an object of its own.
#[test]
fn live_lines_with_times_are_put_where_their_times_are() {
    let dir = folder("forms-live");
    let normal = dir.join("normal.csv");
    let date = |k: usize| {
        let s = 36_000.0 + TS * k as f64;
        format!("2024-05-01 {:02}:{:02}:{:04.1}", (s / 3600.0) as u32, (s / 60.0) as u32 % 60, s % 60.0)
    };
    std::fs::write(&normal, table("time,temp,pwm", 3300, |k, t, p| format!("{},{t},{p}", date(k)))).unwrap();
    let row = |k: usize| format!("{},{},{}\n", date(k), hot_end()[k].0, hot_end()[k].1);
    let mut lines = "time,temp,pwm\n".to_owned();
    lines.extend((3000..3100).map(row)); // a session
    lines.extend((3150..3200).map(row)); // 50 samples later
    lines += "x,1,2\n"; // and one that is none
    lines.extend((3201..3300).map(row));
    lines.extend((3000..3100).map(row)); // back
    lines.extend((3000..3300).map(row)); // and again
    let common = ["diagnose", "-", "--live", "--json", "--train-on", arg(&normal)];
    let done = pt326_reading(&common, &lines);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let said = text(&done.stdout);
    let said: Vec<serde_json::Value> = said
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|why| panic!("{why}: {line}")))
        .collect();
    let events: Vec<&str> = said.iter().map(|said| said["event"].as_str().unwrap()).collect();
    assert_eq!((events[0], *events.last().unwrap()), ("learnt", "end"), "{events:?}");
    let sessions: Vec<_> =
        said.iter().filter(|said| said["event"] == "session").map(|said| &said["line"]).collect();
    assert_eq!(sessions, [252, 352], "{events:?}");
    let end = said.last().unwrap();
    assert_eq!((&end["samples"], &end["left_out"], &end["passed"]), (&649.into(), &1.into(), &700.into()));
}

/// A real-looking log, as it is: read, cut, learnt from and diagnosed, the bed that cannot be learnt from told apart.
#[test]
fn a_printers_log_is_diagnosed_as_it_is() {
    let dir = folder("forms-klipper");
    let file = dir.join("klippy.log");
    std::fs::write(&file, klipper_log()).unwrap();
    let done = pt326(&["diagnose", arg(&file), "--train", "350:750", "--out", arg(&dir.join("out"))]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{said}{}", text(&done.stderr));
    assert!(said.contains("t1=extruder_temp") && said.contains("Fit, simulated"), "{said}");
    assert!(said.contains("heater_bed_temp"), "{said}");
    // The line of the log itself.
    let line = 1 + klipper_log().lines().position(|line| line.starts_with("Stats 4298.0")).unwrap();
    assert!(said.contains(&format!("begin anew 1 times (line {line} at")), "{line}: {said}");
    assert!(said.contains("Not judged: 0.00 to 350.00 s, before what was learnt from."), "{said}");
}
