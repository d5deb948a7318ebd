//! Which faults can be told apart on a rig, and from which size on.
//!
//! The instrument learns the rig as in any run. From then on faults are assumed to begin at several times, and their signatures under the
//! power that is really applied say how far each is from each other fault, of whatever size, after some seconds.

pub mod distance;
pub mod output;

use anyhow::bail;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::likelihood::inputs::Inputs;
use fdi_core::likelihood::signatures::{Candidate, Signatures};
use fdi_core::likelihood::{LikelihoodState, Readiness};
use fdi_core::{Command, Config, FaultClass, Instrument, Mode, Monitor, Observed, RawSample, Report, Tick};
use indicatif::ProgressBar;
use rayon::prelude::*;

use crate::experiment::scenario::Scenario;
use crate::experiment::{self, Backend};
use distance::{Distance, Information, Products};

/// Two faults that are as likely beforehand are told apart at odds of 20 to 1: a distance of ln 20. What is rare takes more.
pub const TOLD: f64 = 2.995_732_273_553_991;
/// An onset is assumed every so many ticks.
const EVERY: u32 = 100;

/// A fault with the sign of its magnitude.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// As the bank knows it.
    pub fault: Candidate,
    /// 1 or -1.
    pub sign: f64,
    /// Least and largest magnitude, without the sign.
    pub range: (f64, f64),
}

/// What a fault is to be told from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// No fault at all: it is to be seen.
    Nothing,
    /// Every other class, and nothing: it is to be named.
    All,
    /// A class, whichever of its faults and however large.
    Class(FaultClass),
}

/// From which size on a fault is told from something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Isolable {
    /// It is of the same class.
    Same,
    /// At no size that it can have.
    Never,
    /// At every size, or having none.
    Any,
    /// From this one on, in the unit of its class.
    Above(f64),
}

/// What is asked of a rig.
#[derive(Clone, Debug)]
pub struct Question {
    /// Seed of the run.
    pub seed: u64,
    /// Times within which a fault is to be told, since it first shows, s; the shortest first.
    pub horizons: Vec<f64>,
    /// What is rare is taken to be as likely beforehand as anything else.
    pub equal_odds: bool,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Isolability {
    /// The rows.
    pub faults: Vec<Asked>,
    /// The columns.
    pub rivals: Vec<From>,
    /// Times after which a fault is to be told, since it first shows, s.
    pub horizons: Vec<f64>,
    /// By horizon, row, column: medians over the onsets.
    pub told: Vec<Vec<Vec<Isolable>>>,
    /// Onsets that were assumed.
    pub onsets: usize,
    /// When the instrument began to watch, s.
    pub armed_at: f64,
}

/// An assumed onset under way.
struct Onset {
    signatures: Signatures,
    ticks: usize,
    products: Products,
    /// At the horizons that it has reached.
    reached: Vec<Information>,
}

impl Onset {
    fn new(signatures: Signatures) -> Self {
        Self { signatures, ticks: 0, products: Products::default(), reached: Vec::new() }
    }
}

/// Onsets assumed now and then, while an instrument goes on.
#[derive(Default)]
pub struct Onsets {
    sample_time: f64,
    horizons: Vec<f64>,
    armed: Option<u32>,
    onsets: Vec<Onset>,
    readiness: Readiness,
    /// Ticks that have passed.
    ticks: u32,
}

/// The instrument, with onsets assumed now and then.
struct Assuming {
    instrument: Instrument,
    onsets: Onsets,
    bar: ProgressBar,
}

impl Backend for Assuming {
    fn control(&mut self, raw: RawSample) -> Tick {
        Backend::control(&mut self.instrument, raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        self.bar.inc(1);
        let report = Backend::diagnose(&mut self.instrument, tick);
        self.onsets.look(&self.instrument, tick, &report);
        report
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Backend::command(&mut self.instrument, command)
    }

    fn baseline(&self) -> Option<Baseline> {
        Backend::baseline(&self.instrument)
    }
}

impl Onsets {
    /// For faults that are to be told within these times, s, the shortest first.
    pub fn new(sample_time: f64, horizons: &[f64]) -> Self {
        Self { sample_time, horizons: horizons.to_vec(), ..Self::default() }
    }

    /// A tick has passed.
    pub fn look(&mut self, instrument: &Instrument, tick: &Tick, report: &Report) {
        self.readiness = report.likelihood.readiness;
        self.ticks = tick.index.saturating_add(1);
        if tick.mode == Mode::Monitor && self.readiness == Readiness::Armed {
            self.gather(instrument.likelihood(), tick.index);
        } else {
            self.forget_those_under_way();
        }
    }

