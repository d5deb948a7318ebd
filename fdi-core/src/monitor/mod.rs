//! Diagnosis without control: temperatures and powers in, report out, for recordings and for rigs that something else controls.
//!
//! It is the instrument's own second half. A rig that is sampled far faster than it answers is looked at twice: sample by sample, for what
//! thermistors do, and by means of several, for what the process does. The second is fed with what the first says of the thermistors taken
//! away, so that each fault is told once.

mod anew;
mod gate;
mod one_rate;

use crate::config::Config;
use crate::diagnosis::Report;
use crate::diagnosis::baseline::Baseline;
use crate::error::{ConfigError, in_range};
use crate::likelihood::arbiter::of_two_rates;
use crate::likelihood::inputs::Inputs;
use crate::likelihood::interacting::{Found, Interacting};
use crate::likelihood::model::Model;
use crate::likelihood::{
    FaultClass, Finding, Fitted, LikelihoodReport, LikelihoodState, Readiness, RejectReason,
};
use crate::observation::Observation;
use crate::units::Seconds;
use gate::Gate;
use one_rate::OneRate;

/// What the units of a recording are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// degC for one unit of a temperature: 1, or for other units whatever makes the rises some 10 to 50.
    pub celsius: f32,
    /// The power that is 100 %, in its unit.
    pub full_power: f32,
}

impl Default for Units {
    fn default() -> Self {
        Self { celsius: 1.0, full_power: 100.0 }
    }
}

/// One sample. What is no number counts as missing, and so does a level that no rig can have, which is counted: see [`Monitor::implausible`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed {
    /// Temperatures of the ambient, at the heater's outlet and behind that; `None` where there is none.
    pub t: [Option<f32>; 3],
    /// What drives the heater from this sample to the next; `None`: as before.
    pub power: Option<f32>,
    /// What drives a heater beside it.
    pub beside: Option<f32>,
    /// Level of the fan as announced, %; `None`: as before.
    pub fan: Option<f32>,
    /// Supply of the heater, share of the nominal voltage; `None`: as before.
    pub supply: Option<f32>,
    /// All is well, so that this sample may be learnt from. The first of them after others begins a learning: what was learnt before is given up.
    pub learn: bool,
}

/// What each number of an [`Observed`] is called, in the order of [`Monitor::implausible`].
pub const OBSERVED: [&str; QUANTITIES] = ["T0", "T1", "T2", "power", "power beside", "fan", "supply"];

/// Temperatures, powers, fan and supply.
const QUANTITIES: usize = 7;

impl Observed {
    fn quantities(&self) -> [Option<f32>; QUANTITIES] {
        let [t0, t1, t2] = self.t;
        [t0, t1, t2, self.power, self.beside, self.fan, self.supply]
    }
}

/// A diagnosis that only looks on.
///
/// ```
/// use fdi_core::likelihood::inputs::Inputs;
/// use fdi_core::{Config, Monitor, Observed, Units};
///
/// let inputs = Inputs { t0: false, t2: false, fan: false, ..Inputs::ALL };
/// let mut monitor = Monitor::new(&Config::default(), inputs, Units::default())?;
/// let (_, report) = monitor.step(&Observed { t: [None, Some(35.0), None], power: Some(40.0), learn: true, ..Observed::default() });
/// assert!(report.likelihood.finding.is_none()); // nothing learnt yet, so nothing claimed
/// # Ok::<(), fdi_core::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Monitor {
    gate: Gate,
    fast: OneRate,
    slow: Option<Slow>,
    asked: Option<Asked>,
}

/// What is asked of an alarm, since which tick, and whether it still stands.
#[derive(Clone, Debug)]
struct Asked {
    bank: Interacting,
    since: u32,
    stands: bool,
}

/// The look at means of several samples.
#[derive(Clone, Debug)]
struct Slow {
    rate: OneRate,
    every: u32,
    gathered: Gathered,
    /// A thermistor is said to read wrong.
    corrected: bool,
    said: LikelihoodReport,
    /// What the model of the samples has taken over this one owes, from the next whole mean on: sums of it so far.
    owed: Option<Owed>,
}

/// Sums over a mean of what the model of the samples has that its power did not give: heat at T1, air and wall, %.
#[derive(Clone, Copy, Debug, Default)]
struct Owed {
    begun: bool,
    sums: [f32; 3],
}

