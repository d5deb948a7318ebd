//! Which part of a recording is learnt from, where nobody says it: what tells the gain and explains all that comes before a leap of T1 that stays.

use std::cmp::Ordering;
use std::ops::Range;

use anyhow::bail;
use fdi_core::{Config, Observed};

use super::leaps::{Leap, far_off_at_the_end, leaps};
use super::run::Training;
use super::training::{self, Trained};
use super::{Heater, Recording};
use pt326_fit::stretches::stretches;

/// Of a longer recording so many samples are looked at, its first ones.
const LOOKED_AT: usize = 200_000;
/// What is tried besides all of it: what comes before the first leap, and these first shares of that.
const TRIED: [f64; 4] = [1.0, 0.25, 0.34, 0.5];
/// A leap that comes earlier leaves too little before it, a share of all.
const EARLY: f64 = 0.2;
/// A part whose model is off by no more than this share of what another's is off by is better. (Chosen.)
const BETTER: f64 = 0.7;
/// A part is one to learn from where its model explains so much of it, %.
const EXPLAINED: f64 = 60.0;

/// A part, and the model that is learnt from it.
struct Learnt {
    part: Range<usize>,
    trained: Trained,
    /// Leaps that are taken out of it first.
    without: Vec<Leap>,
    /// By how much its model is off in the middle of all that comes before the first leap: see [`training::off`].
    off: f64,
}

impl Training {
    /// Finds the part to learn from: the first that tells the gain, in the order of how much they tell; where none does, the one that explains most.
    ///
    /// # Errors
    /// Nothing can be learnt from any, with the reason of the last.
    pub fn find(recording: &Recording, heater: &Heater, config: &Config) -> anyhow::Result<Self> {
        let all = 0..recording.len().min(LOOKED_AT);
        let learn = |part: Range<usize>, without: &[Leap], end: usize| {
            Learnt::of(recording, heater, (part, without), end, config)
        };
        if let Some(part) = recording.learnt.clone()
            && let Ok(learnt) = learn(part.clone(), &[], part.end)
            && learnt.trained.fit >= EXPLAINED
        {
            return Ok(learnt.taken(recording));
        }
        let mut whole = learn(all.clone(), &[], all.end);
        let sound = whole.as_ref().map_or(all.end, Learnt::sound_end);
        let all = 0..sound.min(all.end);
        if whole.as_ref().is_ok_and(|whole| whole.part.end > all.end) {
            whole = learn(all.clone(), &[], all.end);
        }
        let leaps = whole.as_ref().map_or(Vec::new(), |whole| whole.leaps(recording, heater));
        let first = leaps.first().map_or(all.end, |leap| leap.at);
        let end = if (first as f64) < EARLY * all.end as f64 { all.end } else { first };
        let (mut best, mut refusal) = match whole {
            Ok(whole) if leaps.is_empty() => (Some(whole), None),
            Ok(_) => (learn(all, &leaps, end).ok(), None),
            Err(error) => (None, Some(error)),
        };
        for share in TRIED {
            match learn(0..(share * end as f64) as usize, &[], end) {
                Err(error) => refusal = Some(error),
                Ok(learnt) if best.as_ref().is_none_or(|best| learnt.is_better_than(best)) => {
                    best = Some(learnt)
                }
                Ok(_) => {}
            }
        }
        match (best, refusal) {
            (Some(learnt), _) => Ok(learnt.taken(recording)),
            (None, Some(error)) => {
                Err(error.context(format!("{}: nothing can be learnt from any part", recording.file)))
            }
            (None, None) => bail!("{}: there is nothing in it", recording.file),
        }
    }
}

/// Samples from which leaps were taken out.
pub(super) fn without(leaps: &[Leap], samples: &[Observed], celsius: f64) -> Vec<Observed> {
    let mut samples = samples.to_vec();
    for leap in leaps {
        let behind = samples.iter_mut().skip(leap.at);
        behind.filter_map(|sample| sample.t[1].as_mut()).for_each(|t| *t -= (leap.by / celsius) as f32);
    }
    samples
}

impl Learnt {
    fn of(
        recording: &Recording,
        heater: &Heater,
        (part, leaps): (Range<usize>, &[Leap]),
        end: usize,
        config: &Config,
    ) -> anyhow::Result<Self> {
        let samples = without(leaps, &heater.samples[part.clone()], recording.units.celsius.into());
        let trained = training::train(recording, heater, &samples, config)?;
        let off = training::off(&trained.monitor, &heater.samples[..end]);
        Ok(Self { part, trained, without: leaps.to_vec(), off })
    }

    /// What tells the gain is better, and then what is much less off.
    fn is_better_than(&self, other: &Self) -> bool {
        let rank = |learnt: &Self| {
            let explains = learnt.trained.fit >= EXPLAINED;
            (explains && learnt.trained.tells_gain, explains, !learnt.trained.is_poor())
        };
        // What is far more off the rest tells what the rest denies.
        let is_denied = other.off < BETTER * self.off && rank(other).1;
        match rank(self).cmp(&rank(other)) {
            Ordering::Equal => self.off < BETTER * other.off,
            order => order == Ordering::Greater && !is_denied,
        }
    }

    /// Where what is far off up to the end of it begins, such as a reading that collapses: that is not learnt from.
    fn sound_end(&self) -> usize {
        let off: Vec<f64> = self.trained.left.iter().map(|(_, e)| f64::from(*e)).collect();
        let tail = far_off_at_the_end(&off);
        let first = self.trained.left.len() - tail;
        self.trained.left.get(first).filter(|_| tail > 0).map_or(self.part.end, |(k, _)| self.part.start + k)
    }

    /// The leaps of T1 in what was learnt from.
    fn leaps(&self, recording: &Recording, heater: &Heater) -> Vec<Leap> {
        let celsius = recording.units.celsius;
        let mut left = vec![None; self.part.len()];
        self.trained.left.iter().for_each(|(k, e)| left[*k] = Some(f64::from(*e)));
        let row = |k: usize| {
            let t = heater.samples[self.part.start + k].t[1]?;
            Some((self.part.start + k, f64::from(t * celsius), left[k]?))
        };
        let parts = stretches(left.iter().map(Option::is_some)).into_iter();
        parts.flat_map(|part| leaps(&part.filter_map(row).collect::<Vec<_>>())).collect()
    }

    fn taken(self, recording: &Recording) -> Training {
        let seconds = |k: usize| k as f64 * recording.sample_time;
        let (from, to) = (seconds(self.part.start), seconds(self.part.end));
        let mut why = format!(
            "{from:.0} to {to:.0} s: the model learnt there explains {:.1} % of T1",
            self.trained.fit
        );
        if let Some(leap) = self.without.first() {
            why +=
                &format!("; T1 leaps by {:.1} °C at {:.0} s, which is taken out", leap.by, seconds(leap.at));
        }
        if !self.trained.tells_gain {
            why += "; no part tells the gain, say with --train which is normal";
        }
        Training::Found(self.part, why, self.without)
    }
}
