//! How well a diagnosis saw a fault, tick by tick, so that a run of many hours needs no memory of its rows.

pub mod expectation;
mod likelihood;
pub mod said;

use expectation::Expectation;
use fdi_core::diagnosis::Verdict;
use fdi_core::likelihood::FaultClass;
use serde::Serialize;

pub use likelihood::{LikelihoodScore, LikelihoodScorer, likelihood_alarm};
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
    /// Why it does not count as missed; null: it does, or was detected.
    pub not_scored: Option<NotScored>,
}

/// Why a fault that was not detected does not count as missed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NotScored {
    /// The run ended before it began.
    AfterTheEnd,
    /// The diagnosis was not monitoring yet when it began.
    BeforeMonitoring,
}

impl NotScored {
    /// In words, for a table.
    pub fn words(self) -> &'static str {
        match self {
            Self::AfterTheEnd => "after the end",
            Self::BeforeMonitoring => "before monitoring",
        }
    }
}

/// What a diagnosis indicates on a tick, held against what acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Indication {
    /// It would indicate a fault if there were one.
    pub monitoring: bool,
    /// It indicates rightly that there is a fault.
    pub detected: bool,
    /// It names the right one.
    pub isolated: bool,
    /// What it names.
    pub named: Option<FaultClass>,
}

