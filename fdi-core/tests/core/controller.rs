//! What the first half of a tick takes for excitation and for T1.

use fdi_core::control::Controller;
use fdi_core::supervisor::Blocker;
use fdi_core::{AdcCode, Command, Config, Feedback, Instrument, RawSample};

use crate::supervision::{AMBIENT, tick};

/// Near the set-point, where nothing cuts the excitation away.
#[test]
fn an_excitation_below_the_least_that_counts_is_none() {
    for (least, expected) in [(0.98, Some(Blocker::NotSteady)), (1.02, Some(Blocker::Unexcited))] {
        let mut config = Config::default();
        config.supervisor.learn_start.0 = 0.0;
        config.supervisor.min_excitation.0 = least * config.prbs.amplitude.0;
        let mut instrument = Instrument::new(&config).unwrap();
        instrument.command(Command::Arm).unwrap();
        let blocked = (0..100).map(|k| tick(&mut instrument, 1617.0, k).blocked).last().unwrap();
        assert_eq!(blocked, expected, "{least}");
    }
}

#[test]
fn the_virtual_t1_is_regulated_only_where_that_is_set() {
    for go_on in [false, true] {
        let mut config = Config::default();
        config.supervisor.go_on_without_t1 = go_on;
        let controller = Controller::new(&config).unwrap();
        let mut state = controller.start(config.setpoint);
        let feedback = Feedback { t1_faulty: true, virtual_rise: Some(10.0), ..Feedback::default() };
        controller.feed_back(&mut state, feedback);
        let room = AdcCode(AMBIENT);
        let raw = RawSample { t0: room, t1: room, t2: room, ..RawSample::default() };
        assert_eq!(controller.step(&mut state, raw).virtual_t1.is_some(), go_on);
    }
}
