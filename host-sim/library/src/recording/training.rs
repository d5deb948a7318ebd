//! What of a recording is learnt, and how well: all samples at once ([`pt326_fit`]), at the sample time and, where the rig answers over many
//! samples, by means of several.

use std::ops::{Range, RangeInclusive};

use anyhow::{bail, ensure};
use fdi_core::likelihood::model::Model;
use fdi_core::likelihood::{Fitted, Parameter, Parameters, RejectReason};
use fdi_core::settings::Kind;
use fdi_core::{Celsius, Config, Finding, Monitor, Observed, Seconds};
use pt326_fit::{Found, Question};

use super::intervals::{self, Interval, UNKNOWN};
use super::{Heater, Recording, drive_from_here, span};

/// Fewer samples are no answer.
const LEAST_ANSWER: f64 = 10.0;
/// Shares of the samples that a board would fit its model to, and learn its noise from.
const FITTED: f64 = 0.6;
const CHECKED: f64 = 0.35;
/// Fewer samples are no training.
const LEAST: usize = 60;
/// A power whose values are within so much of its full one never changes.
const STILL: f64 = 1e-3;
/// A rig that answers over more samples than this is looked at by means, too.
const MOST_SAMPLES: f64 = 20.0;
/// Samples that the state is found from come before a fit is judged.
const SETTLED: usize = 60;
/// Longest sample time that the diagnosis knows, s: it sees a slower rig as a faster one.
const LONGEST_SAMPLE: f64 = 10.0;

/// A trained monitor.
#[derive(Clone, Debug)]
pub struct Trained {
    /// It has seen nothing yet.
    pub monitor: Monitor,
    /// The settings at the sample time.
    pub config: Config,
    /// Of so many samples there are means, for the process; 1: there are none.
    pub every: u32,
    /// What was learnt.
    pub model: Model,
    /// How much of the training the model explains when it is simulated, %.
    pub fit: f64,
    /// The same if the power of each sample had driven the heater up to it, where that explains much more.
    pub fit_with_power_before: Option<f64>,
    /// How well what was learnt is known.
    pub intervals: Vec<Interval>,
    /// What the samples do not tell, in words; the priors stand for it.
    pub unknown: Vec<&'static str>,
    /// What the model leaves of T1 at each sample that was learnt from, degC, in order: which sample, and how much.
    pub left: Vec<(usize, f32)>,
    /// The gain is known well enough to judge by it.
    pub tells_gain: bool,
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
    // How much has to be explained is for whoever reads the results to say: see `Trained::warning`.
    let mut tuning = *config.tuning;
    tuning.whitening.largest_unexplained = f32::MAX;
    let config = &Config { tuning: tuning.into(), ..config.clone() };
    let ask = |every: usize| Question {
        samples,
        inputs: heater.inputs,
        units: recording.units,
        config,
        usual,
        room: room(recording, heater),
        every,
    };
    let nothing = || {
        anyhow::anyhow!(
            "nothing can be learnt from these {} samples: there are too few without a gap",
            samples.len()
        )
    };
    let found = ask(1).fit(None).ok_or_else(nothing)?;
    let fit_with_power_before = fit_with_power_before(&ask(1), &found);
    let settings = |every: usize, theta: &pt326_fit::Theta| {
        let count = samples.len() / every;
        let answer = (pt326_fit::ANSWER * pt326_fit::residence(theta)).max(LEAST_ANSWER);
        settings(config, recording.sample_time, every as f64, count, answer, usual)
    };
    let fast = settings(1, &found.theta);
    let mut monitor = Monitor::new(&fast, heater.inputs, recording.units)?;
    let mut every = (pt326_fit::residence(&found.theta) / MOST_SAMPLES) as usize;
    let near = pt326_fit::in_ticks_of(every.max(1) as f64, &found.theta);
    let means = if every > 1 { ask(every).fit(Some(&near)) } else { None };
    match &means {
        Some(means) => {
            monitor = monitor.with_means(&settings(every, &means.theta), every as u32)?;
            monitor.take(&fitted(&found), Some(&fitted(means))).map_err(refused)?;
        }
        None => {
            every = 1;
            monitor.take(&fitted(&found), None).map_err(refused)?;
        }
    }
    let Some(model) = monitor.model() else { bail!("nothing can be learnt from these samples") };
    let unknown = unknown(&found, heater);
    ensure!(found.fit.is_finite(), "the model explains nothing");
    let (looked_at, tick) = (means.as_ref().unwrap_or(&found), every as f64 * recording.sample_time);
    let intervals = intervals::intervals(&model, looked_at, heater.inputs.t2, tick);
    Ok(Trained {
        monitor,
        config: fast,
        every: every as u32,
        model,
        fit: found.fit,
        fit_with_power_before,
        intervals,
        unknown,
        left: found.places.iter().copied().zip(found.left.iter().map(|(e, _)| e[0])).collect(),
        tells_gain: tells_gain(&found),
    })
}