/// What the paper's vectors indicate of `fault`.
pub fn signature_indication(fault: &Fault, verdict: Option<Verdict>) -> Indication {
    let expected = Expectation::of(fault);
    verdict.map_or(Indication::default(), |v| Indication {
        monitoring: true,
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

/// Scores one diagnosis for the time of one fault and its tail.
#[derive(Clone, Debug)]
pub struct Scorer {
    at: f64,
    end: f64,
    /// Other faults of the run, with the classes that should be named.
    others: Vec<(FaultClass, Fault)>,
    /// Whether it was monitoring on the first tick of the fault; `None` before that.
    monitoring: Option<bool>,
    detected: SinceOnset,
    isolated: SinceOnset,
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

impl Scorer {
    /// Of `fault`, if nothing else happens.
    pub fn new(fault: &Fault) -> Self {
        Self {
            at: fault.at,
            end: fault.end(),
            others: Vec::new(),
            monitoring: None,
            detected: SinceOnset::default(),
            isolated: SinceOnset::default(),
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

    /// The same beside other faults: an indication that names one of them is theirs.
    pub fn beside<'a>(self, others: impl Iterator<Item = &'a Fault>) -> Self {
        let others = others.filter_map(|other| Some((Expectation::of(other).class?, other.clone())));
        Self { others: others.collect(), ..self }
    }

    /// One tick, at `t`.
    pub fn observe(&mut self, t: f64, indication: Indication) {
        if t < self.at {
            self.detected.stands_before(indication.detected);
            self.isolated.stands_before(indication.isolated);
            return;
        }
        self.monitoring.get_or_insert(indication.monitoring);
        if t >= self.end + TAIL {
            return;
        }
        if self.isolated.rises_to(indication.isolated) {
            self.detected.stood = false;
        } else if self.is_of_another(t, &indication) {
            self.give_back(t);
        }
        let detected = self.detected.rises_to(indication.detected);
        self.indicated_ticks += u32::from(detected);
        self.segments += u32::from(self.rise.of(detected));
        if t >= self.end {
            return;
        }
        self.ticks += 1;
        self.isolated_ticks += u32::from(indication.isolated);
        if detected {
            self.detected_at.get_or_insert(t);
        }
        if indication.isolated && !self.isolated.stood {
            self.isolated_at.get_or_insert(t);
        }
        if let Some(class) = indication.named {
            self.name(class);
        }
    }

    /// It names another fault that acts.
    fn is_of_another(&self, t: f64, indication: &Indication) -> bool {
        let is_theirs =
            |class| self.others.iter().any(|(theirs, fault)| *theirs == class && fault.is_active(t));
        !indication.isolated && indication.named.is_some_and(is_theirs)
    }

    /// What was taken for an indication of this fault was one of another, unless this one has been named.
    fn give_back(&mut self, t: f64) {
        self.detected.stood = true;
        if self.isolated_at.is_none() && t < self.end {
            (self.detected_at, self.indicated_ticks, self.segments) = (None, 0, 0);
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
        let not_scored = match self.monitoring {
            _ if detected_s.is_some() => None,
            None => Some(NotScored::AfterTheEnd),
            Some(false) => Some(NotScored::BeforeMonitoring),
            Some(true) => None,
        };
        Score {
            detected_s,
            detection_delay_s: detected_s.map(since),
            isolated_s,
            isolation_delay_s: isolated_s.map(since),
            indicated_duration_s: detected_s
                .map(|_| microseconds(f64::from(self.indicated_ticks) * sample_time)),
            isolated_share: (isolable && self.ticks > 0).then_some(share),
            segments: detected_s.map(|_| self.segments),
            not_scored,
        }
    }
}

/// A flag that stood already when the fault began: it says nothing of the fault until it has fallen.
#[derive(Clone, Copy, Debug, Default)]
struct SinceOnset {
    stood: bool,
}

impl SinceOnset {
    /// Before the onset.
    fn stands_before(&mut self, now: bool) {
        self.stood = now;
    }

    /// Whether it stands, and has risen since the onset.
    fn rises_to(&mut self, now: bool) -> bool {
        self.stood &= now;
        now && !self.stood
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

#[cfg(test)]
mod tests {
    use super::*;
    use pt326_rig::fault::{Sensor, Verb};

    fn fault(verb: Verb, sensor: Option<Sensor>, at: f64, duration: f64) -> Fault {
        Fault::new(verb, sensor, Some(1.2), at, duration)
    }

    /// More air from 10 s to 20 s beside a T2 that reads wrongly from 5 s to 40 s; a tick a second, until 60 s.
    fn scored(indicates: impl Fn(u32) -> Option<Option<FaultClass>>) -> Score {
        let (flow, offset) =
            (fault(Verb::AirFlow, None, 10.0, 10.0), fault(Verb::Offset, Some(Sensor::T2), 5.0, 35.0));
        let mut scorer = Scorer::new(&flow).beside([&offset].into_iter());
        for t in 0..60 {
            let (alarm, named) = (indicates(t).is_some(), indicates(t).flatten());
            let isolated = named == Some(FaultClass::AirFlow);
            scorer.observe(f64::from(t), Indication { monitoring: true, detected: alarm, isolated, named });
        }
        scorer.score(1.0, true)
    }

    #[test]
    fn an_alarm_that_stood_before_the_fault_is_not_credited_to_it() {
        let stands = scored(|t| (t >= 6).then_some(None));
        assert_eq!((stands.detection_delay_s, stands.not_scored), (None, None), "missed");
        let again = scored(|t| (matches!(t, 6..12 | 14..22)).then_some(None));
        assert_eq!((again.detection_delay_s, again.indicated_duration_s), (Some(4.0), Some(8.0)));
        let named = scored(|t| (t >= 6).then_some((t >= 13).then_some(FaultClass::AirFlow)));
        assert_eq!((named.detection_delay_s, named.isolation_delay_s), (Some(3.0), Some(3.0)));
    }

    #[test]
    fn an_alarm_that_names_another_fault_is_not_credited_to_this_one() {
        let theirs = scored(|t| match t {
            12..14 => Some(None),
            14..40 => Some(Some(FaultClass::T2Offset)),
            _ => None,
        });
        assert_eq!((theirs.detection_delay_s, theirs.indicated_duration_s), (None, None));
        let then_ours = scored(|t| match t {
            12..14 => Some(Some(FaultClass::T2Offset)),
            14..40 => Some(Some(FaultClass::AirFlow)),
            _ => None,
        });
        assert_eq!((then_ours.detection_delay_s, then_ours.isolation_delay_s), (Some(4.0), Some(4.0)));
    }

    #[test]
    fn what_could_not_be_seen_is_not_scored() {
        let late = fault(Verb::AirFlow, None, 30.0, 9.0);
        let mut scorer = Scorer::new(&late);
        let watching = Indication { monitoring: true, ..Indication::default() };
        (0..20).for_each(|t| scorer.observe(f64::from(t), watching));
        assert_eq!(scorer.score(1.0, true).not_scored, Some(NotScored::AfterTheEnd));
        let mut scorer = Scorer::new(&late);
        (0..60).for_each(|t| scorer.observe(f64::from(t), Indication { monitoring: t > 32, ..watching }));
        assert_eq!(scorer.score(1.0, true).not_scored, Some(NotScored::BeforeMonitoring));
        let mut scorer = Scorer::new(&late);
        (0..60).for_each(|t| scorer.observe(f64::from(t), watching));
        assert_eq!(scorer.score(1.0, true).not_scored, None, "missed");
    }
}
