//! On made-up symptoms, one tick a second.

use fdi_core::diagnosis::signature::{MAX_ROWS, Symptom};

use super::*;

/// Ticks on which the symptoms are the same: how many, and the signs.
type Stretch = (usize, [i8; 5]);

const NORMAL: [i8; 5] = [0; 5];
const LOW_T2: [i8; 5] = [0, 1, 0, -1, 0];

fn watch(stretches: &[Stretch]) -> Diagnoses {
    let symptom = |sign| match sign {
        -1 => Symptom::Low,
        0 => Symptom::Normal,
        _ => Symptom::High,
    };
    let said = |signs: &[i8; 5]| Said { symptoms: Some(signs.map(symptom)), ..Said::default() };
    let ticks = stretches.iter().flat_map(|(ticks, signs)| vec![said(signs); *ticks]);
    Diagnoses { sample_time: 1.0, said: ticks.collect() }
}

fn taught(watch: &Diagnoses, marks: &[&str]) -> anyhow::Result<Taught> {
    taught_over(&Config::default(), watch, marks)
}

fn taught_over(config: &Config, watch: &Diagnoses, marks: &[&str]) -> anyhow::Result<Taught> {
    let marks: Vec<Marks> = marks.iter().map(|text| text.parse().unwrap()).collect();
    Taught::of(watch, config, &Marks::by_name(&marks), &[])
}

fn row(lesson: &Lesson) -> String {
    let Proposal { row, .. } = &lesson.proposal;
    format!("{} {} {}", row.number, row.pattern, row.name)
}

#[test]
fn a_row_is_what_all_repetitions_have_in_common() {
    let flicker = [(1, [0, 1, 0, -1, 0]), (1, [0, 1, 0, -1, 1])].repeat(10);
    let repetitions = [
        vec![(20, NORMAL), (10, [1; 5]), (10, LOW_T2), (20, NORMAL)], // another beginning is no matter
        vec![(20, [0, 1, -1, -1, 0]), (20, NORMAL)],                  // disagrees on rsg1
        flicker,                                                      // rbw1 comes and goes
        vec![(20, NORMAL)],
    ];
    let watch = watch(&repetitions.concat());
    let taught = taught(&watch, &["hand:20..39,60..79", "hand:100..119"]).unwrap();
    assert_eq!(row(&taught.lessons[0]), "4 0 +1 x -1 x hand");
    assert!(taught.all_stand());
    for rows in [&taught.config.diagnosis.detection, &taught.config.diagnosis.isolation] {
        assert_eq!(rows.last(), Some(&taught.lessons[0].proposal.row));
    }
    let told = taught.lessons[0].to_string();
    let words: Vec<Vec<&str>> = told.lines().map(|line| line.split_whitespace().collect()).collect();
    let ends = |line: usize| words[line][words[line].len() - 5..].join(" ");
    assert_eq!([2, 3, 4].map(ends), ["0 +1 -1 -1 0", "0 +1 0 -1 ~", "0 +1 x -1 x"], "{told}");
}

#[test]
fn a_row_that_an_old_one_overlaps_is_not_taught() {
    let watch = watch(&[(20, NORMAL), (20, [0, -1, 0, 1, 0]), (20, NORMAL), (20, [1, 0, -1, 0, 1])]);
    let taught = taught(&watch, &["warm_T2:20..39", "air:60..79", "hand:0..19"]).unwrap();
    let places: Vec<_> = taught
        .lessons
        .iter()
        .map(|lesson| lesson.conflicts.iter().map(|c| (c.place, c.same)).collect::<Vec<_>>())
        .collect();
    assert_eq!(places, [vec![(1, true)], vec![(3, false)], vec![(2, false); 0]]);
    assert!(!taught.lessons[2].proposal.tells() && !taught.all_stand(), "nothing departs from normal");
    assert!(taught.lessons.iter().all(|lesson| lesson.trial.is_none()));
    assert_eq!(taught.config, Config::default());
    let told = taught.lessons[1].to_string();
    assert!(
        told.contains("Not taught: row 3 of isolation, +1 0 -1 x +1 (fiv 3), matches some of the same"),
        "{told}"
    );
}

