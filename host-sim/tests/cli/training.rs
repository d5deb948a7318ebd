//! `pt326 diagnose`: what a model is learnt from, and when it is worth nothing.

use fdi_core::Config;
use indicatif::ProgressBar;
use pt326_host::recording::intervals::Known;
use pt326_host::recording::report::{Said, Told, learnt};
use pt326_host::recording::run::{Diagnosed, Training, diagnose};
use pt326_host::recording::training::train;
use pt326_host::recording::{Reading, Recording};

use crate::plant::Plant;
use crate::{arg, folder, on_a_large_stack, pt326, pt326_reading, text};

/// Learns from the first share of a log, or from another, and watches the rest.
fn diagnosed(recording: &Recording, training: &Training) -> Diagnosed {
    let config = Config::default();
    diagnose(recording, 0, training, &[], &config, &ProgressBar::hidden()).unwrap()
}

fn parse(text: &str) -> Recording {
    let how = Reading { fan: Some(false), ..Reading::default() };
    Recording::parse("log".into(), text, &how).unwrap()
}

fn first(share: f64, recording: &Recording) -> Training {
    Training::Own(0..(share * recording.len() as f64) as usize, "made".into())
}

/// What is said, and from which sample on.
fn said(recording: &Recording, training: &Training, done: &Diagnosed) -> Vec<(usize, Said)> {
    let told = Told::new(recording, &recording.heaters[0], training, done, None);
    let all = told.episodes.into_iter().flat_map(|episode| episode.said);
    all.map(|said| (recording.at(said.at), said)).collect()
}

/// The model is the plant's within 10 %.
fn is_of(plant: &Plant, done: &Diagnosed) {
    let model = &done.trained.model;
    let residence = plant.sample_time * (plant.lags[0] + plant.lags[1]);
    let found = model.heater + model.lag + model.dead_time;
    assert!((f64::from(found) / residence - 1.0).abs() < 0.1, "{found} s for {residence} s: {model:?}");
    assert!((f64::from(model.gain) / plant.gain - 1.0).abs() < 0.1, "{} for {}", model.gain, plant.gain);
    assert!(done.trained.fit > 95.0, "{} %", done.trained.fit);
}

/// What T1 reads too high, degC, by a sentence.
fn offset(sentence: &str) -> Option<f64> {
    let (_, rest) = sentence.split_once("T1 reads ")?;
    let size: f64 = rest.split(' ').next()?.parse().ok()?;
    if rest.contains("too low") { Some(-size) } else { Some(size) }
}

/// An oven each 10 s, a box each minute, a floor heating each ten: all that is said is when T1 reads 4 degC too high, and how much that is.
#[test]
fn a_slow_heater_is_learnt_and_its_thermistors_offset_is_found() {
    on_a_large_stack(|| {
        for sample_time in [10.0, 60.0, 600.0] {
            let mut plant = Plant::of(sample_time, 1);
            let recording = parse(&plant.log(3000, |k| if k >= 2500 { 4.0 } else { 0.0 }));
            assert_eq!(recording.sample_time, sample_time);
            let training = first(0.5, &recording);
            let done = diagnosed(&recording, &training);
            is_of(&plant, &done);
            let said = said(&recording, &training, &done);
            let (at, first) = said.first().unwrap_or_else(|| panic!("nothing is said at {sample_time} s"));
            assert!((2500..2510).contains(at), "{sample_time} s: {at}: {said:?}");
            assert!(offset(&first.sentence).is_some_and(|size| (size - 4.0).abs() < 0.5), "{first:?}");
        }
    });
}

/// More rows than are fitted from everywhere, and a rig that is cooling down from something else when they begin.
#[test]
fn a_long_recording_that_begins_in_a_transient_is_learnt() {
    on_a_large_stack(|| {
        let mut plant = Plant { heat: [95.0, 60.0], power: [0.0, 40.0], ..Plant::of(1.0, 2) };
        let recording = parse(&plant.log(8000, |_| 0.0));
        let training = first(0.8, &recording);
        let done = diagnosed(&recording, &training);
        is_of(&plant, &done);
        assert_eq!(said(&recording, &training, &done), []);
    });
}

/// The same rig in two files, hot where the second begins: its own beginning is no fault, the jump in it is one.
#[test]
fn a_rig_that_was_learnt_from_one_file_is_watched_in_another() {
    let dir = folder("training-two");
    let (normal, today) = (dir.join("normal.csv"), dir.join("today.csv"));
    let mut plant = Plant::of(1.0, 3);
    std::fs::write(&normal, plant.log(2000, |_| 0.0)).unwrap();
    plant.heat = [90.0, 90.0];
    std::fs::write(&today, plant.log(1000, |k| if k >= 600 { -4.0 } else { 0.0 })).unwrap();
    let out = dir.join("out");
    let done = pt326(&["diagnose", arg(&today), "--train-on", arg(&normal), "--explain", "--out", arg(&out)]);
    let said = text(&done.stdout);
    assert!(said.contains("95 % interval") && said.contains("Gain: what T1 rises by in the end"), "{said}");
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.contains("1 alarm:"), "{said}");
    assert!(offset(&said).is_some_and(|size| (size + 4.0).abs() < 0.5), "{said}");
}

