//! A trace.csv as a recording: codes are found again from temperatures, commands from what changed.

use std::path::Path;

use anyhow::{Context, ensure};
use fdi_core::sense::plausibility::PlausibilityConfig;
use fdi_core::sense::supply::{Supply, SupplyState};
use fdi_core::sense::thermistor::Thermistor;
use fdi_core::{AdcCode, Celsius, Command, Config, Percent, RawSample, Report, Tick};

use super::{Order, Recorded, Recording, Said};
use crate::experiment::{as_written, truth};
use crate::record::summary;
use crate::record::trace::{Column, OneTick, TRUTH, instrument_columns};
use pt326_rig::fault::Fault;

/// Reads a trace. Its columns may stand in any order; those that it lacks are not compared.
///
/// # Errors
/// A column without which it can't be replayed, or a bad cell, by line and column.
pub(super) fn read(text: &str, config: &Config) -> anyhow::Result<Recording> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = |column: &'static Column| Some((column, position(&header, column.name)?));
    let compared: Vec<_> = instrument_columns().filter_map(place).collect();
    let lacks: Vec<&str> =
        instrument_columns().map(|c| c.name).filter(|name| position(&header, name).is_none()).collect();
    let mut remarks = Vec::new();
    if !lacks.is_empty() {
        remarks.push(format!("the trace has no column {}, which is not compared", lacks.join(", ")));
    }
    let s = &config.sensors;
    let thermistors = [Thermistor::new(&s.t0, 0)?, Thermistor::new(&s.t1, 1)?, Thermistor::new(&s.t2, 2)?];
    let inputs = Inputs::find(&header).context("line 1")?;
    let supply = Supply::new(&config.supply)?;
    let mut reader = Reader {
        thermistors,
        supply,
        limits: config.plausibility,
        inputs,
        compared,
        width: header.len(),
        before: None,
    };
    let ticks =
        lines.zip(2..).map(|(line, number)| reader.row(line).with_context(|| format!("line {number}")));
    let ticks = ticks.collect::<anyhow::Result<Vec<Recorded>>>()?;
    let faults = faults(text, as_written(config.sample_time.0));
    Ok(Recording { config: config.clone(), baseline: None, ticks, faults, remarks })
}

fn position(header: &[&str], name: &str) -> Option<usize> {
    header.iter().position(|column| *column == name)
}

/// Where the columns stand from which codes and commands are found again.
struct Inputs {
    celsius: [usize; 3],
    setpoint: usize,
    prbs: usize,
    y1: usize,
    y2: usize,
    mode: usize,
    /// Columns that a trace of an older release lacks.
    supply: Option<usize>,
    fan: Option<usize>,
}

impl Inputs {
    fn find(header: &[&str]) -> anyhow::Result<Self> {
        let place = |name: &str| {
            position(header, name)
                .with_context(|| format!("expected the header of a trace.csv, with a column {name}"))
        };
        Ok(Self {
            celsius: [place("t0_c")?, place("t1_c")?, place("t2_c")?],
            setpoint: place("setpoint_c")?,
            prbs: place("prbs_pct")?,
            y1: place("y1_c")?,
            y2: place("y2_c")?,
            mode: place("mode")?,
            supply: position(header, "supply"),
            fan: position(header, "fan_pct"),
        })
    }
}

/// The cells of a row that the next one is compared with.
struct Before {
    celsius: [f32; 3],
    setpoint: f32,
    fan: Option<f32>,
    excited: bool,
    heating: bool,
    monitoring: bool,
    tripped: bool,
}

