//! Is all as trained again, in whatever state the rig is? A bank of Kalman filters of T1, asked on each sample while an alarm stands. Two of them
//! interact (interacting multiple models: Blom and Bar-Shalom, IEEE Trans. Automatic Control 33, 1988).
//!
//! Each follows by how much the rig's state differs from the model's, the coloured noise of T1, and one constant p:
//!
//! ```text
//! x <- x + (power - x) / tau + q_x    heat at T1, behind the dead time, %
//! m <- m + (x - m) / t1 + q_m         air at T1, %
//! w <- w + (m - w) / tw               wall, %
//! n <- a1 n[k-1] + a2 n[k-2] + a3 n[k-3] + noise
//! e1 = K ((1 - s1) m + s1 w) + n + error
//! ```
//!
//! [`Kind`] says what power and error are. Under "as trained" there is neither: what is left of something that is over goes as the rig forgets it. Under
//! "disturbed" q_x and q_m are large: heat comes or goes, as through an open lid, and the state is followed meanwhile. So the first samples behind the end
//! tell that it is over. Both are told apart by their probabilities; faults that last (the other kinds) must be refuted by what came since.

mod filter;

use super::added::{Added, begun};
use super::process::Process;
use super::start::Begun;
use super::tuning::{Tuned, Tuning};
use super::whitening::WhiteningFilter;
use super::work::Work;
use super::{Contact, Likelihood, LikelihoodState};
use filter::{CONSTANT, Filter, Matrix, STATES, Vector};

/// What a filter says is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Nothing.
    AsTrained,
    /// Heat comes or goes.
    Disturbed,
    /// The heater gives p more than it is asked for, a share.
    Power,
    /// T1 reads p too high, degC.
    Offset,
    /// T1 sees p more of the rise, a share.
    Gain,
    /// The heater gives p whatever is asked for, %.
    Same,
    /// The heater gives p while it is asked for nothing, %.
    On,
}

const KINDS: [Kind; 7] =
    [Kind::AsTrained, Kind::Disturbed, Kind::Power, Kind::Offset, Kind::Gain, Kind::Same, Kind::On];
/// Places of what lasts, and of "the same".
const LASTING: usize = 2;
const SAME: usize = 5;
const _: () = assert!(matches!(KINDS[SAME], Kind::Same));

impl Kind {
    /// Mean and standard deviation of p, as the hypotheses' of docs/diagnosis.md, section 6, or wider.
    fn prior(self, t: &Tuning) -> (f64, f64) {
        match self {
            Self::AsTrained | Self::Disturbed => (0.0, 0.0),
            Self::Power | Self::Gain => (0.0, t.hypotheses.share_sd.into()),
            Self::Offset => (0.0, t.interacting.offset_sd.into()),
            Self::Same | Self::On => (t.hypotheses.constant.into(), t.hypotheses.constant.into()),
        }
    }

    /// The power of a tick: for each unit of p, and without it, where so much is asked for, %; less than `least` is nothing.
    fn power(self, asked: f64, least: f64) -> (f64, f64) {
        match self {
            Self::Power => (asked, 0.0),
            Self::Same => (1.0, -asked),
            Self::On if asked < least => (1.0, 0.0),
            _ => (0.0, 0.0),
        }
    }

    /// The error of T1 for each unit of p, where it should rise by so much, degC.
    const fn error(self, rise: f64) -> f64 {
        match self {
            Self::Offset => 1.0,
            Self::Gain => rise,
            _ => 0.0,
        }
    }
}

/// What the bank makes of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// Nothing that the alarm does not say.
    Nothing,
    /// All is as trained.
    Over,
    /// The heater gives what nobody asks for.
    HeaterOn,
}

/// What a fault is behind counts up to this: evidence that turns is heard within samples.
const MOST: f64 = 50.0;