#[test]
fn the_trial_finds_what_is_hit_missed_false_and_taken_for_another() {
    let other = [-1, 0, 1, 0, 0];
    let watch = watch(&[
        (20, NORMAL),
        (4, NORMAL), // 20: hand
        (16, LOW_T2),
        (1, NORMAL), // flicker at its end
        (1, LOW_T2),
        (18, NORMAL),
        (5, LOW_T2), // 60: nothing is there
        (35, NORMAL),
        (2, LOW_T2), // 100: cap
        (18, other),
        (80, NORMAL),
    ]);
    let taught = taught(&watch, &["hand:20..39", "cap:100..119"]).unwrap();
    let trial = taught.lessons[0].trial.as_ref().unwrap();
    assert_eq!((&trial.hits, &trial.wrong), (&vec![Some(5.0)], &vec![61.0]));
    assert_eq!(trial.taken_for, [(101.0, "cap".parse().unwrap())]);
    assert_eq!(trial.quiet, 160.0);
    let again = taught_over(&taught.config, &watch, &["hand:20..39,22..39,120..139"]).unwrap();
    assert!(again.lessons[0].trial.is_none(), "of three repetitions one is quiet: nothing is certain");
    let missed = Trial::of(&watch, &taught.config, 4, &["hand:120..139".parse().unwrap()]);
    assert_eq!(missed.hits, [None]);
}

#[test]
fn a_row_that_comes_without_any_fault_is_not_taught() {
    let lesson = watch(&[(20, NORMAL), (20, LOW_T2), (20, NORMAL), (20, [-1, 0, 1, 0, 0])]);
    let marks: Vec<Marks> = ["hand:20..39", "cap:60..79"].map(|text| text.parse().unwrap()).into();
    let flicker = watch(&[(20, NORMAL), (1, LOW_T2), (20, NORMAL)]);
    let taught = |quiet: &[Diagnoses]| Taught::of(&lesson, &Config::default(), &marks, quiet).unwrap();
    assert!(taught(&[flicker]).all_stand());
    let nights = [watch(&[(30, NORMAL)]), watch(&[(20, NORMAL), (3, LOW_T2), (37, NORMAL)])];
    let taught = taught(&nights);
    assert_eq!(taught.lessons[0].quiet, Quiet { watched: 90.0, named: 1 });
    assert!(!taught.lessons[0].stands() && taught.lessons[0].trial.is_none());
    let told = taught.lessons[0].to_string();
    assert!(told.contains("Not taught: 1 false in 0.0 h without a fault"), "{told}");
    assert!(taught.lessons[1].stands());
    let names: Vec<_> = taught.config.diagnosis.isolation.iter().map(|row| row.name.to_string()).collect();
    assert_eq!(names, ["", "", "", "cap"]);
    assert_eq!(taught.config.diagnosis.detection.len(), 3);
}

#[test]
fn ten_faults_fit_and_a_name_that_is_known_is_taught_anew() {
    let patterns: Vec<[i8; 5]> =
        (0..11).map(|i: i8| [-1, i % 3 - 1, i / 3 % 3 - 1, 1, i / 9 % 3 - 1]).collect();
    let watch = watch(&patterns.iter().map(|signs| (10, *signs)).collect::<Vec<_>>());
    let mark = |i: usize| format!("fault{i}:{}..{}", 10 * i, 10 * i + 9);
    let mut config = Config::default();
    for i in 0..10 {
        let taught = taught_over(&config, &watch, &[&mark(i)]).unwrap();
        assert_eq!(taught.lessons[0].proposal.row.number, 4 + i as u8);
        config = taught.config;
    }
    assert_eq!(config.diagnosis.isolation.len(), MAX_ROWS);
    fdi_core::Instrument::new(&config).unwrap();
    let error = taught_over(&config, &watch, &[&mark(10)]).err().unwrap();
    assert!(format!("{error:#}").contains("13 rows"), "{error:#}");
    let anew = taught_over(&config, &watch, &["fault3:100..109"]).unwrap();
    assert_eq!(row(&anew.lessons[0]), "7 -1 0 -1 +1 0 fault3");
    assert_eq!(anew.config.diagnosis.isolation.len(), MAX_ROWS);
}