struct Reader {
    thermistors: [Thermistor; 3],
    supply: Supply,
    limits: PlausibilityConfig,
    inputs: Inputs,
    /// Columns that the core must come to again, with their places.
    compared: Vec<(&'static Column, usize)>,
    /// Number of columns.
    width: usize,
    before: Option<Before>,
}

impl Reader {
    fn row(&mut self, line: &str) -> anyhow::Result<Recorded> {
        let cells: Vec<&str> = line.split(',').collect();
        ensure!(cells.len() >= self.width, "{} cells, expected {}", cells.len(), self.width);
        let number = |i: usize| -> anyhow::Result<f32> {
            cells[i]
                .parse()
                .ok()
                .with_context(|| format!("cell {} is {:?}, expected a number", i + 1, cells[i]))
        };
        let at = &self.inputs;
        let celsius = [number(at.celsius[0])?, number(at.celsius[1])?, number(at.celsius[2])?];
        let heating = !matches!(cells[at.mode], "off" | "tripped");
        let [monitoring, tripped] = ["monitor", "tripped"].map(|mode| cells[at.mode] == mode);
        let excited = number(at.prbs)? != 0.0;
        let known = |at: Option<usize>| at.filter(|i| !cells[*i].is_empty()).map(number).transpose();
        let (supply, fan) = (known(at.supply)?, known(at.fan)?);
        let now =
            Before { celsius, setpoint: number(at.setpoint)?, fan, excited, heating, monitoring, tripped };
        let (no_y1, no_y2) = (cells[at.y1].is_empty(), cells[at.y2].is_empty());
        let [t0, t1, t2] = std::array::from_fn(|i| {
            // A sample that went missing repeats the temperature before, and has no rise.
            let repeats = self.before.as_ref().is_some_and(|b| b.celsius[i] == celsius[i]);
            let blank = match i {
                0 => no_y1 && no_y2,
                1 => no_y1,
                _ => no_y2,
            };
            let code = code(&self.thermistors[i], celsius[i]);
            // A broken wire, or wires that touch, read the same from tick to tick, and are no missing sample.
            let connected = code > self.limits.short_code.0 && code < self.limits.open_code.0;
            AdcCode(if repeats && blank && connected { f32::NAN } else { code })
        });
        let supply = AdcCode(supply.map_or(0.0, |share| supply_code(&self.supply, share)));
        let orders = orders(self.before.as_ref(), &now);
        self.before = Some(now);
        let said = self.compared.iter().map(|(column, i)| (*column, cells[*i].to_owned())).collect();
        Ok(Recorded { orders, raw: RawSample { t0, t1, t2, supply }, applied: None, said: Said::Cells(said) })
    }
}

/// The code that reads as exactly this temperature.
fn code(thermistor: &Thermistor, celsius: f32) -> f32 {
    let about = thermistor.code(Celsius(celsius)).0;
    exact(about, |code| thermistor.celsius(AdcCode(code)).0 == celsius)
}

/// The code that reads as exactly this share of the nominal voltage.
fn supply_code(supply: &Supply, share: f32) -> f32 {
    exact(supply.code(share).0, |code| {
        let mut state = SupplyState::default();
        supply.step(&mut state, AdcCode(code));
        state.share() == Some(share)
    })
}

/// Of the codes near `about`, whole ones and means of 16 conversions, the one that reads as it should.
fn exact(about: f32, reads: impl Fn(f32) -> bool) -> f32 {
    let near = |steps: f32| [0.0, -1.0, 1.0].map(|d| ((about * steps).round() + d) / steps);
    [near(1.0), near(16.0)].concat().into_iter().find(|&code| reads(code)).unwrap_or(about)
}

/// What must have been asked for between two rows.
fn orders(before: Option<&Before>, now: &Before) -> Vec<Order> {
    let mut commands = Vec::new();
    let (was_heating, was_tripped) = before.map_or((false, false), |b| (b.heating, b.tripped));
    if before.is_some_and(|b| now.setpoint != b.setpoint) {
        commands.push(Command::SetPoint(Celsius(now.setpoint)));
    }
    if was_tripped && !now.tripped {
        commands.push(Command::Acknowledge);
    }
    if now.heating && !was_heating {
        commands.push(Command::Arm);
    } else if was_heating && !now.heating && !now.tripped {
        commands.push(Command::Stop);
    }
    if let Some(level) = now.fan.filter(|level| before.and_then(|b| b.fan) != Some(*level)) {
        commands.push(Command::Fan(Percent(level)));
    }
    if now.heating && !now.monitoring && before.is_some_and(|b| b.monitoring) {
        commands.push(Command::Relearn); // nothing else leads from monitoring back to learning
    }
    let excited = before.is_none_or(|b| b.excited || !b.heating);
    if now.heating && now.excited != excited {
        commands.push(Command::Excite(now.excited));
    }
    commands.into_iter().map(Order::Command).collect()
}

/// The column `truth`; of a trace without it, nothing.
fn truths(text: &str) -> Vec<u8> {
    let Some(place) =
        position(&text.lines().next().unwrap_or_default().split(',').collect::<Vec<_>>(), TRUTH)
    else {
        return Vec::new();
    };
    let truth =
        |line: &str| line.split(',').nth(place).and_then(|cell| cell.trim().parse().ok()).unwrap_or(0);
    text.lines().skip(1).map(truth).collect()
}

/// The true faults as far as the column `truth` knows them: from tick to tick, and without a size.
fn faults(text: &str, sample_time: f64) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut from = 0;
    for run in truths(text).chunk_by(|a, b| a == b) {
        let (at, duration) = (from as f64 * sample_time, run.len() as f64 * sample_time);
        faults.extend(Fault::from_truth(run[0], at, duration));
        from += run.len();
    }
    faults
}

