//! The second half of a tick: diagnosis, what was learnt, what went wrong, and what there is to tell. Beside
//! [`ControlLoop`](crate::control_loop::ControlLoop), and joined to it by the records of ticks alone.

#[cfg(test)]
mod tests;

use core::mem::discriminant;

use fdi_core::control::Controller;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::event::Event;
use fdi_core::diagnosis::{Diagnosis, DiagnosisState};
use fdi_core::likelihood::Readiness;
use fdi_core::name::Name;
use fdi_core::{Config, ConfigError, Feedback, Mode, Report, Seconds};

use crate::alarm::Alarms;
use crate::calibration::Still;
use crate::control_loop::{OrderKind, Outcome, TickRecord};
use crate::history::{Entry, History};
use crate::interlock::Lockout;
use crate::log_line::tick::TickLine;
use crate::notice::Notice;
use crate::settings::bits::checksum;
use crate::settings::commissioning::Commissioning;
use crate::settings::schema::Valued;
use crate::settings::stored::{Stored, check};
use crate::status::{Since, Status};
use crate::teaching::Teaching;

/// How often the settings are held against their checksum, at least: each tick where that is longer.
const CHECKED_EVERY: Seconds = Seconds(1.0);

/// The diagnosis half of the instrument on the board.
#[derive(Clone, Debug)]
pub struct DiagnosisLoop {
    diagnosis: Diagnosis,
    state: DiagnosisState,
    /// In force, and what was learnt under them.
    settings: Stored,
    /// Of the settings when they had been checked, and whether they have been found to differ from it.
    checksum: u32,
    damaged: bool,
    /// Ts since the start: another one is in force from the next start on.
    sample_time: Seconds,
    /// Settings that the control half has not answered yet.
    proposed: Option<Proposal>,
    /// What the rig was like when it was commissioned.
    commissioning: Option<Commissioning>,
    /// It is new, and the log does not have it.
    untold: bool,
    status: Status,
    history: History,
    still: Still,
    teaching: Teaching,
    before: Before,
}

/// New settings with the diagnosis that they give.
#[derive(Clone, Debug)]
struct Proposal {
    config: Config,
    diagnosis: Diagnosis,
}

/// What was the case on the tick before, so that a change is noticed.
#[derive(Clone, Debug)]
struct Before {
    mode: Mode,
    lockout: Option<Lockout>,
    readiness: Readiness,
    alarms: Alarms,
}

impl DiagnosisLoop {
    /// The loop at the start; `diagnosis` is the one that these settings give. A baseline among them is restored if it is one
    /// that can have been learnt, and else dropped.
    pub fn new(diagnosis: Diagnosis, settings: Stored) -> Self {
        let mut this = Self {
            state: diagnosis.start(), // in its place: it is too large to lie on a board's stack twice
            diagnosis,
            sample_time: settings.config.sample_time,
            checksum: checksum(&settings.config),
            damaged: false,
            settings,
            proposed: None,
            commissioning: None,
            untold: false,
            status: Status::default(),
            history: History::default(),
            still: Still::default(),
            teaching: Teaching::default(),
            before: Before {
                mode: Mode::Off,
                lockout: None,
                readiness: Readiness::Untrained,
                alarms: Alarms::default(),
            },
        };
        match this.settings.baseline.filter(|baseline| baseline.validate().is_ok()) {
            Some(baseline) => this.diagnosis.restore(&mut this.state, &baseline),
            None => this.settings.baseline = None,
        }
        this
    }

