//! From gains to words: which class is said, how surely, and how large it is.

use super::{Judged, SinceOnset, SinceOnsetState};
use crate::bounds::{larger, smaller};
use crate::likelihood::alarm::Alarm;
use crate::likelihood::class::{FaultClass, Quantity};
use crate::likelihood::evidence::Estimate;
use crate::likelihood::hypothesis::{COUNT, HYPOTHESES, in_unit};
use crate::likelihood::inputs::Inputs;
use crate::likelihood::posterior::Posterior;
use crate::likelihood::tuning::NamingTuning;
use crate::likelihood::verdict::{Finding, Magnitude};
use crate::root::sqrt;

/// Half of the width of a 95 % interval, in standard deviations.
pub(super) const HALF_OF_95: f32 = 1.96;
/// More than any probability.
const ALWAYS_BOTH: f32 = 2.0;

impl NamingTuning {
    /// What leaves more of each whitened residual's square, and of what there was, fits nothing.
    #[inline(always)]
    pub(super) fn strange(&self) -> [f32; 2] {
        [self.strange, self.strange_share]
    }

    /// From which probability on air flow, or heater power, is named by itself, where `was` is the name of before. Without a fan it always is.
    pub(in crate::likelihood::watch) fn apart(&self, inputs: Inputs, was: Option<FaultClass>) -> f32 {
        match was {
            _ if !inputs.fan => 0.0,
            Some(FaultClass::AirFlow | FaultClass::HeaterPower) => self.lasts,
            _ => self.process,
        }
    }

    /// From which probability on a class is named, where what has no name takes `first` and `was` is the name of before.
    fn least(&self, first: f32, was: Option<FaultClass>, class: FaultClass) -> f32 {
        if was == Some(class) { self.lasts } else { first }
    }
}

impl SinceOnset {
    /// Names the fault by a ranking of the hypotheses.
    #[inline(never)]
    pub(super) fn name(&self, s: &SinceOnsetState, alarm: &mut Alarm, judged: &mut Judged) {
        let Judged { estimate, taught, left } = judged;
        let (t, young) = (&self.tuning.naming, alarm.age < self.tuning.alarm.young);
        if young {
            for (estimate, row) in estimate.iter_mut().zip(&HYPOTHESES) {
                if row.class == FaultClass::Drift {
                    estimate.gain = smaller(estimate.gain, 0.0);
                }
            }
        }
        let posterior = Posterior::new(estimate);
        let h = posterior.likeliest % COUNT;
        let Estimate { gain, value, second, .. } = estimate[h];
        if h != alarm.hypothesis {
            alarm.ended = 0.0;
        }
        (alarm.gain, alarm.hypothesis, alarm.values) = (posterior.best_gain, h, [value, second]);
        alarm.evidence = gain - HYPOTHESES[h].prior;
        let was = alarm.finding.map(|finding| finding.class);
        let least = if young && self.inputs.fan { ALWAYS_BOTH } else { t.apart(self.inputs, was) };
        let (class, confidence) = named(t, &posterior, least);
        let unexplained = *left - 2.0 * self.tuning.alarm.kappa * gain;
        let fits = fits(s, unexplained, if alarm.strange { [t.fits, 0.0] } else { t.strange() });
        alarm.misfit += self.tuning.alarm.mean_share * (if fits { 0.0 } else { 1.0 } - alarm.misfit);
        // A named fault that has just ended fits nothing either.
        let named_before = alarm.finding.is_some_and(|was| was.class != FaultClass::Unknown);
        let least = if named_before { t.lasting_misfit } else { 0.0 };
        alarm.strange = !young && !fits && alarm.misfit > least;
        let magnitude = magnitude(t, h, class, &estimate[h]);
        let finding = Finding { class, confidence, magnitude, onset: alarm.onset };
        if alarm.strange {
            let class = FaultClass::Unknown;
            alarm.finding = Some(Finding { class, confidence: 0.0, magnitude: None, ..finding });
        } else if confidence > t.least(self.naming, was, class) {
            alarm.finding = Some(finding);
        } else if was != Some(FaultClass::Unknown) {
            alarm.finding = None;
        }
        self.recall(s, alarm, taught, posterior.evidence(), *left);
    }
}

/// Whether what is left of the residual sum of squares is as little as this: of each whitened residual's square, or as a share of all there was.
pub(super) fn fits(s: &SinceOnsetState, unexplained: f32, [most, most_share]: [f32; 2]) -> bool {
    unexplained < most * larger(1.0, s.since.count) || unexplained < most_share * larger(1.0, s.since.energy)
}

