//! The codes of the paper's experiment on the simulated rig (seed 1), as a file that host and image read.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use fdi_core::{Config, Instrument, RawSample, Report, Tick};
use host_sim::experiment::{Backend, run_on, with_prbs_phase};
use host_sim::scenario::Scenario;
use pil::codes::Codes;

use crate::image;

/// The instrument, and what it was fed.
struct Recorder {
    instrument: Instrument,
    codes: Vec<Codes>,
}

impl Backend for Recorder {
    fn control(&mut self, raw: RawSample) -> Tick {
        self.codes.push([raw.t0.0, raw.t1.0, raw.t2.0]);
        Backend::control(&mut self.instrument, raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        Backend::diagnose(&mut self.instrument, tick)
    }

    fn command(&mut self, command: fdi_core::Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<fdi_core::diagnosis::baseline::Baseline> {
        Backend::baseline(&self.instrument)
    }
}

/// Simulates the experiment and writes its codes into the target folder: their count, then the codes.
pub(crate) fn write() -> anyhow::Result<PathBuf> {
    let config = with_prbs_phase(&Config::default(), 1);
    let mut recorder = Recorder { instrument: Instrument::new(&config)?, codes: Vec::new() };
    run_on(&mut recorder, &config, &Scenario::default(), 1);
    let mut bytes = (recorder.codes.len() as u32).to_le_bytes().to_vec();
    bytes.extend(recorder.codes.as_flattened().iter().flat_map(|code| code.to_le_bytes()));
    let path = image::target_dir()?.join("pil-codes.bin");
    fs::write(&path, bytes).with_context(|| format!("can't write {}", path.display()))?;
    Ok(path)
}

/// Reads the codes back.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Codes>> {
    let bytes = fs::read(path).with_context(|| format!("can't read {}", path.display()))?;
    let words: Vec<[u8; 4]> = bytes.as_chunks().0.to_vec();
    let (count, codes) = words.split_first().with_context(|| format!("{} is empty", path.display()))?;
    let codes: Vec<f32> = codes.iter().map(|&word| f32::from_le_bytes(word)).collect();
    let codes = codes.as_chunks().0;
    ensure!(codes.len() == u32::from_le_bytes(*count) as usize, "{} is cut short", path.display());
    Ok(codes.to_vec())
}
