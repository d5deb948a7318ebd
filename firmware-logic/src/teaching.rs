//! A fault that somebody makes on purpose beside the running board, repetition by repetition, until its row is saved or dropped.

use core::fmt;

use fdi_core::diagnosis::signature::{Signature, Symptoms};
use fdi_core::diagnosis::teach::{Repetition, Steady, common, tables, tells};
use fdi_core::likelihood::taught::{Changed, Mean, Response, put as put_response};
use fdi_core::name::Name;
use fdi_core::{Config, diagnosis::config::DiagnosisConfig};

/// Repetitions that there is room for.
const REPETITIONS: usize = 8;
/// Ticks of the shortest repetition: 2 s by the default sample time.
const SHORTEST: u32 = 18;

/// The fault may have been there for so many ticks when somebody says so: 5 s by the default sample time.
const LATE: u32 = 45;

/// What was shown so far.
#[derive(Clone, Debug, Default)]
pub struct Teaching {
    name: Name,
    repetitions: heapless::Vec<Steady, REPETITIONS>,
    current: Option<Repetition>,
    /// Ticks of it that had no symptoms.
    without: u32,
    /// What the likelihood diagnosis has seen in repetitions.
    seen: Mean,
}

/// What repetitions teach: a row, and why it cannot stand; what the likelihood diagnosis knows the fault by, or why it does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lesson {
    /// The row.
    pub row: Signature,
    /// Why it cannot stand.
    pub refused: Option<TeachError>,
    /// The response.
    pub response: Result<Response, TeachError>,
}

/// Why it cannot be taught.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TeachError {
    /// Symptoms are there only while it monitors.
    NotMonitoring,
    /// A repetition has begun already.
    Begun,
    /// None has begun, or monitoring has ended meanwhile.
    NotBegun,
    /// The repetition is too short to say anything.
    TooShort,
    /// One repetition does not say what comes again.
    Once,
    /// There is room for no more.
    Enough,
    /// Another name has repetitions that are neither saved nor dropped.
    Other(Name),
    /// There are no repetitions.
    Nothing,
    /// Nothing is certain that a rig without a fault does not show.
    Quiet,
    /// Some symptoms match this row of the isolation table, too: its place, from 1, and its number.
    Conflict(usize, u8),
    /// The tables are full.
    Full,
    /// The likelihood diagnosis has raised no alarm in some repetition, or too late.
    Unseen,
    /// Ten faults are taught.
    Ten,
}

impl fmt::Display for TeachError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotMonitoring => "only while it monitors, see `status`",
            Self::Begun => "a repetition is under way, expected `teach end` first",
            Self::NotBegun => "no repetition is under way, or monitoring has ended meanwhile",
            Self::TooShort => "that was too short, or too few of its ticks had symptoms, expected some 20 s",
            Self::Once => "one repetition does not say what comes again, expected three",
            Self::Enough => "that was enough, expected `teach save` or `teach drop`",
            Self::Other(name) => {
                return write!(f, "expected `teach save` or `teach drop` of {name} first");
            }
            Self::Nothing => "there is nothing yet, expected `teach NAME` first",
            Self::Quiet => "nothing of it is certain that a rig without a fault does not show",
            Self::Conflict(place, number) => {
                return write!(f, "some symptoms match row {place} of isolation, too (fiv {number})");
            }
            Self::Full => "the tables are full, expected `set diagnosis.isolation.N none` first",
            Self::Unseen => "in some repetition the likelihood diagnosis had no alarm that lasted 3 s",
            Self::Ten => "ten are taught, expected `set likelihood.taught.N none` first",
        })
    }
}

impl Teaching {
    /// What it is called.
    pub fn name(&self) -> Name {
        self.name
    }

    /// The repetitions so far.
    pub fn repetitions(&self) -> &[Steady] {
        &self.repetitions
    }

    /// A repetition begins after this tick; which one, from 1.
    ///
    /// # Errors
    /// One is under way; there are enough; another name is not done with.
    pub fn begin(&mut self, name: Name, tick: u32) -> Result<usize, TeachError> {
        match self.current {
            Some(_) => Err(TeachError::Begun),
            None if self.repetitions.is_full() => Err(TeachError::Enough),
            None if name != self.name && !self.repetitions.is_empty() => Err(TeachError::Other(self.name)),
            None => {
                self.name = name;
                self.current = Some(Repetition::begin(tick, LATE));
                self.without = 0;
                Ok(self.repetitions.len() + 1)
            }
        }
    }

