//! What of a recording is learnt, and how well: the same training with several answer times, of which the best is kept.

use std::ops::Range;

use anyhow::{Context, bail, ensure};
use fdi_core::likelihood::model::Model;
use fdi_core::likelihood::{Readiness, RejectReason};
use fdi_core::{Celsius, Config, Monitor, Observed, Seconds};

use super::{Heater, Recording, span};

/// Answer times that are tried, samples.
const ANSWERS: [f64; 7] = [10.0, 20.0, 40.0, 80.0, 160.0, 320.0, 640.0];
/// A training takes at least so many answers.
const LEAST_ANSWERS: f64 = 2.0;
/// Shares of the samples that the model is fitted to, and that its noise is learnt from.
const FITTED: f64 = 0.6;
const CHECKED: f64 = 0.35;
/// Fewer samples are no training.
const LEAST: usize = 60;
/// A power whose values are within so much of its full one never changes.
const STILL: f64 = 1e-3;
/// A rig that answers over more samples than this is looked at by means, too.
const MOST_SAMPLES: f64 = 20.0;
/// Samples that the intercept is taken from come before a fit is judged.
const SETTLED: usize = 60;

/// A trained monitor.
#[derive(Clone, Debug)]
pub struct Trained {
    /// It has seen nothing yet.
    pub fresh: Monitor,
    /// It has seen the training alone.
    pub monitor: Monitor,
    /// The settings at the sample time.
    pub config: Config,
    /// Of so many samples there are means, for the process; 1: there are none.
    pub every: u32,
    /// What it learnt.
    pub model: Model,
    /// How much of the training the model explains when it is simulated, %.
    pub fit: f64,
}

/// Learns from some samples of a heater.
///
/// # Errors
/// Why nothing can be learnt from them.
pub fn train(
    recording: &Recording,
    heater: &Heater,
    samples: &[Observed],
    config: &Config,
) -> anyhow::Result<Trained> {
    let usual = identifiable(recording, samples)?;
    let settings = |every: u32, answer: f64| {
        let count = samples.len() / every as usize;
        settings(config, recording.sample_time, f64::from(every), count, answer, usual)
    };
    let monitor = |config: &Config| Monitor::new(config, heater.inputs, recording.units);
    let fast = best_of(recording, samples, 1, |answer| {
        let config = settings(1, answer);
        Ok((monitor(&config)?, config))
    })?;
    let every = (fast.residence(recording.sample_time) / MOST_SAMPLES) as u32;
    if every < 2 {
        return Ok(fast);
    }
    let slow = best_of(recording, samples, every, |answer| {
        let means = settings(every, answer);
        Ok((monitor(&fast.config)?.with_means(&means, every)?, means))
    });
    // Without the look at means the process is not watched as closely, but its thermistors are.
    Ok(slow.map(|slow| Trained { every, config: fast.config.clone(), ..slow }).unwrap_or(fast))
}

/// Trains with each answer time that the samples are long enough for, and keeps what explains most.
fn best_of(
    recording: &Recording,
    samples: &[Observed],
    every: u32,
    make: impl Fn(f64) -> anyhow::Result<(Monitor, Config)>,
) -> anyhow::Result<Trained> {
    let (mut refusals, mut best) = (Vec::new(), None::<Trained>);
    for answer in ANSWERS {
        let answered = answer * f64::from(every);
        if samples.len() as f64 <= LEAST_ANSWERS * answered {
            break;
        }
        let (mut monitor, config) = make(answer)?;
        let fresh = monitor.clone();
        match learn(&mut monitor, samples) {
            Ok((model, fit)) if best.as_ref().is_none_or(|best| fit > best.fit) => {
                best = Some(Trained { fresh, monitor, config, every: 1, model, fit });
            }
            Ok(_) => {}
            Err(why) => {
                refusals.push(format!("{why} with an answer of {:.3} s", answered * recording.sample_time))
            }
        }
    }
    best.with_context(|| {
        format!("nothing can be learnt from these {} samples: {}", samples.len(), refusals.join("; "))
    })
}

impl Trained {
    /// Samples of its first thermistor's answer.
    fn residence(&self, sample_time: f64) -> f64 {
        f64::from(self.model.heater + self.model.lag + self.model.dead_time) / sample_time
    }
}