/// Sums of what will be one sample, and of how many each.
#[derive(Clone, Copy, Debug, Default)]
struct Gathered {
    count: u32,
    learn: bool,
    sums: [(f32, f32); QUANTITIES],
}

impl Gathered {
    fn add(&mut self, o: &Observed) {
        self.learn = o.learn && (self.learn || self.count == 0);
        self.count += 1;
        for ((sum, count), x) in self.sums.iter_mut().zip(o.quantities()) {
            if let Some(x) = x {
                *sum += x;
                *count += 1.0;
            }
        }
    }

    fn forget_temperatures(&mut self) {
        let [t0, t1, t2, ..] = &mut self.sums;
        [*t0, *t1, *t2] = [(0.0, 0.0); 3];
    }

    fn mean(&self) -> Observed {
        let [t0, t1, t2, power, beside, fan, supply] =
            self.sums.map(|(sum, count)| (count > 0.0).then_some(sum / count));
        Observed { t: [t0, t1, t2], power, beside, fan, supply, learn: self.learn }
    }
}

impl Monitor {
    /// A monitor that has seen nothing.
    ///
    /// # Errors
    /// The setting, or the unit, that is out of bounds.
    pub fn new(config: &Config, inputs: Inputs, units: Units) -> Result<Self, ConfigError> {
        Ok(Self {
            gate: Gate::default(),
            fast: OneRate::new(config, inputs, units)?,
            slow: None,
            asked: None,
        })
    }

    /// The same, which looks at means of `every` samples as well.
    ///
    /// # Errors
    /// The same.
    pub fn with_means(self, config: &Config, every: u32) -> Result<Self, ConfigError> {
        in_range("every", every as f32, 2.0, 1e6)?;
        let sample_time = Seconds(config.sample_time.0 * every as f32);
        let config = Config { sample_time, ..config.clone() };
        let inputs = Inputs { since: true, ..self.fast.inputs() };
        let rate = OneRate::new(&config, inputs, self.fast.units())?;
        let (gathered, said) = (Gathered::default(), LikelihoodReport::default());
        Ok(Self { slow: Some(Slow { rate, every, gathered, corrected: false, said, owed: None }), ..self })
    }

    /// One sample: what is believed of it, and the report on it.
    pub fn step(&mut self, observed: &Observed) -> (Observation, Report) {
        let observed = &self.gate.step(observed, self.fast.units());
        let (mut seen, mut report) = self.fast.step(observed);
        [.., seen.known.supply_lost] = self.gate.refused;
        if let Some(slow) = &mut self.slow {
            slow.step(observed, report.likelihood.finding, self.fast.added());
            report.likelihood = slow.together(report.likelihood);
        }
        self.ask(seen.index, &mut report.likelihood);
        (seen, report)
    }

    /// While an alarm stands: is it over, from whatever state, or does the heater give what nobody asks for? Asked of samples, for both looks. An alarm that
    /// has ended by itself leaves a model that may not be where the rig is: the bank goes on until it knows.
    fn ask(&mut self, tick: u32, report: &mut LikelihoodReport) {
        let asks = self.fast.asks() || self.slow.as_ref().is_some_and(|slow| slow.rate.asks());
        // What the filters of faults know of one alarm is wrong of the next.
        let another = asks && self.asked.as_ref().is_some_and(|asked| !asked.stands);
        if self.fast.inputs().t2 || !self.fast.is_watched() || another {
            self.asked = None;
        }
        if self.asked.is_none() && asks {
            self.asked = self.fast.bank().map(|bank| Asked { bank, since: tick, stands: true });
        }
        let Some(asked) = &mut self.asked else { return };
        asked.stands = asks;
        match self.fast.ask(&mut asked.bank) {
            Found::HeaterOn if asks => {
                let onset = report.finding.map_or(asked.since, |finding| finding.onset);
                let confidence = self.fast.certain();
                let class = FaultClass::HeaterPower;
                report.finding = Some(Finding { class, confidence, magnitude: None, onset });
            }
            Found::Nothing | Found::HeaterOn => {}
            Found::Over => {
                let added = self.fast.added();
                self.fast.end_as_found(&asked.bank, [0.0; 3]);
                if let Some(slow) = &mut self.slow {
                    let own = slow.rate.added();
                    slow.rate.end_as_found(&asked.bank, core::array::from_fn(|i| added[i] - own[i]));
                    slow.owed = Some(Owed::default());
                    slow.is_over();
                }
                self.asked = None;
            }
        }
    }

