//! From gains in log evidence to probabilities of the classes: each class as likely as any other beforehand, the hypotheses of a class alike.

use super::class::FaultClass;
use super::evidence::Estimate;
use super::hypothesis::{COUNT, HYPOTHESES, ROWS};

/// A log Bayes factor against the best that leaves nothing of a hypothesis: its share of 2e-9 is less than single precision adds to 1.
const NOTHING: f32 = -20.0;

/// The first hypothesis of the class of each, and how many that class has.
const FIRST: [usize; COUNT] = of_class().0;
const OF_CLASS: [f32; COUNT] = of_class().1;

const fn of_class() -> ([usize; COUNT], [f32; COUNT]) {
    let (mut first, mut count) = ([0; COUNT], [0.0; COUNT]);
    let mut h = 0;
    while h < COUNT {
        let (mut g, mut found) = (COUNT, 0);
        while g > 0 {
            g -= 1;
            if ROWS[g].class.number() == ROWS[h].class.number() {
                first[h] = g;
                found += 1;
            }
        }
        count[h] = found as f32;
        h += 1;
    }
    (first, count)
}

/// What all hypotheses come to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posterior {
    /// Probability of the class of each hypothesis, given that there is a fault.
    class: [f32; COUNT],
    /// The gain of the best.
    pub(super) best_gain: f32,
    /// Evidence of all classes together, as a multiple of that of the best hypothesis.
    all: f32,
    /// The best of all, and the best of the likeliest class.
    pub(super) best: usize,
    pub(super) likeliest: usize,
}

impl Posterior {
    #[inline(never)]
    pub(super) fn new(estimate: &[Estimate; COUNT]) -> Self {
        let (mut best, mut most) = (0, f32::MIN);
        for (h, estimate) in estimate.iter().enumerate() {
            if estimate.gain > most {
                (best, most) = (h, estimate.gain);
            }
        }
        let best_gain = most;
        let weights: [f32; COUNT] = core::array::from_fn(|h| {
            let below = estimate[h].gain - best_gain;
            if below > NOTHING { libm::expf(below) } else { 0.0 }
        });
        // Of each class at its first hypothesis: the mean of its hypotheses.
        let (mut class, mut all) = ([0.0; COUNT], 0.0);
        for (h, weight) in weights.iter().enumerate() {
            class[FIRST[h] % COUNT] += weight / OF_CLASS[h];
        }
        for h in 0..COUNT {
            if FIRST[h] == h {
                all += class[h];
            } else {
                class[h] = class[FIRST[h] % COUNT];
            }
        }
        for class in &mut class {
            *class /= all;
        }
        let (mut likeliest, mut top) = (0, (f32::MIN, f32::MIN));
        for (h, (estimate, class)) in estimate.iter().zip(&class).enumerate() {
            let better = *class > top.0 || (*class == top.0 && estimate.gain > top.1);
            if better {
                (likeliest, top) = (h, (*class, estimate.gain));
            }
        }
        Self { class, best_gain, all, best, likeliest }
    }

    /// Logarithm of the evidence of all classes together.
    pub(super) fn evidence(&self) -> f32 {
        self.best_gain + libm::logf(self.all)
    }

    /// Probability that there is a fault at all, where "none" is as likely beforehand as any class.
    pub(super) fn of_fault(&self) -> f32 {
        self.all / (self.all + libm::expf(-self.best_gain))
    }

    /// Probability of the class of a hypothesis, given that there is a fault.
    pub(super) fn of(&self, h: usize) -> f32 {
        self.class[h % COUNT]
    }

    /// Probability of a class.
    pub(super) fn of_class(&self, class: FaultClass) -> f32 {
        let of = |(row, p): (&super::hypothesis::Hypothesis, &f32)| (row.class == class).then_some(*p);
        HYPOTHESES.iter().zip(&self.class).find_map(of).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests;