    /// One tick, from the record that the control half made of it. What there is to tell goes to `tell`; the feedback to
    /// the control half is part of the report.
    pub fn step(&mut self, record: TickRecord, mut tell: impl FnMut(Notice)) -> &Report {
        let tick = record.tick.index;
        if let Some(outcome) = &record.outcome {
            self.adopt(outcome);
            self.tell_outcome(tick, outcome, record.checked, &mut tell);
        }
        if let Some(news) = record.news {
            self.status.check.note(news);
            tell(Notice::Check(news));
        }
        if core::mem::take(&mut self.untold) {
            tell(Notice::Commissioning(self.commissioning));
        }
        if let Some(standing) = record.tick.tuning {
            let before = self.status.tuning.replace(standing);
            if before.is_none_or(|before| discriminant(&before) != discriminant(&standing)) {
                tell(Notice::Tuning(standing));
            }
        }
        if tick.is_multiple_of(CHECKED_EVERY.ticks(self.sample_time)) {
            self.damaged = self.is_damaged();
        }
        self.still.step(&record.tick.sample, record.applied.0 > 0.0);
        let report = self.diagnosis.step(&mut self.state, &record.tick.observation(record.applied));
        let monitors = record.tick.mode == Mode::Monitor;
        let symptoms = report.filtered.as_ref().map(|verdict| &verdict.symptoms);
        self.teaching.step(monitors, symptoms, || self.diagnosis.changed(&self.state));
        self.status.named = report.filtered.map_or(Name::NONE, |verdict| self.name(verdict.fdv, verdict.fiv));
        self.status.taught = report.likelihood.taught.map_or(Name::NONE, |taught| taught.name);
        tell(Notice::Tick(TickLine::new(&record, &report)));
        self.notice_mode(&record, &mut tell);
        self.notice_lockout(&record, &mut tell);
        self.notice_faults(&report, &mut tell);
        self.notice_jitter(&record, &mut tell);
        &self.status.last.insert((record, report)).1
    }

    fn tell_outcome(&self, tick: u32, outcome: &Outcome, checked: bool, tell: &mut impl FnMut(Notice)) {
        let order = outcome.order;
        match outcome.result {
            Ok(()) => tell(Notice::Order { tick, order }),
            Err(denial) => return tell(Notice::Denied { tick, denial }),
        }
        if !matches!(order, OrderKind::Command(command) if command.heats()) {
            return;
        }
        if !checked {
            tell(Notice::Unchecked);
        }
        Valued::wider_than_default(&self.settings.config).for_each(|wider| tell(Notice::Wider(wider)));
    }

    /// Puts proposed settings in force with the control half, or drops them with it.
    fn adopt(&mut self, outcome: &Outcome) {
        if outcome.order == OrderKind::Settings
            && let Some(Proposal { config, diagnosis }) = self.proposed.take()
            && outcome.result.is_ok()
        {
            self.damaged = self.is_damaged(); // they may have been made of what is kept
            self.diagnosis = diagnosis;
            self.settings.config = config;
            self.checksum = checksum(&self.settings.config);
        }
    }

    fn notice_mode(&mut self, record: &TickRecord, tell: &mut impl FnMut(Notice)) {
        let tick = &record.tick;
        let before = core::mem::replace(&mut self.before.mode, tick.mode);
        if discriminant(&before) == discriminant(&tick.mode) {
            return;
        }
        tell(Notice::Mode { tick: tick.index, from: before.name(), to: tick.mode.name() });
        if let Mode::Tripped(trip) = tick.mode {
            self.history.push(Entry::Trip(trip));
            tell(Notice::Trip(trip));
        }
        if tick.mode == Mode::Monitor {
            self.settings.baseline = self.diagnosis.baseline(&self.state).copied();
        }
    }

    fn notice_lockout(&mut self, record: &TickRecord, tell: &mut impl FnMut(Notice)) {
        let (tick, lockout) = (record.tick.index, record.lockout);
        if core::mem::replace(&mut self.before.lockout, lockout) == lockout {
            return;
        }
        if let Some(lockout) = lockout {
            self.history.push(Entry::Lockout { lockout, tick });
        }
        tell(Notice::Lockout { tick, lockout });
    }

    /// What a user calls the row that isolates, or else the one that detects.
    fn name(&self, fdv: u8, fiv: u8) -> Name {
        let tables = &self.settings.config.diagnosis;
        let (rows, number) = if fiv != 0 { (&tables.isolation, fiv) } else { (&tables.detection, fdv) };
        rows.iter().find(|row| row.number == number).map_or(Name::NONE, |row| row.name)
    }

    /// A tick that was missed is counted where the next one begins.
    fn notice_jitter(&mut self, record: &TickRecord, tell: &mut impl FnMut(Notice)) {
        if record.missed {
            return;
        }
        self.status.health.jitter.count(&record.arrival);
        if record.arrival.missed > 0 {
            tell(Notice::Missed { count: record.arrival.missed, before: record.tick.index });
        }
    }

