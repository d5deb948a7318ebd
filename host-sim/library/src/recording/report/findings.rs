//! The alarms of a recording with their sentences, and where nothing could be said.

use fdi_core::FaultClass;
use fdi_core::likelihood::Readiness;

use super::super::run::Diagnosed;
use super::super::{Heater, Recording};
use crate::experiment::{Record, Row};
use crate::record::summary::sentence;

/// An alarm from its rise to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// When it rose, s.
    pub from: f64,
    /// When it ended, or the recording, s.
    pub to: f64,
    /// How it ended.
    pub ending: Ending,
    /// What was said, one after the other.
    pub said: Vec<Said>,
}

/// How an alarm ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All was as expected again.
    Over,
    /// A gap came, and behind it nobody knows whether what was wrong still is.
    Gap,
    /// It stood to the end of the recording.
    Stands,
}

/// What is said while an alarm stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// From when on, s.
    pub at: f64,
    /// Which fault; none: it can't be told.
    pub class: Option<FaultClass>,
    /// The same in words, with the size as it was said last.
    pub sentence: String,
}

/// A part of which nothing was said.
#[derive(Clone, Debug, PartialEq)]
pub struct Unjudged {
    /// From when, s.
    pub from: f64,
    /// To when, s.
    pub to: f64,
    /// Why.
    pub why: &'static str,
}

impl Episode {
    /// What it came to: the name that stood longest, as it was said last, from when it was said first; or that there was none.
    pub fn headline(&self) -> Option<Said> {
        let ends = self.said.iter().skip(1).map(|said| said.at).chain([self.to]);
        let stood: Vec<(&Said, f64)> =
            self.said.iter().zip(ends).map(|(said, end)| (said, end - said.at)).collect();
        let of = |class: Option<FaultClass>| {
            stood.iter().filter(|(said, _)| said.class == class).map(|(_, time)| time).sum::<f64>()
        };
        let names = self.said.iter().filter(|said| said.class.is_some());
        let last = names.max_by(|a, b| of(a.class).total_cmp(&of(b.class))).or(self.said.last())?;
        let first = self.said.iter().find(|said| said.class == last.class)?;
        Some(Said { at: first.at, ..last.clone() })
    }
}

/// What is said of a fault that nobody can name.
const UNNAMED: &str = "something is wrong, and it cannot be told what";
/// Shorter parts are not told, samples.
const SHORT: f64 = 5.0;

/// Each alarm.
pub(super) fn episodes(recording: &Recording, heater: &Heater, done: &Diagnosed) -> Vec<Episode> {
    let record = &done.record;
    let first = done.watched_from as u32;
    let start = record.rows.partition_point(|row| row.tick.index < first);
    let rows = &record.rows[start..];
    let time = |row: &Row| record.time(row.tick.index);
    let alarm = |row: &Row| row.report.likelihood.alarm;
    let stretches = recording.stretches();
    let mut episodes = Vec::new();
    let mut after = rows;
    for rows in rows.chunk_by(|a, b| alarm(a) == alarm(b)) {
        after = &after[rows.len()..];
        if !alarm(&rows[0]) {
            continue;
        }
        let class = |row: &Row| row.report.likelihood.finding.map(|finding| finding.class);
        let said = rows.chunk_by(|a, b| class(a) == class(b)).map(|same| Said {
            at: time(&same[0]),
            class: class(&same[0]),
            sentence: words(recording, heater, record, same, rows[0].tick.index),
        });
        let to = after.first().map_or(record.end(), time);
        let stretch = |row: &Row| stretches.partition_point(|stretch| stretch.end <= row.tick.index as usize);
        let ending = match (rows.last(), after.first()) {
            (_, None) => Ending::Stands,
            (Some(last), Some(next)) if stretch(last) != stretch(next) => Ending::Gap,
            _ => Ending::Over,
        };
        let to = if ending == Ending::Gap { rows.last().map_or(to, time) } else { to };
        episodes.push(Episode { from: time(&rows[0]), to, ending, said: said.collect() });
    }
    episodes
}

