//! The hypotheses and the nuisances, a row each: what may have changed, by how much, and what it is called.

use super::class::{Channel, FaultClass, Pair, Quantity};
use super::evidence::{Estimate, Nuisance, Prior};
use super::regressor::{self, Direction, FIRST_FREED, FREED, Regressor};
use super::taught;
use super::tuning::{HypothesisTuning, NuisanceTuning, Tuning};
use crate::bounds::larger;

/// A hypothesis about what is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hypothesis {
    /// What it is called.
    pub(super) class: FaultClass,
    /// What it frees: first its magnitude.
    pub(super) first: Prior,
    pub(super) second: Option<Prior>,
    /// What its magnitude may be.
    pub(super) range: (f32, f32),
    /// Logarithm of its odds against the common faults before anything is seen.
    pub(super) prior: f32,
    /// A reading stays where it was: the second's mean is that level, degC.
    pub(super) stuck_at: Option<usize>,
    /// It is asked when a whole minute is judged, too.
    pub(super) lasting: bool,
    /// Its magnitude is that of its class. That of a heater which gives the same whatever is asked for is no share of what is asked.
    pub(super) sized: bool,
}

/// Standard deviation of what may be anywhere within 1.
const ANYWHERE: f32 = 0.288_675;

/// A magnitude that may be anything.
pub(super) const UNBOUNDED: (f32, f32) = (-1e9, 1e9);

/// Hypotheses there are.
pub const COUNT: usize = 25;

const fn of(regressor: Regressor) -> Direction {
    Direction::Of(regressor)
}

const fn row(class: FaultClass, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis {
        class,
        first: Prior { direction, mean, sd },
        second: None,
        range: UNBOUNDED,
        prior: 0.0,
        stuck_at: None,
        lasting: true,
        sized: true,
    }
}

const fn with(row: Hypothesis, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis { second: Some(Prior { direction, mean, sd }), ..row }
}

const fn within(row: Hypothesis, low: f32, high: f32) -> Hypothesis {
    Hypothesis { range: (low, high), ..row }
}

/// One that a minute's means would not tell from others.
const fn brief(row: Hypothesis) -> Hypothesis {
    Hypothesis { lasting: false, ..row }
}

/// What happens more rarely than the others.
const fn rare(row: Hypothesis, prior: f32) -> Hypothesis {
    Hypothesis { prior, ..row }
}

/// All hypotheses with these numbers.
pub(super) const fn rows(t: &Tuning) -> [Hypothesis; COUNT] {
    t.hypotheses.rows()
}

impl HypothesisTuning {
    /// One that begins a little earlier or later than the regressors do.
    const fn late(&self, row: Hypothesis) -> Hypothesis {
        with(row, of(Regressor::Late), 0.0, self.late_sd)
    }

    /// What is still near the mean of what a hypothesis frees first.
    const fn near(&self, row: &Hypothesis) -> (f32, f32) {
        let (mean, away) = (row.first.mean, self.farthest * row.first.sd);
        (mean - away, mean + away)
    }

    const fn clogged(&self, loss: Direction) -> Hypothesis {
        within(row(FaultClass::T1Clogged, loss, 0.0, self.share_sd), -self.large, 0.0)
    }

    /// A thermistor that was clogged when the model was trained, and is mended.
    const fn unclogged(&self) -> Hypothesis {
        let row = row(FaultClass::T1Clogged, of(Regressor::Gain1), 0.0, self.share_sd);
        rare(within(row, 0.0, self.large), self.rare)
    }

    const fn detached(&self, class: FaultClass, loss: Direction) -> Hypothesis {
        let row = row(class, loss, -0.5 * (1.0 + self.large), ANYWHERE * (1.0 - self.large));
        let (least, _) = self.near(&row);
        brief(rare(within(row, least, -self.large), self.uncommon))
    }

    const fn t1_detached(&self, loss: Direction) -> Hypothesis {
        self.detached(FaultClass::T1Detached, loss)
    }

