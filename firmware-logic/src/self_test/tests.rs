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

/// The wires may be swapped: whichever it is that gets hot.
#[test]
fn each_thermistor_that_rises_too_far_ends_it() {
    let mut begun = started();
    for _ in 0..10 {
        step(&mut begun, 22.0);
    }
    (begun.stage, begun.level) = (Stage::Pulses, 3);
    assert!(power(step(&mut begun, 22.0)) > 0.0);
    for (hot, channel) in CHANNELS.into_iter().enumerate() {
        let mut check = begun.clone();
        let reading = |i: usize| Reading {
            celsius: Celsius(if i == hot { 22.1 + MAX_RISE } else { 22.0 }),
            validity: Validity::Good,
        };
        let sample = Sample { t0: reading(0), t1: reading(1), t2: reading(2) };
        assert_eq!(check.step(&sample, &RawSample::default(), None), Output::Off, "{channel:?}");
        assert!(
            matches!(check.findings.last(), Some(CheckFinding::TooHot(found, _)) if *found == channel),
            "{channel:?}"
        );
    }
}

/// What a cycle gave, where no thermistor ever answers: ticks with power, the largest power, ticks with the contactor closed.
fn cycles(plant: &Plant) -> std::vec::Vec<(u32, f32, u32)> {
    let mut check = SelfTest::new(Proof::Cuts { seen: true }, plant);
    let ticks = CYCLE * step_ticks(plant.answer_ticks);
    // The output of a cycle's last tick is that of the next cycle's first.
    for _ in 1..ticks {
        step(&mut check, 22.0);
    }
    let mut given = std::vec![];
    while check.ending().is_none() {
        let (mut heated, mut most, mut closed) = (0, 0.0f32, 0);
        for _ in 0..ticks {
            let output = step(&mut check, 22.0);
            heated += u32::from(power(output) > 0.0);
            most = most.max(power(output));
            closed += u32::from(matches!(output, Output::On { contactor: true, .. }));
        }
        given.push((heated, most, closed));
    }
    given
}

/// The contactor is closed for as long whatever a step is: that is what a shorted MOSFET would heat for.
#[test]
fn each_cycle_heats_for_its_half_and_the_contactor_alone_for_some_ticks() {
    for times in [1, 2] {
        let (half, whole) = (20 * times, 40 * times);
        let mut expected = std::vec![(0, 0.0, 0); 2];
        expected.extend([(0, 0.0, 1), (0, 0.0, 6), (0, 0.0, 20)]);
        expected.extend(LEVELS.map(|level| (half, level, whole)));
        expected.extend([(half, LEVELS[3], whole); 12]);
        expected.push((0, 0.0, 0));
        assert_eq!(cycles(&Plant { answer_ticks: 40 * times, ..PLANT }), expected, "{times} ticks a step");
    }
}

/// Ticks until it ends, and what it found, where all three read this.
fn ends(plant: &Plant, reading: impl Fn(u32) -> Reading) -> (u32, Option<CheckFinding>) {
    let mut check = SelfTest::new(Proof::Cuts { seen: true }, plant);
    let ticks = (0..LONGEST * 4).find(|tick| {
        let all = reading(*tick);
        check.step(&Sample { t0: all, t1: all, t2: all }, &RawSample::default(), None);
        check.ending().is_some()
    });
    (ticks.expect("it ends") + 1, check.findings.first().copied())
}

#[test]
fn a_rig_that_never_comes_to_rest_is_waited_for_27_cycles() {
    let warmer =
        |tick: u32| Reading { celsius: Celsius(22.0 + 0.02 * tick as f32), validity: Validity::Good };
    let (ticks, found) = ends(&PLANT, warmer);
    assert!(
        matches!(found, Some(CheckFinding::NotAtRest(Channel::T0, by)) if (by - 0.8).abs() < 0.01),
        "{found:?}"
    );
    assert_eq!(ticks, CYCLE * (WAITING_CYCLES + CALM_CYCLES - 1));
}

/// A tenth of the ticks of a cycle, however long its steps are.
#[test]
fn some_doubts_in_a_cycle_are_no_broken_wire() {
    for times in [1, 2] {
        let plant = Plant { answer_ticks: 40 * times, ..PLANT };
        let doubted = |doubts: u32| {
            let reading = |tick: u32| {
                let place = tick % (40 * times);
                let doubtful = place % 4 == 1 && place / 4 < doubts;
                let validity = if doubtful { Validity::Spike } else { Validity::Good };
                Reading { celsius: Celsius(22.0), validity }
            };
            ends(&plant, reading).1
        };
        assert_eq!(doubted(4 * times), Some(CheckFinding::Unheated), "{times}");
        assert_eq!(
            doubted(4 * times + 1),
            Some(CheckFinding::Broken(Channel::T0, Validity::Spike)),
            "{times}"
        );
    }
}

#[test]
fn a_wire_that_breaks_while_it_heats_ends_it_in_that_tick() {
    let mut check = started();
    check.stage = Stage::Pulses;
    assert!(power(step(&mut check, 22.0)) > 0.0);
    let [good, open] =
        [Validity::Good, Validity::Open].map(|validity| Reading { celsius: Celsius(22.0), validity });
    let output = check.step(&Sample { t0: good, t1: good, t2: open }, &RawSample::default(), None);
    assert_eq!(output, Output::Off);
    assert_eq!(check.findings.last(), Some(&CheckFinding::Broken(Channel::T2, Validity::Open)));
}