/// Two repetitions with alarms of their own; in the second one goes on that began long before.
#[test]
fn the_likelihood_diagnosis_is_taught_what_it_saw_in_every_repetition() {
    let mut watch = watch(&[(200, LOW_T2)]);
    let of_t2 = |offset: f32| std::array::from_fn(|i| if i == 4 { offset } else { 0.0 });
    for (tick, onset, offset) in
        [(25, 20, -1.0), (26, 20, -2.0), (61, 30, 9.0), (66, 56, -2.5), (90, 56, 9.0), (105, 94, 1.0)]
    {
        watch.said[tick].changed = Some(Changed { onset, effects: of_t2(offset) });
    }
    let marks: Vec<Marks> = vec!["low:20..39,60..79".parse().unwrap(), "cap:100..119".parse().unwrap()];
    let mut config = Config::default();
    let before = Response { name: "low".parse().unwrap(), effects: [7; 11] };
    config.likelihood.taught.push(before).unwrap();
    let mut taught = Taught::of(&watch, &config, &marks, &[]).unwrap();
    let response = Response { effects: [0, 0, 0, 0, -200, 0, 0, 0, 0, 0, 0], ..before };
    assert_eq!(taught.lessons[0].proposal.response, Some(response), "each repetition weighs the same");
    assert_eq!(taught.config.likelihood.taught[..], [response]);
    for tick in [24, 25, 27, 63, 104, 150, 151] {
        watch.said[tick].taught = Some(before.name);
    }
    taught.recall(&watch, &marks, &[]);
    let trial = taught.lessons[0].recall.as_ref().unwrap();
    assert_eq!((&trial.hits, &trial.wrong), (&vec![Some(4.0), Some(3.0)], &vec![150.0]));
    assert_eq!(trial.taken_for, [(104.0, "cap".parse().unwrap())]);
    assert!(!taught.all_are_recalled());
    let told = taught.lessons.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert!(told[0].contains("The likelihood diagnosis: offset of T2 -2.00 degC.\n"), "{}", told[0]);
    assert!(told[1].contains("not taught, since not every repetition raised an alarm"), "{}", told[1]);

    taught.recall(&watch, &marks, &[watch_of_a_night(before.name)]);
    assert_eq!(taught.lessons[0].quiet_recall.named, 1);
    assert_eq!(taught.config.likelihood.taught[..], [before], "a night that shows the new one");
}

#[test]
fn a_fault_that_is_not_found_again_is_not_taught() {
    let mut watch = watch(&[(60, LOW_T2)]);
    watch.said[25].changed = Some(Changed { onset: 20, effects: [0.5; 11] });
    let marks: Vec<Marks> = vec!["low:20..39".parse().unwrap()];
    let mut taught = Taught::of(&watch, &Config::default(), &marks, &[]).unwrap();
    taught.recall(&watch, &marks, &[]);
    assert!(taught.lessons[0].recall.is_some() && !taught.all_are_recalled());
    watch.said[30].taught = Some("low".parse().unwrap());
    taught.recall(&watch, &marks, &[]);
    assert!(taught.all_are_recalled());
}

fn watch_of_a_night(name: Name) -> Diagnoses {
    let mut night = watch(&[(30, NORMAL)]);
    night.said[12].taught = Some(name);
    night
}

#[test]
fn what_was_not_monitored_teaches_nothing() {
    let mut watch = watch(&[(40, LOW_T2)]);
    watch.said[30..].fill(Said::default());
    let error = taught(&watch, &["hand:20..39"]).err().unwrap();
    assert!(error.to_string().contains("from 20 to 39 s the instrument does not monitor"), "{error}");
    assert!(taught(&watch, &["hand:10..29"]).is_ok());
}

#[test]
fn marks_that_make_no_sense_are_refused() {
    for wrong in
        ["hand", "hand:", "hand:1", "hand:10..5", "hand:5..6", "hand:a..b", "2hands:1..9", "hand:-5..9"]
    {
        assert!(wrong.parse::<Marks>().is_err(), "{wrong}");
    }
}