/// The bank.
#[derive(Clone, Debug)]
pub(crate) struct Interacting {
    tuning: Tuned,
    /// The ways that heat, air and wall go on a tick, as shares.
    shares: [f64; 3],
    /// The noise: shares of what it was, the variance of its innovations, and what it is by itself, degC^2.
    own: [f64; 3],
    noise: f64,
    coloured: f64,
    /// What air and wall give T1, degC for each %.
    gains: [f64; 2],
    kappa: f64,
    sure: f64,
    filters: [Filter; KINDS.len()],
    /// Of "as trained" and of "disturbed".
    probability: [f64; 2],
    /// The model's own heat at T1 on the last tick, %.
    heat: Option<f64>,
    /// By how much "the same" differs from what is asked for, a mean of late, %.
    differs: f64,
    found: Found,
    /// The furthest that T1 has been from the model in this alarm, degC.
    furthest: f64,
}

impl Interacting {
    /// Of a rig of which nothing is known but that something stirs.
    pub(super) fn new(tuning: Tuned, process: &Process, whitening: &WhiteningFilter) -> Self {
        let t = &tuning.interacting;
        let unknown = f64::from(t.unknown);
        let (own, sigma) = whitening.of_e1();
        let (own, noise) = (own.map(f64::from), f64::from(sigma) * f64::from(sigma));
        let coloured = noise / (1.0 - own.iter().sum::<f64>()).clamp(0.01, 1.0);
        let filters = KINDS.map(|kind| {
            let (mean, sd) = kind.prior(&tuning);
            let sd = [unknown, unknown, f64::from(t.wall), 0.0, 0.0, 0.0, sd];
            let mut covariance = [[0.0; STATES]; STATES];
            for (i, sd) in sd.into_iter().enumerate() {
                covariance[i][i] = if (3..CONSTANT).contains(&i) { coloured } else { sd * sd };
            }
            Filter { state: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mean], covariance, evidence: 0.0, behind: 0.0 }
        });
        let (gain, slow) = (f64::from(process.gain[0]), f64::from(process.slow[0]));
        Self {
            tuning,
            shares: [process.heater, process.lag[0], process.wall].map(f64::from),
            own,
            noise,
            coloured,
            gains: [gain * (1.0 - slow), gain * slow],
            kappa: f64::from(tuning.alarm.kappa),
            sure: f64::from(tuning.alarm.over),
            filters,
            probability: [0.5; 2],
            heat: None,
            differs: unknown,
            found: Found::Nothing,
            furthest: 0.0,
        }
    }

    /// A tick: what T1 reads beyond the model, degC, the model's heat at T1, %, and by how much T1 should rise, degC.
    fn step(&mut self, e1: Option<f32>, heat: f32, rise: f32) -> Found {
        let tuning = self.tuning;
        let t = &tuning.interacting;
        let heat = f64::from(heat);
        let before = self.heat.replace(heat).unwrap_or(heat);
        let [heater, ..] = self.shares;
        let asked = (heat - (1.0 - heater) * before) / heater;
        let errors = self.errors_of_dynamics(asked - before, heat, rise.into());
        self.mix();
        let mut logs = [0.0; KINDS.len()];
        for (i, kind) in KINDS.into_iter().enumerate() {
            let (matrix, added) = self.transition(kind.power(asked, tuning.hypotheses.least_constant.into()));
            let comes = self.comes(kind, errors);
            let filter = &mut self.filters[i];
            filter.predict(&matrix, added, &comes);
            if let Some(e1) = e1 {
                let output = [0.0, self.gains[0], self.gains[1], 1.0, 0.0, 0.0, kind.error(f64::from(rise))];
                logs[i] = filter.correct(&output, f64::from(e1), tuning.charts.clip.into()) / self.kappa;
            }
        }
        let Some(e1) = e1 else { return Found::Nothing };
        self.furthest = self.furthest.max(f64::from(e1).abs());
        self.weigh(&logs);
        self.differs +=
            ((self.filters[SAME].state[CONSTANT] - asked).abs() - self.differs) / f64::from(t.memory);
        self.found = if self.is_over() {
            Found::Over
        } else if self.is_on() {
            Found::HeaterOn
        } else {
            Found::Nothing
        };
        self.found
    }

    /// What heat and air of the model are wrong by on a tick, %: the heat follows what is asked for, from which it is so far, and the air the heat.
    fn errors_of_dynamics(&self, behind: f64, heat: f64, rise: f64) -> [f64; 2] {
        let [heater, lag, _] = self.shares;
        let share = f64::from(self.tuning.interacting.dynamics);
        let air = rise / (self.gains[0] + self.gains[1]);
        [share * heater * behind, share * lag * (heat - air)]
    }

    /// The model has taken over so much heat at T1, air and wall, %.
    fn differ_less(&mut self, by: [f32; 3]) {
        self.heat = self.heat.map(|heat| heat + f64::from(by[0]));
        for filter in &mut self.filters {
            filter.state.iter_mut().zip(by).for_each(|(x, by)| *x -= f64::from(by));
        }
    }

    /// Takes in how likely each says that a sample was.
    fn weigh(&mut self, logs: &[f64; KINDS.len()]) {
        let [trained, disturbed, ..] = *logs;
        let best = trained.max(disturbed);
        let [a, b] = [0, 1].map(|i| self.probability[i] * libm::exp((logs[i] - best).max(-100.0)));
        // Neither is ever impossible.
        self.probability = [a, b].map(|x| (x / (a + b)).clamp(1e-6, 1.0 - 1e-6));
        let likely = self.probability[0] > 0.5;
        for (filter, log) in self.filters.iter_mut().zip(logs) {
            filter.evidence += log - filter.evidence / f64::from(self.tuning.interacting.memory);
            filter.behind = if likely { (filter.behind + trained - log).clamp(0.0, MOST) } else { 0.0 };
        }
    }

    /// Whether nothing disturbs, and each fault that lasts is refuted or nothing.
    fn is_over(&self) -> bool {
        let t = &self.tuning.interacting;
        let known = f64::from(t.known);
        let (least_power, least_share) = (
            f64::from(self.tuning.hypotheses.least_constant),
            f64::from(self.tuning.since_training.least_gain),
        );
        let refuted = |(kind, filter): (&Kind, &Filter)| {
            let (p, sd) =
                (filter.state[CONSTANT], libm::sqrt(filter.covariance[CONSTANT][CONSTANT].max(0.0)));
            let (prior, is_known) = (kind.prior(&self.tuning).1, sd < known * kind.prior(&self.tuning).1);
            let small = |least: f64| p.abs() + 2.0 * sd < 2.0 * least || (p.abs() < 2.0 * sd && is_known);
            let nothing = match kind {
                // Of what T1 reads less than half: a state that is left and an error look alike until the rig has forgotten some of it.
                Kind::Offset => {
                    p.abs() + 2.0 * sd
                        < (f64::from(t.offset_noise) * libm::sqrt(self.coloured))
                            .max(f64::from(t.offset_share) * self.furthest)
                }
                Kind::Same => self.differs < 2.0 * least_power,
                // While it is asked for more, or was never asked for nothing, this is no fault that can be seen.
                Kind::On => sd > known * prior || small(least_power),
                _ => small(least_share),
            };
            nothing || filter.behind > f64::from(t.refuted)
        };
        self.probability[1] < f64::from(t.ruled_out)
            && KINDS.iter().zip(&self.filters).skip(LASTING).all(refuted)
    }

    /// Whether the heater gives what nobody asks for.
    fn is_on(&self) -> bool {
        let most = |of: &[Kind]| {
            let named = KINDS.iter().zip(&self.filters).filter(|(kind, _)| of.contains(kind));
            named.map(|(_, filter)| filter.evidence).fold(f64::MIN, f64::max)
        };
        let least = if self.found == Found::HeaterOn { 0.0 } else { self.sure };
        most(&[Kind::Same, Kind::On])
            > most(&[Kind::Disturbed, Kind::Power, Kind::Offset, Kind::Gain]) + least
    }

    /// Variances that come in on a tick.
    fn comes(&self, kind: Kind, [of_heat, of_air]: [f64; 2]) -> Vector {
        let [heater, lag, _] = self.shares;
        let t = &self.tuning.interacting;
        let disturbed = kind == Kind::Disturbed;
        let (x, m) = if disturbed {
            (f64::from(t.of_heat), lag * f64::from(t.of_air))
        } else {
            (f64::from(t.model_error), 0.0)
        };
        [heater * x * x + of_heat * of_heat, m * m + of_air * of_air, 0.0, self.noise, 0.0, 0.0, 0.0]
    }

    /// The matrix of a tick, and what is added to x, m and w.
    fn transition(&self, (of_constant, by_itself): (f64, f64)) -> (Matrix, [f64; 3]) {
        let [heater, lag, wall] = self.shares;
        let mut matrix = [[0.0; STATES]; STATES];
        (matrix[0][0], matrix[0][CONSTANT]) = (1.0 - heater, heater * of_constant);
        for j in 0..STATES {
            matrix[1][j] = lag * matrix[0][j] + if j == 1 { 1.0 - lag } else { 0.0 };
            matrix[2][j] = wall * matrix[1][j] + if j == 2 { 1.0 - wall } else { 0.0 };
        }
        matrix[3][3..CONSTANT].copy_from_slice(&self.own);
        (matrix[4][3], matrix[5][4], matrix[CONSTANT][CONSTANT]) = (1.0, 1.0, 1.0);
        let x = heater * by_itself;
        (matrix, [x, lag * x, wall * lag * x])
    }

    /// What both that interact begin the next tick with, since the rig may have changed from one to the other.
    fn mix(&mut self) {
        let leave = 1.0 / f64::from(self.tuning.interacting.lasts);
        let [a, b] = self.probability;
        let from = [[(1.0 - leave) * a, leave * b], [leave * a, (1.0 - leave) * b]];
        let [trained, disturbed, ..] = self.filters;
        for (i, [a, b]) in from.into_iter().enumerate() {
            self.probability[i] = a + b;
            let parts = [(a / (a + b), &trained), (b / (a + b), &disturbed)];
            let state: Vector =
                core::array::from_fn(|k| parts.iter().map(|(share, filter)| share * filter.state[k]).sum());
            let mut covariance = [[0.0; STATES]; STATES];
            for (share, filter) in parts {
                let off: Vector = core::array::from_fn(|k| filter.state[k] - state[k]);
                for (k, row) in covariance.iter_mut().enumerate() {
                    for (l, sum) in row.iter_mut().enumerate() {
                        *sum += share * (filter.covariance[k][l] + off[k] * off[l]);
                    }
                }
            }
            (self.filters[i].state, self.filters[i].covariance) = (state, covariance);
        }
    }

    /// What the rig has of it now that the model has not.
    pub(super) fn begun(&self, apart: [f32; 3]) -> Begun {
        let [trained, ..] = &self.filters;
        begun(core::array::from_fn(|i| trained.state[i] as f32 + apart[i]))
    }
}

