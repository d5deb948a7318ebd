//! Search for heat that should not be: random scenarios, each judged by the truth alone, the true temperatures of air and element against time.
//!
//! A [`Case`] is drawn from a number: a plant, what breaks, when, what its user does meanwhile, with which settings. [`Case::look`] runs it and says for how
//! long it was driven while it was too hot; of a healthy rig, whether it tripped. Nothing here knows why the instrument does what it does.

mod check;
mod draw;
mod random;
mod settings;

use std::fmt;
use std::ops::Range;

use anyhow::Context;
use fdi_core::{Command, Config, Instrument, Mode, TripReason};
use indicatif::{ParallelProgressIterator, ProgressBar};
use pt326_lab::{change, preset};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use crate::experiment::scenario::Scenario;
use crate::experiment::{as_written, drive};
pub use settings::Random;

/// Too hot is what is above the highest set-point's rise over a room of 20 degC by a third, and above the set-point by 25 degC: by default 80 degC at least.
const ROOM: f64 = 20.0;
const RISE: f64 = 4.0 / 3.0;
const ABOVE: f64 = 25.0;
/// The element is too hot if it is so many times as much warmer than the room as full power and nominal air make it.
const ELEMENT: f64 = 1.5;
/// One stretch of so many s, driven while it is too hot, is what must not be.
pub const HARMFUL: f64 = 10.0;

/// One drawn scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The number that it was drawn from; also the seed of the rig.
    pub number: u64,
    /// The settings that differ from the defaults, as in a trace.
    pub settings: String,
    /// A board's self-test goes before it, and its finding is obeyed.
    #[serde(default)]
    pub checked: bool,
    /// Nothing is broken: then nothing may trip, but for a set-point that is out of reach.
    pub healthy: bool,
    /// What happens.
    pub scenario: Scenario,
}

/// What became of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Longest stretch that it was driven with air, or an element, that was too hot, s.
    pub air_s: f64,
    /// The same of the element.
    pub element_s: f64,
    /// Hottest air while it was driven, degC.
    pub hottest: f64,
    /// The first trip, and when, s.
    pub trip: Option<(f64, TripReason)>,
    /// Its self-test has failed, so that it was not armed.
    pub refused: bool,
    /// The longest that it was driven on after the first fault began, s.
    pub driven_s: f64,
}

impl Outcome {
    /// What must not be.
    pub fn is_harmful(&self) -> bool {
        self.air_s > HARMFUL
    }
}

/// Ticks in a row, as s.
#[derive(Default)]
struct Stretch {
    now: f64,
    longest: f64,
}

impl Stretch {
    fn add(&mut self, goes_on: bool, span: f64) {
        self.now = if goes_on { self.now + span } else { 0.0 };
        self.longest = self.longest.max(self.now);
    }
}

impl Case {
    /// The settings.
    ///
    /// # Errors
    /// What is no setting.
    pub fn config(&self) -> anyhow::Result<Config> {
        let mut config = Config::default();
        change::apply(&mut config, &self.settings)?;
        Ok(preset::with_prbs_phase(&config, self.number))
    }

    /// Runs it.
    ///
    /// # Errors
    /// Settings that no instrument takes.
    pub fn look(&self) -> anyhow::Result<Outcome> {
        let config = self.config()?;
        let mut instrument = Instrument::new(&config).context(self.settings.clone())?;
        if self.checked {
            let Some(gain) = check::passes(&config, &self.scenario, self.number)? else {
                return Ok(Outcome { refused: true, ..Outcome::default() });
            };
            instrument.command(Command::Gain(gain))?;
        }
        let ts = as_written(config.sample_time.0);
        let rig = &self.scenario.rig;
        let hot = ROOM + RISE * (f64::from(config.supervisor.setpoint_max.0) - ROOM);
        let glowing = ELEMENT * (1.0 + pt326_rig::ELEMENT_OVER_AIR) * rig.gain * 100.0;
        let begins = self.scenario.faults.iter().map(|fault| fault.at).fold(f64::MAX, f64::min);
        let (mut air, mut element, mut driven) = <(Stretch, Stretch, Stretch)>::default();
        let mut outcome = Outcome::default();
        let mut t = 0.0;
        drive(&mut instrument, &config, &self.scenario, self.number, |row, rig_now, _| {
            let (is_driven, [at_t1, _]) = (row.applied.0 > 0.0, rig_now.air());
            let limit = hot.max(f64::from(row.tick.setpoint.0) + ABOVE);
            air.add(is_driven && at_t1 > limit, ts);
            element.add(is_driven && rig_now.element() - rig.ambient > glowing, ts);
            driven.add(row.tick.mode.is_heating() && t >= begins, ts);
            if is_driven {
                outcome.hottest = outcome.hottest.max(at_t1);
            }
            if let (Mode::Tripped(trip), None) = (&row.tick.mode, outcome.trip) {
                outcome.trip = Some((t, trip.reason));
            }
            t += ts;
        });
        (outcome.air_s, outcome.element_s, outcome.driven_s) = (air.longest, element.longest, driven.longest);
        Ok(outcome)
    }

