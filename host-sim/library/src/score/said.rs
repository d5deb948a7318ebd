//! What the likelihood diagnosis said of a run, held against the truth: names, confidence, sizes, and how long an alarm lasted.

use std::collections::BTreeMap;

use fdi_core::likelihood::{FaultClass, Finding, LikelihoodReport};
use pt326_rig::fault::Fault;
use serde::{Deserialize, Serialize};

use super::expectation::{is_right, size_as};
use super::{TAIL, microseconds};
use crate::experiment::as_written;

/// Confidences at which the second and further bins begin.
pub const BINS: [f64; 5] = [0.5, 0.8, 0.9, 0.95, 0.99];
/// A verdict above this confidence is as good as certain.
const SURE: f64 = 0.95;
/// Two causes that look alike at first must have been told apart so long after the onset, s.
const TOLD_APART: f64 = 5.0;

/// Verdicts of about one confidence, one a second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// How many.
    pub said: u64,
    /// How many of them were right.
    pub right: u64,
    /// Sum of their confidences.
    pub confidence: f64,
}

/// What was said of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Said {
    /// Onset to the first right name, s; a name for two causes of which one is right counts.
    pub right_delay_s: Option<f64>,
    /// The name on the last tick of the fault.
    pub end_name: Option<String>,
    /// Whether that was right; null: the fault did not end.
    pub end_right: Option<bool>,
    /// The size on that tick, in the unit of the class named.
    pub end_size: Option<f64>,
    /// Half of its 95 % interval.
    pub end_half_width: Option<f64>,
    /// What it truly was on that tick, if the name was right.
    pub end_size_true: Option<f64>,
    /// Share of the time from the detection to the end of the fault on which the alarm stood.
    pub alarm_share: Option<f64>,
    /// How long the alarm outlived the fault, s; 0: it stood until then. Null: it did not stand.
    pub tail_s: Option<f64>,
    /// It stood still when the run ended.
    pub tail_open: bool,
    /// Time during the fault that a wrong name was said above 0.95, s.
    pub sure_wrong_s: f64,
    /// The same, later than 5 s after the onset.
    pub sure_wrong_late_s: f64,
    /// Intervals said under a right name during the fault, one a second.
    pub intervals: u64,
    /// How many of them held the size of that moment.
    pub held: u64,
    /// All verdicts by confidence, but for those within 15 s after the fault.
    pub bins: [Bin; BINS.len() + 1],
    /// The names on the seconds of the fault, or of a run without: on how many, and on how many above 0.95.
    pub names: BTreeMap<String, [u64; 2]>,
}

/// Gathers it.
pub struct SaidScorer<'a> {
    fault: Option<&'a Fault>,
    right: &'a [FaultClass],
    sample_time: f64,
    /// The last whole second that was sampled.
    second: Option<u64>,
    ticks_since_detection: u32,
    alarm_ticks: u32,
    /// The last tick of the fault, s, and what was said on it.
    last: Option<(f64, Option<Finding>)>,
    /// The alarm that stood at the end of the fault, or rose soon after, stands.
    outlives: bool,
    said: Said,
}

impl<'a> SaidScorer<'a> {
    /// Of a run with a fault, or with none, of which each name of `right` may be said.
    pub fn new(fault: Option<&'a Fault>, right: &'a [FaultClass], sample_time: f64) -> Self {
        Self {
            fault,
            right,
            sample_time,
            second: None,
            ticks_since_detection: 0,
            alarm_ticks: 0,
            last: None,
            outlives: false,
            said: Said::default(),
        }
    }

    /// One tick, at `t`.
    pub fn observe(&mut self, t: f64, report: &LikelihoodReport) {
        let finding = report.finding.as_ref();
        let right = finding.is_some_and(|f| is_right(self.right, f.class.name()));
        self.sample(t, finding, right);
        match self.fault {
            Some(fault) if fault.is_active(t) => self.during(t, fault, report, right),
            Some(fault) if t >= fault.end() => self.after(t - fault.end(), report.alarm),
            _ => {}
        }
    }