/// The class that is likeliest, and how likely. Air flow and heater power are one until one of them is likely enough by itself.
pub(in crate::likelihood::watch) fn named(
    t: &NamingTuning,
    posterior: &Posterior,
    least: f32,
) -> (FaultClass, f32) {
    let class = HYPOTHESES[posterior.likeliest % COUNT].class;
    let probability = posterior.of(posterior.likeliest);
    let [flow, power] = [FaultClass::AirFlow, FaultClass::HeaterPower].map(|class| posterior.of_class(class));
    let process = matches!(class, FaultClass::AirFlow | FaultClass::HeaterPower);
    if process && larger(flow, power) < least {
        return (FaultClass::AirFlowOrHeaterPower, smaller(t.certain, flow + power));
    }
    (class, smaller(t.certain, probability))
}

/// The size of a hypothesis in the unit of its class.
pub(in crate::likelihood::watch) fn magnitude(
    t: &NamingTuning,
    h: usize,
    class: FaultClass,
    estimate: &Estimate,
) -> Option<Magnitude> {
    let Estimate { value, variance, .. } = *estimate;
    let half_width = |share: f32| HALF_OF_95 * sqrt(variance + share * share * value * value);
    let half_width = match class.quantity() {
        _ if !HYPOTHESES[h % COUNT].sized => return None,
        Quantity::Nothing => return None,
        Quantity::Offset | Quantity::Ramp => half_width(t.size_error),
        Quantity::Rise | Quantity::Power => 100.0 * half_width(t.size_error),
        Quantity::Flow => {
            let inverse = larger(0.1, 1.0 + value);
            100.0 * half_width(t.flow_error) / (inverse * inverse)
        }
    };
    Some(Magnitude { value: in_unit(class, value), half_width })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::likelihood::class::Channel;

    /// Both names share a probability that never exceeds one.
    #[test]
    fn a_pair_is_as_likely_as_both() {
        let mut estimate = [Estimate { gain: -10.0, ..Estimate::default() }; COUNT];
        let place = |class: FaultClass| HYPOTHESES.iter().position(|row| row.class == class).unwrap();
        estimate[place(FaultClass::AirFlow)].gain = 12.0;
        estimate[place(FaultClass::HeaterPower)].gain = 11.0;
        let (t, posterior) = (NamingTuning::DEFAULT, Posterior::new(&estimate));
        let (class, confidence) = named(&t, &posterior, t.process);
        assert_eq!(class, FaultClass::AirFlowOrHeaterPower);
        assert_eq!(confidence, t.certain);
        let (class, confidence) = named(&t, &posterior, 0.6);
        assert!(class == FaultClass::AirFlow && confidence < 0.8, "{class:?} {confidence}");
    }

    /// A T0 that was named with 0.99 has 0.7 when the beginning of the fault is forgotten: it keeps its name, which nothing else would get.
    #[test]
    fn a_name_lasts_while_it_is_likelier_than_all_others() {
        let (t, t0) = (NamingTuning::DEFAULT, FaultClass::T0Fault);
        let named = |was, confidence: f32| confidence > t.least(0.95, was, t0);
        assert!(named(Some(t0), 0.7) && !named(Some(t0), 0.49));
        assert!(!named(Some(FaultClass::HeaterPower), 0.7) && !named(None, 0.7));
        assert!(named(None, 0.96));
    }

    /// Sizes in the units of their classes: `1/f - 1` is told as the air flow that it is, shares in %.
    #[test]
    fn sizes_are_told_in_their_units() {
        let estimate = |value: f32| Estimate { value, variance: 1e-4, ..Estimate::default() };
        let told = |class, value| {
            magnitude(&NamingTuning::DEFAULT, 0, class, &estimate(value)).map(|size| size.value)
        };
        assert!((told(FaultClass::AirFlow, 0.25).unwrap() + 20.0).abs() < 1e-3);
        assert!((told(FaultClass::AirFlow, -0.2).unwrap() - 25.0).abs() < 1e-3);
        assert!((told(FaultClass::HeaterPower, -0.3).unwrap() + 30.0).abs() < 1e-3);
        assert_eq!(told(FaultClass::T2Offset, 1.5), Some(1.5));
        assert_eq!(
            (told(FaultClass::AirFlowOrHeaterPower, 0.3), told(FaultClass::Stuck(Channel::T1), -1.0)),
            (None, None)
        );
        let constant = HYPOTHESES.iter().position(|row| !row.sized).unwrap();
        assert_eq!(
            magnitude(&NamingTuning::DEFAULT, constant, FaultClass::HeaterPower, &estimate(60.0)),
            None,
            "no share of what is asked for"
        );
        let wide = magnitude(
            &NamingTuning::DEFAULT,
            0,
            FaultClass::T2Offset,
            &Estimate { value: 0.0, variance: 0.25, ..Estimate::default() },
        )
        .unwrap();
        assert!((wide.half_width - 0.98).abs() < 1e-3, "1.96 standard deviations");
    }
}
