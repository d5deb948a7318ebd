//! How well a diagnosis saw a fault, tick by tick, so that a run of many hours needs no memory of its rows.

pub mod expectation;
mod likelihood;

use expectation::Expectation;
use fdi_core::diagnosis::Verdict;
use fdi_core::likelihood::FaultClass;
use serde::Serialize;

pub use likelihood::{LikelihoodScore, LikelihoodWatch};
use pt326_rig::fault::Fault;

/// An alarm so long after a fault's end still belongs to it, s.
pub const TAIL: f64 = 15.0;

/// How one form of the diagnosis saw a fault; null for what never happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// First time, during the fault, that it was rightly detected.
    pub detected_s: Option<f64>,
    /// The same, since the onset.
    pub detection_delay_s: Option<f64>,
    /// First time, during the fault, that it was rightly isolated.
    pub isolated_s: Option<f64>,
    /// The same, since the onset.
    pub isolation_delay_s: Option<f64>,
    /// Time that it was detected, up to 15 s after the end.
    pub indicated_duration_s: Option<f64>,
    /// Share of the fault's time that it was rightly isolated.
    pub isolated_share: Option<f64>,
    /// Pieces into which the indication is broken.
    pub segments: Option<u32>,
}

/// What a diagnosis says on a tick, held against what acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sight {
    /// It says rightly that there is a fault.
    pub detected: bool,
    /// It names the right one.
    pub isolated: bool,
    /// What it names.
    pub named: Option<FaultClass>,
}

/// What the paper's vectors say of `fault`.
pub fn signature_sight(fault: &Fault, verdict: Option<Verdict>) -> Sight {
    let expected = Expectation::of(fault);
    verdict.map_or(Sight::default(), |v| Sight {
        detected: Some(v.fdv) == expected.fdv,
        isolated: Some(v.fiv) == expected.fiv,
        named: signature_class(v.fiv),
    })
}

/// The class that a number of the paper's isolation table stands for.
pub fn signature_class(fiv: u8) -> Option<FaultClass> {
    match fiv {
        1 => Some(FaultClass::T2Offset),
        2 => Some(FaultClass::T1Clogged),
        3 => Some(FaultClass::AirFlow),
        _ => None,
    }
}

/// Watches one diagnosis for the time of one fault and its tail.
#[derive(Clone, Debug)]
pub struct Watch {
    at: f64,
    end: f64,
    detected_at: Option<f64>,
    isolated_at: Option<f64>,
    ticks: u32,
    isolated_ticks: u32,
    indicated_ticks: u32,
    segments: u32,
    rise: Rise,
    first_named: Option<FaultClass>,
    named: Vec<(FaultClass, u32)>,
}

impl Watch {
    /// A watch over `fault`.
    pub fn new(fault: &Fault) -> Self {
        Self {
            at: fault.at,
            end: fault.end(),
            detected_at: None,
            isolated_at: None,
            ticks: 0,
            isolated_ticks: 0,
            indicated_ticks: 0,
            segments: 0,
            rise: Rise::default(),
            first_named: None,
            named: Vec::new(),
        }
    }

    /// Takes in the tick at `t`.
    pub fn see(&mut self, t: f64, sight: Sight) {
        if t < self.at || t >= self.end + TAIL {
            return;
        }
        self.indicated_ticks += u32::from(sight.detected);
        self.segments += u32::from(self.rise.of(sight.detected));
        if t >= self.end {
            return;
        }
        self.ticks += 1;
        self.isolated_ticks += u32::from(sight.isolated);
        if sight.detected {
            self.detected_at.get_or_insert(t);
        }
        if sight.isolated {
            self.isolated_at.get_or_insert(t);
        }
        if let Some(class) = sight.named {
            self.name(class);
        }
    }

    fn name(&mut self, class: FaultClass) {
        if self.first_named.is_none_or(|first| first == FaultClass::Unknown) {
            self.first_named = Some(class);
        }
        match self.named.iter_mut().find(|(known, _)| *known == class) {
            Some((_, ticks)) => *ticks += 1,
            None => self.named.push((class, 1)),
        }
    }

    /// What was named first during the fault; "unknown" only if nothing else ever was.
    pub fn first_named(&self) -> Option<FaultClass> {
        self.first_named
    }

    /// What was named on most ticks of the fault; of equals, what was named earlier.
    pub fn settled(&self) -> Option<FaultClass> {
        let most = self.named.iter().rev().max_by_key(|(_, ticks)| *ticks);
        most.map(|(class, _)| *class)
    }

    /// The score; `isolable`: whether the diagnosis has a name for the fault.
    pub fn score(&self, sample_time: f64, isolable: bool) -> Score {
        let since = |t: f64| microseconds(t - self.at);
        let (detected_s, isolated_s) = (self.detected_at, self.isolated_at);
        let share = f64::from(self.isolated_ticks) / f64::from(self.ticks);
        Score {
            detected_s,
            detection_delay_s: detected_s.map(since),
            isolated_s,
            isolation_delay_s: isolated_s.map(since),
            indicated_duration_s: detected_s
                .map(|_| microseconds(f64::from(self.indicated_ticks) * sample_time)),
            isolated_share: (isolable && self.ticks > 0).then_some(share),
            segments: detected_s.map(|_| self.segments),
        }
    }
}

/// Rounds a time to the microsecond: 0.61 and not 0.6100000000000136.
pub fn microseconds(t: f64) -> f64 {
    (t * 1e6).round() / 1e6
}

/// Sees a flag rise; it was down before the first value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rise {
    before: bool,
}

impl Rise {
    /// Whether it rises now.
    pub fn of(&mut self, now: bool) -> bool {
        !std::mem::replace(&mut self.before, now) && now
    }
}