    fn notice_faults(&mut self, report: &Report, tell: &mut impl FnMut(Notice)) {
        for event in &report.events {
            let (Event::Detected(fault) | Event::Isolated(fault) | Event::Ended(fault)) = event;
            self.history.event(*event, self.name(fault.detection_number, fault.isolation_number));
            tell(Notice::Fault(*event));
        }
        let readiness = report.likelihood.readiness;
        if core::mem::replace(&mut self.before.readiness, readiness) != readiness {
            tell(Notice::Readiness { tick: report.tick, readiness });
            if readiness == Readiness::Armed {
                self.notice_commissioning(tell);
            }
        }
        if let Some(alarm) = self.before.alarms.notice(report) {
            self.history.alarm(alarm);
            tell(Notice::Alarm(alarm));
        }
    }

    /// The first models that are accepted are those of the commissioning; later ones are held against them.
    fn notice_commissioning(&mut self, tell: &mut impl FnMut(Notice)) {
        if self.commissioning.is_none() {
            self.commission();
        }
        self.follow_commissioning();
        if let Some(since) = self.status.commissioned {
            tell(Notice::Commissioned(since));
        }
    }

    /// Takes the models in force for those of a new commissioning; `false` where there are none.
    pub fn commission(&mut self) -> bool {
        let trained = self.diagnosis.trained(&self.state).filter(|models| models.validate().is_ok());
        let Some(models) = trained else { return false };
        let number = self.commissioning.map_or(0, |before| before.number).wrapping_add(1);
        self.commissioned(Some(Commissioning { number, models }));
        true
    }

    /// Restores the commissioning, or forgets it.
    pub fn commissioned(&mut self, commissioning: Option<Commissioning>) {
        self.diagnosis.commission(&mut self.state, commissioning.map(|kept| kept.models));
        self.untold |= self.commissioning != commissioning;
        self.commissioning = commissioning;
        self.follow_commissioning();
    }

    fn follow_commissioning(&mut self) {
        let change = self.diagnosis.since_commissioning(&self.state);
        self.status.commissioned = self.commissioning.map(|kept| Since { number: kept.number, change });
    }

    /// The commissioning, to be kept.
    pub fn commissioning(&self) -> Option<&Commissioning> {
        self.commissioning.as_ref()
    }

    /// Proposes settings: checks that a board can run with them, and keeps them until the record of a tick says that the
    /// control half has put its part in force, which is returned and goes into
    /// [`Order::Retune`](crate::control_loop::Order::Retune).
    ///
    /// # Errors
    /// The first setting that is out of bounds; nothing has changed then.
    pub fn propose(&mut self, config: &Config) -> Result<Controller, ConfigError> {
        check(config)?;
        let now = self.in_force(config);
        let controller = Controller::new(&now)?;
        self.proposed = Some(Proposal { config: config.clone(), diagnosis: Diagnosis::new(&now)? });
        Ok(controller)
    }

    /// What of settings can be put in force before the next start: all but the sample time.
    pub fn in_force(&self, config: &Config) -> Config {
        Config { sample_time: self.sample_time, ..config.clone() }
    }

    /// Ts since the start.
    pub fn sample_time(&self) -> Seconds {
        self.sample_time
    }

    /// What the control half needs of this tick.
    pub fn feedback(&self) -> Feedback {
        let found = self.status.last.as_ref().map_or_else(Feedback::default, |(_, report)| report.feedback());
        Feedback { settings_damaged: self.damaged, ..found }
    }

    /// Whether the settings kept here are no longer those that were checked.
    pub fn is_damaged(&self) -> bool {
        self.damaged || checksum(&self.settings.config) != self.checksum
    }

    /// Settings in force, but for the sample time, and what was learnt as normal under them.
    pub fn settings(&self) -> &Stored {
        &self.settings
    }

    /// What a save keeps: settings, and what was learnt if it holds at the next start, too.
    pub fn to_keep(&self) -> Stored {
        let Stored { config, baseline } = self.settings.clone();
        let baseline = baseline.filter(|_| config.sample_time == self.sample_time);
        Stored { config, baseline }
    }

    /// What was learnt as normal, or restored.
    pub fn baseline(&self) -> Option<&Baseline> {
        self.settings.baseline.as_ref()
    }

    /// How the instrument is.
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// What the thermistors read at rest.
    pub fn still(&self) -> &Still {
        &self.still
    }

    /// The fault that is being taught.
    pub fn teaching(&mut self) -> &mut Teaching {
        &mut self.teaching
    }

    /// What went wrong since the start.
    pub fn history(&self) -> &History {
        &self.history
    }
}
