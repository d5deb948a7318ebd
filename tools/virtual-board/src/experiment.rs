//! The paper's experiment on the board: power up, arm, let the rig run, read the log.

use std::rc::Rc;

use anyhow::{Context, ensure};
use fdi_core::{Command, Config};
use firmware_logic::control_loop::OrderKind;
use firmware_logic::log_line::LogLine;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{Origin, Record, Row, as_written, with_prbs_phase};
use pt326_rig::Rig;
use pt326_rig::fault::Fault;

use crate::board::Board;
use crate::clock::Cause;
use crate::closed_loop::{Shared, TICK};
use crate::image::Image;
use crate::recording::{self, Difference, Recording};
use crate::scene::WAIVE_CHECK;
use crate::time::{MS, SECOND};
use crate::wiring::AT_REST;

/// A run on the board.
pub struct Experiment {
    /// The board after the run.
    pub board: Board,
    /// The rig on its wires.
    pub rig: Shared,
    /// What a run of the simulation gives, too; tick 0 is the one at which the board was armed.
    pub record: Record,
    /// Where the board's words differ from the host's.
    pub differences: Vec<Difference>,
    /// Ticks of the board before it was armed.
    pub idle_ticks: usize,
}

/// Runs a scenario on the image.
///
/// # Errors
/// The program did something that is not modelled, or its log has a gap.
pub fn run(image: Rc<Image>, scenario: &Scenario, seed: u64) -> anyhow::Result<Experiment> {
    ensure!(scenario.actions.is_empty(), "actions are not carried out on the board");
    let rig = Shared::at_rest(AT_REST);
    let mut board = Board::new(image, Box::new(rig.clone()))?;
    let config = prepare(&mut board, seed)?;
    let first = board.log.len();
    let sample_time = as_written(config.sample_time.0);
    rig.0.borrow_mut().start(Rig::new(
        &scenario.rig,
        scenario.disturbance,
        sample_time,
        seed,
        &scenario.faults,
    ));
    // In the middle between two ticks, so that the order is there when the rig begins.
    let answer = board.command("arm")?;
    ensure!(answer.starts_with("ok"), "the board does not arm: {answer}");
    let ticks = (scenario.duration / sample_time).floor() as usize;
    board.run_for(ticks as u64 * TICK)?;

    let armed = board.log[first..].iter().find_map(|line| match recording::parse(line) {
        Ok(Some(LogLine::Order { tick, order: OrderKind::Command(Command::Arm) })) => Some(tick as usize),
        _ => None,
    });
    let idle_ticks = armed.context("the log does not say that the board was armed")?;
    let start =
        board.log.iter().rposition(|line| matches!(recording::parse(line), Ok(Some(LogLine::Start { .. }))));
    let recording = Recording::of(&board.log[start.unwrap_or(0)..], &config)?;
    ensure!(recording.ticks.len() >= idle_ticks + ticks, "the log ends at tick {}", recording.ticks.len());
    let rows = rows(&recording, idle_ticks, ticks, &scenario.faults, sample_time);
    let origin = Origin::Simulated { seed, disturbance: scenario.disturbance };
    let baseline = recording.instrument.baseline().copied();
    let record = Record::new(origin, &config, &scenario.faults, rows, baseline);
    let record = Record { is_papers: scenario.is_papers(), ..record };
    Ok(Experiment { board, rig, record, differences: recording.differences, idle_ticks })
}

/// Waits for the first ticks; gives the board the phase of the excitation that the seed asks for, which is in force
/// from the start after it was saved.
fn prepare(board: &mut Board, seed: u64) -> anyhow::Result<Config> {
    let config = with_prbs_phase(&Config::default(), seed);
    board.run_for(SECOND)?;
    if config != Config::default() {
        let start = config.prbs.start;
        let answer = board.command(&format!("set prbs.start {start}"))?;
        ensure!(answer == format!("prbs.start = {start}"), "the board says: {answer}");
        let answer = board.command("save")?;
        ensure!(answer == "ok", "the board does not save: {answer}");
        board.reset(Cause::Pin)?;
        board.run_for(SECOND)?;
    }
    board.command(WAIVE_CHECK)?;
    // The first tick is due 110 ms after the start, a sample takes 1.3 ms; arming takes a few.
    let ticks = board.log.len();
    board.run_until("a tick", 2 * TICK, |board| board.log.len() > ticks)?;
    board.run_for(20 * MS)?;
    Ok(config)
}

/// The rows of a record, from the tick at which the board was armed.
fn rows(recording: &Recording, first: usize, count: usize, faults: &[Fault], sample_time: f64) -> Vec<Row> {
    let ticks = recording.ticks.iter().skip(first).take(count).enumerate();
    ticks
        .map(|(i, recorded)| {
            let (mut tick, mut report) = (recorded.tick, recorded.report.clone());
            tick.index -= first as u32;
            report.tick -= first as u32;
            if let Some(finding) = &mut report.likelihood.finding {
                finding.onset = finding.onset.saturating_sub(first as u32);
            }
            let truth = pt326_host::experiment::truth(faults, i as f64 * sample_time);
            Row { applied: tick.drive, tick, report, truth }
        })
        .collect()
}