/// What is said on rows that name the same, with its size on the last of them. What an alarm is of began no later than the tick on which it rose.
fn words(recording: &Recording, heater: &Heater, record: &Record, rows: &[Row], rose: u32) -> String {
    let told = |row: &Row| {
        let mut finding = row.report.likelihood.finding?;
        finding.onset = finding.onset.min(rose);
        let told = plain(recording, heater, &sentence(record, row, &finding));
        let Some(date) = recording.date(record.time(finding.onset)) else { return Some(told) };
        let (what, since) = told.split_once("; since ")?;
        Some(format!("{what}; since {date}, {since}"))
    };
    rows.iter().rev().filter_map(told).find(|text| is_whole(text)).unwrap_or_else(|| UNNAMED.to_owned())
}

/// Whether each number of a sentence is known: one that is not is a question mark in its place.
fn is_whole(sentence: &str) -> bool {
    !sentence.contains(" ? ")
}

/// The sentence of a board about a rig of which less is known.
pub fn plain(recording: &Recording, heater: &Heater, sentence: &str) -> String {
    let loose = if heater.inputs.fan { "is it loose? " } else { "is it loose, or is heat lost? " };
    let sentence = sentence.replace("is it out of the tube? ", loose).replace("°C", recording.unit(heater));
    ["% less ", "% weaker "].into_iter().fold(sentence, |sentence, less| no_more_than_all(&sentence, less))
}

/// An interval of a loss ends at 100 %: `72.3 (43.4 to 101.1) % less`.
fn no_more_than_all(sentence: &str, less: &str) -> String {
    let end = || {
        let (head, _) = sentence.split_once(&format!(") {less}"))?;
        let from = head.rfind(' ')? + 1;
        let beyond = head[from..].parse::<f64>().ok()? > 100.0;
        beyond.then_some(from..head.len())
    };
    end().map_or_else(
        || sentence.to_owned(),
        |end| format!("{}100{}", &sentence[..end.start], &sentence[end.end..]),
    )
}