    const fn lagging(&self, row: Hypothesis, lag: Direction) -> Hypothesis {
        brief(with(row, lag, 1.0, self.lag_sd))
    }

    const fn drift(&self, ramp: Direction, offset: Direction) -> Hypothesis {
        let row = rare(row(FaultClass::Drift, ramp, 0.0, self.drift_sd), self.uncommon);
        brief(with(row, offset, 0.0, self.jump_sd))
    }

    const fn stuck(&self, which: Channel, gain: Regressor, offset: Regressor, channel: usize) -> Hypothesis {
        let row = row(FaultClass::Stuck(which), of(gain), -1.0, self.wholly_sd);
        let row = with(row, of(offset), 0.0, self.jump_sd);
        let row = within(row, -1.0 - self.stuck_most, -1.0 + self.stuck_most);
        brief(rare(Hypothesis { stuck_at: Some(channel), ..row }, self.rare))
    }

    /// The heater gives the same whatever is asked for.
    const fn constant(&self) -> Hypothesis {
        let row = row(FaultClass::HeaterPower, of(Regressor::Constant), self.constant, self.constant);
        let row = with(row, of(Regressor::Power), -1.0, self.wholly_sd);
        let row = within(row, self.least_constant, 100.0 * self.most_power);
        Hypothesis { sized: false, ..brief(rare(row, self.rare)) }
    }

    /// A thermistor exchanged with T0 loses its rise twice; the other one loses as much as the exchanged one rises.
    const fn swapped_with_t0(&self, pair: Pair, gain: Regressor, other: Regressor) -> Hypothesis {
        let row = row(FaultClass::Swapped(pair), of(gain), -2.0, self.wholly_sd);
        let (least, most) = self.near(&row);
        let row = within(row, least, most);
        with(brief(rare(row, self.rare)), of(other), -1.0, self.wholly_sd)
    }

    const fn rows(&self) -> [Hypothesis; COUNT] {
        [
            row(FaultClass::T1Offset, of(Regressor::Offset1), 0.0, self.offset_sd),
            row(FaultClass::T2Offset, of(Regressor::Offset2), 0.0, self.offset_sd),
            row(FaultClass::T0Fault, Direction::Offset0, 0.0, self.offset_sd),
            self.late(within(
                row(FaultClass::AirFlow, of(Regressor::LessFlow), 0.0, self.flow_sd),
                0.0,
                self.most_flow_loss,
            )),
            self.late(within(
                row(FaultClass::AirFlow, of(Regressor::MoreFlow), 0.0, self.flow_sd),
                -self.most_flow_gain,
                0.0,
            )),
            self.late(within(
                row(FaultClass::HeaterPower, of(Regressor::Power), 0.0, self.share_sd),
                -self.most_power,
                self.most_power,
            )),
            self.clogged(of(Regressor::Gain1)),
            self.lagging(self.clogged(of(Regressor::ShortLoss)), of(Regressor::ShortLag)),
            self.lagging(self.clogged(Direction::MidLoss), Direction::MidLag),
            self.lagging(self.clogged(of(Regressor::LongLoss)), of(Regressor::LongLag)),
            self.unclogged(),
            self.drift(of(Regressor::Ramp1), of(Regressor::Offset1)),
            self.drift(of(Regressor::Ramp2), of(Regressor::Offset2)),
            self.drift(Direction::Ramp0, Direction::Offset0),
            self.stuck(Channel::T1, Regressor::Gain1, Regressor::Offset1, 0),
            self.stuck(Channel::T2, Regressor::Gain2, Regressor::Offset2, 1),
            self.constant(),
            self.t1_detached(of(Regressor::Gain1)),
            self.lagging(self.t1_detached(of(Regressor::ShortLoss)), of(Regressor::ShortLag)),
            self.lagging(self.t1_detached(Direction::MidLoss), Direction::MidLag),
            self.lagging(self.t1_detached(of(Regressor::LongLoss)), of(Regressor::LongLag)),
            brief(rare(
                row(FaultClass::Swapped(Pair::T1T2), of(Regressor::Exchanged), 1.0, self.wholly_sd),
                self.rare,
            )),
            self.detached(FaultClass::T2Detached, of(Regressor::Gain2)),
            // With T0 where the air is hot: T1, or T2, is below it by its own rise, the other by what is left of that.
            self.swapped_with_t0(Pair::T0T1, Regressor::Gain1, Regressor::Gain2),
            self.swapped_with_t0(Pair::T0T2, Regressor::Gain2, Regressor::Gain1),
        ]
    }
}