/// What was learnt is little: which faults could be told apart is not known, and the recording is diagnosed all the same.
#[test]
fn a_short_training_is_explained_as_far_as_it_goes() {
    let dir = folder("training-short");
    let record = dir.join("record.csv");
    std::fs::write(&record, Plant::of(1.0, 3).log(2000, |k| if k >= 1500 { 4.0 } else { 0.0 })).unwrap();
    let done =
        pt326(&["diagnose", arg(&record), "--train", "0:70", "--explain", "--out", arg(&dir.join("out"))]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.contains("is not known: 70 samples are too few") && said.contains("alarm"), "{said}");
}

/// A rig that is slower than a simulated one can be is not written as a faster one without a word.
#[test]
fn what_no_simulated_rig_has_is_told() {
    let dir = folder("training-slow-rig");
    let record = dir.join("record.csv");
    std::fs::write(&record, Plant::of(60.0, 6).log(1500, |_| 0.0)).unwrap();
    let done = pt326(&["fit-rig", arg(&record), "-o", arg(&dir.join("rig.toml"))]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(said.contains("heater_time is 17") && said.contains("written as 1000.0"), "{said}");
    assert!(!said.contains("gain is"), "{said}");
}

/// A model that explains little is warned about, with a cause and what to do; one that explains hardly anything is refused, and goes on if told to.
#[test]
fn a_poor_model_is_warned_about_or_refused() {
    let dir = folder("training-poor");
    let (weak, poor) = (dir.join("weak.csv"), dir.join("poor.csv"));
    for (file, noise) in [(&weak, 6.0), (&poor, 40.0)] {
        std::fs::write(file, Plant { noise, ..Plant::of(1.0, 5) }.log(2000, |_| 0.0)).unwrap();
    }
    let out = dir.join("out");
    let diagnose = |file, more: &[&str]| {
        pt326(&[&["diagnose", arg(file), "--train", "0:1500", "--out", arg(&out)], more].concat())
    };
    let done = diagnose(&weak, &[]);
    let said = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    for part in ["where it was learnt, which is little: take what follows with care.", "Cause: ", "Next: "] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let done = diagnose(&poor, &[]);
    let said = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(said.contains("too little to say anything by it") && said.contains("--force"), "{said}");
    let done = diagnose(&poor, &["--force"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("too little to say anything by it"), "{}", text(&done.stdout));
    // Line by line it is the same.
    let live = ["diagnose", "-", "--live", "--train-on", arg(&poor)];
    let done = pt326_reading(&live, "time,temp,power\n0,30,40\n");
    assert_eq!(done.status.code(), Some(2), "{}", text(&done.stdout));
    let done = pt326_reading(&[&live[..], &["--force"]].concat(), "time,temp,power\n0,30,40\n");
    assert!(done.status.success() && text(&done.stdout).contains("too little to say anything by it"));
}

/// Of made rigs whose noise is correlated the intervals hold what they should of 25; what a power that hardly moves does not tell is said by name.
#[test]
fn intervals_hold_what_was_made() {
    on_a_large_stack(|| {
        let mut held = [0; 3];
        for seed in 1..=25 {
            let mut plant = Plant { noise: 1.0, wander: 0.9, ..Plant::of(1.0, seed) };
            let recording = parse(&plant.log(800, |_| 0.0));
            let trained =
                train(&recording, &recording.heaters[0], &recording.heaters[0].samples, &Config::default());
            let trained = trained.unwrap();
            // A lag that goes 1/T of its way a sample has a time constant of T - 1/2.
            for (i, (name, true_value)) in
                [("gain", 0.4), ("heater", 29.5), ("lag", 3.5)].into_iter().enumerate()
            {
                let known = trained.intervals.iter().find(|(known, _)| *known == name).unwrap().1;
                let Known::Within(low, high) = known else { panic!("{name}: {known:?}") };
                assert!(high - low < 2.0 * true_value, "{name}: {low} to {high}");
                held[i] += usize::from((low..high).contains(&true_value));
            }
        }
        println!("{held:?}");
        assert!(held.iter().all(|held| *held >= 21), "{held:?}");
        let mut plant = Plant { power: [39.9, 40.1], heat: [40.0, 40.0], noise: 1.0, ..Plant::of(1.0, 1) };
        let recording = parse(&plant.log(800, |_| 0.0));
        let trained =
            train(&recording, &recording.heaters[0], &recording.heaters[0].samples, &Config::default());
        let learnt = learnt(&recording, &recording.heaters[0], &trained.unwrap());
        let gain = learnt.iter().find(|learnt| learnt.name.starts_with("Gain")).unwrap();
        assert_eq!(gain.interval(), "not known");
    });
}
