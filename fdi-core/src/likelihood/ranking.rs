//! The hypotheses ranked by what they leave unexplained. Residuals are white, so the residual sum of squares (RSS) of a hypothesis is -2 times its
//! log-likelihood, but for a constant: the difference of two is twice a log-likelihood ratio. All margins here are in that unit.

use super::bank::{Bank, Evidence};
use super::class::FaultClass;
use super::hypothesis::{COUNT, DETACHED, FLOW, HYPOTHESES, Hypothesis, PROCESS, Scale, Signature};
use super::verdict::Magnitude;
use crate::bounds::{bounded, larger, smaller};
use crate::root::sqrt;

/// Residual sum of squares that noise, misfit of the models and the linearised signatures may leave of a true hypothesis.
///
/// Noise alone leaves 2 a tick in the mean, of two residuals of variance 1.
struct Limit {
    a_tick: f32,
    /// Share of all that there was to explain.
    share: f32,
    constant: f32,
}

// Tuned on seeds 1 to 99999, lively (docs/diagnosis.md, sections 8 and 12).
/// Below it the best hypothesis explains nearly all.
const FITS: Limit = Limit { a_tick: 4.5, share: 0.03, constant: 20.0 };
/// Above it no hypothesis explains what is seen.
const STRANGE: Limit = Limit { a_tick: 6.0, share: 0.07, constant: 30.0 };
/// Below it a change of power is all there is.
const SAG: Limit = Limit { a_tick: 5.0, share: 0.0, constant: 10.0 };
/// A tolerated change of power may be worse than the best fault by so much: odds of 3,000 to 1.
const SAG_DISADVANTAGE: f32 = 16.0;
/// Both are widened by this factor while the change of power looks smaller than so many tolerated ones: it gets the time to show its size.
const SMALL_SAG: f32 = 2.0;
const SMALL_SAG_PATIENCE: f32 = 2.0;
/// Before so many sums of squares the misfit says nothing: that of the first four ticks.
const FIRST: f32 = 8.0;
/// Nothing is named a drift within so long, s: until then an offset explains as much.
const EARLIEST_DRIFT: f32 = 5.0;
/// A thermistor that lags seems to have lost more of the rise at first, s; until then it is detached from this loss on, as a fraction.
const LAG_KNOWN: f32 = 2.0;
const SURELY_DETACHED: f32 = 0.8;
/// Of the margin between power and air flow this share is enough where the flow would be impossible.
const IMPOSSIBLE_FLOW: f32 = 0.5;
/// Once T2 has answered, the share of that margin that is enough: it grows with the relative change of the power, as the linear signature of the
/// flow gets worse, from this for small ones on.
const LATE_SLOPE: f32 = 1.5;
const LATE_LEAST: f32 = 0.12;
/// Standard deviations in half of a 95 % interval of a normal distribution.
const HALF_OF_95: f32 = 1.96;
/// Variance of the whitened noise in an interval: its standard deviation doubled, as the white noise of the models is not quite white.
const NOISE_VARIANCE: f32 = 4.0;
/// Over how many ticks slow disturbance counts as a drift.
const DRIFT_TICKS: (f32, f32) = (10.0, 60.0);
/// The smallest rise that slow disturbance is a share of, degC, and the smallest 1/f.
const LEAST_RISE: f32 = 1.0;
const LEAST_INVERSE_FLOW: f32 = 0.05;

/// One hypothesis with the magnitude that suits it best.
#[derive(Clone, Copy, Debug)]
struct Fitted {
    /// Residual sum of squares.
    rss: f32,
    /// In the unit of the signature.
    magnitude: f32,
    /// Inverse variance of the magnitude in white noise.
    information: f32,
}

/// All hypotheses, and the best of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranking {
    fitted: [Fitted; COUNT],
    /// Sum of squares of the residuals without any hypothesis.
    energy: f32,
    /// Ticks since the onset.
    age: f32,
    best: &'static Hypothesis,
    best_rss: f32,
    /// The least that one of another kind leaves.
    rival_rss: f32,
    sample_time: f32,
}

