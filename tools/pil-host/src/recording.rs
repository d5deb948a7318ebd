//! The paper's experiment on the simulated rig (seed 1), as a file that host and images read.

use std::fs;
use std::path::PathBuf;

use anyhow::Context;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{Command, Config, Instrument, RawSample, Report, Tick};
use pil::recording::{Recording, Row};
use pt326_host::experiment::scenario::Scenario;
use pt326_host::experiment::{Backend, run_on, with_prbs_phase};

use crate::image;

/// The instrument, and what goes through it.
struct Recorder {
    instrument: Instrument,
    raw: RawSample,
    rows: Vec<Row>,
}

impl Backend for Recorder {
    fn control(&mut self, raw: RawSample) -> Tick {
        self.raw = raw;
        Backend::control(&mut self.instrument, raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        let report = Backend::diagnose(&mut self.instrument, tick);
        let missing = [f32::NAN; _];
        self.rows.push(Row {
            codes: [self.raw.t0.0, self.raw.t1.0, self.raw.t2.0],
            rise: [report.y1, report.y2].map(|y| y.unwrap_or(f32::NAN)),
            power: tick.drive.0,
            features: report.features.unwrap_or(missing),
            filtered: report.features_filtered.unwrap_or(missing),
        });
        report
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<Baseline> {
        Backend::baseline(&self.instrument)
    }
}

/// Simulates a run and returns what a [`Recording`] is made of.
pub(crate) fn simulate(scenario: &Scenario) -> anyhow::Result<(Option<Baseline>, Vec<Row>)> {
    let config = with_prbs_phase(&Config::default(), 1);
    let instrument = Instrument::new(&config)?;
    let mut recorder = Recorder { instrument, raw: RawSample::default(), rows: Vec::new() };
    let record = run_on(&mut recorder, &config, scenario, 1);
    Ok((record.baseline, recorder.rows))
}

/// Simulates the experiment and writes the recording into the target folder.
pub(crate) fn write() -> anyhow::Result<PathBuf> {
    let (baseline, recorded) = simulate(&Scenario::default())?;
    let baseline = baseline.context("the experiment learnt nothing")?;
    let first = Recording::first_row(&baseline.filtered);
    let rows = std::iter::once(first).chain(recorded.iter().map(Row::numbers));
    let mut bytes = (recorded.len() as u32 + 1).to_le_bytes().to_vec();
    bytes.extend(rows.flatten().flat_map(f32::to_le_bytes));
    let path = image::target_dir()?.join("pil-recording.bin");
    fs::write(&path, bytes).with_context(|| format!("can't write {}", path.display()))?;
    Ok(path)
}
