//! Samples as they come, a line each. A line that is no sample is told and counted, a source that is silent as well: both are gaps, and it goes on.
//! Where lines have times, a sample stands where its time is.

use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, ensure};
use fdi_core::likelihood::Readiness;
use fdi_core::monitor::OBSERVED;
use fdi_core::{Config, Finding, Monitor, Observed};
use serde_json::{Value, json};

use super::super::terminal::{in_words, print};
use super::DiagnoseArgs;
use super::lines::{Heard, Lines};
use pt326_fit::stretches::GAP;
use pt326_host::experiment::{Origin, Record, Row, tick_time};
use pt326_host::record::summary::sentence;
use pt326_host::recording::believed::Believed;
use pt326_host::recording::grid::OFF;
use pt326_host::recording::map::Role;
use pt326_host::recording::report::plain;
use pt326_host::recording::run::as_tick;
use pt326_host::recording::stamp::Stamps;
use pt326_host::recording::table::Table;
use pt326_host::recording::text::as_numbers;
use pt326_host::recording::training::{Trained, train};
use pt326_host::recording::{Reading, Recording};

/// A source is silent when nothing has come for so many sample times, and at least so long: loggers gather some lines before they send them.
const SILENT: f64 = 5.0;
const LEAST_SILENCE: Duration = Duration::from_secs(2);
/// So many gaps from the first line on are another unit of time.
const ASKED: u64 = 10;

/// Learns from the other recording, then reads standard input until it ends.
pub(super) fn run(args: &DiagnoseArgs, how: &Reading, config: &Config) -> anyhow::Result<()> {
    ensure!(
        !how.power_before,
        "--power-before: not with --live, where the power that drives from here on is not known yet"
    );
    let path = args.train_on.as_deref().context("--live asks for --train-on")?;
    let other = Recording::read(path, how)?;
    let heater = &other.heaters[0];
    let trained = train(&other, heater, &heater.samples, config)?;
    let warning = trained.accepted(args.force, super::FORCED)?;
    let mut say = |said: Said| print(&if args.json { format!("{}\n", said.json) } else { said.text });
    let text =
        format!("{warning}{}: learnt from {}, {:.1} % explained\n", heater.map, other.file, trained.fit);
    say(Said::new(
        "learnt",
        text,
        json!({ "map": heater.map.to_string(), "file": other.file, "fit_pct": trained.fit }),
    ))?;
    let silence = Duration::from_secs_f64(SILENT * other.sample_time).max(LEAST_SILENCE);
    let mut lines = Lines::of_standard_input();
    let Heard::Line(header) = lines.next(None) else {
        anyhow::bail!("standard input is empty: expected a header")
    };
    let mut live = Live::new(&other, how, &trained, header?)?;
    loop {
        match lines.next(Some(silence)) {
            Heard::End => break,
            heard => live.hear(heard, Instant::now(), &mut say)?,
        }
    }
    live.end(&mut say)
}

/// Something that is said: for people, and for programs.
struct Said {
    text: String,
    json: Value,
}

impl Said {
    /// `more`: an object with what there is to it.
    fn new(event: &str, text: String, mut more: Value) -> Self {
        more["event"] = event.into();
        more["text"] = text.trim().into();
        Self { text, json: more }
    }
}