    /// What could have been told.
    ///
    /// # Errors
    /// Nothing was learnt, or it ended too soon after.
    pub fn found(mut self, question: &Question) -> anyhow::Result<Isolability> {
        self.forget_those_under_way();
        let began = self.armed.map(|tick| experiment::tick_time(tick, self.sample_time));
        let longest = self.horizons.last().copied().unwrap_or_default();
        match began {
            Some(armed_at) if !self.onsets.is_empty() => {
                Ok(Isolability::new(&self.onsets, question, Inputs::ALL, armed_at))
            }
            Some(at) => bail!(
                "it watched from {at:.0} s on: expected a duration of {:.0} s or more",
                at + longest + self.sample_time * f64::from(EVERY)
            ),
            None => {
                let lasted = f64::from(self.ticks) * self.sample_time;
                bail!("it learnt no models in {lasted:.0} s ({:?}): expected a longer run", self.readiness)
            }
        }
    }

    fn forget_those_under_way(&mut self) {
        self.onsets.retain(|onset| onset.reached.len() == self.horizons.len());
    }

    fn gather(&mut self, likelihood: &LikelihoodState, tick: u32) {
        let since = tick - *self.armed.get_or_insert(tick);
        if since.is_multiple_of(EVERY) {
            self.onsets.extend(Signatures::begin(likelihood).map(Onset::new));
        }
        for onset in self.onsets.iter_mut().filter(|onset| onset.reached.len() < self.horizons.len()) {
            let Some(columns) = onset.signatures.step(likelihood) else { continue };
            onset.products.add(&columns);
            onset.ticks += 1;
            let is_reached = |horizon: &f64| onset.ticks >= ticks(*horizon, self.sample_time);
            while self.horizons.get(onset.reached.len()).is_some_and(is_reached) {
                onset.reached.push(Information::new(
                    &onset.products,
                    &onset.signatures.nuisances(),
                    onset.signatures.kappa(),
                ));
            }
        }
    }
}

fn ticks(seconds: f64, sample_time: f64) -> usize {
    (seconds / sample_time).ceil().max(1.0) as usize
}

impl Isolability {
    /// Runs a scenario without its faults and finds what could have been told in it.
    ///
    /// # Errors
    /// A parameter of `config` out of bounds, or a run in which nothing was learnt or that ends too soon after.
    pub fn of(
        config: &Config,
        scenario: &Scenario,
        question: &Question,
        bar: &ProgressBar,
    ) -> anyhow::Result<Self> {
        let Question { seed, horizons, .. } = question;
        let config = experiment::with_prbs_phase(config, *seed);
        let sample_time = experiment::as_written(config.sample_time.0);
        let healthy = Scenario { faults: Vec::new(), ..scenario.clone() };
        let mut assuming = Assuming {
            instrument: Instrument::new(&config)?,
            onsets: Onsets::new(sample_time, horizons),
            bar: bar.clone(),
        };
        experiment::drive(&mut assuming, &config, &healthy, *seed, |_, _, _| ());
        assuming.onsets.found(question)
    }

    /// Lets a trained monitor look on and finds what could have been told. Its ticks are of `every` samples.
    ///
    /// # Errors
    /// There are too few samples.
    pub fn watched(
        monitor: &Monitor,
        samples: &[Observed],
        (inputs, sample_time, every): (Inputs, f64, u32),
        question: &Question,
    ) -> anyhow::Result<Self> {
        let mut monitor = monitor.clone();
        let mut onsets = Onsets::new(sample_time * f64::from(every), &question.horizons);
        for (sample, k) in samples.iter().zip(1..) {
            let (_, report) = monitor.step(&Observed { learn: false, ..*sample });
            if report.likelihood.readiness == Readiness::Armed && k % every == 0 {
                onsets.gather(monitor.likelihood(), k / every);
            }
        }
        onsets.forget_those_under_way();
        if onsets.onsets.is_empty() {
            bail!("{} samples are too few to say what could be told in them", samples.len());
        }
        Ok(Self::new(&onsets.onsets, question, inputs, 0.0))
    }

