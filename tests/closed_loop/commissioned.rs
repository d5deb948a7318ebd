//! A rig that is learnt anew at each start is held against what it was when it was commissioned.

use fdi_core::likelihood::{Commissioned, FaultClass};
use fdi_core::{Config, Instrument};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{FaultSize, Record, on_rig, run_on};
use pt326_lab::preset::with_prbs_phase;
use pt326_rig::fault::{Fault, Verb};

/// A start of the rig of `preset` whose heater gives `power` times what it is asked for from before it is armed, and what was trained then.
fn start(
    preset: &str,
    power: f64,
    seed: u64,
    commissioned: Option<Commissioned>,
) -> (Record, Option<Commissioned>) {
    let weak = Fault::new(Verb::HeaterPower, None, Some(power), 0.0, 1e6);
    let scenario = Scenario { duration: 420.0, faults: vec![weak], ..Scenario::default() };
    let config = with_prbs_phase(&Config::default(), seed);
    let scenario = on_rig(scenario, &config, Some(preset), None, FaultSize::default()).expect("a preset");
    let mut instrument = Instrument::new(&config).expect("the default settings");
    instrument.commission(commissioned).expect("what was trained");
    let record = run_on(&mut instrument, &config, &scenario, seed);
    (record, instrument.trained())
}

/// Each start learns the rig as it is, so that nothing else tells of what it has lost between them.
#[test]
fn a_heater_that_is_a_quarter_weaker_at_the_next_start_is_told_as_advice() {
    for preset in ["paper", "trainer"] {
        for seed in 1..=4 {
            let (_, commissioned) = start(preset, 1.0, seed, None);
            assert!(commissioned.is_some(), "{preset} {seed}");
            for (power, told) in [(0.75, true), (1.0, false)] {
                let (record, _) = start(preset, power, seed + 10, commissioned);
                let said = record.rows.last().expect("rows").report.likelihood;
                let finding = said.finding.filter(|finding| finding.class == FaultClass::SinceCommissioning);
                assert_eq!((said.alarm, said.advice), (told, told), "{preset} {seed} {power}: {said:?}");
                assert_eq!(finding.is_some(), told, "{preset} {seed} {power}: {said:?}");
                if let Some(size) = finding.and_then(|finding| finding.magnitude) {
                    assert!((size.value + 25.0).abs() < size.half_width, "{preset} {seed}: {size:?}");
                }
            }
        }
    }
}
