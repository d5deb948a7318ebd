//! A trace.csv as a recording: codes are found again from temperatures, commands from what changed.

use anyhow::{Context, ensure};
use fdi_core::sense::thermistor::Thermistor;
use fdi_core::{AdcCode, Celsius, Command, Config, RawSample, Report, Tick};

use super::{Order, Recorded, Recording, Said};
use crate::experiment::as_written;
use crate::record::trace::{INSTRUMENT_COLUMNS, LIKELIHOOD_COLUMNS, instrument_row, likelihood_row};
use pt326_rig::fault::Fault;

/// Places of the columns that a replay reads.
const T0: usize = 1;
const SETPOINT: usize = 4;
const PRBS: usize = 6;
const Y1: usize = 8;
const Y2: usize = 9;
const MODE: usize = 38;
const TRUTH: usize = 39;

/// Reads a trace; one from before the likelihood diagnosis ends with `truth`.
///
/// # Errors
/// Another header, or a bad cell by line and column.
pub(super) fn read(text: &str, config: &Config) -> anyhow::Result<Recording> {
    let mut columns: Vec<&str> = INSTRUMENT_COLUMNS.split(',').chain(["truth"]).collect();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    ensure!(
        header.starts_with(&columns),
        "line 1: expected the header of a trace.csv: {}",
        columns.join(",")
    );
    let likelihood: Vec<&str> = LIKELIHOOD_COLUMNS.split(',').collect();
    if header[columns.len()..].starts_with(&likelihood) {
        columns.extend(likelihood);
    }
    let s = &config.sensors;
    let thermistors = [Thermistor::new(&s.t0, 0)?, Thermistor::new(&s.t1, 1)?, Thermistor::new(&s.t2, 2)?];
    let mut reader = Reader { thermistors, columns, before: None };
    let ticks =
        lines.zip(2..).map(|(line, number)| reader.row(line).with_context(|| format!("line {number}")));
    let ticks = ticks.collect::<anyhow::Result<Vec<Recorded>>>()?;
    let faults = faults(text, as_written(config.sample_time.0));
    Ok(Recording { config: config.clone(), baseline: None, ticks, faults, remarks: Vec::new() })
}

/// The cells of a row that the next one is compared with.
struct Before {
    celsius: [f32; 3],
    setpoint: f32,
    excited: bool,
    heating: bool,
    monitoring: bool,
}

struct Reader {
    thermistors: [Thermistor; 3],
    columns: Vec<&'static str>,
    before: Option<Before>,
}

impl Reader {
    fn row(&mut self, line: &str) -> anyhow::Result<Recorded> {
        let cells: Vec<&str> = line.split(',').collect();
        ensure!(cells.len() >= self.columns.len(), "{} cells, expected {}", cells.len(), self.columns.len());
        let number = |i: usize| -> anyhow::Result<f32> {
            cells[i]
                .parse()
                .ok()
                .with_context(|| format!("{} is {:?}, expected a number", self.columns[i], cells[i]))
        };
        let celsius = [number(T0)?, number(T0 + 1)?, number(T0 + 2)?];
        let heating = !matches!(cells[MODE], "off" | "tripped");
        let monitoring = cells[MODE] == "monitor";
        let excited = number(PRBS)? != 0.0;
        let now = Before { celsius, setpoint: number(SETPOINT)?, excited, heating, monitoring };
        let [t0, t1, t2] = std::array::from_fn(|i| {
            // A sample that went missing repeats the temperature before, and has no rise.
            let repeats = self.before.as_ref().is_some_and(|b| b.celsius[i] == celsius[i]);
            let blank = match i {
                0 => cells[Y1].is_empty() && cells[Y2].is_empty(),
                1 => cells[Y1].is_empty(),
                _ => cells[Y2].is_empty(),
            };
            AdcCode(if repeats && blank { f32::NAN } else { code(&self.thermistors[i], celsius[i]) })
        });
        let orders = orders(self.before.as_ref(), &now);
        self.before = Some(now);
        let compared = [&cells[..TRUTH], &cells[TRUTH + 1..self.columns.len()]].concat();
        let text = compared.join(",");
        Ok(Recorded { orders, raw: RawSample { t0, t1, t2 }, applied: None, said: Said::Text(text) })
    }
}

/// The code that reads as exactly this temperature: whole, or a mean of 16 conversions.
fn code(thermistor: &Thermistor, celsius: f32) -> f32 {
    let about = thermistor.code(Celsius(celsius)).0;
    let reads = |code: f32| thermistor.celsius(AdcCode(code)).0 == celsius;
    let near = |steps: f32| [0.0, -1.0, 1.0].map(|d| ((about * steps).round() + d) / steps);
    [near(1.0), near(16.0)].concat().into_iter().find(|&code| reads(code)).unwrap_or(about)
}

/// What must have been asked for between two rows.
fn orders(before: Option<&Before>, now: &Before) -> Vec<Order> {
    let mut commands = Vec::new();
    match before {
        None if now.heating => commands.push(Command::Arm),
        Some(b) if now.setpoint != b.setpoint => commands.push(Command::SetPoint(Celsius(now.setpoint))),
        _ => {}
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

/// The true faults, from the column `truth`.
fn faults(text: &str, sample_time: f64) -> Vec<Fault> {
    let truth =
        |line: &str| line.split(',').nth(TRUTH).and_then(|cell| cell.trim().parse::<u8>().ok()).unwrap_or(0);
    let truths: Vec<u8> = text.lines().skip(1).map(truth).collect();
    let mut faults = Vec::new();
    let mut from = 0;
    for run in truths.chunk_by(|a, b| a == b) {
        let (at, duration) = (from as f64 * sample_time, run.len() as f64 * sample_time);
        faults.extend(Fault::from_truth(run[0], at, duration));
        from += run.len();
    }
    faults
}

/// In what the core's row differs from the trace's.
pub(super) fn differences(said: &str, tick: &Tick, report: &Report, sample_time: f64) -> Vec<String> {
    let mut ours = String::new();
    instrument_row(&mut ours, tick, report, sample_time);
    likelihood_row(&mut ours, &report.likelihood, sample_time);
    let cells = said.split(',').zip(ours.split(','));
    let named = INSTRUMENT_COLUMNS.split(',').chain(LIKELIHOOD_COLUMNS.split(',')).zip(cells);
    named
        .filter(|(_, (a, b))| a != b)
        .map(|(name, (a, b))| format!("{name}: trace {a:?}, core {b:?}"))
        .collect()
}
