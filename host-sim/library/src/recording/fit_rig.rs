//! A simulated rig that answers as a recorded one does.

use std::fmt::Write as _;

use anyhow::{Context, ensure};
use indicatif::ProgressBar;

use super::run::{Diagnosed, Training, diagnose};
use super::{Heater, Recording};
use crate::settings;

/// A rig that was fitted to a recording.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The rig as a scenario without faults, TOML: what `pt326 run --scenario` reads.
    pub scenario: String,
    /// How much of T1 its model explains, simulated, %.
    pub fit: f64,
    /// What whoever uses the model must know; empty where it explains enough.
    pub warning: String,
    /// What of it no simulated rig can have, a line each, with what was written in its place.
    pub beyond: String,
}

impl Fitted {
    /// From one heater of a recording (from 1), all of which is taken for normal. `bar` tells how far the diagnosis of it has come.
    ///
    /// # Errors
    /// There is no such heater; nothing can be learnt from it; the model explains too little to go by.
    pub fn new(recording: &Recording, heater: usize, bar: &ProgressBar) -> anyhow::Result<Self> {
        let count = recording.heaters.len();
        let which = heater.wrapping_sub(1);
        let heater = recording
            .heaters
            .get(which)
            .with_context(|| format!("heater is {heater}, expected 1 to {count}"))?;
        let training = Training::Own(0..recording.len(), "all of it is taken for normal".into());
        let done = diagnose(recording, which, &training, &[], &settings::read(None)?, bar)?;
        let warning = done.trained.accepted(false, "")?;
        let (scenario, beyond) = scenario(recording, heater, &done)?;
        Ok(Self { scenario, fit: done.trained.fit, warning, beyond })
    }
}

/// Standard deviation of what the model leaves unexplained, of its steps from sample to sample, and its correlation over an answer of T1.
struct Left {
    white: f64,
    slow: f64,
    slow_time: f64,
}

impl Left {
    /// White noise and a slow wander: e = w + s with cov(e, e') = var(s) over a few samples.
    fn of(recording: &Recording, heater: &Heater, done: &Diagnosed) -> anyhow::Result<Self> {
        let mut monitor = done.trained.monitor.clone();
        let e: Vec<f64> = heater
            .samples
            .iter()
            .filter_map(|sample| {
                let (seen, report) = monitor.step(sample);
                Some(f64::from(seen.sample.t1.good()? - report.likelihood.expected[1]?))
            })
            .skip(60)
            .collect();
        ensure!(e.len() > 100, "{} samples are too few to say what noise there is", e.len());
        let mean = e.iter().sum::<f64>() / e.len() as f64;
        let lag = |k: usize| {
            let pairs = e.iter().zip(&e[k..]).map(|(a, b)| (a - mean) * (b - mean));
            pairs.sum::<f64>() / (e.len() - k) as f64
        };
        let (variance, one, two) = (lag(0), lag(1), lag(2));
        // What is correlated falls by the same share each sample: back to lag 0 it is the wander, the rest is white.
        let share = (two / one).clamp(0.05, 0.9999);
        let slow = (one / share).clamp(0.0, variance);
        let degc = f64::from(recording.units.celsius);
        Ok(Self {
            white: (variance - slow).max(0.0).sqrt() * degc,
            slow: slow.sqrt() * degc,
            slow_time: -recording.sample_time / share.ln(),
        })
    }
}

/// A value that is written with another one, by more than this share of it, is told.
const MOVED: f64 = 0.01;

/// The rig as a scenario without faults, and what of it no simulated rig can have.
fn scenario(recording: &Recording, heater: &Heater, done: &Diagnosed) -> anyhow::Result<(String, String)> {
    let model = &done.trained.model;
    let left = Left::of(recording, heater, done)?;
    let number = |x: f64| format!("{:?}", format!("{x:.4}").parse::<f64>().unwrap_or(x));
    let mut text = format!(
        "# Fitted to {} ({}) by pt326 fit-rig: {:.1} % of T1 explained.\n\
         duration = {}\nfault = []\n\n[rig]\n",
        recording.file,
        heater.map,
        done.trained.fit,
        number((recording.len() as f64 * recording.sample_time).max(1.0)),
    );
    let mut beyond = String::new();
    let mut put = |text: &mut String, name: &str, value: f64, [low, high]: [f64; 2]| {
        let kept = value.clamp(low, high);
        let _ = writeln!(text, "{name} = {}", number(kept));
        if (value - kept).abs() > MOVED * kept.abs() {
            let _ = writeln!(
                beyond,
                "{name} is {} in the recording, and a simulated rig has {low} to {high}: written as {}, so it answers otherwise.",
                number(value),
                number(kept)
            );
        }
    };
    put(&mut text, "gain", model.gain.into(), [0.001, 100.0]);
    put(&mut text, "heater_time", model.heater.into(), [0.01, 1000.0]);
    put(&mut text, "dead_time", model.dead_time.into(), [0.0, 60.0]);
    put(&mut text, "t1_lag", model.lag.into(), [0.001, 100.0]);
    if heater.inputs.t2 {
        put(&mut text, "t2_lag", model.lag2.into(), [0.001, 100.0]);
        put(&mut text, "t2_delay", model.transport.into(), [0.0, 60.0]);
        put(&mut text, "heat_loss", 1.0 - f64::from(model.reaches), [0.0, 0.9]);
    }
    put(&mut text, "white_noise", left.white, [0.0, 10.0]);
    put(&mut text, "turbulence", left.slow, [0.0, 10.0]);
    put(&mut text, "turbulence_time", left.slow_time, [0.001, 100.0]);
    text += "\n[rig.wall]\n";
    put(&mut text, "t1_share", model.wall_share.into(), [0.0, 0.5]);
    put(&mut text, "time", model.wall.into(), [0.1, 1e4]);
    Ok((text, beyond))
}
