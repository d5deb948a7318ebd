//! How well the likelihood diagnosis saw a fault: when, as what, how large, since when.

use crate::score::expectation::{Expectation, is_right};
use fdi_core::likelihood::{FaultClass, Finding, LikelihoodReport, Readiness};
use serde::Serialize;

use super::{Indication, Score, Scorer, microseconds};
use crate::experiment::{as_written, tick_time};
use pt326_rig::fault::Fault;

/// A score with the estimates; null for what never happened or has no meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LikelihoodScore {
    /// When it was detected (an alarm) and isolated (the right class), and for how long.
    #[serde(flatten)]
    pub score: Score,
    /// Class that was named on most ticks of the fault.
    pub verdict: Option<&'static str>,
    /// Class that was named first.
    pub first_verdict: Option<&'static str>,
    /// Whether that was the right one, or a pair that holds it.
    pub first_verdict_right: Option<bool>,
    /// Last estimate during the fault of how large it is, under `verdict`.
    pub magnitude: Option<f64>,
    /// Half of its 95 % interval.
    pub magnitude_half_width: Option<f64>,
    /// Unit of these.
    pub magnitude_unit: Option<&'static str>,
    /// What it truly is.
    pub magnitude_true: Option<f64>,
    /// Unit of that, which is the right class's.
    pub magnitude_true_unit: Option<&'static str>,
    /// Onset as it was dated minus the true one, s.
    pub onset_error_s: Option<f64>,
    /// Probability that `verdict` had last.
    pub confidence: Option<f64>,
}

/// Whether the likelihood diagnosis raises an alarm; `None` while it is not monitoring. Thermistors that contradict each
/// other raise one before that.
pub fn likelihood_alarm(report: &LikelihoodReport) -> Option<bool> {
    (report.alarm || report.readiness == Readiness::Armed).then_some(report.alarm)
}

/// Scores the likelihood diagnosis for the time of one fault.
#[derive(Clone, Debug)]
pub struct LikelihoodScorer {
    scorer: Scorer,
    expected: Expectation,
    /// Classes of which each is the right name.
    right: Vec<FaultClass>,
    at: f64,
    end: f64,
    sample_time: f64,
    /// The last finding of each class during the fault.
    findings: Vec<Finding>,
}

impl LikelihoodScorer {
    /// Of `fault`, if nothing else happens.
    pub fn new(fault: &Fault, sample_time: f64) -> Self {
        Self {
            scorer: Scorer::new(fault),
            expected: Expectation::of(fault),
            right: Expectation::of(fault).class.into_iter().collect(),
            at: fault.at,
            end: fault.end(),
            sample_time,
            findings: Vec::new(),
        }
    }

    /// The same where each of these names is right.
    pub fn right(self, right: &[FaultClass]) -> Self {
        Self { right: right.to_vec(), ..self }
    }

