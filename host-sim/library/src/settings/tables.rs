//! The tables of docs/diagnosis.md that repeat the code are made from it.

use fdi_core::Config;
use fdi_core::likelihood::Tuning;
use fdi_core::likelihood::described::{self, Described, Term};

use super::short;

/// Each table by its mark in the document.
fn tables() -> [(&'static str, String); 5] {
    [
        ("priors", priors()),
        ("charts", charts()),
        ("nuisances", nuisances()),
        ("hypotheses", hypotheses()),
        ("times", times()),
    ]
}

fn priors() -> String {
    let (t, r) = (Tuning::DEFAULT.prior, Tuning::DEFAULT.range);
    let ticks = |ln: f32| format!("{:.1}", ln.exp());
    let factor = |ln: f32| format!("factor e^{ln}");
    let rows = [
        ["K gain", "°C per %", "usual gain", &factor(t.wide)],
        ["tau heater", "ticks", &format!("{} Ta", t.heater), &factor(t.heater_sd)],
        ["d1 dead time to T1", "ticks", &t.delay1.to_string(), &t.delay_sd.to_string()],
        ["t1 lag of T1", "ticks", &ticks(t.lag1), &factor(t.lag_sd)],
        ["s1 wall at T1", "share", &t.wall1.to_string(), &t.wall_sd.to_string()],
        ["r2 what reaches T2", "share", &t.reaches.to_string(), &t.reaches_sd.to_string()],
        ["d2 transport from T1 to T2", "ticks", &t.delay2.to_string(), &t.delay_sd.to_string()],
        ["t2 lag of T2", "ticks", &ticks(t.lag2), &factor(t.lag_sd)],
        ["s2 wall at T2 on top", "share", &t.wall2.to_string(), &t.wall_sd.to_string()],
        [
            "tw wall",
            "ticks",
            &format!("{} Ta, within {} standard deviations", t.wall_time, r.wall_sds),
            &factor(t.wide),
        ],
        [
            "c1, c2 offsets from T0",
            "°C",
            "0; on a cold rig as read",
            &format!("{}; of a reading: {}", t.offset_sd, Tuning::DEFAULT.sensors.noise),
        ],
        ["q curvature", &format!("per {} %", Tuning::DEFAULT.model.step), "0", &t.curvature_sd.to_string()],
    ];
    table(&["parameter", "unit", "prior: mean", "standard deviation"], rows.iter().map(|row| row.join(" | ")))
}

/// Mean samples between false alarms of one side (Siegmund 1985).
fn run_length(k: f32, h: f32) -> f64 {
    let (k, b) = (f64::from(k), f64::from(h) + 1.166);
    ((2.0 * k * b).exp() - 1.0 - 2.0 * k * b) / (2.0 * k * k)
}

fn charts() -> String {
    let config = Config::default();
    let (c, ts) = (&config.likelihood, f64::from(config.sample_time.0));
    let row = |name: &str, on: &str, k: f32, h: f32, each: &str| {
        let length = run_length(k, h);
        let years = length * ts / 2.0 / (365.25 * 86400.0);
        format!("{name} | {on} | {k} | {h} | {length:.1e} | {years:.1} years{each}")
    };
    let rows = [
        row("fast", "z1, z2", c.fast_allowance, c.fast_interval, " each"),
        row("slow", "z2", c.slow_allowance, c.slow_interval, ""),
    ];
    table(&["chart", "on", "k", "h", "L in samples", &format!("two-sided, at {ts:.2} s")], rows.into_iter())
}

/// A number with its unit; shares in %.
fn with_unit(value: f32, unit: &str) -> String {
    match unit {
        "" => format!("{} %", short((1000.0 * value).round() / 10.0)),
        "1/f - 1" => format!("{} % in 1/f", short((1000.0 * value).round() / 10.0)),
        "degC" => format!("{} °C", short(value)),
        "degC/min" => format!("{} °C a minute", short(value)),
        unit => format!("{} {unit}", short(value)),
    }
}

fn nuisances() -> String {
    let tuning = Config::default().tuning;
    let lists: [&[Term]; 3] = [
        &described::since_onset(tuning),
        &described::since_training(tuning),
        &described::model_errors(tuning),
    ];
    let mut names: Vec<&str> = Vec::new();
    lists.iter().copied().flatten().for_each(|term| {
        if !names.contains(&term.name) {
            names.push(term.name);
        }
    });
    let rows = names.into_iter().map(|name| {
        let of = |list: &[Term]| {
            let term = list.iter().find(|term| term.name == name);
            term.map_or("-".into(), |term| with_unit(term.sd, term.unit))
        };
        format!("{name} | {}", lists.map(of).join(" | "))
    });
    table(&["nuisance", "since the onset", "since training", "of the model, right after training"], rows)
}

fn hypotheses() -> String {
    let prior = |term: &Term| {
        let (mean, sd) = (with_unit(term.mean, term.unit), with_unit(term.sd, term.unit));
        format!("{} {} ± {sd}", term.name, mean.split(' ').next().unwrap_or_default())
    };
    let row = |h: &Described| {
        let second = match (&h.second, h.stuck_at) {
            (Some(second), true) => {
                format!("; {}, what it reads then ± {}", second.name, with_unit(second.sd, second.unit))
            }
            (Some(second), false) => format!("; {}", prior(second)),
            (None, _) => String::new(),
        };
        let range = h.range.map_or(String::new(), |(low, high)| {
            let (low, high) = (with_unit(low, h.first.unit), with_unit(high, h.first.unit));
            format!("{} to {high}", low.split(' ').next().unwrap_or_default())
        });
        let since = if h.since_training { "yes" } else { "" };
        format!("{} | {}{second} | {range} | {} | {since}", h.class.name(), prior(&h.first), short(h.prior))
    };
    let head = [
        "class",
        "frees, with mean ± standard deviation",
        "magnitude within",
        "log odds beforehand",
        "since training",
    ];
    table(&head, described::hypotheses(Config::default().tuning).iter().map(row))
}

fn times() -> String {
    let rows = Tuning::PARTS.iter().flat_map(|part| part.entries).filter(|entry| entry.unit == "s");
    let rows = rows.map(|entry| {
        let about = entry.about.lines().map(str::trim).collect::<Vec<_>>().join(" ");
        format!("`{}` | {} s | {about}", entry.name, short((entry.value)(&Tuning::DEFAULT)))
    });
    table(&["time", "on the reference rig", "what it is"], rows)
}

fn table(head: &[&str], rows: impl Iterator<Item = String>) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    rows.for_each(|row| text += &format!("| {row} |\n"));
    text
}

