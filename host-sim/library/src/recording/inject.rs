//! Faults put into a recording: what T1 would have read, by the model that was learnt from it.
//!
//! A thermistor's fault is put on what was read. What the process does is the difference of two simulations, with the fault and without,
//! on top of what was read, so that all noise and surroundings stay those of the recording.

use fdi_core::likelihood::model::Model;
use fdi_core::{Monitor, Observed};
use serde::Serialize;

use super::run::Diagnosed;
use super::{Heater, Recording};

/// A kind of fault, of the size that the campaign's nominal one has beside its rig's rise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// T1 reads 12 % of its rise too high.
    Offset,
    /// T1 sees 85 % of its rise.
    Loss,
    /// The heater gives 80 % of the power.
    Power,
    /// The air flow is 126 % of what it was.
    Flow,
}

/// All of them, with the names that are right.
pub const KINDS: [(Kind, &[&str]); 4] = [
    (Kind::Offset, &["t1_offset"]),
    (Kind::Loss, &["t1_clogged"]),
    (Kind::Power, &["heater_power", "air_flow_or_heater_power"]),
    (Kind::Flow, &["air_flow", "air_flow_or_heater_power"]),
];

const OFFSET: f64 = 0.12;
const LOSS: f64 = 0.15;
const POWER: f64 = 0.8;
const FLOW: f64 = 1.26;
/// Forced convection (docs/diagnosis.md, section 1).
const FILM: f64 = 0.8;
/// Samples within which a fault counts as seen, besides the dead time; and within which it should have its name.
const SEEN: usize = 3;
const NAMED: usize = 60;

/// How the onsets of a kind were seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Injected {
    /// What was put in.
    pub kind: Kind,
    /// How often.
    pub onsets: usize,
    /// Alarms within three samples and the dead time, %.
    pub seen_pct: f64,
    /// Rightly named within 60 samples, %.
    pub named_pct: f64,
}

/// Two lags and a dead time, with an air flow.
struct Simulated {
    step: f64,
    lags: [f64; 2],
    gain: f64,
    delay: f64,
    states: [f64; 2],
    past: Vec<f64>,
}

impl Simulated {
    fn new(model: &Model, sample_time: f64, flow: f64, power: f64) -> Self {
        let film = flow.powf(FILM);
        let delay = f64::from(model.dead_time) / sample_time * (0.25 + 0.75 / flow);
        Self {
            step: 1.0 / film,
            lags: [f64::from(model.heater) / film, f64::from(model.lag)]
                .map(|t| 1.0 - (-sample_time / t).exp()),
            gain: f64::from(model.gain) * film / flow,
            delay,
            states: [power / film, power * film / flow / film],
            past: vec![power / film; delay.ceil() as usize + 2],
        }
    }

    fn tick(&mut self, power: f64) -> f64 {
        self.states[0] += self.lags[0] * (power * self.step - self.states[0]);
        self.past.rotate_right(1);
        self.past[0] = self.states[0];
        let whole = self.delay.floor() as usize;
        let part = self.delay - whole as f64;
        let air = (1.0 - part) * self.past[whole] + part * self.past[whole + 1];
        self.states[1] += self.lags[1] * (air - self.states[1]);
        self.gain * self.states[1]
    }
}

/// Puts each kind of fault in at `onsets` places after the training, one at a time.
pub fn inject(recording: &Recording, heater: &Heater, done: &Diagnosed, onsets: usize) -> Vec<Injected> {
    let samples = &heater.samples;
    let mut monitors: Vec<Monitor> = Vec::new();
    let mut monitor = done.trained.monitor.clone();
    for (k, sample) in samples.iter().enumerate() {
        if k >= done.watched_from {
            monitors.push(monitor.clone());
        }
        monitor.step(&Observed { learn: k < done.watched_from, ..*sample });
    }
    let model = &done.trained.model;
    let last = monitors.len().saturating_sub(NAMED + 1);
    let within = SEEN + (f64::from(model.dead_time) / recording.sample_time).ceil() as usize;
    let place = |i: usize| i * last / onsets.max(1);
    KINDS
        .into_iter()
        .map(|(kind, right)| {
            let (mut seen, mut named) = (0, 0);
            for i in 0..onsets {
                let onset = done.watched_from + place(i);
                let mut monitor = monitors[place(i)].clone();
                let readings = faulty(recording, model, samples, kind, onset);
                let said = samples[onset..].iter().zip(readings).map(|(sample, t1)| {
                    let observed = Observed { t: [sample.t[0], Some(t1 as f32), sample.t[2]], ..*sample };
                    monitor.step(&observed).1.likelihood
                });
                let said: Vec<_> = said.take(NAMED).collect();
                seen += usize::from(said.iter().take(within + 1).any(|likelihood| likelihood.alarm));
                let is_right = |name: &str| right.contains(&name);
                named +=
                    usize::from(said.iter().any(|l| l.finding.is_some_and(|f| is_right(f.class.name()))));
            }
            let percent = |count: usize| 100.0 * count as f64 / onsets.max(1) as f64;
            Injected { kind, onsets, seen_pct: percent(seen), named_pct: percent(named) }
        })
        .collect()
}

/// What T1 reads from an onset on with a fault.
fn faulty(recording: &Recording, model: &Model, samples: &[Observed], kind: Kind, onset: usize) -> Vec<f64> {
    let full = f64::from(recording.units.full_power);
    let powers: Vec<f64> =
        samples.iter().map(|sample| f64::from(sample.power.unwrap_or(0.0)) / full * 100.0).collect();
    let degc = f64::from(recording.units.celsius);
    let sample_time = recording.sample_time;
    let mut healthy = Simulated::new(model, sample_time, 1.0, powers[0]);
    let rises: Vec<f64> = powers.iter().map(|power| healthy.tick(*power)).collect();
    let mean = rises.iter().sum::<f64>() / rises.len() as f64;
    let mut broken = Simulated::new(model, sample_time, 1.0, powers[0]);
    for power in &powers[..onset] {
        broken.tick(*power);
    }
    if kind == Kind::Flow {
        let blown = Simulated::new(model, sample_time, FLOW, 0.0);
        broken =
            Simulated { states: broken.states, past: stretched(&broken.past, blown.past.len()), ..blown };
    }
    (onset..samples.len())
        .map(|k| {
            let read = f64::from(samples[k].t[1].unwrap_or(f32::NAN));
            let share = if kind == Kind::Power { POWER } else { 1.0 };
            let change = match kind {
                Kind::Offset => OFFSET * mean,
                Kind::Loss => -LOSS * rises[k],
                Kind::Power | Kind::Flow => broken.tick(share * powers[k]) - rises[k],
            };
            read + change / degc
        })
        .collect()
}

/// The past of the air as long as it has to be.
fn stretched(past: &[f64], length: usize) -> Vec<f64> {
    let mut past = past.to_vec();
    past.resize(length, past[past.len() - 1]);
    past
}