    /// The same beside other faults.
    pub fn beside<'a>(self, others: impl Iterator<Item = &'a Fault>) -> Self {
        Self { scorer: self.scorer.beside(others), ..self }
    }

    /// One tick, at `t`.
    pub fn observe(&mut self, t: f64, report: &LikelihoodReport) {
        let named = report.finding.map(|finding| finding.class);
        let detected = report.alarm && self.expected.class.is_some();
        let isolated = named.is_some_and(|class| self.right.contains(&class));
        let monitoring = likelihood_alarm(report).is_some();
        self.scorer.observe(t, Indication { monitoring, detected, isolated, named });
        if let Some(finding) = report.finding.filter(|_| t >= self.at && t < self.end) {
            match self.findings.iter_mut().find(|known| known.class == finding.class) {
                Some(known) => *known = finding,
                None => self.findings.push(finding),
            }
        }
    }

    /// The score.
    pub fn score(&self) -> LikelihoodScore {
        let known = self.expected.class.is_some();
        let first = self.scorer.first_named();
        let settled = self.scorer.settled();
        let finding = self.findings.iter().find(|f| Some(f.class) == settled);
        let magnitude = finding.and_then(|f| f.magnitude);
        LikelihoodScore {
            score: self.scorer.score(self.sample_time, known),
            verdict: settled.map(FaultClass::name),
            first_verdict: first.map(FaultClass::name),
            first_verdict_right: first.filter(|_| known).map(|class| is_right(&self.right, class.name())),
            magnitude: magnitude.map(|m| as_written(m.value)),
            magnitude_half_width: magnitude.map(|m| as_written(m.half_width)),
            magnitude_unit: magnitude.and(settled).map(FaultClass::unit),
            magnitude_true: self.expected.magnitude,
            magnitude_true_unit: self.expected.magnitude.and(self.expected.class).map(FaultClass::unit),
            onset_error_s: finding.map(|f| microseconds(tick_time(f.onset, self.sample_time) - self.at)),
            confidence: finding.map(|f| as_written(f.confidence)),
        }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::Magnitude;

    use super::*;
    use pt326_rig::fault::{Sensor, Verb};

    fn finding(class: FaultClass, value: f32) -> Finding {
        Finding { class, confidence: 0.5, magnitude: Some(Magnitude { value, half_width: 0.5 }), onset: 11 }
    }

    /// T2 offset of 1.5 degC from 1 s to 3 s; ticks each 0.1 s.
    fn scored(says: impl Fn(u32) -> (bool, Option<Finding>)) -> LikelihoodScore {
        let fault = Fault::new(Verb::Offset, Some(Sensor::T2), Some(1.5), 1.0, 2.0);
        let mut scorer = LikelihoodScorer::new(&fault, 0.1);
        for tick in 0..250 {
            let (alarm, finding) = says(tick);
            scorer.observe(
                tick_time(tick, 0.1),
                &LikelihoodReport { alarm, finding, ..LikelihoodReport::default() },
            );
        }
        scorer.score()
    }

    #[test]
    fn detection_isolation_and_estimates_are_those_of_the_fault() {
        let score = scored(|tick| {
            let named = match tick {
                14..16 => Some(finding(FaultClass::Unknown, 0.0)),
                16..18 => Some(finding(FaultClass::AirFlow, 9.0)),
                18..29 => Some(finding(FaultClass::T2Offset, 9.0)),
                29 => Some(finding(FaultClass::T2Offset, 1.25)),
                30..40 => Some(finding(FaultClass::T2Offset, 9.0)),
                _ => None,
            };
            ((12..34).contains(&tick), named)
        });
        assert_eq!(score.score.detection_delay_s, Some(0.2));
        assert_eq!(score.score.isolation_delay_s, Some(0.8));
        assert_eq!(score.score.indicated_duration_s, Some(2.2));
        assert_eq!((score.score.isolated_share, score.score.segments), (Some(0.6), Some(1)));
        assert_eq!((score.first_verdict, score.first_verdict_right), (Some("air_flow"), Some(false)));
        assert_eq!(
            (score.verdict, score.magnitude, score.magnitude_true),
            (Some("t2_offset"), Some(1.25), Some(1.5))
        );
        assert_eq!((score.onset_error_s, score.magnitude_unit), (Some(0.1), Some("degC")));
    }

    #[test]
    fn the_truth_has_its_own_unit() {
        let score =
            scored(|tick| (tick >= 12, Some(finding(FaultClass::AirFlow, 9.0)).filter(|_| tick >= 12)));
        assert_eq!(
            (score.verdict, score.magnitude_unit),
            (Some("air_flow"), Some(FaultClass::AirFlow.unit()))
        );
        assert_eq!((score.magnitude_true, score.magnitude_true_unit), (Some(1.5), Some("degC")));
    }

    #[test]
    fn an_alarm_outside_the_fault_is_no_detection() {
        let score = scored(|tick| {
            (!(10..30).contains(&tick), Some(finding(FaultClass::T2Offset, 1.0)).filter(|_| tick >= 30))
        });
        assert_eq!((score.score.detected_s, score.score.indicated_duration_s), (None, None));
        assert_eq!((score.verdict, score.magnitude, score.first_verdict_right), (None, None, None));
        assert_eq!(score.score.isolated_share, Some(0.0));
    }
}