impl Likelihood {
    /// The highest confidence of a name.
    pub(crate) fn certain(&self) -> f32 {
        self.tuning.naming.certain
    }

    /// The bank of a rig, which knows nothing yet; none where nothing was learnt.
    pub(crate) fn interacting(&self, state: &LikelihoodState) -> Option<Interacting> {
        Some(state.trained.as_ref()?.interacting())
    }

    /// A tick of it: what T1 reads beyond the model, degC.
    pub(crate) fn ask(
        &self,
        state: &LikelihoodState,
        bank: &mut Interacting,
        added: &Added,
        e1: Option<f32>,
    ) -> Found {
        state.trained.as_ref().map_or(Found::Nothing, |trained| {
            let ([heat, rise], came) = (trained.heat_at_t1(), added.last());
            let found = bank.step(e1, heat - came[0], rise);
            bank.differ_less(came);
            found
        })
    }

    /// All is as trained, from this state on: what alarm stands is over. Says whether it was taken over.
    pub(super) fn end_in(&self, state: &mut LikelihoodState, begun: &Begun) -> bool {
        let watched = (&mut state.trained, &state.work);
        if let (Some(trained), Work::Watching(_)) = watched {
            self.watch.return_to(trained, begun);
            state.work.begin_watching();
            // What is left of heat is no error of a thermistor that comes and goes.
            state.contact = Contact::default();
            return true;
        }
        false
    }
}

#[cfg(test)]
mod tests;