/// What a source sends must not command the terminal.
fn visible(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

/// Where what is said goes.
type Say<'a> = &'a mut dyn FnMut(Said) -> anyhow::Result<()>;

/// A source of samples under watch.
struct Live<'a> {
    other: &'a Recording,
    believed: Believed,
    how: Reading,
    header: String,
    learnt: &'a Trained,
    monitor: Monitor,
    /// How the lines tell their times, and that of the last sample, s.
    stamps: Option<Stamps>,
    at: Option<f64>,
    /// Lines that were placed by their time, and gaps before them.
    placed: u64,
    gaps: u64,
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
    fn new(other: &'a Recording, how: &Reading, learnt: &'a Trained, header: String) -> anyhow::Result<Self> {
        let celsius = Some(other.units.celsius.into());
        let full_power = Some(other.units.full_power.into());
        let how =
            Reading { sample_time: Some(other.sample_time), celsius, full_power, ..how.clone() }.untimed();
        let numbers = as_numbers(&header);
        let line =
            Recording::parse("standard input, line 1".into(), &format!("{header}\n{numbers}\n"), &how)?;
        // The stream's own name of the time says its unit, unless somebody else does.
        let name =
            line.heaters[0].map.column(Role::Time).filter(|_| how.time_unit.is_none()).map(str::to_owned);
        let stamps = other.stamps.map(|stamps| name.map_or(stamps, |name| stamps.under(&name)));
        let origin = Origin::Watched { file: "standard input".into() };
        let mut record = Record::new(origin, &learnt.config, &[], Vec::new(), None);
        record.sample_time = other.sample_time;
        let mut monitor = learnt.monitor.clone();
        monitor.resume();
        Ok(Self {
            other,
            believed: Believed::of(&other.heaters[0]),
            how,
            header,
            learnt,
            implausible: [0; OBSERVED.len()],
            monitor,
            stamps,
            at: None,
            placed: 0,
            gaps: 0,
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
                let text = format!("no sample for {time:.1} s, after line {}\n", self.line);
                say(Said::new("silent", text, json!({ "line": self.line, "for_s": time })))?;
            }
            return Ok(());
        };
        self.line += 1;
        self.last = Some(now);
        if let Some(since) = self.silent_since.take() {
            let time = now.duration_since(since).as_secs_f64();
            let text = format!("line {}: samples again, after {time:.1} s without\n", self.line);
            say(Said::new("again", text, json!({ "line": self.line, "for_s": time })))?;
        }
        if line.as_ref().is_ok_and(|line| line.trim().is_empty() || line.trim_start().starts_with('#')) {
            return Ok(()); // as in a file
        }
        match line
            .with_context(|| format!("standard input, line {}", self.line))
            .and_then(|line| self.sample(&line))
        {
            Ok((sample, time)) => {
                self.samples += 1;
                self.place(&sample, time, say)
            }
            Err(why) => {
                self.left_out += 1;
                let why = visible(&in_words(&why));
                let text = format!("left out, it counts as a sample that is missing: {why}\n");
                say(Said::new("left_out", text, json!({ "line": self.line })))?;
                // Where lines have times, the next one says how many are missing.
                if self.at.is_some() { Ok(()) } else { self.watch(&Observed::default(), say) }
            }
        }
    }

    /// A recording of one line: the same cells, the same errors, but for where the line is; and its time, s.
    fn sample(&mut self, line: &str) -> anyhow::Result<(Observed, Option<f64>)> {
        let file = format!("standard input, line {}", self.line);
        let text = format!("{}\n{line}\n", self.header);
        let here = |error: anyhow::Error| {
            anyhow!("{}", format!("{error:#}").replace(&format!("{file}, line 2"), &file))
        };
        let one = Recording::parse(file.clone(), &text, &self.how).map_err(here)?;
        let heater = one.heaters.first().with_context(|| format!("{file} holds no sample"))?;
        let sample = *heater.samples.first().with_context(|| format!("{file} holds no sample"))?;
        let Some(column) = heater.map.column(Role::Time).filter(|_| self.stamps.is_some()) else {
            return Ok((sample, None));
        };
        let table = Table::parse(file.clone(), &text)?;
        let column = table.column(column)?;
        let cell = table.first_of(column)?.unwrap_or_default();
        if let Some(time) = self.stamps.and_then(|stamps| stamps.seconds(&cell)) {
            return Ok((sample, Some(time)));
        }
        // Written in another way than in the training.
        let (stamps, times) = Stamps::of(&table, column, self.how.time_unit).map_err(here)?;
        self.stamps = Some(stamps);
        Ok((sample, times.values.first().copied().flatten()))
    }

    /// A sample where its time is: those before it are missing, and another session begins where time does not go on.
    fn place(&mut self, sample: &Observed, time: Option<f64>, say: Say) -> anyhow::Result<()> {
        let (Some(time), Some(stamps)) = (time, self.stamps) else { return self.watch(sample, say) };
        let Some(at) = self.at.replace(time) else { return self.watch(sample, say) };
        let ts = self.record.sample_time;
        let steps = stamps.between(at, time, ts) / ts;
        let is_gap = !(-0.25..=GAP as f64 + 1.5).contains(&steps);
        (self.placed, self.gaps) = (self.placed + 1, self.gaps + u64::from(is_gap));
        if is_gap && self.said.take().is_some() {
            let text = format!("line {}: a gap: whether what was wrong is over is not known\n", self.line);
            say(Said::new("unknown", text, json!({ "line": self.line })))?;
        }
        if self.gaps == ASKED && self.placed == ASKED {
            say(Said::new("gaps", self.only_gaps(), json!({ "line": self.line })))?;
        }
        // A quarter: what is nearer to the last sample than half of a step may only be early.
        if !(-0.25..=OFF).contains(&steps) {
            let text = format!("line {}: its times begin anew: another session\n", self.line);
            say(Said::new("session", text, json!({ "line": self.line })))?;
            self.monitor.resume();
            return self.watch(sample, say);
        }
        let steps = steps.round();
        // On the grid of the first, so that what is early or late now does not shift all that comes.
        self.at = Some(at + steps * ts);
        let missing = (steps as u32).saturating_sub(1);
        if missing as usize > GAP {
            // What was before says little of what comes behind.
            self.passed = self.passed.saturating_add(missing);
            self.monitor.resume();
        } else {
            (0..missing).try_for_each(|_| self.watch(&Observed::default(), say))?;
        }
        if steps > 0.0 { self.watch(sample, say) } else { Ok(()) }
    }

    /// What whoever runs the source must know of it.
    fn only_gaps(&self) -> String {
        format!(
            "each of {} lines is a gap, by its time: nothing is judged. The training has a sample each {} s; is the time in another unit? \
             --time-unit says which\n",
            self.placed, self.record.sample_time
        )
    }

    fn watch(&mut self, sample: &Observed, say: Say) -> anyhow::Result<()> {
        let (mut seen, mut report) = self.monitor.step(sample);
        // The monitor counts from its training on.
        let before = seen.index.saturating_sub(self.passed);
        seen.index = self.passed;
        self.passed = self.passed.saturating_add(1);
        let time = tick_time(seen.index, self.record.sample_time);
        // Those of the training are not told again; of each the first is.
        let told = self.learnt.monitor.implausible().into_iter().zip(self.monitor.implausible());
        for ((name, count), (learnt, now)) in OBSERVED.iter().zip(&mut self.implausible).zip(told) {
            if *count == 0 && now > learnt {
                let text =
                    format!("{time:>9.2} s  line {}: no {name} is so; it counts as not known\n", self.line);
                say(Said::new("implausible", text, json!({ "t_s": time, "line": self.line, "what": name })))?;
            }
            *count = now.saturating_sub(learnt);
        }
        let likelihood = &mut report.likelihood;
        if likelihood.readiness == Readiness::Restarted {
            let text = format!(
                "{time:>9.2} s  its memory held what is no number: it begins anew as it was trained\n"
            );
            say(Said::new("restarted", text, json!({ "t_s": time, "line": self.line })))?;
            self.monitor = self.learnt.monitor.clone();
            self.monitor.resume();
        }
        let heater = &self.other.heaters[0];
        let expected = &likelihood.expected;
        let can_be = |finding: &Finding| self.believed.believes(finding, &seen.sample, expected);
        likelihood.finding = likelihood.finding.filter(can_be);
        if let Some(finding) = &mut likelihood.finding {
            self.learnt.calibrate(finding);
            finding.onset = finding.onset.saturating_sub(before);
        }
        let now = likelihood.alarm.then(|| likelihood.finding.map(|finding| finding.class));
        if now == self.said {
            return Ok(());
        }
        self.said = now;
        let row = Row { applied: seen.power, tick: as_tick(&seen), report, truth: 0 };
        let finding = row.report.likelihood.finding.filter(|_| now.is_some());
        let what = match (now, finding) {
            (None, _) => "all is as expected again".to_owned(),
            (_, Some(finding)) => plain(self.other, heater, &sentence(&self.record, &row, &finding)),
            _ => "something is wrong, and it cannot be told what yet".to_owned(),
        };
        let number = |x: f32| pt326_host::experiment::as_written(x);
        let size = finding.and_then(|finding| finding.magnitude);
        let more = json!({
            "t_s": time,
            "line": self.line,
            "class": finding.map(|finding| finding.class.name()),
            "confidence": finding.map(|finding| number(finding.confidence)),
            "since_s": finding.map(|finding| tick_time(finding.onset, self.record.sample_time)),
            "size": size.map(|size| number(size.value)),
            "half_width": size.map(|size| number(size.half_width)),
            "unit": finding.filter(|_| size.is_some()).map(|finding| finding.class.unit()),
            "t1": row.tick.sample.t1.good().map(number),
            "t1_expected": row.report.likelihood.expected[1].map(number),
        });
        say(Said::new(
            if now.is_some() { "alarm" } else { "clear" },
            format!("{time:>9.2} s  {what}\n"),
            more,
        ))
    }

    /// # Errors
    /// No line was a sample.
    fn end(&self, say: Say) -> anyhow::Result<()> {
        let Self { samples, left_out, silences, .. } = self;
        ensure!(*samples > 0, "standard input: none of {left_out} lines was a sample");
        ensure!(self.gaps == 0 || self.gaps < self.placed, "standard input: {}", self.only_gaps().trim_end());
        let odd = super::odd(&self.implausible).map(|odd| format!(", {odd}")).unwrap_or_default();
        let text = format!("{samples} samples, {left_out} lines left out, {silences} times silent{odd}\n");
        let passed = self.passed;
        let more =
            json!({ "samples": samples, "left_out": left_out, "silences": silences, "passed": passed });
        say(Said::new("end", text, more))
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
        let mut live = Live::new(&other, &how, &learnt, "t,u,y".into()).unwrap();
        let start = Instant::now();
        let mut text = String::new();
        let mut say = |said: Said| {
            text += &said.text;
            Ok(())
        };
        let mut seconds = 0;
        let mut line = || {
            seconds += 1;
            Heard::Line(Ok(format!("{seconds},30,29.0")))
        };
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