/// The hypotheses with the default numbers. Their classes and directions are the same with any.
pub(super) const ROWS: [Hypothesis; COUNT] = rows(&Tuning::DEFAULT);

/// The same in one place of memory.
pub(super) static HYPOTHESES: [Hypothesis; COUNT] = ROWS;

/// Which products of regressors are asked for: bit j of element i, where j is not above i.
pub(super) type Pairs = [u32; regressor::COUNT];

/// All of them.
#[cfg(test)]
pub(super) static ALL_PAIRS: Pairs = [u32::MAX; regressor::COUNT];

/// Those that the hypotheses ask for, and with those of faults that were taught; those of the magnitudes that are asked over a minute.
pub(super) static PAIRS: Pairs = pairs(&[]);
pub(super) static TAUGHT_PAIRS: Pairs = pairs(&taught::REGRESSORS);
pub(super) static LASTING_PAIRS: Pairs = lasting_pairs();

/// All among some regressors, and those of the hypotheses.
const fn pairs(among: &[Regressor]) -> Pairs {
    let mut pairs = [0; regressor::COUNT];
    let mut i = 0;
    while i < among.len() {
        let mut j = 0;
        while j < among.len() {
            pairs = with_pairs(pairs, [among[i] as usize; 2], [among[j] as usize; 2]);
            j += 1;
        }
        i += 1;
    }
    let mut h = 0;
    while h < COUNT {
        let first = ROWS[h].first.direction.regressors();
        pairs = with_pairs(pairs, first, first);
        if let Some(second) = ROWS[h].second {
            let second = second.direction.regressors();
            pairs = with_pairs(with_pairs(pairs, first, second), second, second);
        }
        h += 1;
    }
    pairs
}

const fn lasting_pairs() -> Pairs {
    let mut pairs = [0; regressor::COUNT];
    let mut h = 0;
    while h < COUNT {
        let first = ROWS[h].first.direction.regressors();
        if ROWS[h].lasting {
            pairs = with_pairs(pairs, first, first);
        }
        h += 1;
    }
    pairs
}

/// The same with those of one direction and another.
const fn with_pairs(mut pairs: Pairs, one: [usize; 2], another: [usize; 2]) -> Pairs {
    let mut i = 0;
    while i < 4 {
        let (a, b) = (one[i / 2], another[i % 2]);
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        assert!(
            low >= FIRST_FREED && high < FIRST_FREED + FREED,
            "a hypothesis that frees what is only a nuisance"
        );
        pairs[high] |= 1 << low;
        i += 1;
    }
    pairs
}

impl Hypothesis {
    /// What it frees second; a reading that stays stays at one of these rises, degC.
    pub(super) fn second_at(&self, rises: [f32; 2]) -> Option<Prior> {
        let second = self.second?;
        Some(self.stuck_at.map_or(second, |m| Prior { mean: rises[m % 2], ..second }))
    }

    /// How late a change of the process by `value` may begin: anywhere within so many ticks.
    pub(super) fn later(&self, value: f32, ticks: f32) -> Option<Prior> {
        let second =
            self.second.filter(|second| matches!(second.direction, Direction::Of(Regressor::Late)))?;
        Some(Prior { sd: ANYWHERE * ticks * value.abs(), ..second })
    }