/// How much of the temperature of some samples the trained model explains when it is simulated from the first of all on, %.
pub fn fit(trained: &Monitor, samples: &[Observed], judged: Range<usize>) -> f64 {
    let mut monitor = trained.clone();
    monitor.resume();
    let first = judged.start.max(SETTLED);
    let simulate = |sample: &Observed| {
        let (seen, report) = monitor.step(&Observed { learn: false, ..*sample });
        Some([seen.sample.t1.good()?, report.likelihood.expected[1]?].map(f64::from))
    };
    let pairs: Vec<[f64; 2]> = samples.iter().take(judged.end).map(simulate).skip(first).flatten().collect();
    let mean = pairs.iter().map(|[y, _]| y).sum::<f64>() / pairs.len() as f64;
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(|pair| of(pair).powi(2)).sum::<f64>().sqrt();
    100.0 * (1.0 - sum(&|[y, model]| y - model) / sum(&|[y, _]| y - mean))
}

/// What hinders a model, or about how many degC there are for a %.
fn identifiable(recording: &Recording, samples: &[Observed]) -> anyhow::Result<f64> {
    ensure!(samples.len() >= LEAST, "{} samples are too few to learn from, expected {LEAST}", samples.len());
    let span = |of: &dyn Fn(&Observed) -> Option<f32>| span(samples.iter().filter_map(of));
    let (low, high) = span(&|sample| sample.power);
    let full = f64::from(recording.units.full_power);
    if !(high - low > STILL * full) {
        let at = if low > high { "it is missing".to_owned() } else { format!("it is {low} in every sample") };
        bail!(
            "cannot be identified from this: the power never changes ({at}), so that what it warms and what is warm anyway look alike. \
             Train on a part where it moves; if the rig was cold and off before the first sample, say --from-rest"
        );
    }
    ensure!(
        high <= 1.001 * full && low >= -0.001 * full,
        "power goes from {low} to {high}, expected 0 to {full}: say --full-power"
    );
    let (cold, hot) = span(&|sample| sample.t[1]);
    ensure!(hot > cold, "cannot be identified from this: T1 never changes");
    Ok((f64::from(recording.units.celsius) * (hot - cold) / (100.0 * (high - low) / full)).clamp(1e-3, 50.0))
}

fn settings(config: &Config, sample_time: f64, every: f64, count: usize, answer: f64, usual: f64) -> Config {
    let mut config = config.clone();
    let seconds = |samples: f64| Seconds((samples * every * sample_time) as f32);
    config.identification.answer_time = seconds(answer);
    config.identification.y_scale = Celsius((usual * f64::from(config.identification.u_scale.0)) as f32);
    config.identification.gain_max = (10.0 * usual) as f32;
    config.likelihood.fit_time = seconds((FITTED * count as f64).floor());
    config.likelihood.check_time = seconds((CHECKED * count as f64).floor());
    config.sample_time = Seconds(sample_time as f32);
    config
}

/// Feeds samples to be learnt from; gives the model and its fit, or why there is none.
fn learn(monitor: &mut Monitor, samples: &[Observed]) -> Result<(Model, f64), &'static str> {
    let mut readiness = Readiness::Untrained;
    for sample in samples {
        readiness = monitor.step(&Observed { learn: true, ..*sample }).1.likelihood.readiness;
    }
    match readiness {
        Readiness::Refused(why) => Err(words(why)),
        Readiness::Training | Readiness::Untrained => Err("too many samples are missing"),
        Readiness::Restarted => Err("what it learnt was no number"),
        Readiness::Armed => {
            let model = monitor.model().map(|model| (model, fit(monitor, samples, 0..samples.len())));
            model.filter(|(_, fit)| fit.is_finite()).ok_or("the model explains nothing")
        }
    }
}

/// Why a training was not accepted.
fn words(why: RejectReason) -> &'static str {
    match why {
        RejectReason::PoorFit => "the model leaves too much unexplained",
        RejectReason::DeadTime => "the dead time is longer than the model remembers",
        RejectReason::Gain => "more power does not warm",
        RejectReason::Unstable => "the model is unstable",
    }
}
