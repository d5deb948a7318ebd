//! PID settings from the experiment of `tune`: what each rule proposes with what is to be expected of it, put in force only when it is asked
//! for, and taken back when that is.

use core::fmt;

use fdi_core::control::pid::PidConfig;
use fdi_core::tune::{Lag, Margins, Search, Standing, StepResponse, Tuned};
use fdi_core::{Config, Seconds};

use crate::decimal::{Fixed, rounded};

/// A rule by which settings follow from a lag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// From the oscillation under a relay.
    Relay,
    /// From the lag, robust.
    Model,
    /// The quickest that leaves a margin, from a search.
    Quick,
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Relay, Self::Model, Self::Quick];

    /// Name on the console.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Relay => "relay",
            Self::Model => "model",
            Self::Quick => "quick",
        }
    }
}

/// What a rule proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// By which rule.
    pub rule: Rule,
    /// The settings.
    pub tuned: Tuned,
    /// What the lag says of the loop with them.
    pub margins: Margins,
    /// See `margins`.
    pub response: StepResponse,
}

impl Proposal {
    /// With what is to be expected; `None` where the loop does not settle in 20 time constants.
    fn new(rule: Rule, tuned: Tuned, lag: &Lag, ts: Seconds) -> Option<Self> {
        let tuned = Tuned {
            kp: rounded(tuned.kp, 1e4),
            ti: Seconds(rounded(tuned.ti.0, 1e3)),
            td: Seconds(rounded(tuned.td.0, 1e3)),
        };
        let (margins, response) = (lag.margins(&tuned, ts)?, lag.step_response(&tuned, ts)?);
        Some(Self { rule, tuned, margins, response })
    }
}

impl fmt::Display for Proposal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rule, tuned, margins, response } = self;
        write!(f, "{}: {}; a step overshoots by", rule.name(), Gains(tuned.kp, tuned.ti, tuned.td))?;
        write!(
            f,
            " {} %, settles in {} s",
            Fixed(100.0 * response.overshoot, 0),
            Fixed(response.settled.0, 1)
        )?;
        write!(f, "; gain margin {}, phase margin {} deg", Fixed(margins.gain, 1), Fixed(margins.phase, 0))
    }
}

/// Kp, Ti, Td.
struct Gains(f32, Seconds, Seconds);

impl fmt::Display for Gains {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "kp {}, ti {} s, td {} s", Fixed(self.0, 4), Fixed(self.1.0, 3), Fixed(self.2.0, 3))
    }
}

/// PID settings that are in force.
pub struct InForce<'a>(pub &'a PidConfig);

impl fmt::Display for InForce<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "in force: {}", Gains(self.0.kp, self.0.ti, self.0.td))
    }
}

/// How far an experiment has come, for people.
pub struct TuningText<'a>(pub &'a Standing);

impl fmt::Display for TuningText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Standing::Over(Ok(Lag { gain, time, dead })) => write!(
                f,
                "tune: done, the heater is off. The rig: {} degC per %, time constant {} s, dead time {} s",
                Fixed(*gain, 4),
                Fixed(*time, 3),
                Fixed(*dead, 3)
            ),
            Standing::Over(Err(unclear)) => {
                write!(f, "tune: ended without a result, the heater is off: {}", unclear.words())
            }
            standing => write!(f, "tune: {}", standing.words()),
        }
    }
}

/// The search of [`Rule::Quick`] with its result, and what was in force before.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tuner {
    search: Option<Search>,
    before: Option<PidConfig>,
}

/// Candidates that are tried before others have their turn.
const AT_ONCE: usize = 4;

impl Tuner {
    /// A part of the search for the settings of this lag; `true` once it is done.
    pub fn search(&mut self, lag: &Lag, ts: Seconds) -> bool {
        let search = match &mut self.search {
            Some(search) if search.lag() == lag => search,
            other => other.insert(Search::new(lag, ts)),
        };
        (0..AT_ONCE).any(|_| search.step())
    }

    /// What a rule proposes for this lag; `None` where that does not settle in 20 time constants, or is not searched yet.
    pub fn proposal(&self, rule: Rule, lag: &Lag, ts: Seconds) -> Option<Proposal> {
        let tuned = match rule {
            Rule::Relay => lag.by_oscillation(ts),
            Rule::Model => Some(lag.by_model()),
            Rule::Quick => self.search.filter(|search| search.lag() == lag).map(|search| search.best()),
        };
        Proposal::new(rule, tuned?, lag, ts)
    }

    /// The settings with what is proposed.
    pub fn applied(&self, proposal: &Proposal, config: &Config) -> Config {
        let Tuned { kp, ti, td } = proposal.tuned;
        let pid = PidConfig { kp, ti, td, ..config.pid };
        Config { pid, ..config.clone() }
    }

    /// What was in force before those that have just been put in force, for [`Tuner::undone`]; `None`: it has just come back.
    pub fn keep(&mut self, before: Option<PidConfig>) {
        self.before = before;
    }

    /// The settings with what was in force before the last proposal; `None` where there was none since the start.
    pub fn undone(&self, config: &Config) -> Option<Config> {
        let PidConfig { kp, ti, td, .. } = self.before?;
        let pid = PidConfig { kp, ti, td, ..config.pid };
        Some(Config { pid, ..config.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAG: Lag = Lag { gain: 0.3, time: 1.0, dead: 0.3 };
    const TS: Seconds = Seconds(0.11);

    fn searched() -> Tuner {
        let mut tuner = Tuner::default();
        assert!((0..1000).any(|_| tuner.search(&LAG, TS)), "it ends");
        tuner
    }

    #[test]
    fn every_rule_leaves_a_margin_and_says_what_to_expect() {
        let tuner = searched();
        for rule in Rule::ALL {
            let proposal = tuner.proposal(rule, &LAG, TS).expect("settles");
            assert!(proposal.margins.gain >= 2.5 && proposal.response.overshoot <= 0.15, "{proposal}");
        }
        let settled = |rule| tuner.proposal(rule, &LAG, TS).unwrap().response.settled.0;
        assert!(
            settled(Rule::Quick) <= settled(Rule::Model),
            "{} {}",
            settled(Rule::Quick),
            settled(Rule::Model)
        );
    }

    #[test]
    fn another_lag_has_to_be_searched_anew() {
        let tuner = searched();
        let other = Lag { dead: 0.5, ..LAG };
        assert_eq!(tuner.proposal(Rule::Quick, &other, TS), None);
        assert!(tuner.proposal(Rule::Model, &other, TS).is_some());
    }

    #[test]
    fn what_was_in_force_comes_back_once() {
        let mut tuner = searched();
        let config = Config::default();
        let proposal = tuner.proposal(Rule::Model, &LAG, TS).unwrap();
        let mut new = tuner.applied(&proposal, &config);
        assert!(tuner.undone(&new).is_none(), "not in force yet");
        tuner.keep(Some(config.pid));
        assert_eq!((new.pid.kp, new.pid.output_max), (proposal.tuned.kp, config.pid.output_max));
        new.pid.output_max.0 = 50.0; // set since
        let old = tuner.undone(&new).expect("there was one");
        assert_eq!((old.pid.kp, old.pid.ti, old.pid.output_max.0), (config.pid.kp, config.pid.ti, 50.0));
        tuner.keep(None);
        assert!(tuner.undone(&old).is_none());
    }
}
