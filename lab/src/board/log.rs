//! The log of a board as what a core beside it needs: settings and baseline at the start, the records of ticks, and what was asked for before
//! each.

use std::collections::VecDeque;

use anyhow::ensure;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::likelihood::Commissioned;
use fdi_core::{Command, Config, Instrument, Report, Tick};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::{OrderKind, TickRecord};
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::log_line::{LogLine, VERSION};

use super::settings;

/// Something that changed the instrument before a tick.
#[derive(Clone, Debug)]
pub enum Change {
    /// A command was carried out.
    Command(Command),
    /// Other settings are in force.
    Settings(Box<Config>),
    /// The rig was commissioned, or is so no more.
    Commission(Option<Commissioned>),
}

impl Change {
    /// Changes an instrument.
    ///
    /// # Errors
    /// It does not take that.
    pub fn carry_out(&self, instrument: &mut Instrument) -> anyhow::Result<()> {
        match self {
            // The board logs what it carried out, and an `ack` that released its own interlock means nothing here.
            Self::Command(command) => drop(instrument.command(*command)),
            Self::Settings(config) => instrument.retune(config)?,
            Self::Commission(commissioned) => instrument.commission(*commissioned)?,
        }
        Ok(())
    }
}

/// One start of the board: its records, and what was asked for before a tick.
#[derive(Clone, Debug)]
pub struct Start {
    /// Settings at the start.
    pub config: Config,
    /// A baseline that it began with.
    pub baseline: Option<Baseline>,
    /// Records that have not been taken.
    pub records: VecDeque<TickLine>,
    /// What was asked for before which tick, and has not been taken.
    pub orders: Vec<(u32, Change)>,
    /// Lines that the board's port had no room for.
    pub dropped: u32,
    /// Records so far.
    pub heard: u32,
    /// Settings told since the last order for some: all that are not at their default. The order comes after them.
    told: Config,
}

impl Start {
    /// Nothing of it was heard; `config` is what its settings come on top of.
    pub fn new(config: Config) -> Self {
        let (records, orders) = (VecDeque::new(), Vec::new());
        Self { config, baseline: None, records, orders, dropped: 0, heard: 0, told: Config::default() }
    }

    /// A line of it.
    ///
    /// # Errors
    /// Another version of the log, or a setting that is not known here.
    pub fn line(&mut self, line: LogLine<'_>) -> anyhow::Result<()> {
        match line {
            LogLine::Start { version } => {
                ensure!(
                    version == VERSION,
                    "log format {version}, expected {VERSION}: use the replay of the board's release"
                );
            }
            LogLine::Tick(record) => {
                self.records.push_back(record);
                self.heard = self.heard.saturating_add(1);
            }
            LogLine::Order { tick, order: OrderKind::Command(command) } => {
                self.orders.push((tick, Change::Command(command)));
            }
            LogLine::Order { tick, order: OrderKind::Settings } => {
                let settings = std::mem::take(&mut self.told);
                self.orders.push((tick, Change::Settings(Box::new(settings))));
            }
            LogLine::Order { order: OrderKind::Check, .. } => {} // nothing to the core
            // Settings told before an order that was not carried out are not in force.
            LogLine::Denied { .. } => self.told = Config::default(),
            LogLine::Lockout { tick } => self.orders.insert(0, (tick, Change::Command(Command::Stop))),
            LogLine::Setting { name, value } => {
                let config = if self.heard == 0 { &mut self.config } else { &mut self.told };
                settings::put(config, name, value)?;
            }
            LogLine::Commissioned(kept) => {
                self.orders.push((self.heard, Change::Commission(kept.map(|kept| kept.models))));
            }
            LogLine::Image(_) => {}      // for people
            LogLine::Wider { .. } => {}  // told as a setting, too
            LogLine::Cycles { .. } => {} // times of the board
            LogLine::Dropped { count } => self.dropped = self.dropped.saturating_add(count),
            LogLine::Baseline(part) => part.restore(self.baseline.get_or_insert_default()),
        }
        Ok(())
    }

    /// The next record, with what was asked for just before it.
    pub fn take(&mut self) -> Option<(Vec<Change>, TickLine)> {
        let record = self.records.pop_front()?;
        let due = self.orders.extract_if(.., |(tick, _)| *tick == record.tick());
        Some((due.map(|(_, change)| change).collect(), record))
    }
}

/// What the core says of a tick, as the board would have logged it.
pub fn again(said: &TickLine, tick: &Tick, report: &Report) -> TickLine {
    let arrival = Arrival { late_us: said.late_us(), ..Arrival::default() };
    let record =
        TickRecord { arrival, missed: said.missed(), ..TickRecord::new(said.raw(), *tick, said.applied()) };
    TickLine::new(&record, report)
}
