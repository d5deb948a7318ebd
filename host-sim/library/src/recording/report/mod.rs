//! What was found in a recording: as text for a terminal, and as a page that needs nothing else.

mod chart;
mod data;
mod findings;
mod learnt;
mod page;

use std::fmt::Write as _;
use std::ops::Range;

use fdi_core::Observed;
use fdi_core::likelihood::{Channel, FaultClass};

use super::run::{Diagnosed, Training};
use super::score::Score;
use super::{Heater, Recording};
use crate::experiment::Row;

pub use findings::{Ending, Episode, Said, Unjudged, plain};
pub use learnt::{Learnt, learnt, table};

/// A heater of a recording with all that is told of it.
#[derive(Clone, Debug)]
pub struct Told<'a> {
    /// The recording.
    pub recording: &'a Recording,
    /// The heater.
    pub heater: &'a Heater,
    /// What was learnt from.
    pub training: &'a Training,
    /// What was made of it.
    pub done: &'a Diagnosed,
    /// How its faults were seen, where they are known.
    pub score: Option<&'a Score>,
    /// Each alarm.
    pub episodes: Vec<Episode>,
    /// Where nothing could be said.
    pub unjudged: Vec<Unjudged>,
    /// The recording's other heaters are diagnosed as well, each in a folder of its own beside this one.
    pub has_others: bool,
    /// What the model says of T1 at each row, in the recording's unit; none where it says nothing.
    expected: Vec<Option<f64>>,
    /// T1 was within so much of it for [`WITHIN`] of the training, in the recording's unit.
    band: f64,
}

/// Share of the training that lies within the band.
const WITHIN: f64 = 0.95;
/// Samples that a model which begins with the first of them takes to know where it is.
const SETTLED: usize = 60;

