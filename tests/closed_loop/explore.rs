use fdi_core::Config;
use fdi_core::likelihood::taught::{Capture, Response};
use host_sim::experiment::run;
use host_sim::experiment::scenario::Scenario;

type Kind = (&'static str, &'static [&'static str]);
const KINDS: [Kind; 6] = [
    ("T1_high", &["do = \"offset\"\nsensor = \"t1\"\nsize = 1.5"]),
    ("T2_low", &["do = \"offset\"\nsensor = \"t2\"\nsize = -1.5"]),
    ("less_air", &["do = \"air-flow\"\nsize = 0.75"]),
    ("T2_clog", &["do = \"clog\"\nsensor = \"t2\"\nsize = 0.8\nlag = 0.9"]),
    ("hand", &["do = \"air-flow\"\nsize = 0.8\nover = 1.0", "do = \"ambient\"\nsize = 1.0"]),
    ("two", &["do = \"offset\"\nsensor = \"t1\"\nsize = 1.0", "do = \"clog\"\nsensor = \"t2\"\nsize = 0.9\nlag = 0.9"]),
];
const OTHERS: [Kind; 14] = [
    ("AFS2", &["do = \"offset\"\nsensor = \"t2\"\nsize = 1.5"]),
    ("T1low", &["do = \"offset\"\nsensor = \"t1\"\nsize = -1.5"]),
    ("T1high3", &["do = \"offset\"\nsensor = \"t1\"\nsize = 3.0"]),
    ("T1high.7", &["do = \"offset\"\nsensor = \"t1\"\nsize = 0.7"]),
    ("clog", &["do = \"clog\"\nsensor = \"t1\"\nsize = 0.85\nlag = 0.4"]),
    ("more air", &["do = \"air-flow\"\nsize = 1.3"]),
    ("air .9", &["do = \"air-flow\"\nsize = 0.9"]),
    ("air .6", &["do = \"air-flow\"\nsize = 0.6"]),
    ("power .8", &["do = \"heater-power\"\nsize = 0.8"]),
    ("power 1.2", &["do = \"heater-power\"\nsize = 1.2"]),
    ("T0", &["do = \"offset\"\nsensor = \"t0\"\nsize = 1.5"]),
    ("T0low", &["do = \"offset\"\nsensor = \"t0\"\nsize = -1.5"]),
    ("detach1", &["do = \"detach\"\nsensor = \"t1\"\nsize = 1.0"]),
    ("detach2", &["do = \"detach\"\nsensor = \"t2\"\nsize = 1.0"]),
];
const LONG: f64 = 25.0;
const MON: f64 = 400.0;

fn scenario(preset: &str, duration: f64, faults: &[(Kind, f64)]) -> Scenario {
    let mut text = format!("duration = {duration:?}\n");
    for ((_, parts), at) in faults {
        for part in *parts {
            text += &format!("[[fault]]\nname = \"taught\"\n{part}\nat = {at:?}\nfor = {LONG:?}\n");
        }
    }
    if faults.is_empty() { text += "fault = []\n"; }
    if !preset.is_empty() { text += &format!("[rig]\npreset = \"{preset}\"\n"); }
    toml::from_str(&text).expect("a scenario")
}

fn taught(preset: &str, seed: u64) -> Config {
    let mut config = Config::default();
    let faults: Vec<_> = (0..3 * KINDS.len()).map(|i| (KINDS[i % KINDS.len()], MON + 80.0 * i as f64)).collect();
    let lesson = run(&config, &scenario(preset, MON + 80.0 * 18.0 + 20.0, &faults), seed).expect("a run");
    for (i, (name, _)) in KINDS.iter().enumerate() {
        let mut all = vec![];
        for (_, at) in faults.iter().skip(i).step_by(KINDS.len()) {
            let mut capture = Capture::default();
            capture.begin();
            let mut classes = vec![];
            for row in &lesson.rows {
                let t = f64::from(row.tick.index) * lesson.sample_time;
                if t >= *at && t <= at + LONG {
                    capture.step(row.report.likelihood.departure);
                    let c = row.report.likelihood.finding.map_or("-", |f| f.class.name());
                    if classes.last() != Some(&c) { classes.push(c); }
                }
            }
            println!("{name} {at}: {classes:?}");
            if let Some(c) = capture.end() { all.push(c) } else { println!("   nothing captured") }
        }
        if all.is_empty() { continue; }
        let response = Response::mean(name.parse().unwrap(), &all);
        println!("{response:?}");
        let _ = config.likelihood.taught.push(response);
    }
    config
}

/// taught names with times and classes on them
fn told(config: &Config, scenario: &Scenario, seed: u64) -> Vec<(f64, String, String)> {
    let record = run(config, scenario, seed).expect("a run");
    let mut all: Vec<(f64, String, String)> = vec![];
    let mut before = None;
    for row in &record.rows {
        let now = row.report.likelihood.taught.map(|t| t.place);
        if now != before {
            let name = now.map_or("-".to_owned(), |place| config.likelihood.taught[usize::from(place)].name.to_string());
            let class = row.report.likelihood.finding.map_or("-", |f| f.class.name()).to_owned();
            all.push((f64::from(row.tick.index) * record.sample_time, name, class));
        }
        before = now;
    }
    all
}

#[test]
#[ignore = "explores"]
fn explore() {
    let preset = std::env::var("PRESET").unwrap_or_default();
    let runs: u64 = std::env::var("RUNS").map_or(10, |x| x.parse().unwrap());
    let config = taught(&preset, 3);
    let sets: Vec<Kind> = KINDS.into_iter().chain(OTHERS).collect();
    let results: Vec<String> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..2).map(|w| { let (config, sets, preset) = (&config, &sets, &preset); scope.spawn(move || {
            sets.iter().enumerate().filter(|(i, _)| i % 2 == w).map(|(_, kind)| {
                let mut firsts = std::collections::BTreeMap::<String, Vec<f64>>::new();
                let mut changes = 0;
                for i in 0..runs {
                    let told = told(config, &scenario(preset, 440.0, &[(*kind, MON)]), 100_001 + i);
                    let names: Vec<_> = told.iter().filter(|t| t.0 >= MON && t.1 != "-").collect();
                    changes += names.len();
                    let first = names.first();
                    firsts.entry(first.map_or("none".into(), |f| f.1.clone())).or_default().push(first.map_or(0.0, |f| f.0 - MON));
                }
                let mut text = format!("{:10} said {changes}:", kind.0);
                for (name, mut at) in firsts { at.sort_by(f64::total_cmp); text += &format!(" {name} {} ({:.1} s)", at.len(), at[at.len() / 2]); }
                text
            }).collect::<Vec<_>>()
        })}).collect();
        workers.into_iter().flat_map(|w| w.join().unwrap()).collect()
    });
    results.iter().for_each(|r| println!("{r}"));
    let quiet: usize = (0..runs / 2).map(|i| told(&config, &scenario(&preset, 7200.0, &[]), 200_001 + i).iter().filter(|t| t.1 != "-").count()).sum();
    println!("quiet: {quiet} in {} h", runs);
}