/// Takes onsets and sizes of the faults from the summary.json beside a trace, if it is one of the same run, so that delays
/// are those of that run; else says that they are known to a tick only.
pub(super) fn use_summary(recording: &mut Recording, text: &str, file: &Path) {
    if recording.faults.is_empty() || truths(text).is_empty() {
        return;
    }
    let json = std::fs::read_to_string(file.with_file_name("summary.json"));
    let exact = json.ok().and_then(|json| summary::faults_in(&json));
    let sample_time = as_written(recording.config.sample_time.0);
    let is_of_this_run = |faults: &Vec<Fault>| {
        let mut ticks = truths(text).into_iter().enumerate();
        ticks.all(|(i, number)| truth(faults, i as f64 * sample_time) == number)
    };
    match exact.filter(is_of_this_run) {
        Some(faults) => recording.faults = faults,
        None => recording.remarks.push(
            "no summary.json of this run beside the trace: sizes of the faults are not known, onsets to a tick only".into(),
        ),
    }
}

/// In what the core's row differs from the trace's.
pub(super) fn differences(
    said: &[(&'static Column, String)],
    tick: &Tick,
    report: &Report,
    sample_time: f64,
) -> Vec<String> {
    let on = OneTick { tick, report, truth: 0, sample_time };
    let difference = |(column, theirs): &(&'static Column, String)| {
        let ours = (column.value)(&on).to_string();
        (ours != *theirs).then(|| format!("{}: trace {theirs:?}, core {ours:?}", column.name))
    };
    said.iter().filter_map(difference).collect()
}

#[cfg(test)]
mod tests {
    use pt326_lab::scene::{Order as Asked, Scene};
    use pt326_lab::session::Session;
    use pt326_rig::fault::{Sensor, Verb};

    use super::*;

    /// A session in which the user stops, arms, acknowledges a trip: what was asked for is found again from its trace.
    #[test]
    fn what_the_user_did_is_found_again() {
        let mut session = Session::new(Scene::default()).unwrap();
        let broken = Fault::new(Verb::Open, Some(Sensor::T1), None, 0.0, 1.0);
        for order in [
            Asked::Setpoint { celsius: 36.0 },
            Asked::Stop,
            Asked::Arm,
            Asked::Break { fault: broken },
            Asked::Acknowledge,
            Asked::Arm,
        ] {
            (0..50).for_each(|_| drop(session.step()));
            session.order(order).unwrap();
        }
        (0..50).for_each(|_| drop(session.step()));
        let text = session.trace().unwrap().collect::<Vec<_>>().join("\n");
        let recording = read(&text, &Config::default()).unwrap();
        let (_, agreement) = super::super::rerun(&recording, Path::new("trace.csv"), |_, _, _| ()).unwrap();
        assert!(agreement.to_string().contains("on all 350 ticks"), "{agreement}");
    }
}