    /// The gain of a hypothesis that was estimated, with its prior; none where the magnitude is not one that it can have.
    pub(super) fn judged(&self, mut estimate: Estimate) -> Estimate {
        let (low, high) = self.range;
        estimate.gain = if estimate.value > low && estimate.value < high {
            estimate.gain + self.prior
        } else {
            IMPOSSIBLE
        };
        estimate
    }
}

/// A magnitude in the unit of its class.
pub(super) fn in_unit(class: FaultClass, value: f32) -> f32 {
    match class.quantity() {
        Quantity::Nothing | Quantity::Offset | Quantity::Ramp => value,
        Quantity::Rise | Quantity::Power => 100.0 * value,
        Quantity::Flow => 100.0 * (1.0 / larger(0.1, 1.0 + value) - 1.0),
    }
}

/// Gain of what cannot be.
pub(super) const IMPOSSIBLE: f32 = -50.0;

/// Nuisances there are since an onset, and since training.
pub(super) const NUISANCES_SINCE_ONSET: usize = 10;
pub(super) const NUISANCES_SINCE_TRAINING: usize = 8;

/// What may move since an onset without being a fault: mains, sensors, inlet, what the model does not know of wall and time. Each list is in the order of
/// the regressors, and T0 last: so their products are read off quickest.
pub(super) const fn nuisances_since_onset(t: &NuisanceTuning) -> [Nuisance; NUISANCES_SINCE_ONSET] {
    [
        (of(Regressor::Wall), t.wall),
        (of(Regressor::Shift), t.shift),
        (of(Regressor::Power), t.onset_power),
        (of(Regressor::LessFlow), t.onset_flow),
        (of(Regressor::MoreFlow), t.onset_flow),
        (of(Regressor::Offset1), t.onset_offset),
        (of(Regressor::Offset2), t.onset_offset),
        (of(Regressor::Inlet1), t.inlet),
        (of(Regressor::Inlet2), t.inlet),
        (Direction::Offset0, t.onset_t0),
    ]
}

/// The same since training.
pub(super) const fn nuisances_since_training(t: &NuisanceTuning) -> [Nuisance; NUISANCES_SINCE_TRAINING] {
    [
        (of(Regressor::Wall), t.wall),
        (of(Regressor::Shift), t.shift),
        (of(Regressor::Power), t.trained_power),
        (of(Regressor::LessFlow), 2.0 * t.onset_flow),
        (of(Regressor::MoreFlow), 2.0 * t.onset_flow),
        (of(Regressor::Offset1), 2.0 * t.onset_offset),
        (of(Regressor::Offset2), 2.0 * t.onset_offset),
        (Direction::Offset0, 2.0 * t.onset_t0),
    ]
}

/// By what the model may be wrong right after training, as its fast content shows.
pub(super) const fn model_errors(t: &NuisanceTuning) -> [Nuisance; 7] {
    [
        (of(Regressor::Wall), t.error),
        (of(Regressor::Shift), t.error_shift),
        (of(Regressor::Power), t.error),
        (of(Regressor::LessFlow), t.error),
        (of(Regressor::MoreFlow), t.error),
        (of(Regressor::Gain1), t.error),
        (of(Regressor::Gain2), t.error),
    ]
}

/// With the default numbers.
#[cfg(test)]
pub(super) const SINCE_ONSET: [Nuisance; NUISANCES_SINCE_ONSET] =
    nuisances_since_onset(&NuisanceTuning::DEFAULT);
#[cfg(test)]
pub(super) const SINCE_TRAINING: [Nuisance; NUISANCES_SINCE_TRAINING] =
    nuisances_since_training(&NuisanceTuning::DEFAULT);
#[cfg(test)]
pub(super) const MODEL_ERRORS: [Nuisance; 7] = model_errors(&NuisanceTuning::DEFAULT);

#[cfg(test)]
mod tests;
