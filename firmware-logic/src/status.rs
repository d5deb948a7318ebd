//! How the instrument is, in a few lines for people.

use core::fmt;

use fdi_core::likelihood::{Readiness, RejectReason};
use fdi_core::{Mode, Percent, Reading, Report, Validity};

use crate::cadence::Jitter;
use crate::control_loop::TickRecord;
use crate::decimal::Fixed;
use crate::interlock::Lockout;
use crate::led::Sign;
use crate::self_test::Progress;

/// Health of the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Health {
    /// Jitter of the control tick.
    pub jitter: Jitter,
    /// Ticks that the diagnosis never saw.
    pub records_lost: u32,
    /// Frames of the log that did not fit.
    pub log_dropped: u32,
    /// Most bytes of stack ever used.
    pub stack_used: u32,
    /// Bytes of stack.
    pub stack_size: u32,
}

/// What the last tick said.
#[derive(Clone, Debug, Default)]
pub struct Status {
    /// TickRecord and report of the last tick; `None` before the first.
    pub last: Option<(TickRecord, Report)>,
    /// Health of the board.
    pub health: Health,
    /// What the self-test has told so far.
    pub check: Progress,
}

impl Status {
    /// Whether a self-test has passed since the start.
    pub fn is_checked(&self) -> bool {
        self.last.as_ref().is_some_and(|(record, _)| record.checked)
    }

    /// Whether a trip or a lockout keeps the heater off.
    pub fn is_latched(&self) -> bool {
        let tripped = |(record, _): &(TickRecord, Report)| matches!(record.tick.mode, Mode::Tripped(_));
        self.lockout().is_some() || self.last.as_ref().is_some_and(tripped)
    }

    /// Whether the heater may be on, or a self-test be under way, which is off only between its pulses.
    pub fn may_heat(&self) -> bool {
        self.is_heating() || self.check.stage.is_some()
    }

    /// What the LED should say.
    pub fn sign(&self) -> Sign {
        let Some((_, report)) = &self.last else { return Sign::Off };
        let faulty = report.likelihood.alarm || report.filtered.is_some_and(|verdict| verdict.fdv != 0);
        match (self.is_latched(), self.may_heat()) {
            (true, _) => Sign::Latched,
            (false, true) if faulty => Sign::Alarm,
            (false, true) => Sign::Heating,
            (false, false) => Sign::Off,
        }
    }

    /// What holds the heater off.
    pub fn lockout(&self) -> Option<Lockout> {
        self.last.as_ref().and_then(|(record, _)| record.lockout)
    }

    /// Whether the heater may be on.
    pub fn is_heating(&self) -> bool {
        self.last.as_ref().is_some_and(|(record, _)| record.tick.mode.is_heating())
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((record, report)) = &self.last else { return f.write_str("no tick yet") };
        let tick = &record.tick;
        write!(f, "mode {}", tick.mode.name())?;
        if let Mode::Tripped(trip) = tick.mode {
            write!(f, " ({}), `ack` when its cause has gone", trip.reason.words())?;
        }
        if let Some(lockout) = record.lockout {
            write!(f, ", heater locked out: {lockout}; `ack` to release")?;
        }
        if let Some(stage) = self.check.stage {
            write!(f, ", check under way: {}, {} findings", stage.name(), self.check.findings.len())?;
        }
        if let Some(blocker) = tick.blocked {
            write!(f, ", not learning: {}", blocker.words())?;
        }
        let sample = &tick.sample;
        let [t0, t1, t2] = [sample.t0, sample.t1, sample.t2].map(ReadingText);
        let Percent(drive) = record.applied;
        write!(
            f,
            "\nT0 {t0}, T1 {t1} of {} degC, T2 {t2}, heater {} %",
            Fixed(tick.setpoint.0, 1),
            Fixed(drive, 1)
        )?;
        f.write_str("\ngain")?;
        number(f, report.ms1.static_gain, 3)?;
        number(f, report.ms2.static_gain, 3)?;
        f.write_str(" degC/%, bandwidth")?;
        number(f, report.ms1.bandwidth, 2)?;
        write!(f, " rad/s, learnt from {} samples", report.learned)?;
        if let Some(verdict) = &report.filtered {
            write!(f, "\nfdv {} fiv {}", verdict.fdv, verdict.fiv)?;
        }
        f.write_str("\nlikelihood diagnosis ")?;
        f.write_str(readiness(report.likelihood.readiness))?;
        write!(f, "\n{}", self.health)
    }
}

impl fmt::Display for Health {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let p = &self.jitter;
        write!(
            f,
            "ticks {} missed {} worst {} us late, diagnosis lost {}, log dropped {}, stack {} of {} bytes",
            p.ticks,
            p.missed,
            p.worst_us,
            self.records_lost,
            self.log_dropped,
            self.stack_used,
            self.stack_size
        )
    }
}

/// How far the likelihood diagnosis has come.
pub const fn readiness(readiness: Readiness) -> &'static str {
    match readiness {
        Readiness::Untrained => "not trained",
        Readiness::Training => "in training",
        Readiness::Refused(RejectReason::Unstable) => "refused: a model is unstable",
        Readiness::Refused(RejectReason::Gain) => "refused: a gain is not positive",
        Readiness::Refused(RejectReason::PoorFit) => "refused: the models fit badly",
        Readiness::Armed => "armed",
    }
}

fn number(f: &mut fmt::Formatter<'_>, x: Option<f32>, decimals: u8) -> fmt::Result {
    match x {
        Some(x) => write!(f, " {}", Fixed(x, decimals)),
        None => f.write_str(" ?"),
    }
}

/// A reading, with its doubts.
struct ReadingText(Reading);

impl fmt::Display for ReadingText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Fixed(self.0.celsius.0, 2).fmt(f)?;
        match self.0.validity {
            Validity::Good => Ok(()),
            doubt => write!(f, " ({doubt:?})"),
        }
    }
}