    /// A verdict a second goes into the bins.
    fn sample(&mut self, t: f64, finding: Option<&Finding>, right: bool) {
        let second = Some(t as u64);
        let fades = self.fault.is_some_and(|f| t >= f.end() && t < f.end() + TAIL);
        if std::mem::replace(&mut self.second, second) == second || fades {
            return;
        }
        let Some(finding) = finding else { return };
        let confidence = as_written(finding.confidence);
        let bin = &mut self.said.bins[BINS.iter().filter(|from| confidence >= **from).count()];
        bin.said += 1;
        bin.right += u64::from(right && self.fault.is_none_or(|f| f.is_active(t)));
        bin.confidence += confidence;
        if self.fault.is_none_or(|f| f.is_active(t)) {
            let [all, sure] = self.said.names.entry(finding.class.name().into()).or_default();
            *all += 1;
            *sure += u64::from(confidence > SURE);
        }
        let size = self.fault.filter(|f| right && f.is_active(t)).and_then(|f| size_as(f, finding.class, t));
        if let Some((estimate, truth)) = finding.magnitude.zip(size) {
            let apart = (f64::from(estimate.value) - truth).abs();
            self.said.intervals += 1;
            self.said.held += u64::from(apart <= f64::from(estimate.half_width));
        }
    }

    fn during(&mut self, t: f64, fault: &Fault, report: &LikelihoodReport, right: bool) {
        let said = &mut self.said;
        let finding = report.finding.as_ref();
        if right {
            said.right_delay_s.get_or_insert(microseconds(t - fault.at));
        } else if finding.is_some_and(|f| f64::from(f.confidence) > SURE) {
            said.sure_wrong_s += self.sample_time;
            let late = t - fault.at > TOLD_APART;
            said.sure_wrong_late_s += if late { self.sample_time } else { 0.0 };
        }
        if report.alarm || self.ticks_since_detection > 0 {
            self.ticks_since_detection += 1;
            self.alarm_ticks += u32::from(report.alarm);
        }
        said.tail_s = report.alarm.then_some(0.0);
        self.outlives = report.alarm;
        self.last = Some((t, report.finding));
    }

    fn after(&mut self, since_end: f64, alarm: bool) {
        self.outlives = alarm && (self.outlives || since_end < TAIL);
        if self.outlives {
            self.said.tail_s = Some(microseconds(since_end + self.sample_time));
        }
        self.said.tail_open = self.outlives;
    }

