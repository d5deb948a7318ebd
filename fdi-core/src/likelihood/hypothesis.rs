//! The hypotheses about a fault, compared: which one leaves least unexplained, and by how much.

use super::bank::{Bank, Match};
use super::class::{Channel, FaultClass, Pair};
use super::verdict::Magnitude;
use crate::bounds::{bounded, larger, smaller};
use crate::root::sqrt;

/// The hypotheses.
pub(super) const ALL: [FaultClass; 18] = [
    FaultClass::T2Offset,
    FaultClass::T1Offset,
    FaultClass::T0Fault,
    FaultClass::AirFlow,
    FaultClass::HeaterPower,
    FaultClass::T1Clogged,
    FaultClass::Stuck(Channel::T1),
    FaultClass::Stuck(Channel::T2),
    DRIFTS[0],
    DRIFTS[1],
    DRIFTS[2],
    FaultClass::HeaterPower, // the same power whatever is asked for
    FaultClass::T2Detached,
    FaultClass::Swapped(Pair::T1T2),
    FaultClass::Swapped(Pair::T0T1),
    FaultClass::Swapped(Pair::T0T2),
    FaultClass::Stuck(Channel::T1), // near to where it was
    FaultClass::Stuck(Channel::T2),
];
/// Drift of T0, T1, T2.
const DRIFTS: [FaultClass; 3] = [FaultClass::Drift; 3];
const COUNT: usize = ALL.len();

const CLOGGED: usize = 5;
/// Places of the two that are told apart last.
const FLOW: usize = 3;
const POWER: usize = 4;
const DRIFT: usize = 8;
/// The heater that gives the same power whatever is asked for, %.
const CONSTANT: usize = 11;
/// From here on a thermistor is not where it should be, or stuck but noisy. That leaves far less unexplained than anything
/// else once it is so; until it does, by so much, it is neither best nor a rival of the best.
const MISPLACED: usize = 12;
const MISPLACED_LEAD: f32 = 20.0;

/// A thermistor that loses more than this share of the rise is not clogged, but out of the tube: at once, and once it is
/// known whether it lags, s, which looks like a greater loss at first.
const SURELY_DETACHED: f32 = 0.8;
const DETACHED: f32 = 0.4;
const LAG_KNOWN: f32 = 2.0;
/// No slow drift is faster, degC a minute.
const FASTEST_DRIFT: f32 = 10.0;
/// Energy of noise that a few samples may have without being called a misfit.
const FIRST: f32 = 8.0;
/// Nothing is named a drift within so long: too early to tell, s.
const EARLIEST_DRIFT: f32 = 5.0;

/// Everything that the bank says, weighed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighed {
    /// Unexplained energy of each hypothesis.
    left: [f32; COUNT],
    theta: [f32; COUNT],
    square: [f32; COUNT],
    energy: f32,
    age: f32,
    /// The hypothesis that leaves least, what it leaves, and its kind.
    best: usize,
    best_left: f32,
    best_kind: u8,
    /// The least that one of another kind leaves; power and flow are one kind.
    rival: f32,
    sample_time: f32,
}

/// Bounds of the magnitude of each hypothesis, in the unit of its signature; of a drift in degC/s.
const BOUNDS: [(f32, f32); COUNT] = [
    ANYTHING,
    ANYTHING,
    ANYTHING,
    (-4.0, 0.7), // 1 - 1/f for f from 0.2 to 3.3
    (-1.0, 1.0),
    (0.0, 1.0),
    ANYTHING,
    ANYTHING,
    SLOW_DRIFT,
    SLOW_DRIFT,
    SLOW_DRIFT,
    (0.0, 100.0),
    (DETACHED, 1.0),
    ANYTHING,
    ANYTHING,
    ANYTHING,
    NEARBY,
    NEARBY,
];
/// Where a thermistor is stuck differs by no more from where it was a tick before the onset, degC.
const NEARBY: (f32, f32) = (-0.5, 0.5);
const ANYTHING: (f32, f32) = (-200.0, 200.0);
const SLOW_DRIFT: (f32, f32) = (-FASTEST_DRIFT / 60.0, FASTEST_DRIFT / 60.0);

