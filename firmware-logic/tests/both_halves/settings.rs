//! Settings are in force in both halves or in none, and what was learnt holds for them alone.

use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::diagnosis::baseline::{Baseline, Normal};
use fdi_core::{AdcCode, Command, Config, Feedback, RawSample, Seconds};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::board::Chip;
use firmware_logic::console::{ApplyError, Board};
use firmware_logic::control_loop::{ControlLoop, Denial, Order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::interlock::Interlock;
use firmware_logic::settings::stored::Stored;

use crate::output::Output;
use crate::{at_rest, board, now, waived};

#[test]
fn settings_are_in_force_in_both_halves_or_in_none() {
    let mut board = at_rest();
    let mut config = waived();
    config.sample_time.0 = 9.0;
    assert!(matches!(now(board.apply(&config)), Err(ApplyError::Config(_))));
    config.sample_time.0 = 0.11;
    config.supervisor.over_temperature.0 += 1.0;
    now(board.command(Command::Arm)).expect("arms");
    assert!(matches!(now(board.apply(&config)), Err(ApplyError::Denied(_))), "a limit is widened");
    assert_eq!(board.config(), waived());
    now(board.command(Command::Stop)).expect("always");
    now(board.apply(&config)).expect("at rest it may");
    assert_eq!(board.config(), config);
}

/// The timers have begun with the old one, and what was learnt holds for it alone.
#[test]
fn a_sample_time_is_kept_and_in_force_from_the_next_start_on() {
    let mut board = at_rest();
    let config = Config { sample_time: Seconds(0.2), ..waived() };
    now(board.apply(&config)).expect("a board can keep it");
    assert_eq!((board.config().sample_time, board.sample_time()), (Seconds(0.2), Seconds(0.11)));
    assert_eq!(board.chip.diagnosis.in_force(&config).sample_time, Seconds(0.11));
    assert_eq!(board.chip.diagnosis.to_keep(), Stored { config: config.clone(), baseline: None });
    let learnt = Some(Baseline { samples: 1637, ..Baseline::default() });
    for (sample_time, kept) in [(0.11, learnt), (0.2, None)] {
        let settings = Stored { config: waived(), baseline: learnt };
        let mut diagnosis = DiagnosisLoop::new(Diagnosis::new(&waived()).expect("valid"), settings);
        let config = Config { sample_time: Seconds(sample_time), ..waived() };
        diagnosis.propose(&config).expect("valid");
        let mut control = ControlLoop::new(
            Controller::new(&waived()).expect("valid"),
            config.setpoint,
            Interlock::default(),
        );
        let order = Some(Order::Retune(Controller::new(&diagnosis.in_force(&config)).expect("valid")));
        let raw = RawSample {
            t0: AdcCode(2160.0),
            t1: AdcCode(2160.0),
            t2: AdcCode(2160.0),
            ..RawSample::default()
        };
        let record =
            control.tick(raw, Arrival::default(), order, Feedback::default(), &mut Output::default());
        diagnosis.step(record, |_| {});
        assert_eq!(diagnosis.to_keep().baseline, kept, "{sample_time} s");
        assert_eq!(diagnosis.baseline().copied(), learnt, "in force until then");
    }
}

#[test]
fn an_order_without_an_answer_is_in_force_once_it_was_carried_out() {
    let mut board = at_rest();
    let mut config = waived();
    config.pid.kp += 1.0;
    board.chip.deaf = true;
    assert_eq!(now(board.apply(&config)), Err(ApplyError::Denied(Denial::NoAnswer)));
    assert_eq!(board.config(), waived());
    now(board.chip.pause());
    assert_eq!(
        board.config(),
        config,
        "what `get` shows and `save` keeps is what the control half runs with"
    );
}

#[test]
fn only_a_baseline_that_can_have_been_learnt_is_restored() {
    let normal = Normal { mean: [0.5; 7], sigma: [0.1; 7] };
    let learnt = Baseline { samples: 1636, raw: normal, filtered: normal };
    assert_eq!(board(Stored { config: waived(), baseline: Some(learnt) }).baseline(), Some(learnt));
    let broken = Baseline { raw: Normal { mean: [f32::NAN; 7], sigma: [0.1; 7] }, ..learnt };
    assert_eq!(board(Stored { config: waived(), baseline: Some(broken) }).baseline(), None);
}
