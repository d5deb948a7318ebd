//! From the log of the board to the record of a run: the codes and orders that it carries are run through the core once
//! more, and every word that the board said of each tick must come out again, bit for bit.

use anyhow::{Context, ensure};
use fdi_core::{Command, Config, Instrument, Report, Tick};
use firmware_logic::control_loop::TickRecord;
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
        let orders: Vec<(u32, Command)> = log.iter().filter_map(|line| order(&line.text)).collect();
        let (mut ticks, mut differences) = (Vec::new(), Vec::new());
        for line in log.iter().filter(|line| line.text.starts_with("tick ") && line.level == "debug") {
            let record: TickLine = line.text.parse().with_context(|| line.text.clone())?;
            let index = ticks.len() as u32;
            ensure!(record.tick() == index, "the log has tick {} where {index} was due", record.tick());
            ensure!(!record.missed(), "the board missed tick {index}");
            for (_, command) in orders.iter().filter(|(tick, _)| *tick == index) {
                instrument.command(*command).with_context(|| format!("order before tick {index}"))?;
            }
            let tick = instrument.control(record.raw());
            let report = instrument.diagnose(&tick, record.applied());
            let again = TickLine::new(&beat(&record, tick), &report);
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

/// The command that a line of the log says was carried out before a tick.
fn order(text: &str) -> Option<(u32, Command)> {
    let mut words = text.strip_prefix("order ")?.split(' ');
    let tick = words.next()?.parse().ok()?;
    let command = match words.next()? {
        "arm" => Command::Arm,
        "stop" => Command::Stop,
        "ack" => Command::Acknowledge,
        "relearn" => Command::Relearn,
        _ => return None,
    };
    Some((tick, command))
}

/// The beat as the board had it: time and power are the board's own.
fn beat(record: &TickLine, tick: Tick) -> TickRecord {
    let mut beat = TickRecord {
        raw: record.raw(),
        tick,
        applied: record.applied(),
        arrival: Default::default(),
        missed: false,
        lockout: None,
        outcome: None,
        news: None,
        checked: false,
    };
    beat.arrival.late_us = record.late_us();
    beat
}