impl Limit {
    fn at(&self, age: f32, energy: f32) -> f32 {
        self.a_tick * age + self.share * energy + self.constant
    }
}

impl Ranking {
    /// Ranks by the evidence of the bank; Ts in s.
    #[inline(never)]
    pub(super) fn new(bank: &Bank, sample_time: f32) -> Self {
        let young = bank.age.saturating_add(bank.ago) as f32 * sample_time < EARLIEST_DRIFT;
        let fitted = Fitted { rss: 0.0, magnitude: 0.0, information: 0.0 };
        let mut ranking = Self {
            fitted: [fitted; COUNT],
            energy: bank.energy(),
            age: bank.age as f32,
            best: &HYPOTHESES[0],
            best_rss: f32::MAX,
            rival_rss: f32::MAX,
            sample_time,
        };
        for (fitted, (row, evidence)) in
            ranking.fitted.iter_mut().zip(HYPOTHESES.iter().zip(&bank.evidence()))
        {
            *fitted = Fitted::new(evidence, row, sample_time);
            let too_early = young && row.scale == Scale::Drift;
            if fitted.rss + row.handicap < ranking.best_rss && !too_early {
                (ranking.best, ranking.best_rss) = (row, fitted.rss);
            }
        }
        ranking.rival_rss = ranking.least_rss(|row| row.kind != ranking.best.kind, ranking.best);
        ranking
    }

    /// The least that one of `these` leaves, of those that count beside `hypothesis`.
    fn least_rss(&self, these: impl Fn(&Hypothesis) -> bool, hypothesis: &Hypothesis) -> f32 {
        let mut least = f32::MAX;
        for (row, fitted) in HYPOTHESES.iter().zip(&self.fitted) {
            if row.handicap <= hypothesis.handicap && these(row) {
                least = smaller(least, fitted.rss);
            }
        }
        least
    }

    fn fitted(&self, signature: Signature) -> &Fitted {
        &self.fitted[signature as usize]
    }

    #[cfg(test)]
    pub(super) fn rss_and_magnitude(&self, signature: Signature) -> (f32, f32) {
        let fitted = self.fitted(signature);
        (fitted.rss, fitted.magnitude)
    }

    /// The residual sum of squares of the best hypothesis over that of noise alone; 1 where it is no more.
    fn misfit(&self) -> f32 {
        larger(1.0, (self.best_rss + FIRST) / (2.0 * self.age + FIRST))
    }

    /// Whether the best hypothesis explains nearly all.
    pub(super) fn fits(&self) -> bool {
        self.best_rss < FITS.at(self.age, self.energy)
    }

    /// Whether no hypothesis explains what is seen.
    pub(super) fn is_strange(&self) -> bool {
        self.best_rss > STRANGE.at(self.age, self.energy)
    }

    /// Twice the log-likelihood ratio of the best hypothesis and the next of another kind. Where even the best fits badly it counts less.
    pub(super) fn margin(&self) -> f32 {
        (self.rival_rss - self.best_rss) / self.misfit()
    }

    /// Whether the process, not a sensor, is to blame.
    pub(super) fn is_process(&self) -> bool {
        self.best.kind == PROCESS
    }

    /// The best hypothesis; of power and flow the flow, unless the power is better by `power_margin`, or the flow would
    /// have to be impossible.
    pub(super) fn choice(&self, power_margin: f32) -> Signature {
        if !self.is_process() {
            return self.best.signature;
        }
        let [flow, power, constant] =
            [Signature::AirFlow, Signature::Power, Signature::ConstantPower].map(|h| self.fitted(h));
        if smaller(flow.rss, power.rss) - constant.rss > power_margin * self.misfit() {
            return Signature::ConstantPower;
        }
        let impossible = flow.magnitude <= FLOW.0 || flow.magnitude >= FLOW.1;
        let margin = if impossible { IMPOSSIBLE_FLOW * power_margin } else { power_margin * self.misfit() };
        if flow.rss - power.rss > margin { Signature::Power } else { Signature::AirFlow }
    }