/// Which hypotheses are of one kind: they are told apart only after the kind is known.
const KIND: [u8; COUNT] = [0, 1, 2, 3, 3, 4, 5, 6, 7, 7, 7, 3, 8, 9, 10, 11, 5, 6];

/// The class of a hypothesis.
pub(super) fn class(h: usize) -> FaultClass {
    ALL.get(h).copied().unwrap_or(FaultClass::Unknown)
}

fn at(values: &[f32; COUNT], h: usize) -> f32 {
    values.get(h).copied().unwrap_or(0.0)
}

fn is_drift(h: usize) -> bool {
    KIND[h] == KIND[DRIFT]
}

impl Weighed {
    /// Weighs what the bank has gathered.
    #[inline(never)]
    pub(super) fn new(bank: &Bank, sample_time: f32) -> Self {
        let energy = bank.energy();
        let young = bank.age.saturating_add(bank.ago) as f32 * sample_time < EARLIEST_DRIFT;
        let (clogged_energy, clogged) = bank.clogged(BOUNDS[CLOGGED]);
        let none = Match::default();
        let [t1_t2, t0_t1, t0_t2] = bank.swapped().map(|left| (left, none));
        let sums: [(f32, Match); COUNT] = [
            (energy, bank.offset[1]),
            (energy, bank.offset[0]),
            (energy, Match::joined(&bank.offset, -1.0)),
            (energy, bank.flow),
            (energy, bank.power),
            (clogged_energy, clogged),
            (bank.stuck(0), none),
            (bank.stuck(1), none),
            (energy, Match::joined(&bank.ramp, -1.0)),
            (energy, bank.ramp[0]),
            (energy, bank.ramp[1]),
            (bank.constant_energy, bank.constant),
            (energy, bank.t2_out),
            t1_t2,
            t0_t1,
            t0_t2,
            (bank.stuck(0), bank.stuck_level[0]),
            (bank.stuck(1), bank.stuck_level[1]),
        ];
        let mut all = Self {
            left: [0.0; COUNT],
            theta: [0.0; COUNT],
            square: [0.0; COUNT],
            energy,
            age: bank.age as f32,
            best: 0,
            best_left: f32::MAX,
            best_kind: KIND[0],
            rival: f32::MAX,
            sample_time,
        };
        for (h, (before, sum)) in sums.iter().enumerate() {
            let (low, high) = BOUNDS[h];
            let unit = if is_drift(h) { sample_time } else { 1.0 };
            let theta = sum.best((low * unit, high * unit));
            all.theta[h] = theta;
            all.square[h] = sum.square;
            all.left[h] = before - sum.explained(theta);
            let lead = if h < MISPLACED { 0.0 } else { MISPLACED_LEAD };
            if all.left[h] + lead < all.best_left && !(young && is_drift(h)) {
                (all.best, all.best_left, all.best_kind) = (h, all.left[h], KIND[h]);
            }
        }
        let rivals = if all.best < MISPLACED { MISPLACED } else { COUNT };
        for h in 0..rivals {
            if KIND[h] != all.best_kind {
                all.rival = smaller(all.rival, all.left[h]);
            }
        }
        all
    }

    /// Unexplained energy a sample, over what noise alone leaves; 1 where it is no more.
    fn misfit(&self) -> f32 {
        larger(1.0, (self.best_left + FIRST) / (2.0 * self.age + FIRST))
    }

    /// Whether the best hypothesis explains nearly all.
    pub(super) fn fits(&self) -> bool {
        self.best_left < 4.5 * self.age + 0.03 * self.energy + 20.0
    }

    /// Whether no hypothesis explains what is seen.
    pub(super) fn is_strange(&self) -> bool {
        self.best_left > 6.0 * self.age + 0.07 * self.energy + 30.0
    }

    /// By how much the best hypothesis beats those of another kind. Where even the best fits badly, so may its lead.
    pub(super) fn lead(&self) -> f32 {
        (self.rival - self.best_left) / self.misfit()
    }

    /// Whether the process, not a sensor, is to blame.
    pub(super) fn is_process(&self) -> bool {
        self.best_kind == KIND[FLOW]
    }

