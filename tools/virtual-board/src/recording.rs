//! From the log of the board to the record of a run: the codes and orders that it carries are run through the core once
//! more, and every word that the board said of each tick must come out again, bit for bit.

use anyhow::{Context, anyhow, ensure};
use fdi_core::{Command, Config, Instrument, Report, Tick};
use firmware_logic::control_loop::{OrderKind, TickRecord};
use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;

use crate::rtt::Line;

/// What the board said of one tick, and what the core makes of it on the host.
pub struct RerunTick {
    /// The words of the log.
    pub record: TickLine,
    /// First half, on the host.
    pub tick: Tick,
    /// Second half, on the host.
    pub report: Report,
}

/// A word in which board and host differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Number of the tick.
    pub tick: u32,
    /// Name of the word.
    pub name: &'static str,
    /// What the board said.
    pub board: u32,
    /// What the host says.
    pub host: u32,
}

/// A log, run again.
pub struct Recording {
    /// Every tick.
    pub ticks: Vec<RerunTick>,
    /// Where board and host differ.
    pub differences: Vec<Difference>,
    /// The instrument after the last tick.
    pub instrument: Instrument,
}

impl Recording {
    /// Runs a log from tick 0 on again, under the settings that the board had when it started.
    ///
    /// # Errors
    /// The log lacks a tick, or cannot be read.
    pub fn of(log: &[Line], config: &Config) -> anyhow::Result<Self> {
        let mut instrument = Instrument::new(config)?;
        let lines: Vec<LogLine<'_>> =
            log.iter().map(parse).filter_map(Result::transpose).collect::<Result<_, _>>()?;
        let (mut ticks, mut differences) = (Vec::new(), Vec::new());
        for line in &lines {
            if let LogLine::Commissioned(kept) = line {
                instrument.commission(kept.map(|kept| kept.models))?;
            }
            let LogLine::Tick(record) = *line else { continue };
            let index = ticks.len() as u32;
            ensure!(record.tick() == index, "the log has tick {} where {index} was due", record.tick());
            ensure!(!record.missed(), "the board missed tick {index}");
            for command in lines.iter().filter_map(|line| order(line, index)) {
                instrument.command(command).with_context(|| format!("order before tick {index}"))?;
            }
            let tick = instrument.control(record.raw());
            let report = instrument.diagnose(&tick, record.applied());
            let again = TickLine::new(&as_recorded(&record, tick), &report);
            differences.extend(record.differences(&again).map(|(name, board, host)| Difference {
                tick: index,
                name,
                board,
                host,
            }));
            ticks.push(RerunTick { record, tick, report });
        }
        Ok(Self { ticks, differences, instrument })
    }
}

/// The line, if it is one that a program reads.
///
/// # Errors
/// It is broken.
pub fn parse(line: &Line) -> anyhow::Result<Option<LogLine<'_>>> {
    LogLine::find(&line.text).map_err(|error| anyhow!("{}: {error}", line.text))
}

/// The command that was carried out before this tick.
fn order(line: &LogLine<'_>, before: u32) -> Option<Command> {
    match *line {
        LogLine::Order { tick, order: OrderKind::Command(command) } if tick == before => Some(command),
        _ => None,
    }
}

/// The record as the board had it: time and power are the board's own.
fn as_recorded(line: &TickLine, tick: Tick) -> TickRecord {
    let mut record = TickRecord::new(line.raw(), tick, line.applied());
    record.arrival.late_us = line.late_us();
    record
}