    /// Share of the power margin that is enough once T2 has answered: the larger the change, the rougher the model of
    /// the flow, and the more is asked for.
    pub(super) fn late_share(&self) -> f32 {
        bounded(LATE_SLOPE * self.fitted(Signature::Power).magnitude.abs(), LATE_LEAST, 1.0)
    }

    /// The class of a hypothesis with its magnitude: a T1 that loses most of the rise is not clogged.
    pub(super) fn class(&self, h: Signature) -> FaultClass {
        let class = HYPOTHESES[h as usize].class;
        let known = self.age * self.sample_time >= LAG_KNOWN;
        let limit = if known { DETACHED } else { SURELY_DETACHED };
        if class == FaultClass::T1Clogged && self.fitted(h).magnitude > limit {
            FaultClass::T1Detached
        } else {
            class
        }
    }

    /// Probability of a hypothesis against the strongest of another class, 0..=1.
    pub(super) fn confidence(&self, h: Signature) -> f32 {
        let row = &HYPOTHESES[h as usize];
        let rival = self.least_rss(|other| other.class != row.class, row);
        let log_ratio = 0.5 * (rival - self.fitted(h).rss) / self.misfit();
        1.0 / (1.0 + libm::expf(bounded(-log_ratio, -40.0, 40.0)))
    }

    /// Whether a change of power no larger than `share` explains what is seen about as well as any fault that shows at once.
    pub(super) fn is_sag(&self, bank: &Bank, share: f32) -> bool {
        let rss = self.energy - bank.power().explained(bank.power().best((-share, share)));
        let at_once = |row: &Hypothesis| !matches!(row.class, FaultClass::T0Fault | FaultClass::Drift);
        let least = self.least_rss(at_once, &HYPOTHESES[Signature::Power as usize]);
        let small = self.is_process() && self.fitted(Signature::Power).magnitude.abs() < SMALL_SAG * share;
        let patience = if small { SMALL_SAG_PATIENCE } else { 1.0 };
        rss < patience * SAG.at(self.age, self.energy) && rss - least < patience * SAG_DISADVANTAGE
    }

    /// The magnitude of a hypothesis in the unit of its class. `slow_sd` is the standard deviation, in degC, of disturbance
    /// slower than the noise model's memory, `rise` the rise of T1.
    pub(super) fn magnitude(&self, h: Signature, slow_sd: f32, rise: f32) -> Option<Magnitude> {
        let Fitted { magnitude, information, .. } = *self.fitted(h);
        if !(information > 0.0) {
            return None;
        }
        let variance = NOISE_VARIANCE / information;
        let scaled = |factor: f32, slow: f32| Magnitude {
            value: factor * magnitude,
            half_width: HALF_OF_95 * factor * sqrt(variance + slow * slow),
        };
        let slow_share = slow_sd / larger(LEAST_RISE, rise);
        match HYPOTHESES[h as usize].scale {
            Scale::None => None,
            Scale::Degrees => Some(scaled(1.0, slow_sd)),
            Scale::Gain => Some(scaled(100.0, slow_share)),
            Scale::Loss => {
                let lost = scaled(100.0, slow_share);
                Some(Magnitude { value: -lost.value, ..lost })
            }
            Scale::Drift => {
                let (fewest, most) = DRIFT_TICKS;
                Some(scaled(60.0 / self.sample_time, slow_sd / bounded(self.age, fewest, most)))
            }
            Scale::Flow => {
                let inverse = larger(LEAST_INVERSE_FLOW, 1.0 - magnitude); // 1/f
                let at_it = scaled(100.0 / (inverse * inverse), slow_share);
                Some(Magnitude { value: 100.0 * (1.0 / inverse - 1.0), ..at_it })
            }
        }
    }
}

impl Fitted {
    #[inline(always)]
    fn new(evidence: &Evidence, row: &Hypothesis, sample_time: f32) -> Self {
        let unit = if row.scale == Scale::Drift { sample_time } else { 1.0 };
        let (low, high) = row.bounds;
        let correlator = &evidence.correlator;
        let magnitude = correlator.best((low * unit, high * unit));
        let rss = evidence.fixed - correlator.explained(magnitude);
        Self { rss, magnitude, information: correlator.energy }
    }
}