    /// The best hypothesis; of power and flow the flow, unless the power is better by `power_margin`, or the flow would
    /// have to be impossible.
    pub(super) fn choice(&self, power_margin: f32) -> usize {
        if !self.is_process() {
            return self.best;
        }
        let (low, high) = BOUNDS[FLOW];
        let impossible = self.theta[FLOW] <= low || self.theta[FLOW] >= high;
        if smaller(self.left[FLOW], self.left[POWER]) - self.left[CONSTANT] > power_margin * self.misfit() {
            return CONSTANT;
        }
        let margin = if impossible { 0.5 * power_margin } else { power_margin * self.misfit() };
        if self.left[FLOW] - self.left[POWER] > margin { POWER } else { FLOW }
    }

    /// Share of the power margin that is enough once T2 has answered: the larger the change, the rougher the model of
    /// the flow, and the more is asked for.
    pub(super) fn late_share(&self) -> f32 {
        bounded(1.5 * self.theta[POWER].abs(), 0.12, 1.0)
    }

    /// The class of a hypothesis with its magnitude: who loses most of the rise is not clogged.
    pub(super) fn named(&self, h: usize) -> FaultClass {
        match class(h) {
            FaultClass::T1Clogged => {
                let early = self.age * self.sample_time < LAG_KNOWN;
                let limit = if early { SURELY_DETACHED } else { DETACHED };
                if at(&self.theta, h) > limit { FaultClass::T1Detached } else { FaultClass::T1Clogged }
            }
            named => named,
        }
    }

    /// Probability of a hypothesis against the strongest of another class.
    pub(super) fn confidence(&self, h: usize) -> f32 {
        let rivals = if h < MISPLACED { MISPLACED } else { COUNT };
        let others = (0..rivals).filter(|&other| ALL[other] != class(h));
        let rival = others.map(|other| self.left[other]).fold(f32::MAX, smaller);
        let lead = (rival - at(&self.left, h)) / self.misfit();
        1.0 / (1.0 + libm::expf(bounded(-0.5 * lead, -40.0, 40.0)))
    }

    /// Whether a change of power no larger than `share` explains what is seen about as well as any clear fault.
    pub(super) fn is_sag(&self, bank: &Bank, share: f32) -> bool {
        let left = self.energy - bank.power.explained(bank.power.best((-share, share)));
        let clear = (0..MISPLACED).filter(|&h| !matches!(ALL[h], FaultClass::T0Fault | FaultClass::Drift));
        let best = clear.map(|h| self.left[h]).fold(f32::MAX, smaller);
        // A change of the process not much larger than a sag is no emergency: it gets the time to show its size.
        let small = self.is_process() && self.theta[POWER].abs() < 2.0 * share;
        let patience = if small { 2.0 } else { 1.0 };
        left < patience * (5.0 * self.age + 10.0) && left - best < patience * 16.0
    }

    /// The magnitude of a hypothesis in the unit of its class. `slow` is the standard deviation, in degC, of disturbance
    /// slower than the noise model's memory, `rise` the rise of T1.
    pub(super) fn magnitude(&self, h: usize, slow: f32, rise: f32) -> Option<Magnitude> {
        let theta = at(&self.theta, h);
        let square = at(&self.square, h);
        let variance = if square > 0.0 { 4.0 / square } else { return None };
        let scaled = |factor: f32, slow: f32| {
            let half_width = 1.96 * factor * sqrt(variance + slow * slow);
            Some(Magnitude { value: factor * theta, half_width })
        };
        let share = slow / larger(1.0, rise);
        match class(h) {
            _ if h == CONSTANT => None,
            FaultClass::T1Offset | FaultClass::T2Offset | FaultClass::T0Fault => scaled(1.0, slow),
            FaultClass::T1Clogged | FaultClass::T2Detached => {
                scaled(100.0, share).map(|m| Magnitude { value: -m.value, ..m })
            }
            FaultClass::HeaterPower => scaled(100.0, share),
            FaultClass::Drift => scaled(60.0 / self.sample_time, slow / bounded(self.age, 10.0, 60.0)),
            FaultClass::AirFlow => {
                let left = larger(0.05, 1.0 - theta); // 1/f
                let at_theta = scaled(100.0 / (left * left), share)?;
                Some(Magnitude { value: 100.0 * (1.0 / left - 1.0), ..at_theta })
            }
            _ => None,
        }
    }
}
