//! A check whose own memory has gone wrong: a flipped bit must neither heat more nor for ever.

use fdi_core::Celsius;

use super::*;

const PLANT: Plant = Plant { answer_ticks: 40, gain: 0.3 };

fn started() -> SelfTest {
    SelfTest::new(Proof::Cuts { seen: true }, &PLANT)
}

/// A tick on which all three read this.
fn step(check: &mut SelfTest, celsius: f32) -> Output {
    let reading = Reading { celsius: Celsius(celsius), validity: Validity::Good };
    check.step(&Sample { t0: reading, t1: reading, t2: reading }, &RawSample::default(), None)
}

fn power(output: Output) -> f32 {
    match output {
        Output::On { power, .. } => power.0,
        Output::Off => 0.0,
    }
}

/// Without a contactor, power with the contactor open heats.
#[test]
fn a_stage_that_would_never_end_ends_by_time() {
    let mut check = started();
    (check.stage, check.judged_cycles) = (Stage::ContactorOpen, u32::MAX);
    let ends = (0..LONGEST + 2).position(|_| {
        step(&mut check, 22.0);
        check.ending().is_some()
    });
    assert_eq!((ends, check.ending()), (Some(LONGEST as usize), Some(Ending::Failed(0))));
    assert_eq!(step(&mut check, 22.0), Output::Off);
}

#[test]
fn no_gain_makes_a_pulse_stronger() {
    for gain in [0.0, 1e-30, -1.0, 0.01, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (level, allowed) in LEVELS.into_iter().enumerate() {
            let mut check = started();
            (check.stage, check.level, check.gain) = (Stage::Pulses, level, gain);
            let given = power(step(&mut check, 22.0));
            assert!(given <= allowed, "{given} % at a gain of {gain}");
        }
    }
    let mut check = SelfTest::new(Proof::Cuts { seen: true }, &Plant { gain: 2.0, ..PLANT });
    check.stage = Stage::Pulses;
    assert_eq!(power(step(&mut check, 22.0)), LEVELS[0] / 2.0, "divided by that of a strong rig");
}

/// A rise above what is no number may be any.
#[test]
fn a_beginning_that_is_no_number_ends_it() {
    let mut check = started();
    for _ in 0..10 {
        step(&mut check, 22.0);
    }
    (check.stage, check.level) = (Stage::Pulses, 3);
    assert!(power(step(&mut check, 22.0)) > 0.0);
    for nonsense in [f32::NAN, f32::NEG_INFINITY] {
        let mut check = check.clone();
        check.start[1] = nonsense;
        check.last[1] = nonsense; // else the next reading mends it
        let reading = Reading { celsius: Celsius(22.0), validity: Validity::Spike };
        let sample = Sample { t0: reading, t1: reading, t2: reading };
        assert_eq!(check.step(&sample, &RawSample::default(), None), Output::Off, "{nonsense}");
        assert!(matches!(check.findings.last(), Some(CheckFinding::TooHot(Channel::T1, _))));
    }
}