/// The gain is known where its standard deviation is below this share of it, that of the time constant below this one, and the room is no further from what is
/// told of it, standard deviations. (Measured on 47 sessions of printers: 43 of those that it calls known are within 30 %.)
const GAIN_SD: f64 = 0.10;
const TIME_SD: f64 = 0.25;
const ROOM_OFF: f64 = 1.5;

fn tells_gain(found: &Found) -> bool {
    let slow = [Parameter::Heater, Parameter::Lag1].map(|which| which as usize);
    let slow = if found.theta[slow[0]] > found.theta[slow[1]] { slow[0] } else { slow[1] };
    let is_time_known = found.sd[slow] < TIME_SD && found.known[slow] < UNKNOWN;
    found.sd[Parameter::Gain as usize] < GAIN_SD && is_time_known && found.room_off.abs() < ROOM_OFF
}

/// A room is so warm where nothing says it, degC, with this standard deviation. What T1 reads first, within these bounds and with the heater off, says more.
const USUAL_ROOM: (f64, f64) = (25.0, 10.0);
const COLD: RangeInclusive<f32> = 5.0..=40.0;
const COLD_SD: f64 = 5.0;
/// Samples that are asked, how many of the powers, and the power that is off, a share of the full one.
const ASKED: usize = 10;
const ASKED_OF_POWER: usize = 3;
const OFF: f32 = 0.05;

/// What T1 reads without power in the end, degC: mean and standard deviation. Nothing is known of it in another unit.
fn room(recording: &Recording, heater: &Heater) -> Option<(f64, f64)> {
    if recording.units.celsius != 1.0 {
        return None;
    }
    let mut powers = heater.samples.iter().filter_map(|sample| sample.power).take(ASKED_OF_POWER);
    let is_off = powers.all(|power| power <= OFF * recording.units.full_power);
    let mut first: Vec<f32> = heater.samples.iter().filter_map(|sample| sample.t[1]).take(ASKED).collect();
    first.retain(|t| is_off && COLD.contains(t));
    first.sort_by(f32::total_cmp);
    Some(first.get(first.len() / 2).map_or(USUAL_ROOM, |t| (f64::from(*t), COLD_SD)))
}

/// A dead time of fewer samples is none: there the power of the sample itself may act.
const AT_ONCE: f64 = 0.1;
/// What is left then is less than this share of what is left otherwise.
const EXPLAINS_MORE: f64 = 0.8;

/// How much of T1 is explained where the power of each sample has driven the heater up to it, %. No dead time says that: it would be below zero.
fn fit_with_power_before(question: &Question, found: &Found) -> Option<f64> {
    if found.theta[Parameter::Delay1 as usize] > AT_ONCE {
        return None;
    }
    let mut samples = question.samples.to_vec();
    drive_from_here(&mut samples);
    let fit = Question { samples: &samples, ..*question }.fit(Some(&found.theta))?.fit;
    (100.0 - fit < EXPLAINS_MORE * (100.0 - found.fit)).then_some(fit)
}