/// Where nothing could be said after the training.
pub(super) fn unjudged(recording: &Recording, done: &Diagnosed) -> Vec<Unjudged> {
    let first = done.record.rows.first().map_or(0, |row| row.tick.index);
    let before = Unjudged { from: 0.0, to: done.record.time(first), why: "before what was learnt from" };
    let record = &done.record;
    let time = |k: usize| record.time(k as u32);
    let stretches = recording.stretches();
    let between = stretches.windows(2).filter(|pair| pair[1].start > done.watched_from);
    let session = |k: usize| recording.sessions.iter().position(|session| session.contains(&k));
    let gaps = between.map(|pair| {
        let why = if session(pair[1].start) != session(pair[0].start) {
            "another session begins"
        } else {
            "no rows"
        };
        Unjudged { from: time(pair[0].end.max(done.watched_from)), to: time(pair[1].start), why }
    });
    let why = |row: &Row| {
        let likelihood = &row.report.likelihood;
        let is_watched = !likelihood.alarm && (row.tick.index as usize) >= done.watched_from;
        let why = match () {
            () if row.tick.sample.t1.good().is_none() => "no T1",
            () if likelihood.readiness != Readiness::Armed || likelihood.expected[1].is_none() => {
                "the state of the rig was not known yet"
            }
            () => return None,
        };
        is_watched.then_some(why)
    };
    let parts = record.rows.chunk_by(|a, b| why(a) == why(b)).filter_map(|rows| {
        let (first, last) = (rows.first()?, rows.last()?);
        let to = record.time(last.tick.index + 1);
        Some(Unjudged { from: record.time(first.tick.index), to, why: why(first)? })
    });
    let mut parts: Vec<Unjudged> = parts.chain(gaps).chain([before]).collect();
    parts.retain(|part| part.to - part.from > SHORT * record.sample_time);
    parts.sort_by(|a, b| a.from.total_cmp(&b.from));
    parts
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::Magnitude;
    use fdi_core::{Celsius, Finding, Reading, Sample};
    use firmware_logic::finding::Sentence;

    use super::*;
    use crate::recording::Reading as How;
    use crate::recording::report::Told;
    use crate::recording::run::{Training, diagnose};

    /// Whatever is said while an alarm stands: one sentence of it, and of nothing that came later.
    #[test]
    fn an_alarm_is_one_sentence_that_is_not_before_its_onset() {
        let row = |k: u32| {
            let at = |power: f64, seconds: f64| power * (1.0 - (-seconds / 60.0f64).exp());
            let t = (0..=k / 40).map(|step| {
                let change = if step == 0 { 40.0 } else { 20.0 - 40.0 * f64::from(step % 2) };
                at(0.3 * change, f64::from(k - 40 * step))
            });
            let noise = 0.02 * f64::from(k * 7 % 11) - 0.1;
            let power = if (k / 40).is_multiple_of(2) { 40 } else { 20 };
            let (hour, minute, second) = (1 + k / 3600, k / 60 % 60, k % 60);
            format!(
                "2026-03-28T0{hour}:{minute:02}:{second:02}+02:00,{:.3},{power}\n",
                20.0 + t.sum::<f64>() + noise
            )
        };
        let text: String = (0..600).map(row).collect();
        let how = How { fan: Some(false), ..How::default() };
        let recording = Recording::parse("f".into(), &format!("time,temp,power\n{text}"), &how).unwrap();
        let heater = &recording.heaters[0];
        let training = Training::Own(0..400, "as told".into());
        let config = fdi_core::Config::default();
        let mut done =
            diagnose(&recording, 0, &training, &[], &config, &indicatif::ProgressBar::hidden()).unwrap();
        assert!(Told::new(&recording, heater, &training, &done, None).episodes.is_empty());
        for row in &mut done.record.rows {
            let k = row.tick.index;
            let classes = [FaultClass::HeaterPower, FaultClass::T1Offset, FaultClass::HeaterPower];
            row.report.likelihood.alarm = (500..560).contains(&k);
            let magnitude = Some(Magnitude { value: -20.0, half_width: 5.0 });
            // The onset is found later than the name.
            row.report.likelihood.finding = (510..560).contains(&k).then(|| Finding {
                class: classes[(k as usize - 510) / 17],
                confidence: 0.9,
                magnitude,
                onset: 540,
            });
        }
        let said = Told::new(&recording, heater, &training, &done, None).text();
        let lines: Vec<&str> = said.lines().filter(|line| line.contains("since")).collect();
        assert_eq!(lines.len(), 1, "{said}");
        for part in [
            "500.00 s  2026-03-28 01:08:20  the heater gives 20",
            "since 2026-03-28 01:08:20, 500.0 s",
            "(so named from 510.00 s on; for a time named: T1 reads wrong)",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(said.contains("560.00 s  2026-03-28 01:09:20  all is as expected again"), "{said}");
        // Of what was not judged nothing is said.
        done.unjudged = std::iter::once(400.0..600.0).collect();
        done.record.rows.iter_mut().for_each(|row| row.report.likelihood.alarm = false);
        let said = Told::new(&recording, heater, &training, &done, None).text();
        assert!(said.starts_with("200 s watched, none of it judged\n"), "{said}");
    }

    /// A sentence that asks something is told, one that lacks a number is not.
    #[test]
    fn a_question_is_no_number_that_is_missing() {
        let sized = Magnitude { value: 2.0, half_width: 5.0 };
        for class in [FaultClass::T1Loose, FaultClass::T1Detached] {
            for (celsius, whole) in [(30.0, true), (f32::NAN, false)] {
                for magnitude in [None, Some(sized)] {
                    let finding = &Finding { class, confidence: 0.97, magnitude, onset: 0 };
                    let t1 = Reading { celsius: Celsius(celsius), ..Reading::default() };
                    let sample = &Sample { t1, ..Sample::default() };
                    let said =
                        Sentence { finding, sample, expected: [None, Some(25.0), None], sample_time: 1.0 };
                    let said = said.to_string();
                    assert_eq!(is_whole(&said), whole, "{said}");
                }
            }
        }
    }

    #[test]
    fn no_interval_of_a_loss_goes_beyond_all() {
        for (sentence, expected) in [
            ("gives 72.3 (43.4 to 101.1) % less power", "gives 72.3 (43.4 to 100) % less power"),
            ("gives 72.3 (43.4 to 99.1) % less power", "gives 72.3 (43.4 to 99.1) % less power"),
            ("gives 90.0 (70.1 to 110.0) % more power", "gives 90.0 (70.1 to 110.0) % more power"),
        ] {
            assert_eq!(no_more_than_all(sentence, "% less "), expected);
        }
    }
}
