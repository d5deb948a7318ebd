//! Each wrong wiring and each stage that fails by its own name, on weak rigs and strong.

use super::*;

/// What is found where the thermistors are at these places, but for the interlock's contact that nobody has opened.
const WIRINGS: [([Place; 3], Option<CheckFinding>); 15] = {
    use Channel::{T0, T1, T2};
    use Place::{Behind, Nowhere, Outlet, Room};
    [
        (RIGHT, None),
        ([Room, Behind, Outlet], Some(CheckFinding::Swapped(T1, T2))),
        ([Outlet, Room, Behind], Some(CheckFinding::Swapped(T0, T1))),
        ([Behind, Outlet, Room], Some(CheckFinding::Swapped(T0, T2))),
        ([Behind, Room, Outlet], Some(CheckFinding::Rotated)),
        ([Outlet, Behind, Room], Some(CheckFinding::Rotated)),
        ([Room, Outlet, Outlet], Some(CheckFinding::SameTime)),
        ([Room, Outlet, Room], Some(CheckFinding::Silent(T2))),
        ([Room, Room, Behind], Some(CheckFinding::Silent(T1))),
        ([Room, Nowhere, Behind], Some(CheckFinding::Stuck(T1))),
        ([Room, Outlet, Nowhere], Some(CheckFinding::Stuck(T2))),
        ([Outlet, Room, Room], Some(CheckFinding::OnlyT0)),
        ([Outlet, Outlet, Behind], Some(CheckFinding::AllAnswer)),
        ([Outlet, Behind, Outlet], Some(CheckFinding::AllAnswer)),
        ([Room, Room, Room], Some(CheckFinding::Unheated)),
    ]
};

/// Cycles of a check, 40 ticks each: 3 at rest, 3 with the contactor alone, a pulse, 4 for the order; then 1 to settle and 4 with the contactor
/// open. Where nothing answers there are four pulses, and 12 for the order.
const JUDGED: u32 = 11;
const PASSED: u32 = 16;
const UNHEATED: u32 = 22;

#[test]
fn thermistors_at_a_wrong_place_are_named_on_weak_rigs_and_strong() {
    for gain in [0.05, 0.3, 1.0] {
        for (places, expected) in WIRINGS {
            let mut bench = Bench { gain, places, ..Bench::new(&Config::default()) };
            let ending = bench.check();
            let found = bench.progress.findings.get(1).copied();
            assert_eq!(found, expected, "{places:?} at {gain} degC per %");
            let passes = expected.is_none_or(|finding| finding.is_note());
            assert_eq!(ending, if passes { Ending::Passed } else { Ending::Failed(1) }, "{places:?}");
            let cycles = match expected {
                Some(CheckFinding::Unheated) => UNHEATED,
                _ if passes => PASSED,
                _ => JUDGED,
            };
            // The weakest takes one pulse more, or two.
            let later = (bench.ticks - 40 * cycles) / 40;
            assert!(if gain < 0.1 { later <= 2 } else { later == 0 }, "{places:?}: {} ticks", bench.ticks);
        }
    }
}

/// A T0 in a draught would not show that the heater warms it: it is asked again with more power.
#[test]
fn a_noisy_thermistor_is_asked_with_more_power() {
    let mut bench =
        Bench { places: [Place::Draught, Place::Outlet, Place::Behind], ..Bench::new(&Config::default()) };
    assert_eq!(bench.order(Order::Check), Ok(()));
    let mut given = vec![];
    for _ in 0..LONGEST {
        given.push(bench.tick().applied.0);
    }
    given.dedup();
    given.retain(|power| *power > 0.0);
    assert_eq!(bench.progress.ending, Some(Ending::Passed), "{:?}", bench.progress);
    // A pulse is answered at once; the order takes four each.
    assert_eq!(given, [vec![LEVELS[0]; 5], vec![LEVELS[1]; 4], vec![LEVELS[2]; 4]].concat());
}

#[test]
fn a_stage_that_heats_unasked_is_named() {
    let shorted: fn(&Output) -> f32 = |output| if output.enabled && output.contactor { 100.0 } else { 0.0 };
    let welded: fn(&Output) -> f32 = |output| if output.enabled { output.power } else { 0.0 };
    for gain in [0.05, 0.3, 1.0] {
        let stages = [(shorted, CheckFinding::MosfetShorted), (welded, CheckFinding::NoContactor)];
        for (heats, expected) in stages {
            let mut bench = Bench { gain, heats, ..Bench::new(&Config::default()) };
            let ending = bench.check();
            assert_eq!(bench.progress.findings[1..], [expected], "{gain} degC per %");
            assert_eq!(ending, if expected.is_note() { Ending::Passed } else { Ending::Failed(1) });
        }
    }
}
