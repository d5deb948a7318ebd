//! What a tick has to tell people, as lines of the log: the board writes them to its log, the host's console shows them.

use core::fmt;

use fdi_core::Trip;
use fdi_core::diagnosis::event::Event;
use fdi_core::likelihood::Readiness;
use fdi_core::name::Name;
use fdi_core::tune::Standing;

use crate::alarm::AlarmRecord;
use crate::control_loop::{Denial, OrderKind};
use crate::history::{Entry, EntryText};
use crate::interlock::Lockout;
use crate::log_line::tick::TickLine;
use crate::log_line::{LogLine, WIDER};
use crate::self_test::News;
use crate::settings::commissioning::Commissioning;
use crate::settings::schema::Valued;
use crate::status::{Since, readiness};
use crate::tuning::TuningText;

/// Something to tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Notice {
    /// An order was carried out before this tick.
    Order {
        /// The tick.
        tick: u32,
        /// The order.
        order: OrderKind,
    },
    /// An order was not carried out.
    Denied {
        /// The tick before which it was due.
        tick: u32,
        /// Why.
        denial: Denial,
    },
    /// It was armed though no self-test has passed.
    Unchecked,
    /// It was armed with a limit that is wider than its default.
    Wider(Valued),
    /// News of the self-test.
    Check(News),
    /// The experiment of `tune` is at another stage, or has ended.
    Tuning(Standing),
    /// The record of the tick.
    Tick(TickLine),
    /// Another mode.
    Mode {
        /// The tick.
        tick: u32,
        /// Name of the mode before.
        from: &'static str,
        /// Name of the mode now.
        to: &'static str,
    },
    /// The supervisor has tripped.
    Trip(Trip),
    /// The heater is locked out from now on; `None`: no more. Memory that outlives a reset has to have it, too.
    Lockout {
        /// The tick.
        tick: u32,
        /// Why.
        lockout: Option<Lockout>,
    },
    /// A fault was detected, isolated, or has passed.
    Fault(Event),
    /// How far the likelihood diagnosis has come.
    Readiness {
        /// The tick.
        tick: u32,
        /// How far.
        readiness: Readiness,
    },
    /// New models were accepted: the commissioning that they are held against.
    Commissioned(Since),
    /// The commissioning from this tick on.
    Commissioning(Option<Commissioning>),
    /// The likelihood diagnosis has raised an alarm, named it, or ended it.
    Alarm(AlarmRecord),
    /// Ticks that never began.
    Missed {
        /// How many.
        count: u32,
        /// The tick that did begin.
        before: u32,
    },
}

/// How urgent a line of the log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For a program that reads the log.
    Debug,
    /// The course of things.
    Info,
    /// Worth a look.
    Warn,
    /// The heater is off because of it.
    Error,
}

impl Notice {
    /// How urgent it is.
    pub fn level(&self) -> Level {
        match self {
            Self::Tick(_) | Self::Commissioning(_) => Level::Debug,
            Self::Order { .. }
            | Self::Check(News::Stage(_) | News::Ended(_))
            | Self::Tuning(_)
            | Self::Mode { .. }
            | Self::Lockout { lockout: None, .. }
            | Self::Readiness { .. }
            | Self::Commissioned(_) => Level::Info,
            Self::Denied { .. }
            | Self::Unchecked
            | Self::Wider(_)
            | Self::Check(News::Found(_))
            | Self::Fault(_)
            | Self::Alarm(_)
            | Self::Missed { .. } => Level::Warn,
            Self::Trip(_) | Self::Lockout { lockout: Some(_), .. } => Level::Error,
        }
    }

    /// Its text; `sample_time` in s turns ticks into times.
    pub fn text(&self, sample_time: f32) -> NoticeText<'_> {
        NoticeText { notice: self, sample_time }
    }
}

/// A notice, to be shown.
#[derive(Clone, Copy, Debug)]
pub struct NoticeText<'a> {
    notice: &'a Notice,
    sample_time: f32,
}

impl fmt::Display for NoticeText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut write_entry =
            |what, entry| write!(f, "{what}{}", EntryText { entry: &entry, sample_time: self.sample_time });
        match *self.notice {
            Notice::Order { tick, order } => LogLine::Order { tick, order }.fmt(f),
            Notice::Denied { tick, denial } => write!(f, "{} {denial}", LogLine::Denied { tick }),
            Notice::Unchecked => f.write_str("armed without a check"),
            Notice::Wider(limit) => write!(f, "{WIDER}{limit}"),
            Notice::Check(News::Stage(stage)) => write!(f, "check: {}", stage.name()),
            Notice::Check(News::Found(finding)) => write!(f, "check: {finding}"),
            Notice::Check(News::Ended(ending)) => ending.fmt(f),
            Notice::Tuning(standing) => TuningText(&standing).fmt(f),
            Notice::Tick(line) => LogLine::Tick(line).fmt(f),
            Notice::Mode { tick, from, to } => write!(f, "mode {tick} {from} -> {to}"),
            Notice::Trip(trip) => write_entry("", Entry::Trip(trip)),
            Notice::Lockout { tick, lockout: Some(lockout) } => {
                write!(f, "{} {lockout}", LogLine::Lockout { tick })
            }
            Notice::Lockout { tick, lockout: None } => write!(f, "released {tick}"),
            Notice::Fault(Event::Detected(fault)) => {
                write_entry("detected: ", Entry::Fault { fault, ended: false, name: Name::NONE })
            }
            Notice::Fault(Event::Isolated(fault)) => {
                write_entry("isolated: ", Entry::Fault { fault, ended: false, name: Name::NONE })
            }
            Notice::Fault(Event::Ended(fault)) => {
                write_entry("ended: ", Entry::Fault { fault, ended: true, name: Name::NONE })
            }
            Notice::Alarm(alarm) => {
                write_entry("likelihood: ", Entry::Alarm { alarm, count: 1, first: alarm.raised })
            }
            Notice::Readiness { tick, readiness: now } => write!(f, "likelihood {tick} {}", readiness(now)),
            Notice::Commissioning(kept) => LogLine::Commissioned(kept).fmt(f),
            Notice::Commissioned(since) => since.fmt(f),
            Notice::Missed { count, before } => write!(f, "{count} ticks missed before tick {before}"),
        }
    }
}
