//! Samples as they come, a line each. A line that is no sample is told and counted, a source that is silent as well: both are gaps, and it goes on.

use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, ensure};
use fdi_core::likelihood::Readiness;
use fdi_core::monitor::OBSERVED;
use fdi_core::{Config, Monitor, Observed};

use super::super::terminal::{in_words, print};
use super::DiagnoseArgs;
use super::lines::{Heard, Lines};
use crate::experiment::{Origin, Record, Row, tick_time};
use crate::record::summary::sentence;
use crate::recording::run::as_tick;
use crate::recording::training::train;
use crate::recording::{Reading, Recording, table};

/// A source is silent when nothing has come for so many sample times, and at least so long: loggers gather some lines before they send them.
const SILENT: f64 = 5.0;
const LEAST_SILENCE: Duration = Duration::from_secs(2);

/// Learns from the other recording, then reads standard input until it ends.
pub(super) fn run(args: &DiagnoseArgs, how: &Reading, config: &Config) -> anyhow::Result<()> {
    let path = args.train_on.as_deref().context("--live asks for --train-on")?;
    let other = Recording::read(path, how)?;
    let heater = &other.heaters[0];
    let trained = train(&other, heater, &heater.samples, config)?;
    print(&format!("{}: learnt from {}, {:.1} % explained\n", heater.map, other.file, trained.fit))?;
    let silence = Duration::from_secs_f64(SILENT * other.sample_time).max(LEAST_SILENCE);
    let mut lines = Lines::of_standard_input();
    let Heard::Line(header) = lines.next(None) else {
        anyhow::bail!("standard input is empty: expected a header")
    };
    let mut live = Live::new(&other, how, &trained.monitor, &trained.config, header?)?;
    loop {
        match lines.next(Some(silence)) {
            Heard::End => break,
            heard => live.hear(heard, Instant::now(), &mut print)?,
        }
    }
    live.end(&mut print)
}

/// What a source sends must not command the terminal.
fn visible(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

/// Where what is said goes.
type Say<'a> = &'a mut dyn FnMut(&str) -> anyhow::Result<()>;

/// A source of samples under watch.
struct Live<'a> {
    how: Reading,
    header: String,
    trained: &'a Monitor,
    monitor: Monitor,
    /// Sample times that have passed since the first line.
    passed: u32,
    record: Record,
    /// Number of the last line, the header being the first.
    line: u64,
    samples: u64,
    left_out: u64,
    silences: u64,
    silent_since: Option<Instant>,
    last: Option<Instant>,
    said: Option<Option<fdi_core::FaultClass>>,
    implausible: [u32; OBSERVED.len()],
}

impl<'a> Live<'a> {
    /// # Errors
    /// The header lacks a column.
    fn new(
        other: &Recording,
        how: &Reading,
        trained: &'a Monitor,
        config: &Config,
        header: String,
    ) -> anyhow::Result<Self> {
        let celsius = Some(other.units.celsius.into());
        let how = Reading { sample_time: Some(other.sample_time), celsius, ..how.clone() }.untimed();
        let numbers = table::as_numbers(&header);
        Recording::parse("standard input, line 1".into(), &format!("{header}\n{numbers}\n"), &how)?;
        let origin = Origin::Watched { file: "standard input".into() };
        let mut record = Record::new(origin, config, &[], Vec::new(), None);
        record.sample_time = other.sample_time;
        let mut monitor = trained.clone();
        monitor.resume();
        Ok(Self {
            how,
            header,
            trained,
            implausible: [0; OBSERVED.len()],
            monitor,
            passed: 0,
            record,
            line: 1,
            samples: 0,
            left_out: 0,
            silences: 0,
            silent_since: None,
            last: None,
            said: None,
        })
    }

    /// A line, or that none has come for long, at this time.
    fn hear(&mut self, heard: Heard, now: Instant, say: Say) -> anyhow::Result<()> {
        let Heard::Line(line) = heard else {
            if self.silent_since.is_none() {
                let since = *self.silent_since.insert(self.last.unwrap_or(now));
                self.silences += 1;
                let time = now.duration_since(since).as_secs_f64();
                say(&format!("no sample for {time:.1} s, after line {}\n", self.line))?;
            }
            return Ok(());
        };
        self.line += 1;
        self.last = Some(now);
        if let Some(since) = self.silent_since.take() {
            let time = now.duration_since(since).as_secs_f64();
            say(&format!("line {}: samples again, after {time:.1} s without\n", self.line))?;
        }
        if line.as_ref().is_ok_and(|line| line.trim().is_empty() || line.trim_start().starts_with('#')) {
            return Ok(()); // as in a file
        }
        let sample = match line
            .with_context(|| format!("standard input, line {}", self.line))
            .and_then(|line| self.sample(&line))
        {
            Ok(sample) => {
                self.samples += 1;
                sample
            }
            Err(why) => {
                self.left_out += 1;
                say(&format!(
                    "left out, it counts as a sample that is missing: {}\n",
                    visible(&in_words(&why))
                ))?;
                Observed::default()
            }
        };
        self.watch(&sample, say)
    }

