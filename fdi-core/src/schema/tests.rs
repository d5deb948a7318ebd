use std::collections::HashSet;
use std::vec::Vec;

extern crate std;

use super::*;
use crate::likelihood::verdict::TaughtFinding;
use crate::likelihood::{LikelihoodReport, Magnitude};
use crate::name::Name;
use crate::supervisor::Mode;
use crate::{AdcCode, Config, Instrument};

/// What an instrument gives on its first tick.
fn first(with: impl Fn(&Moment)) {
    let mut instrument = Instrument::new(&Config::default()).unwrap();
    let tick = instrument.control(RawSample::default());
    let report = instrument.diagnose(&tick, tick.drive);
    with(&Moment::new(&tick, &report));
}

#[test]
fn no_two_numbers_have_one_name_and_no_two_share_a_bit() {
    let mut bits = HashSet::new();
    let mut names = HashSet::new();
    for at in NUMBERS.iter().filter_map(|number| number.log) {
        assert!(names.insert(at.name), "{}", at.name);
        assert!((at.shift..at.shift + at.width).all(|bit| bits.insert((at.word, bit))), "{}", at.name);
    }
    for all in [&COLUMNS[..], &FIELDS[..]] {
        let names: HashSet<_> = all.iter().map(|entry| entry.name).collect();
        assert_eq!(names.len(), all.len());
    }
    assert!(WORD_NAMES.iter().all(|name| !name.is_empty()));
}

/// Pages find the fields by name, and what was kept of older ones by place; so do programs that read traces and logs.
#[test]
fn what_has_a_place_keeps_it() {
    let at = |all: &[Entry], place: usize| all[place].name;
    assert_eq!(
        [0, 9, 14, 28, 29, 42, 44].map(|i| at(&FIELDS, i)),
        ["tick", "drive", "readiness", "truth", "x_t1_offset", "x_t0_t2_swapped", "taught_size"]
    );
    assert_eq!([0, 7, 24, 39, 48].map(|i| at(&COLUMNS, i)), ["t_s", "pa_pct", "rap_f", "truth", "taught"]);
    assert_eq!(
        [0, 1, 10, 17, 24, 25, 26, 31].map(|i| WORD_NAMES[i]),
        ["tick", "timing", "state", "ry1_f", "symptoms", "vectors", "likelihood", "supply_code"]
    );
}

/// What a log holds of a number is what a page has of it.
#[test]
fn a_number_comes_back_from_the_record_of_its_tick() {
    let config = Config::default();
    let mut instrument = Instrument::new(&config).unwrap();
    instrument.command(crate::Command::Arm).unwrap();
    let code = AdcCode(2160.0);
    for k in 0..60 {
        let t1 = if k < 50 { code } else { AdcCode(4095.0) };
        let raw = RawSample { t0: code, t1, t2: code, ..RawSample::default() };
        let tick = instrument.control(raw);
        let report = instrument.diagnose(&tick, tick.drive);
        let moment = Moment { raw, missed: k == 7, late_us: k, ..Moment::new(&tick, &report) };
        let words = words(&moment);
        for number in NUMBERS.iter() {
            let Some(at) = number.log else { continue };
            let bits = number.bits(&words);
            let said = match number.kind {
                Kind::Float => bits.map_or(f32::NAN, f32::from_bits),
                _ => bits.map_or(f32::NAN, |bits| bits as f32),
            };
            let value = number.value(&moment).number();
            assert!(said == value || said.is_nan() && value.is_nan(), "{}: {said} for {value}", at.name);
        }
        assert_eq!(logged(&words, "trip").is_some(), matches!(tick.mode, Mode::Tripped(_)), "{k}");
        assert_eq!(logged(&words, "missed"), Some(u32::from(k == 7)));
        let mut without = words;
        forget(&mut without, "trip");
        assert_eq!((logged(&without, "trip"), without[10]), (None, words[10] & 0x0FFF_FFFF));
    }
}

#[test]
fn the_power_is_what_the_heater_got_not_what_the_controller_wanted() {
    first(|on| {
        let numbers = row(&Moment { applied: Percent(2.5), ..*on });
        let number = |name| numbers[field(name).unwrap()];
        assert_eq!((on.tick.drive.0, number("drive"), number("pid")), (0.0, 2.5, 0.0));
    });
}

#[test]
fn a_taught_fault_has_its_place_from_1_and_its_size() {
    first(|on| {
        let numbers = |taught| {
            let likelihood = LikelihoodReport { taught, ..on.report.likelihood };
            let report = Report { likelihood, ..on.report.clone() };
            let numbers = row(&Moment { report: &report, ..*on });
            ["taught", "taught_size"].map(|name| numbers[field(name).unwrap()])
        };
        let magnitude = Magnitude { value: 96.0, half_width: 8.0 };
        let taught = TaughtFinding { name: Name::NONE, place: 1, confidence: 0.97, magnitude };
        assert_eq!(numbers(Some(taught)), [2.0, 96.0]);
        assert!(numbers(None).iter().all(|number| number.is_nan()));
    });
}

#[test]
fn the_modes_are_told_to_prometheus_by_their_names() {
    let all: Vec<_> = Mode::NAMES.iter().zip(0..).map(|(name, i)| std::format!("{i} {name}")).collect();
    let mode = FIELDS[field("mode").unwrap()].number;
    assert_eq!(mode.metric.as_ref().unwrap().help, all.join(", "));
}
