//! The core run beside a board on the board's own codes: the same bits? And what no log holds: what the models expect, what each hypothesis
//! explains, residuals in units of their thresholds.

use fdi_core::schema::{self, Moment, Numbers};
use fdi_core::{Config, Instrument};
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::log_line::{LogLine, VERSION};

use super::log::{Change, Start, again};

/// Orders for ticks to come; no board gives as many.
const MOST_ORDERS: usize = 1000;

/// How a core beside a board agrees with it.
#[derive(Clone, Debug, PartialEq)]
pub enum Agreement {
    /// The log was not heard from the board's start on, or not without a gap: no core can be run beside it.
    NotWhole,
    /// Every bit of so many ticks is the same.
    Same(u32),
    /// From this tick on a number is another than the core's.
    Differs {
        /// The tick.
        tick: u32,
        /// The number.
        name: &'static str,
    },
    /// The board's image writes another format of the log than the one that is read here.
    Format(u32),
    /// Its settings are of another release, in words.
    Other(String),
}

/// The core beside a board.
pub(super) struct Twin {
    start: Start,
    core: Option<Box<Instrument>>,
    sigma_factor: f32,
    pub(super) agreement: Agreement,
}

impl Twin {
    /// None of it was heard.
    pub(super) fn new() -> Self {
        Self {
            start: Start::new(Config::default()),
            core: None,
            sigma_factor: 1.0,
            agreement: Agreement::NotWhole,
        }
    }

    /// Whether it runs.
    pub(super) fn runs(&self) -> bool {
        matches!(self.agreement, Agreement::Same(_))
    }

    /// Whether all has been told of the tick before: what locks the heater out on a tick is told behind its record, and before its times.
    pub(super) fn ends_tick(line: &LogLine<'_>) -> bool {
        matches!(line, LogLine::Tick(_) | LogLine::Cycles { .. } | LogLine::Start { .. })
    }

    /// A line of the stream. The numbers of a tick come with the line that ends it, where they are the board's.
    pub(super) fn line(&mut self, line: LogLine<'_>) -> Option<Numbers> {
        if let LogLine::Start { version } = line {
            let agreement = if version == VERSION { Agreement::Same(0) } else { Agreement::Format(version) };
            *self = Self { agreement, ..Self::new() };
        }
        if !self.runs() {
            return None;
        }
        let numbers = if Self::ends_tick(&line) { self.step() } else { None };
        if self.start.orders.len() > MOST_ORDERS {
            self.agreement = Agreement::NotWhole;
        } else if let Err(error) = self.start.line(line) {
            self.agreement = Agreement::Other(format!("{error:#}"));
        }
        numbers
    }

    /// The core's next tick, where there is a record of it.
    fn step(&mut self) -> Option<Numbers> {
        let (changes, said) = self.start.take()?;
        let Agreement::Same(due) = self.agreement else { return None };
        if said.tick() != due {
            self.agreement = Agreement::NotWhole;
            return None;
        }
        let (numbers, difference) = match self.run(&changes, &said) {
            Ok(done) => done,
            Err(error) => {
                self.agreement = Agreement::Other(format!("{error:#}"));
                return None;
            }
        };
        self.agreement = match difference {
            None => Agreement::Same(due.saturating_add(1)),
            Some(name) => Agreement::Differs { tick: due, name },
        };
        self.runs().then_some(numbers)
    }

    /// The core's numbers, and what differs.
    fn run(
        &mut self,
        changes: &[Change],
        said: &TickLine,
    ) -> anyhow::Result<(Numbers, Option<&'static str>)> {
        let core = match &mut self.core {
            Some(core) => core,
            none => {
                let mut core = Instrument::new(&self.start.config)?;
                if let Some(baseline) = &self.start.baseline {
                    core.restore(baseline)?;
                }
                self.sigma_factor = self.start.config.diagnosis.sigma_factor;
                none.insert(Box::new(core))
            }
        };
        for change in changes {
            change.carry_out(core)?;
            if let Change::Settings(config) = change {
                self.sigma_factor = config.diagnosis.sigma_factor;
            }
        }
        let tick = core.control(said.raw());
        let report = core.diagnose(&tick, said.applied());
        let difference = said.differences(&again(said, &tick, &report)).next().map(|(name, ..)| name);
        let numbers = schema::row(&Moment {
            raw: said.raw(),
            applied: said.applied(),
            explained: schema::explained(core, &report).as_ref(),
            normal: core.baseline().map(|baseline| &baseline.filtered),
            sigma_factor: self.sigma_factor,
            ..Moment::new(&tick, &report)
        });
        Ok((numbers, difference))
    }
}