#[test]
fn the_tables_of_the_diagnosis_are_not_stale() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/diagnosis.md");
    let committed = std::fs::read_to_string(path).unwrap();
    let mut text = committed.clone();
    for (name, table) in tables() {
        let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end {name} -->"));
        let (head, rest) = text.split_once(&begin).expect(name);
        let (_, tail) = rest.split_once(&end).expect(name);
        text = format!("{head}{begin}{table}{end}{tail}");
    }
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert!(
        committed == text,
        "stale: UPDATE_DOCS=1 cargo test -p pt326-host --lib the_tables_of_the_diagnosis"
    );
}

#[test]
fn a_run_length_is_that_of_the_formula() {
    assert!((run_length(0.5, 4.0) - 337.0).abs() < 2.0, "{}", run_length(0.5, 4.0));
}

/// Files and names of the third column of docs/glossary.md are in the code.
#[test]
fn the_names_of_the_glossary_are_in_the_code() {
    let top = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let (mut code, mut folders) = (String::new(), vec![format!("{top}/fdi-core/src/likelihood").into()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir::<std::path::PathBuf>(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                code += &format!("{}\n{}", path.display(), std::fs::read_to_string(&path).unwrap());
            }
        }
    }
    let words: Vec<&str> = code.split(|c: char| !(c.is_alphanumeric() || "_.".contains(c))).collect();
    let glossary = std::fs::read_to_string(format!("{top}/docs/glossary.md")).unwrap();
    let rows = glossary.lines().filter(|line| line.starts_with("| ")).skip(1);
    let names = rows.flat_map(|row| row.split('|').nth(3).unwrap_or_default().split('`').skip(1).step_by(2));
    let names: Vec<&str> = names.flat_map(|name| name.split("::")).collect();
    assert!(names.len() > 40, "{names:?}");
    for name in names {
        assert!(words.iter().any(|word| word.split('.').any(|part| part == name) || *word == name), "{name}");
    }
}