    /// Samples so far of each of [`OBSERVED`] that no rig can have given: they counted as not known. Of fan and supply the last level that was one
    /// stands in for them.
    pub fn implausible(&self) -> [u32; QUANTITIES] {
        self.gate.refused
    }

    /// Is armed with models that were fitted elsewhere, to samples and to means where it looks at these; the next sample is the first of a recording.
    ///
    /// # Errors
    /// Why one cannot be trusted.
    pub fn take(&mut self, samples: &Fitted, means: Option<&Fitted>) -> Result<(), RejectReason> {
        self.fast.take(samples)?;
        match (&mut self.slow, means) {
            (Some(slow), Some(means)) => slow.rate.take(means),
            _ => Ok(()),
        }
    }

    /// The next sample is the first of another recording of the same rig.
    pub fn resume(&mut self) {
        self.gate.resume();
        self.fast.resume();
        if let Some(slow) = &mut self.slow {
            slow.rate.resume();
            slow.gathered = Gathered::default();
            slow.owed = None;
        }
    }

    /// What was learnt, by the means where they are looked at; its degC and % are those of [`Units`].
    pub fn model(&self) -> Option<Model> {
        self.slow.as_ref().map_or_else(|| self.fast.model(), |slow| slow.rate.model())
    }

    /// What the signatures take for normal.
    pub fn baseline(&self) -> Option<&Baseline> {
        self.fast.baseline()
    }

    /// The memory of the likelihood diagnosis, for those who ask what it could tell: of the means where they are looked at.
    pub fn likelihood(&self) -> &LikelihoodState {
        self.slow.as_ref().map_or_else(|| self.fast.likelihood(), |slow| slow.rate.likelihood())
    }
}

impl Slow {
    fn step(&mut self, observed: &Observed, fast: Option<Finding>, added: [f32; 3]) {
        let mut observed = *observed;
        let mut corrected = false;
        if let Some(Finding { class, magnitude: Some(magnitude), .. }) = fast {
            let [t0, t1, t2] = &mut observed.t;
            let reads_wrong = match class {
                FaultClass::T0Fault => t0,
                FaultClass::T1Offset => t1,
                FaultClass::T2Offset => t2,
                _ => &mut None,
            };
            corrected = reads_wrong.is_some();
            *reads_wrong = reads_wrong.map(|t| t - magnitude.value);
        }
        // What has just been found out was so for some samples: none of them may be in a mean with those that are right.
        if core::mem::replace(&mut self.corrected, corrected) != corrected {
            self.gathered.forget_temperatures();
        }
        if let Some(owed) = &mut self.owed {
            owed.begun |= self.gathered.count == 0;
            owed.sums.iter_mut().zip(added).filter(|_| owed.begun).for_each(|(sum, added)| *sum += added);
        }
        self.gathered.add(&observed);
        if self.gathered.count >= self.every {
            let mean = core::mem::take(&mut self.gathered).mean();
            self.said = self.rate.step(&mean).1.likelihood;
            if let Some(owed) = self.owed.take_if(|owed| owed.begun) {
                self.rate.catch_up(owed.sums.map(|sum| sum / self.every as f32));
                self.is_over();
            }
        }
    }

    /// What alarm it had is over.
    fn is_over(&mut self) {
        (self.said.alarm, self.said.finding) = (false, None);
    }

    /// What both say: of thermistors the look at each sample, of the process that at means.
    fn together(&self, fast: LikelihoodReport) -> LikelihoodReport {
        let readiness = if fast.readiness == Readiness::Armed { self.said.readiness } else { fast.readiness };
        let at_means =
            |finding: Finding| Finding { onset: finding.onset.saturating_mul(self.every), ..finding };
        let by_means = self.said.finding.map(at_means);
        LikelihoodReport {
            readiness,
            alarm: fast.alarm || self.said.alarm,
            restarts: fast.restarts.saturating_add(self.said.restarts),
            finding: of_two_rates(fast.finding, by_means),
            expected: fast.expected.map(|expected| expected.filter(|_| readiness == Readiness::Armed)),
            ..fast
        }
    }
}