/// A model that explains less, %, is warned about, and one that explains still less is none.
const WEAK: f64 = 60.0;
const POOR: f64 = 30.0;
/// The most confidence in what may as well not be.
const HALF: f32 = 0.5;

impl Trained {
    /// Whether what is said by this model is worth nothing.
    pub fn is_poor(&self) -> bool {
        !(self.fit >= POOR)
    }

    /// The warning, if there is one; `instead` says how to go on with a model that is worth nothing.
    ///
    /// # Errors
    /// It is worth nothing, and nobody said to go on.
    pub fn accepted(&self, force: bool, instead: &str) -> anyhow::Result<String> {
        let warning = self.warning().unwrap_or_default();
        ensure!(force || !self.is_poor(), "{warning}{instead}");
        Ok(warning)
    }

    /// Lowers the confidence of what is named to what the model is worth: no more than the share of T1 that it explains where that is little, and no more than
    /// a half where the gain is not known and the name rests on it, or where the interval of its size holds nought.
    pub fn calibrate(&self, finding: &mut Finding) {
        let explained = if self.fit < WEAK { self.fit.max(0.0) as f32 / 100.0 } else { 1.0 };
        let rests_on_gain = !self.tells_gain && finding.class.unit() != "degC";
        let holds_nought = finding.magnitude.is_some_and(|size| size.value.abs() <= size.half_width);
        let most = if rests_on_gain || holds_nought { explained.min(HALF) } else { explained };
        finding.confidence = finding.confidence.min(most);
    }

    /// What whoever reads the results must know of the model, the cause, and what to do next; none where it explains enough.
    pub fn warning(&self) -> Option<String> {
        let (cause, next) = match self.unknown.first() {
            _ if self.fit >= WEAK && self.tells_gain => return None,
            _ if self.fit >= WEAK => {
                return Some(
                    "The gain is not known from what was learnt: how much a heater gives cannot be judged, and its names have at most half of the confidence.\n\
                     Next: train on a part where the power moves further, with --train FROM:TO or --train-on RECORD.\n"
                        .into(),
                );
            }
            _ if self.model.gain < LEAST_GAIN => (
                "T1 does not get warmer by more power",
                "say which column is what with --map, or train on another part with --train FROM:TO",
            ),
            Some(unknown) => (
                *unknown,
                "train on a part where the power moves further, with --train FROM:TO or --train-on RECORD",
            ),
            None => (
                "something moves T1 that is not in the record: a room, a fan, a lid, another heater",
                "add what is known of it with --map t0=COLUMN, known=COLUMN or fan=COLUMN, or train on a quieter part with --train FROM:TO",
            ),
        };
        Some(format!(
            "The model explains {:.0} % of T1 where it was learnt, which is {}.\nCause: {cause}.\nNext: {next}.\n",
            self.fit,
            if self.is_poor() {
                "too little to say anything by it"
            } else {
                "little: take what follows with care"
            },
        ))
    }
}

/// A gain of less, degC per %, is none.
const LEAST_GAIN: f32 = 0.01;

/// The same for the diagnosis.
fn fitted(found: &Found) -> Fitted<'_> {
    Fitted {
        parameters: Parameters(found.theta.map(|x| x as f32)),
        curvature_sd: found.sd[Parameter::Curvature as usize] as f32,
        base: found.base as f32,
        left: &found.left,
    }
}

/// T1 of some samples, and what the trained model says of it when it is simulated from the first of all on.
fn simulated(trained: &Monitor, samples: &[Observed], judged: Range<usize>) -> Vec<[f64; 2]> {
    let mut monitor = trained.clone();
    let first = judged.start.max(SETTLED);
    let simulate = |sample: &Observed| {
        let (seen, report) = monitor.step(&Observed { learn: false, ..*sample });
        Some([seen.sample.t1.good()?, report.likelihood.expected[1]?].map(f64::from))
    };
    samples.iter().take(judged.end).map(simulate).skip(first).flatten().collect()
}