    /// All of it. `detected`: the alarm rose because of the fault; else nothing was said of it.
    pub fn finish(self, detected: bool) -> Said {
        let share = f64::from(self.alarm_ticks) / f64::from(self.ticks_since_detection);
        let finding = self.last.and_then(|(_, finding)| finding);
        let right = finding.filter(|f| is_right(self.right, f.class.name()));
        let size = finding.and_then(|f| f.magnitude);
        let size_true = right.zip(self.fault.zip(self.last));
        Said {
            end_name: finding.map(|f| f.class.name().into()),
            end_right: self.last.map(|_| right.is_some()),
            end_size: size.map(|m| as_written(m.value)),
            end_half_width: size.map(|m| as_written(m.half_width)),
            end_size_true: size_true.and_then(|(f, (fault, (t, _)))| size_as(fault, f.class, t)),
            right_delay_s: self.said.right_delay_s.filter(|_| detected),
            alarm_share: detected.then_some(share),
            sure_wrong_s: microseconds(self.said.sure_wrong_s),
            sure_wrong_late_s: microseconds(self.said.sure_wrong_late_s),
            ..self.said
        }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::Magnitude;
    use pt326_rig::fault::Verb;

    use super::*;

    fn finding(class: FaultClass, confidence: f32) -> Finding {
        let magnitude = Some(Magnitude { value: -19.0, half_width: 2.0 });
        Finding { class, confidence, magnitude, onset: 0 }
    }

    /// Air flow that falls by 20 % within 20 s, from 100 s to 140 s; a tick each half second until 200 s.
    fn said(says: impl Fn(f64) -> (bool, Option<Finding>)) -> Said {
        let fault = Fault { over: Some(20.0), ..Fault::new(Verb::AirFlow, None, Some(0.8), 100.0, 40.0) };
        let mut scorer = SaidScorer::new(Some(&fault), &[FaultClass::AirFlow], 0.5);
        for tick in 0..400 {
            let t = f64::from(tick) * 0.5;
            let (alarm, finding) = says(t);
            scorer.observe(t, &LikelihoodReport { alarm, finding, ..LikelihoodReport::default() });
        }
        scorer.finish(true)
    }

    #[test]
    fn names_are_held_against_the_truth_of_their_moment() {
        let said = said(|t| match t {
            103.0..112.0 => (true, Some(finding(FaultClass::HeaterPower, 0.97))),
            112.0..150.0 => (true, Some(finding(FaultClass::AirFlow, 0.85))),
            _ => (false, None),
        });
        assert_eq!((said.right_delay_s, said.end_right), (Some(12.0), Some(true)));
        assert_eq!(
            (said.sure_wrong_s, said.sure_wrong_late_s),
            (9.0, 6.5),
            "105 s itself is not later than 5 s"
        );
        assert_eq!(
            (said.end_size, said.end_half_width, said.end_size_true),
            (Some(-19.0), Some(2.0), Some(-20.0))
        );
        assert_eq!(said.end_name.as_deref(), Some("air_flow"));
        let [.., sound, _, certain, _] = said.bins;
        assert_eq!((certain.said, certain.right), (9, 0), "one a second");
        assert_eq!((sound.said, sound.right), (28, 28), "none of the 10 s after the end");
        assert!((sound.confidence - 28.0 * 0.85).abs() < 1e-9);
        let names = [("air_flow".to_owned(), [28, 0]), ("heater_power".to_owned(), [9, 9])];
        assert_eq!(said.names, names.into_iter().collect());
        assert_eq!(
            (said.intervals, said.held),
            (28, 23),
            "-19 and 2 hold what is below -17, which it is from 117 s on"
        );
    }

    #[test]
    fn an_alarm_is_followed_from_its_rise_until_it_falls_after_the_end() {
        let alarm = |stands: fn(f64) -> bool| said(|t| (stands(t), None));
        let whole = alarm(|t| (110.0..140.0).contains(&t));
        assert_eq!((whole.alarm_share, whole.tail_s, whole.tail_open), (Some(1.0), Some(0.0), false));
        let broken = alarm(|t| (110.0..125.0).contains(&t) || (130.0..145.0).contains(&t));
        assert_eq!((broken.alarm_share, broken.tail_s), (Some(50.0 / 60.0), Some(5.0)));
        let twice = alarm(|t| (110.0..142.0).contains(&t) || (150.0..170.0).contains(&t) || t > 180.0);
        assert_eq!(
            (twice.tail_s, twice.tail_open),
            (Some(30.0), false),
            "it rose again within 15 s, then 40 s later"
        );
        let endless = alarm(|t| t > 110.0);
        assert_eq!((endless.tail_s, endless.tail_open), (Some(60.0), true));
        assert_eq!(alarm(|t| (110.0..120.0).contains(&t)).tail_s, None, "it fell before the end");
    }

    #[test]
    fn where_there_is_no_fault_every_verdict_is_wrong() {
        let mut scorer = SaidScorer::new(None, &[], 0.5);
        let finding = Some(finding(FaultClass::AirFlow, 0.4));
        for tick in 0..20 {
            scorer
                .observe(f64::from(tick) * 0.5, &LikelihoodReport { finding, ..LikelihoodReport::default() });
        }
        let said = scorer.finish(false);
        assert_eq!((said.bins[0].said, said.bins[0].right, said.end_right), (10, 0, None));
    }

    #[test]
    fn what_was_not_detected_was_not_named_either() {
        let fault = Fault::new(Verb::AirFlow, None, Some(0.8), 1.0, 1.0);
        let mut scorer = SaidScorer::new(Some(&fault), &[FaultClass::AirFlow], 1.0);
        let finding = Some(finding(FaultClass::AirFlow, 0.9));
        scorer.observe(1.0, &LikelihoodReport { alarm: true, finding, ..LikelihoodReport::default() });
        let said = scorer.finish(false);
        assert_eq!((said.right_delay_s, said.alarm_share), (None, None), "the alarm stood before");
    }
}