    /// A recording of one line: the same cells, the same errors, but for where the line is.
    fn sample(&self, line: &str) -> anyhow::Result<Observed> {
        let file = format!("standard input, line {}", self.line);
        let text = format!("{}\n{line}\n", self.header);
        let one = Recording::parse(file.clone(), &text, &self.how).map_err(|error| {
            anyhow!("{}", format!("{error:#}").replace(&format!("{file}, line 2"), &file))
        })?;
        let sample = one.heaters.first().and_then(|heater| heater.samples.first());
        sample.copied().with_context(|| format!("{file} holds no sample"))
    }

    fn watch(&mut self, sample: &Observed, say: Say) -> anyhow::Result<()> {
        let (mut seen, mut report) = self.monitor.step(sample);
        // The monitor counts from its training on.
        let before = seen.index.saturating_sub(self.passed);
        seen.index = self.passed;
        self.passed = self.passed.saturating_add(1);
        let time = tick_time(seen.index, self.record.sample_time);
        // Those of the training are not told again; of each the first is.
        let told = self.trained.implausible().into_iter().zip(self.monitor.implausible());
        for ((name, count), (learnt, now)) in OBSERVED.iter().zip(&mut self.implausible).zip(told) {
            if *count == 0 && now > learnt {
                say(&format!(
                    "{time:>9.2} s  line {}: no {name} is so; it counts as not known\n",
                    self.line
                ))?;
            }
            *count = now.saturating_sub(learnt);
        }
        let likelihood = &mut report.likelihood;
        if likelihood.readiness == Readiness::Restarted {
            say(&format!(
                "{time:>9.2} s  its memory held what is no number: it begins anew as it was trained\n"
            ))?;
            self.monitor = self.trained.clone();
            self.monitor.resume();
        }
        if let Some(finding) = &mut likelihood.finding {
            finding.onset = finding.onset.saturating_sub(before);
        }
        let now = likelihood.alarm.then(|| likelihood.finding.map(|finding| finding.class));
        if now == self.said {
            return Ok(());
        }
        self.said = now;
        let row = Row { applied: seen.power, tick: as_tick(&seen), report, truth: 0 };
        let what = match (now, row.report.likelihood.finding) {
            (None, _) => "all is as expected again".to_owned(),
            (_, Some(finding)) => sentence(&self.record, &row, &finding),
            _ => "something is wrong, and it cannot be told what yet".to_owned(),
        };
        say(&format!("{time:>9.2} s  {what}\n"))
    }

    /// # Errors
    /// No line was a sample.
    fn end(&self, say: Say) -> anyhow::Result<()> {
        let Self { samples, left_out, silences, .. } = self;
        ensure!(*samples > 0, "standard input: none of {left_out} lines was a sample");
        let odd = super::odd(&self.implausible).map(|odd| format!(", {odd}")).unwrap_or_default();
        say(&format!("{samples} samples, {left_out} lines left out, {silences} times silent{odd}\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heater of one lag that was trained on, and the header that goes with it.
    fn trained() -> (Recording, Reading) {
        let mut text = "t,u,y\n".to_owned();
        let mut rise = 0.0;
        for k in 0..1500u32 {
            let power = if (k / 20).wrapping_mul(0x9E37_79B9) >> 31 == 0 { 40.0 } else { 25.0 };
            text += &format!(
                "{k},{power},{:.3}\n",
                22.0 + rise + 0.02 * f64::from(k.wrapping_mul(0x9E37_79B9) >> 24) / 128.0
            );
            rise += 0.2 * (0.3 * power - rise);
        }
        let map = ["time=t", "t1=y", "power=u"].map(str::to_owned).to_vec();
        let how = Reading { map, ..Reading::default() };
        (Recording::parse("other".into(), &text, &how).unwrap(), how)
    }

    /// Each silence is told once, and its end, whatever else comes meanwhile.
    #[test]
    fn a_source_that_is_silent_is_told_once_and_so_is_its_return() {
        let (other, how) = trained();
        let heater = &other.heaters[0];
        let learnt = train(&other, heater, &heater.samples, &Config::default()).unwrap();
        let mut live = Live::new(&other, &how, &learnt.monitor, &learnt.config, "t,u,y".into()).unwrap();
        let start = Instant::now();
        let mut text = String::new();
        let mut say = |said: &str| {
            text += said;
            Ok(())
        };
        let line = || Heard::Line(Ok("1,30,29.0".to_owned()));
        let script = [
            (0, line()),
            (5, Heard::Silence),
            (10, Heard::Silence),
            (12, line()),
            (13, line()),
            (18, Heard::Silence),
        ];
        for (after, heard) in script {
            live.hear(heard, start + Duration::from_secs(after), &mut say).unwrap();
        }
        live.end(&mut say).unwrap();
        assert_eq!(text.matches("no sample for 5.0 s, after line").count(), 2, "{text}");
        assert_eq!(text.matches("line 3: samples again, after 12.0 s without").count(), 1, "{text}");
        assert!(text.ends_with("3 samples, 0 lines left out, 2 times silent\n"), "{text}");
    }
}
