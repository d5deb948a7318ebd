//! The paper's experiment on a board by itself: codes from the port, every word compared with the core on the host, times of its ticks
//! by its own counter of cycles. What comes out is text that its owner can send.

use std::fmt::Write as _;
use std::io::{Read, Write};

use anyhow::{Context, ensure};
use fdi_core::Config;
use firmware_logic::log_line::LogLine;
use pt326_rig::Rig;

use crate::commands::replay::agreement;
use pt326_host::board::simulate::SimulatedRig;
use pt326_host::board::{Heard, Session, settings};
use pt326_host::experiment::as_written;
use pt326_host::experiment::scenario::Scenario;

/// What a board has shown.
pub struct Verification {
    /// All is as it should be.
    pub passed: bool,
    /// What was found, for people.
    pub report: String,
    /// The board's stream, for `pt326 replay`.
    pub log: String,
}

/// Runs the paper's experiment, or the first `seconds` of it. The board keeps its settings, has its outputs locked off meanwhile, and ends
/// restarted, off and not simulated. `progress` is told each tick.
///
/// # Errors
/// The port has gone; the board is not off, or starts anew in the middle.
pub fn verify<P: Read + Write>(
    session: &mut Session<P>,
    seconds: Option<f64>,
    mut progress: impl FnMut(u64, u64),
) -> anyhow::Result<Verification> {
    let scenario = Scenario::default();
    let config = settings::read(session)?;
    let sample_time = as_written(config.sample_time.0);
    let needed = (seconds.unwrap_or(scenario.duration) / sample_time).round() as u64;
    let rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, 1, &scenario.faults);
    let rig = SimulatedRig::new(rig);
    session.simulate(rig.clone());
    session.order("simulate on")?;
    session.order("set supervisor.check_before_arming false")?;
    session.order("arm")?;

    let mut run = Run::default();
    while (run.control.len() as u64) < needed {
        for heard in session.hear_alive().context("its outputs are locked off until its next start")? {
            run.note(&heard);
        }
        ensure!(run.starts < 2, "the board has started anew in the middle");
        progress(run.control.len() as u64, needed);
    }
    session.order("stop")?;
    let status = session.order("status")?;
    ensure!(status.contains("SIMULATED"), "the board does not say that it is simulated:\n{status}");
    session.order("restart")?;
    session.order("stream off")?;
    run.verification(rig.unseen(), &status, &config)
}

/// What has come.
#[derive(Default)]
struct Run {
    log: String,
    /// What the board says it is.
    name: String,
    hz: f64,
    starts: u32,
    broken: u32,
    dropped: u32,
    late_us: u32,
    missed: u32,
    control: Vec<u32>,
    diagnosis: Vec<u32>,
}

impl Run {
    fn note(&mut self, heard: &Heard) {
        let line = match heard {
            Heard::Line(line) => line,
            Heard::Broken => {
                self.broken += 1;
                return;
            }
            Heard::Text(_) => return,
        };
        let _ = writeln!(self.log, "{line}");
        match LogLine::find(line) {
            Ok(Some(LogLine::Start { .. })) => self.starts += 1,
            Ok(Some(LogLine::Dropped { count })) => self.dropped += count,
            Ok(Some(LogLine::Tick(tick))) => {
                self.missed += u32::from(tick.missed());
                self.late_us = self.late_us.max(tick.late_us());
            }
            Ok(Some(LogLine::Cycles { control, diagnosis, .. })) => {
                self.control.push(control);
                self.diagnosis.push(diagnosis);
            }
            Ok(Some(LogLine::Image(image))) => {
                self.name = format!("PT-326 FDI {} ({}) on {}", image.release, image.commit, image.board);
            }
            _ if line.starts_with("clock ") => {
                self.name += &line.replacen("clock", ",", 1);
                self.hz = line.split(' ').zip(line.split(' ').skip(1)).find_map(hertz).unwrap_or(0.0);
            }
            _ => {}
        }
    }

    fn verification(mut self, unseen: u32, status: &str, config: &Config) -> anyhow::Result<Verification> {
        let (agrees, told) = agreement(&self.log)?;
        let late = self.late_us > 1000;
        let lost = self.broken + self.dropped + self.missed + unseen;
        let passed = agrees && !late && lost == 0;
        let mut report = String::new();
        let _ = writeln!(report, "pt326 {} verifies: {}", env!("CARGO_PKG_VERSION"), self.name);
        let _ = writeln!(report, "{}", told.trim_end());
        let _ = writeln!(
            report,
            "ticks missed {}, latest {} us late; lines broken {}, dropped {}; codes that came too late {unseen}",
            self.missed, self.late_us, self.broken, self.dropped
        );
        let period = as_written(config.sample_time.0);
        for (half, cycles) in [("first half", &mut self.control), ("second half", &mut self.diagnosis)] {
            let _ = writeln!(report, "{half:<12} {}", times(cycles, self.hz, period));
        }
        let _ = writeln!(report, "{}", status.trim_end());
        let _ = writeln!(report, "{}", if passed { "passed" } else { "NOT passed" });
        Ok(Verification { passed, report, log: self.log })
    }
}

/// `100000000 Hz`.
fn hertz((number, unit): (&str, &str)) -> Option<f64> {
    number.parse().ok().filter(|_| unit == "Hz")
}

/// Median and most of some cycles.
fn times(cycles: &mut [u32], hz: f64, period: f64) -> String {
    cycles.sort_unstable();
    let (Some(median), Some(most)) = (cycles.get(cycles.len() / 2), cycles.last()) else {
        return "not measured".into();
    };
    let us = |cycles: u32| f64::from(cycles) / hz * 1e6;
    format!(
        "median {median} cycles ({:.0} us), at most {most} ({:.0} us, {:.1} % of a tick), interrupts included",
        us(*median),
        us(*most),
        us(*most) / period / 1e4
    )
}