impl<'a> Told<'a> {
    /// Gathers it. `heater` is one of the recording's own.
    pub fn new(
        recording: &'a Recording,
        heater: &'a Heater,
        training: &'a Training,
        done: &'a Diagnosed,
        score: Option<&'a Score>,
    ) -> Self {
        let own = learnt_from(training);
        let normal = match (own, training) {
            (Some((part, _)), _) => &heater.samples[part.clone()],
            (None, Training::Other(other)) => {
                let which = recording.heaters.iter().position(|of| std::ptr::eq(of, heater));
                which.and_then(|which| other.heaters.get(which)).map_or(&[][..], |theirs| &theirs.samples)
            }
            (None, _) => &[],
        };
        let every = f64::from(done.trained.every);
        let ticks: Vec<u32> = (0..normal.len() as u32).collect();
        let learnt = aligned(&ticks, &simulated(done, normal), every);
        let off = learnt.iter().zip(normal).skip(SETTLED);
        let off = off.filter_map(|(expected, sample)| Some((f64::from(sample.t[1]?) - (*expected)?).abs()));
        let mut off: Vec<f64> = off.filter(|off| off.is_finite()).collect();
        off.sort_by(f64::total_cmp);
        let band = off.get((WITHIN * off.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        // Of what was learnt from, too, the page shows what the model made of it.
        let in_training = |k: usize| learnt.get(k.checked_sub(own?.0.start)?).copied().flatten();
        let expected = |row: &Row| {
            let now = row.report.likelihood.expected[1].map(f64::from);
            now.or_else(|| in_training(row.tick.index as usize))
        };
        let (ticks, said): (Vec<u32>, Vec<Option<f64>>) =
            done.record.rows.iter().map(|row| (row.tick.index, expected(row))).unzip();
        Self {
            recording,
            heater,
            training,
            done,
            score,
            episodes: findings::episodes(recording, heater, done),
            unjudged: findings::unjudged(recording, done),
            has_others: false,
            expected: aligned(&ticks, &said, every),
            band,
        }
    }

    /// What a temperature is in.
    pub fn unit(&self) -> &'static str {
        self.recording.unit(self.heater)
    }

    /// Each alarm and what was not judged, a line each.
    pub fn text(&self) -> String {
        let record = &self.done.record;
        let from = self.done.watched_from as f64 * self.recording.sample_time;
        let (watched, judged) = ((record.end() - from).max(0.0), self.done.judged());
        if self.episodes.is_empty() && self.done.nothing_judged().is_some() {
            return format!("{watched:.0} s watched, none of it judged\n{}", self.not_judged());
        }
        let judged =
            if judged < 0.995 * watched { format!(", {judged:.0} s of it judged") } else { String::new() };
        let mut text = format!("{watched:.0} s watched{judged}, {}", alarms(self.episodes.len()));
        text += if self.episodes.is_empty() { "\n" } else { ":\n" };
        for episode in &self.episodes {
            let Some(said) = episode.headline() else { continue };
            let _ = writeln!(text, "{}  {}{}", self.at(episode.from), said.sentence, named(episode, &said));
            let _ = match episode.ending {
                Ending::Over => writeln!(text, "{}  all is as expected again", self.at(episode.to)),
                Ending::Gap => {
                    writeln!(text, "{}  a gap: whether it is over is not known", self.at(episode.to))
                }
                Ending::Stands => writeln!(text, "{:>11}  and so to the end", ""),
            };
        }
        text + &self.not_judged()
    }

    /// A time at the begin of a line, with its date where the file has dates.
    fn at(&self, time: f64) -> String {
        let date = self.recording.date(time).map_or(String::new(), |date| format!("  {date}"));
        format!("{time:>9.2} s{date}")
    }

    /// What was not judged, a line each.
    fn not_judged(&self) -> String {
        let mut text = String::new();
        for part in &self.unjudged {
            let _ = writeln!(text, "Not judged: {:.2} to {:.2} s, {}.", part.from, part.to, part.why);
        }
        text
    }

    /// The page.
    pub fn page(&self) -> String {
        page::html(self)
    }
}

/// From when on an alarm had its name, if not at once, and which others it had, in brackets.
fn named(episode: &Episode, headline: &Said) -> String {
    let mut parts = Vec::new();
    if headline.at > episode.from {
        parts.push(format!("so named from {:.2} s on", headline.at));
    }
    let mut others: Vec<String> = Vec::new();
    for said in episode.said.iter().filter(|said| said.class != headline.class) {
        let Some(class) = said.class else { continue };
        let sensor = class.sensor().map_or("", Channel::name);
        let short = match said.sentence.split_once("; ") {
            // A heater that does not follow at all is another thing to mend than a weak one, and has the same class.
            Some((words, _)) if class == FaultClass::HeaterPower && !words.contains('%') => words.to_owned(),
            _ => class.short().replace("{t}", sensor),
        };
        if !others.contains(&short) {
            others.push(short);
        }
    }
    if !others.is_empty() {
        parts.push(format!("for a time named: {}", others.join(", ")));
    }
    if parts.is_empty() { String::new() } else { format!(" ({})", parts.join("; ")) }
}

fn alarms(count: usize) -> String {
    if count == 1 { "1 alarm".into() } else { format!("{count} alarms") }
}

/// The samples of the recording that were learnt from, and why they are trusted; none where another recording was.
fn learnt_from(training: &Training) -> Option<(&Range<usize>, &str)> {
    match training {
        Training::Own(part, why) | Training::Found(part, why, _) => Some((part, why)),
        Training::Other(_) => None,
    }
}

/// What is said of means of `every` samples once they have passed, where it belongs: in the middle of them, and on straight lines between.
fn aligned(ticks: &[u32], said: &[Option<f64>], every: f64) -> Vec<Option<f64>> {
    if every < 2.0 {
        return said.to_vec();
    }
    let (mut places, mut last) = (Vec::new(), None);
    for (tick, value) in ticks.iter().zip(said) {
        if *value != last
            && let Some(value) = value
        {
            places.push((f64::from(*tick) - 0.5 * (every - 1.0), *value));
        }
        last = *value;
    }
    let mut next = 0;
    let at = |(tick, value): (&u32, &Option<f64>)| {
        let tick = f64::from(*tick);
        while places.get(next).is_some_and(|(place, _)| *place <= tick) {
            next += 1;
        }
        let between = || {
            let ((a, from), (b, to)) = (*places.get(next.checked_sub(1)?)?, *places.get(next)?);
            (b - a < 3.0 * every).then(|| from + (to - from) * (tick - a) / (b - a))
        };
        value.map(|value| between().unwrap_or(value))
    };
    ticks.iter().zip(said).map(at).collect()
}

/// What the trained model says of T1 at some samples, from the first of them on.
fn simulated(done: &Diagnosed, samples: &[Observed]) -> Vec<Option<f64>> {
    let mut monitor = done.trained.monitor.clone();
    monitor.resume();
    let step = |sample: &Observed| {
        let (_, report) = monitor.step(&Observed { learn: false, ..*sample });
        report.likelihood.expected[1].map(f64::from)
    };
    samples.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp that is told by means of 4, each when its last sample has come.
    #[test]
    fn means_stand_in_the_middle_of_what_they_are_of() {
        let ticks: Vec<u32> = (0..40).collect();
        let mean = |k: &u32| (*k >= 3).then(|| f64::from((k + 1) / 4 * 4) - 2.5);
        let said: Vec<Option<f64>> = ticks.iter().map(mean).collect();
        let placed = aligned(&ticks, &said, 4.0);
        assert!(placed[..3].iter().all(Option::is_none));
        for (k, value) in placed.iter().enumerate().take(36).skip(3) {
            assert_eq!(*value, Some(k as f64));
        }
        assert_eq!(aligned(&ticks, &said, 1.0), said);
    }
}
