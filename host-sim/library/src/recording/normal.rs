//! Which part of a recording is normal, where nobody says it.

use std::ops::Range;

use anyhow::bail;
use fdi_core::{Config, Observed};

use super::intervals::Known;
use super::run::Training;
use super::training::{self, Trained};
use super::{Heater, Recording};

/// A part is taken for normal where the model explains so much of it, %, and raises no alarm when it goes over it again.
const EXPLAINED: f64 = 60.0;
/// What is tried after what a board has learnt from: shares of the recording.
const TRIED: [Range<f64>; 6] = [0.0..0.25, 0.0..0.34, 0.0..0.5, 0.33..0.67, 0.5..1.0, 0.0..1.0];
/// A part that begins with a rig on its way up may not tell the gain. Then more of the recording is learnt from, up to this share of it.
const LONGEST: f64 = 0.5;
/// A part that lasts as many time constants has more in it than a way up.
const LONG: f64 = 20.0;
/// The gain is not known where the upper end of its 95 % interval is so many times the lower one.
const WIDEST: f64 = 1.5;
/// A longer part holds the same rig if its model leaves no more of the shorter part than so many times what the shorter part's own model leaves. (Chosen: with
/// 5 % less power behind the shorter part it was 2.8 times or more on 24 made logs of a hotend.)
const AS_WELL: f64 = 1.05;

/// A part, and the model that is learnt from it.
struct Learnt {
    part: Range<usize>,
    trained: Trained,
    /// The share of its samples that are in alarm when it goes over them again.
    alarms: f64,
    /// What is said of it.
    why: String,
}

impl Training {
    /// Finds a part that seems to be normal; where none does, the one over which its own model raises the fewest alarms, and explains most.
    ///
    /// # Errors
    /// Nothing can be learnt from any, with the reason of the last.
    pub fn find(recording: &Recording, heater: &Heater, config: &Config) -> anyhow::Result<Self> {
        let (mut refusal, mut best) = (None, None::<(f64, Learnt)>);
        for part in recording.learnt.iter().cloned().chain(parts(recording)) {
            match Learnt::of(recording, heater, part, config) {
                Err(error) => refusal = Some(error),
                Ok(learnt) if learnt.seems_normal() => {
                    let learnt = learnt.grown(recording, heater, config);
                    return Ok(Self::Found(learnt.part, learnt.why));
                }
                Ok(learnt) => {
                    let score = learnt.trained.fit - 100.0 * learnt.alarms;
                    if best.as_ref().is_none_or(|(least, _)| score > *least) {
                        best = Some((score, learnt));
                    }
                }
            }
        }
        match (best, refusal) {
            (Some((_, learnt)), _) => Ok(Self::Found(learnt.part, learnt.why)),
            (None, Some(error)) => {
                Err(error.context(format!("{}: nothing can be learnt from any part", recording.file)))
            }
            (None, None) => bail!("{}: there is nothing in it", recording.file),
        }
    }
}

/// The parts of a recording that are tried.
fn parts(recording: &Recording) -> [Range<usize>; TRIED.len()] {
    let at = |share: f64| (share * recording.len() as f64) as usize;
    TRIED.map(|share| at(share.start)..at(share.end))
}

impl Learnt {
    fn of(
        recording: &Recording,
        heater: &Heater,
        part: Range<usize>,
        config: &Config,
    ) -> anyhow::Result<Self> {
        let samples = &heater.samples[part.clone()];
        let trained = training::train(recording, heater, samples, config)?;
        let alarms = alarms(&trained, samples);
        let place = place(recording, &part);
        let explains = format!("{place}: the model learnt there explains {:.1} % of T1", trained.fit);
        let why = if trained.fit >= EXPLAINED && alarms == 0.0 {
            format!("{explains} and raises no alarm on going over it again")
        } else {
            let alarmed = 100.0 * alarms;
            format!(
                "{explains}, and is in alarm for {alarmed:.1} % of it; no part is better, say with --train which is normal"
            )
        };
        Ok(Self { part, trained, alarms, why })
    }

    fn seems_normal(&self) -> bool {
        self.trained.fit >= EXPLAINED && self.alarms == 0.0
    }

    /// The same rig by more of the recording, where this part does not tell its gain.
    fn grown(mut self, recording: &Recording, heater: &Heater, config: &Config) -> Self {
        let most = (LONGEST * recording.len() as f64) as usize;
        for part in parts(recording) {
            let is_longer = part.start == self.part.start && self.part.end < part.end && part.end <= most;
            if !is_longer || self.is_long(recording) {
                continue;
            }
            let Ok(mut longer) = Self::of(recording, heater, part, config) else { continue };
            if longer.tells_what(&self) {
                let ratio = f64::from(self.trained.model.gain / longer.trained.model.gain);
                longer.why += &format!(
                    "; {} is too little to tell the gain, which would be {:.0} % {} by it",
                    place(recording, &self.part),
                    100.0 * (ratio - 1.0).abs(),
                    if ratio < 1.0 { "less" } else { "more" },
                );
                self = longer;
            }
        }
        self
    }

    /// Whether it has seen the rig for much longer than it takes to answer.
    fn is_long(&self, recording: &Recording) -> bool {
        let model = &self.trained.model;
        let constant = f64::from(model.heater + model.lag + model.dead_time);
        self.part.len() as f64 * recording.sample_time > LONG * constant
    }

    /// Whether it tells the gain, which a shorter part that it begins with does not: that one does not know it, or thinks that it knows another and is
    /// contradicted. Where it does not explain the shorter part as well, something has changed behind that, and nothing is told.
    fn tells_what(&self, shorter: &Self) -> bool {
        let gain = f64::from(self.trained.model.gain);
        let Some((own, theirs)) = self.gain().map(|own| (own, shorter.gain())) else { return false };
        let is_known = |(low, high): (f64, f64)| high < WIDEST * low;
        if !self.seems_normal() || !is_known(own) {
            return false;
        }
        match theirs.filter(|theirs| is_known(*theirs)) {
            None => true,
            Some((low, high)) => {
                let rows = shorter.trained.left.len();
                let there = size(self.trained.left.get(..rows).unwrap_or_default());
                !(low..=high).contains(&gain) && there <= AS_WELL * size(&shorter.trained.left)
            }
        }
    }

    /// The 95 % interval of the gain; none where it is not known.
    fn gain(&self) -> Option<(f64, f64)> {
        self.trained.intervals.iter().find_map(|(name, known)| match known {
            Known::Within(low, high) if *name == "gain" => Some((*low, *high)),
            _ => None,
        })
    }
}

fn place(recording: &Recording, part: &Range<usize>) -> String {
    let seconds = |k: usize| k as f64 * recording.sample_time;
    format!("{:.0} to {:.0} s", seconds(part.start), seconds(part.end))
}

/// Root of the mean square.
fn size(left: &[f32]) -> f64 {
    (left.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>() / left.len() as f64).sqrt()
}

/// The share of some samples in which what was learnt from them is in alarm.
fn alarms(trained: &Trained, samples: &[Observed]) -> f64 {
    let mut monitor = trained.monitor.clone();
    let alarmed = samples.iter().filter(|sample| monitor.step(sample).1.likelihood.alarm);
    alarmed.count() as f64 / samples.len() as f64
}