    fn new(onsets: &[Onset], question: &Question, inputs: Inputs, armed_at: f64) -> Self {
        let faults = asked(&told(&onsets[0], inputs));
        let rivals = rivals(&faults);
        let each: Vec<Vec<Vec<Vec<Isolable>>>> =
            onsets.par_iter().map(|onset| tell(onset, &rivals, inputs, question.equal_odds)).collect();
        let median = |h: usize, i: usize, j: usize| {
            let mut told: Vec<Isolable> = each.iter().map(|told| told[h][i][j]).collect();
            told.sort_by(|a, b| a.order().total_cmp(&b.order()));
            told[told.len() / 2]
        };
        let row = |h, i| (0..rivals.len()).map(|j| median(h, i, j)).collect();
        let table = |h| (0..faults.len()).map(|i| row(h, i)).collect();
        let told = (0..question.horizons.len()).map(table).collect();
        Self { faults, rivals, horizons: question.horizons.clone(), told, onsets: onsets.len(), armed_at }
    }
}

impl Isolable {
    /// The larger, the worse.
    fn order(self) -> f64 {
        match self {
            Self::Same | Self::Any => 0.0,
            Self::Above(size) => size.abs(),
            Self::Never => f64::INFINITY,
        }
    }
}

/// The faults that a rig with these inputs can have told.
fn told(onset: &Onset, inputs: Inputs) -> Vec<Candidate> {
    let candidates = onset.signatures.candidates().into_iter();
    let there = |which: &str| (inputs.t0 || which != "T0") && (inputs.t2 || which != "T2");
    candidates.filter(|candidate| inputs.tell(candidate.class) && there(candidate.which)).collect()
}

/// Every fault with either sign that it may have; what has no magnitude once.
fn asked(candidates: &[Candidate]) -> Vec<Asked> {
    let mut asked = Vec::new();
    for fault in candidates {
        let (low, high) = (f64::from(fault.range.0), f64::from(fault.range.1));
        for (sign, least, most) in [(1.0, low, high), (-1.0, -high, -low)] {
            let range = (least.max(0.0), most);
            if range.0 < range.1 {
                asked.push(Asked { fault: *fault, sign, range });
            }
        }
    }
    asked
}

/// Nothing, all together, and each class.
fn rivals(faults: &[Asked]) -> Vec<From> {
    let mut rivals = vec![From::Nothing, From::All];
    for asked in faults {
        let class = From::Class(asked.fault.class);
        if !rivals.contains(&class) {
            rivals.push(class);
        }
    }
    rivals
}

/// By horizon, fault, rival.
fn tell(onset: &Onset, rivals: &[From], inputs: Inputs, equal_odds: bool) -> Vec<Vec<Vec<Isolable>>> {
    let mut candidates = told(onset, inputs);
    if equal_odds {
        candidates.iter_mut().for_each(|candidate| candidate.prior = 0.0);
    }
    let faults = asked(&candidates);
    let row = |asked: &Asked, information: &Information| {
        let told = |rival: &From| asked.told(*rival, &candidates, information);
        rivals.iter().map(told).collect()
    };
    let table = |information| faults.iter().map(|asked| row(asked, information)).collect();
    onset.reached.iter().map(table).collect()
}

impl Asked {
    /// From which size on it is told from a rival.
    fn told(&self, rival: From, candidates: &[Candidate], information: &Information) -> Isolable {
        if rival == From::Class(self.fault.class) {
            return Isolable::Same;
        }
        let is_rival = |other: &&Candidate| match rival {
            From::Nothing => false,
            From::All => other.class != self.fault.class,
            From::Class(class) => other.class == class,
        };
        let others =
            candidates.iter().filter(is_rival).filter(|other| !other.differs_in_size_alone(&self.fault));
        let from_others = others
            .map(|other| (Distance::from_other(&self.fault, other, information), f64::from(other.prior)));
        let nothing = matches!(rival, From::Nothing | From::All)
            .then(|| (Distance::from_nothing(&self.fault, information), 0.0));
        let worst = from_others.chain(nothing).try_fold(self.range.0, |worst: f64, (distance, prior)| {
            let least = TOLD + prior - f64::from(self.fault.prior);
            Some(worst.max(distance.first_above(least, self.sign, self.range.0, self.range.1)?))
        });
        match worst {
            None => Isolable::Never,
            Some(worst) if worst <= self.range.0 => Isolable::Any,
            Some(_) if !self.fault.sized => Isolable::Never,
            Some(worst) => Isolable::Above(f64::from(self.fault.in_unit((self.sign * worst) as f32))),
        }
    }

    /// Its class and which of them, as tables name it.
    pub fn name(&self) -> String {
        let mut name = self.fault.class.name().to_owned();
        if !self.fault.which.is_empty() {
            name += &format!(" {}", self.fault.which);
        }
        if !self.sign_in_unit().is_empty() {
            name += &format!(" {}", self.sign_in_unit());
        }
        name
    }

    /// The sign of its size, where it has one: more of 1/f - 1 is less air.
    pub fn sign_in_unit(&self) -> &'static str {
        let size = self.fault.in_unit((self.sign * self.range.1) as f32);
        match self.fault.sized {
            true if size < 0.0 => "-",
            true => "+",
            false => "",
        }
    }
}