    /// One tick, with its symptoms and what the likelihood diagnosis says that an alarm has changed, which is asked only in a repetition. Where nothing
    /// is monitored any more, what has begun is worth nothing; a tick without symptoms only counts.
    pub fn step(
        &mut self,
        monitors: bool,
        symptoms: Option<&Symptoms>,
        changed: impl FnOnce() -> Option<Changed>,
    ) {
        let Some(repetition) = &mut self.current else { return };
        if !monitors {
            self.current = None;
            return;
        }
        match symptoms {
            Some(symptoms) => repetition.push(symptoms),
            None => self.without = self.without.saturating_add(1),
        }
        if let Some(changed) = changed() {
            repetition.add(&changed);
        }
    }

    /// The repetition ends; what was steady in it, and whether the likelihood diagnosis saw it.
    ///
    /// # Errors
    /// None is under way; it was too short.
    pub fn end(&mut self) -> Result<(Steady, bool), TeachError> {
        let repetition = self.current.take().ok_or(TeachError::NotBegun)?;
        let judged = repetition.ticks() >= SHORTEST && repetition.ticks() / 9 >= self.without; // nine of ten
        let steady = repetition.steady().filter(|_| judged).ok_or(TeachError::TooShort)?;
        self.repetitions.push(steady).map_err(|_| TeachError::Enough)?;
        let effects = repetition.effects();
        if let Some(effects) = &effects {
            self.seen.add(effects);
        }
        Ok((steady, effects.is_some()))
    }

    /// What the repetitions teach, and the settings with as much of it as can stand. What was taught under this name before is kept where nothing
    /// new can take its place.
    ///
    /// # Errors
    /// There are no repetitions.
    pub fn proposed(&self, config: &Config) -> Result<(Config, Lesson), TeachError> {
        if self.repetitions.is_empty() {
            return Err(TeachError::Nothing);
        }
        let mut with = config.clone();
        let number = tables::make_room(&mut with.diagnosis, self.name);
        let row = Signature { number, pattern: common(&self.repetitions), name: self.name };
        let refused = put(&mut with.diagnosis, row).err();
        if refused.is_some() {
            with.diagnosis = config.diagnosis.clone();
        }
        let response = self.response().and_then(|response| {
            put_response(&mut with.likelihood.taught, response).map_err(|_| TeachError::Ten)?;
            Ok(response)
        });
        Ok((with, Lesson { row, refused, response }))
    }

    /// The mean of what the likelihood diagnosis has seen, if it has seen every repetition.
    fn response(&self) -> Result<Response, TeachError> {
        let mean = self.seen.value().filter(|_| self.seen.count as usize == self.repetitions.len());
        let response = mean.map(|effects| Response::new(self.name, &effects));
        response.filter(|response| !response.is_nothing()).ok_or(TeachError::Unseen)
    }
}

fn put(config: &mut DiagnosisConfig, row: Signature) -> Result<(), TeachError> {
    if !tells(&row.pattern) {
        return Err(TeachError::Quiet);
    }
    if let Some((place, other)) = tables::conflicts(config, row.pattern).next() {
        return Err(TeachError::Conflict(place, other.number));
    }
    tables::add(config, row).map_err(|_| TeachError::Full)
}

#[cfg(test)]
mod tests {
    use fdi_core::diagnosis::signature::Symptom;

    use super::*;

    const HIGH: Symptoms = [Symptom::High, Symptom::Normal, Symptom::Low, Symptom::Normal, Symptom::Normal];

    fn taught(without: u32) -> Result<Steady, TeachError> {
        let mut teaching = Teaching::default();
        teaching.begin("loose".parse().expect("a name"), 0).expect("nothing is under way");
        for k in 0..200 {
            teaching.step(true, (k % without != 0).then_some(&HIGH), || None);
        }
        teaching.end().map(|(steady, _)| steady)
    }