/// Half of T1 is within so much of the model: a fault does not move that, as long as it is not there for half of the time.
pub(super) fn off(trained: &Monitor, samples: &[Observed]) -> f64 {
    let pairs = simulated(trained, samples, 0..samples.len());
    let mut off: Vec<f64> = pairs.iter().map(|[y, model]| (y - model).abs()).collect();
    let middle = off.len() / 2;
    if off.is_empty() { f64::INFINITY } else { *off.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// How much of the temperature of some samples the trained model explains when it is simulated from the first of all on, %.
pub fn fit(trained: &Monitor, samples: &[Observed], judged: Range<usize>) -> f64 {
    let pairs = simulated(trained, samples, judged);
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
    let below =
        samples.iter().filter_map(|sample| sample.power).filter(|power| f64::from(*power) < -1e-3 * full);
    let count = below.count();
    ensure!(
        count == 0,
        "the power is below 0 in {count} of {} samples, down to {low}, and a heater takes none back: if it cools there, say --cooling",
        samples.len()
    );
    ensure!(high <= 1.001 * full, "power goes from {low} to {high}, expected 0 to {full}: say --full-power");
    let (cold, hot) = span(&|sample| sample.t[1]);
    ensure!(hot > cold, "cannot be identified from this: T1 never changes");
    Ok((f64::from(recording.units.celsius) * (hot - cold) / (100.0 * (high - low) / full)).clamp(1e-3, 50.0))
}

fn settings(config: &Config, sample_time: f64, every: f64, count: usize, answer: f64, usual: f64) -> Config {
    let mut config = config.clone();
    let seconds = |samples: f64| Seconds((samples * every * sample_time) as f32);
    // The diagnosis takes a slower rig for a faster one, and its settings have bounds.
    let slower = (every * sample_time / LONGEST_SAMPLE).max(1.0);
    let within = |setting: &str, time: Seconds| {
        let kind = Config::settings().find(|known| known.name == setting).map(|known| known.kind);
        let Some(Kind::Number { min, max }) = kind else { return time };
        Seconds(time.0.clamp(min * slower as f32, max * slower as f32))
    };
    config.identification.answer_time = within("identification.answer_time", seconds(answer));
    config.identification.y_scale = Celsius((usual * f64::from(config.identification.u_scale.0)) as f32);
    config.identification.gain_max = (10.0 * usual) as f32;
    let part = |share: f64| seconds((share * count as f64).floor());
    config.likelihood.fit_time = within("likelihood.fit_time", part(FITTED));
    config.likelihood.check_time = within("likelihood.check_time", part(CHECKED));
    config.sample_time = Seconds(sample_time as f32);
    config
}

/// Why a training was not accepted.
fn refused(why: RejectReason) -> anyhow::Error {
    let why = match why {
        RejectReason::PoorFit => "the model leaves too much unexplained",
        RejectReason::DeadTime => "the dead time is longer than the model remembers",
        RejectReason::Gain => "more power does not warm",
        RejectReason::Unstable => "the model is unstable",
    };
    anyhow::anyhow!("nothing can be learnt from these samples: {why}")
}

/// What the samples do not tell.
fn unknown(found: &Found, heater: &Heater) -> Vec<&'static str> {
    use Parameter::{Gain, Heater, Offset1, Reaches2};
    let mut told = vec![
        (Gain, "the gain is not known: the power hardly moved while T1 was steady"),
        (Heater, "the time constant is not known: the power hardly moved for as long as T1 takes to answer"),
    ];
    if !heater.inputs.t0 {
        told.push((
            Offset1,
            "what T1 reads without power is not known: it was never without, nor did the power move far",
        ));
    }
    if !heater.inputs.t2 {
        told.push((
            Reaches2,
            "what the heater beside does is not known: its power moved as the own one did, or hardly",
        ));
    }
    told.into_iter().filter(|(which, _)| found.known[*which as usize] > UNKNOWN).map(|(_, why)| why).collect()
}