    /// It tripped though nothing is broken.
    pub fn is_false_trip(&self, outcome: &Outcome) -> bool {
        let excused = |reason| reason == TripReason::OutOfReach && !self.is_within_reach();
        self.healthy && outcome.trip.is_some_and(|(_, reason)| !excused(reason))
    }

    /// Whether full power reaches the highest set-point that is asked for, with 5 degC to spare.
    fn is_within_reach(&self) -> bool {
        let Ok(config) = self.config() else { return true };
        let asked = self.scenario.actions.iter().filter_map(|action| action.setpoint);
        let highest = asked.fold(config.setpoint.0, f32::max);
        let rig = &self.scenario.rig;
        rig.ambient + rig.gain * f64::from(config.pid.output_max.0) > f64::from(highest) + 5.0
    }
}

/// What a search found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Cases with a fault, and healthy ones.
    pub cases: [u64; 2],
    /// Of each, those that were not armed since their check failed.
    pub refused: [u64; 2],
    /// Of the first, those that were harmful; those whose element was too hot for as long.
    pub harmful: u64,
    /// The same by the element.
    pub glowing: u64,
    /// Of the second, those that tripped.
    pub false_trips: Vec<(Case, Outcome)>,
    /// The worst of the first, worst first.
    pub worst: Vec<(Case, Outcome)>,
}

/// So many of the worst are kept.
const KEPT: usize = 10;

/// How bad it is.
fn badness(outcome: &Outcome) -> f64 {
    outcome.air_s + 1e-3 * outcome.element_s
}

impl Found {
    fn of(case: Case, outcome: Outcome) -> Self {
        let mut found = Self::default();
        found.cases[usize::from(case.healthy)] = 1;
        found.refused[usize::from(case.healthy)] = outcome.refused.into();
        if case.healthy {
            found.false_trips.extend(case.is_false_trip(&outcome).then_some((case, outcome)));
        } else {
            found.harmful = outcome.is_harmful().into();
            found.glowing = (outcome.element_s > HARMFUL).into();
            found.worst.extend((badness(&outcome) > 0.0).then_some((case, outcome)));
        }
        found
    }

    fn and(mut self, other: Self) -> Self {
        self.cases = [0, 1].map(|i| self.cases[i] + other.cases[i]);
        self.refused = [0, 1].map(|i| self.refused[i] + other.refused[i]);
        self.harmful += other.harmful;
        self.glowing += other.glowing;
        self.false_trips.extend(other.false_trips);
        self.worst.extend(other.worst);
        self.worst.sort_by(|a, b| badness(&b.1).total_cmp(&badness(&a.1)).then(a.0.number.cmp(&b.0.number)));
        self.worst.truncate(KEPT);
        self.false_trips.sort_by_key(|(case, _)| case.number);
        self
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([broken, healthy], [caught, refused]) = (self.cases, self.refused);
        writeln!(
            f,
            "{broken} with a fault: {caught} not armed by their check, {} driven for more than {HARMFUL} s with air that is too hot, {} with such an element",
            self.harmful, self.glowing
        )?;
        writeln!(
            f,
            "{healthy} healthy: {refused} not armed by their check, {} tripped",
            self.false_trips.len()
        )?;
        for (name, list) in [("worst", &self.worst), ("tripped", &self.false_trips)] {
            for (case, o) in list.iter().take(KEPT) {
                let trip =
                    o.trip.map_or("no trip".into(), |(t, reason)| format!("{} at {t:.1} s", reason.name()));
                let what: Vec<_> = case.scenario.faults.iter().map(pt326_rig::fault::Fault::label).collect();
                writeln!(
                    f,
                    "{name} {}: {:.1} s, element {:.1} s, at most {:.0} degC; {trip}; {}",
                    case.number,
                    o.air_s,
                    o.element_s,
                    o.hottest,
                    what.join(", ")
                )?;
            }
        }
        Ok(())
    }
}

/// Looks at every case of some numbers, on all cores; the result does not depend on how many there are.
///
/// # Errors
/// None is expected: it says which case could not be run.
pub fn search(numbers: Range<u64>, bar: &ProgressBar) -> anyhow::Result<Found> {
    let one = |number| {
        let case = Case::draw(number);
        let outcome = case.look().with_context(|| format!("case {number}"))?;
        Ok(Found::of(case, outcome))
    };
    let all = numbers.into_par_iter().progress_with(bar.clone()).map(one);
    all.try_reduce(Found::default, |a, b| Ok(a.and(b)))
}

#[cfg(test)]
mod tests;