    #[test]
    fn a_contact_that_is_loose_now_and_then_can_be_taught_one_that_mostly_is_cannot() {
        let steady = taught(20).expect("190 of 200 ticks");
        assert_eq!((steady[0], steady[2]), (Some(Symptom::High), Some(Symptom::Low)));
        assert_eq!(taught(4), Err(TeachError::TooShort));
    }

    #[test]
    fn what_is_begun_is_worth_nothing_once_nothing_is_monitored() {
        let mut teaching = Teaching::default();
        teaching.begin("hand".parse().expect("a name"), 0).expect("nothing is under way");
        (0..100).for_each(|_| teaching.step(true, Some(&HIGH), || None));
        teaching.step(false, None, || None);
        assert_eq!(teaching.end(), Err(TeachError::NotBegun));
    }

    /// T2 too high is the paper's first row already; T1 and T2 of no symptom at all are none.
    #[test]
    fn what_one_diagnosis_refuses_the_other_may_take() {
        let (high, low, normal) = (Symptom::High, Symptom::Low, Symptom::Normal);
        let effects = core::array::from_fn(|i| if i == 4 { 1.5 } else { 0.0 });
        let shown = |symptoms: Symptoms, seen: &[bool]| {
            let mut teaching = Teaching::default();
            for seen in seen {
                teaching.begin("low".parse().expect("a name"), 0).expect("nothing is under way");
                (0..100).for_each(|_| {
                    teaching.step(true, Some(&symptoms), || seen.then_some(Changed { onset: 7, effects }))
                });
                assert_eq!(teaching.end().map(|(_, seen)| seen), Ok(*seen));
            }
            teaching.proposed(&Config::default()).expect("repetitions")
        };
        let (config, lesson) = shown([normal, low, normal, high, normal], &[true, true]);
        assert_eq!((lesson.refused, lesson.response.is_ok()), (Some(TeachError::Conflict(1, 1)), true));
        assert_eq!(config.likelihood.taught[0].effects, [0, 0, 0, 0, 150, 0, 0, 0, 0, 0, 0]);
        assert_eq!(config.diagnosis, Config::default().diagnosis);
        let (config, lesson) = shown([high; 5], &[true, false]);
        assert_eq!((lesson.refused, lesson.response), (None, Err(TeachError::Unseen)));
        assert_eq!((config.likelihood.taught.len(), config.diagnosis.isolation.len()), (0, 4));
        let (config, lesson) = shown([normal; 5], &[false]);
        assert_eq!((lesson.refused, lesson.response), (Some(TeachError::Quiet), Err(TeachError::Unseen)));
        assert_eq!(config, Config::default());
    }

    /// Somebody says so 5 s too late at most.
    #[test]
    fn an_alarm_that_stood_before_is_of_something_else() {
        let response = |onset| {
            let mut teaching = Teaching::default();
            teaching.begin("low".parse().expect("a name"), 1000).expect("nothing is under way");
            let changed = Changed { onset, effects: [0.1; 11] };
            (0..100).for_each(|_| teaching.step(true, Some(&HIGH), || Some(changed)));
            teaching.end().expect("long enough");
            teaching.proposed(&Config::default()).expect("a repetition").1.response.map(drop)
        };
        assert_eq!([954, 955, 1050].map(response), [Err(TeachError::Unseen), Ok(()), Ok(())]);
    }

    #[test]
    fn an_eleventh_fault_is_not_taught_and_a_known_name_is_taught_anew() {
        let mut config = Config::default();
        for name in ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"] {
            let response = Response { name: name.parse().expect("a name"), ..Response::default() };
            config.likelihood.taught.push(response).expect("room");
        }
        for (name, wanted) in [("k", Err(TeachError::Ten)), ("c", Ok(()))] {
            let mut teaching = Teaching::default();
            teaching.begin(name.parse().expect("a name"), 0).expect("nothing is under way");
            (0..100).for_each(|_| {
                teaching.step(true, Some(&HIGH), || Some(Changed { onset: 7, effects: [0.1; 11] }))
            });
            teaching.end().expect("long enough");
            let (config, lesson) = teaching.proposed(&config).expect("a repetition");
            assert_eq!(lesson.response.map(drop), wanted, "{name}");
            assert_eq!(
                (config.likelihood.taught.len(), config.likelihood.taught[2].effects[0] > 0),
                (10, wanted.is_ok())
            );
        }
    }
}
