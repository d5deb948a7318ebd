//! The hypotheses and the nuisances, a row each: what may have changed, by how much, and what it is called.

use super::class::{Channel, FaultClass, Pair};
use super::column::{Column, Direction};
use super::evidence::{Free, Freed, Nuisance};
use crate::bounds::larger;
use crate::root::sqrt;

/// A hypothesis about what is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hypothesis {
    /// What it is called.
    pub(super) class: FaultClass,
    /// What it frees: first its magnitude.
    pub(super) first: Free,
    pub(super) second: Option<Free>,
    /// What its magnitude may be.
    pub(super) range: (f32, f32),
    /// Logarithm of its odds against the common faults before anything is seen.
    pub(super) prior: f32,
    /// A reading stays where it was: the second's mean is that level, degC.
    pub(super) stays: Option<usize>,
    /// It is asked when a whole minute is judged, too.
    pub(super) lasting: bool,
}

/// Hypotheses there are.
pub const COUNT: usize = 25;

const fn of(column: Column) -> Direction {
    Direction::Of(column)
}

const fn row(class: FaultClass, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis {
        class,
        first: Free { direction, mean, sd },
        second: None,
        range: (-1e9, 1e9),
        prior: 0.0,
        stays: None,
        lasting: true,
    }
}

const fn with(row: Hypothesis, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis { second: Some(Free { direction, mean, sd }), ..row }
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

/// One that begins a little earlier or later than the columns do.
const fn late(row: Hypothesis) -> Hypothesis {
    with(row, of(Column::Late), 0.0, LATE)
}

const fn clogged(loss: Direction) -> Hypothesis {
    within(row(FaultClass::T1Clogged, loss, 0.0, 0.25), -DETACHED, 0.0)
}

/// A thermistor that was clogged when the model was trained, and is mended.
const fn unclogged() -> Hypothesis {
    rare(within(row(FaultClass::T1Clogged, of(Column::Gain1), 0.0, 0.25), 0.0, MENDED), RARE)
}

const fn t1_detached(loss: Direction) -> Hypothesis {
    brief(rare(within(row(FaultClass::T1Detached, loss, -0.7, 0.2), -1.3, -DETACHED), -3.0))
}

const fn lagging(row: Hypothesis, lag: Direction) -> Hypothesis {
    brief(with(row, lag, LAGGING.0, LAGGING.1))
}

const fn stuck(which: Channel, gain: Column, offset: Column, channel: usize) -> Hypothesis {
    let row = row(FaultClass::Stuck(which), of(gain), -1.0, STUCK.0);
    let row = within(with(row, of(offset), 0.0, STUCK.1), -1.1, -0.9);
    brief(rare(Hypothesis { stays: Some(channel), ..row }, RARE))
}

const fn swapped_with_t0(pair: Pair, gain: Column) -> Hypothesis {
    brief(rare(within(row(FaultClass::Swapped(pair), of(gain), -2.0, SWAPPED), -2.3, -1.7), RARE))
}

/// A thermistor exchanged with T0 loses its rise twice, give or take so much; the other one loses as much as the exchanged one rises.
const SWAPPED: f32 = 0.05;
const HALF_SWAPPED: (f32, f32) = (-1.0, 0.15);
/// A constant power below this is none, %: a share that is lost, with its size.
const LEAST_CONSTANT: f32 = 5.0;
/// Spread of how late a change of the process begins, ticks times its share. With more, the time that tells air flow from power is lost.
const LATE: f32 = 0.03;
/// A change by more than this share is judged once more, with the spread that a beginning anywhere within a tick gives such a share.
const LARGE: f32 = 0.4;
const WITHIN_A_TICK: f32 = 0.3;
/// Lag of a clogged thermistor as a share of the column's lag, and its spread.
const LAGGING: (f32, f32) = (1.0, 0.15);
/// A drift begins from within so many degC.
const BEGINS: f32 = 0.2;
/// What is stuck has lost its gain but for so much, and stays within so many degC of where it was.
const STUCK: (f32, f32) = (0.03, 0.3);
/// A thermistor that loses more than this share of the rise is not clogged, but out of the tube.
pub(super) const DETACHED: f32 = 0.4;
/// One that was clogged while it was learnt sees no more than this share on top when it is mended.
const MENDED: f32 = 0.45;
/// Prior of what is rare.
const RARE: f32 = -5.0;

/// All hypotheses. Spreads are those of the faults that may come: degC, shares, `1/f - 1`, degC a minute.
pub(super) const ROWS: [Hypothesis; COUNT] = [
    row(FaultClass::T1Offset, of(Column::Offset1), 0.0, 2.0),
    row(FaultClass::T2Offset, of(Column::Offset2), 0.0, 2.0),
    row(FaultClass::T0Fault, Direction::Offset0, 0.0, 2.0),
    late(within(row(FaultClass::AirFlow, of(Column::LessFlow), 0.0, 0.3), 0.0, 4.0)),
    late(within(row(FaultClass::AirFlow, of(Column::MoreFlow), 0.0, 0.3), -0.7, 0.0)),
    late(within(row(FaultClass::HeaterPower, of(Column::Power), 0.0, 0.25), -1.1, 1.1)),
    clogged(of(Column::Gain1)),
    lagging(clogged(of(Column::ShortLoss)), of(Column::ShortLag)),
    lagging(clogged(Direction::MidLoss), Direction::MidLag),
    lagging(clogged(of(Column::LongLoss)), of(Column::LongLag)),
    unclogged(),
    brief(with(
        rare(row(FaultClass::Drift, of(Column::Ramp1), 0.0, 3.0), -3.0),
        of(Column::Offset1),
        0.0,
        BEGINS,
    )),
    brief(with(
        rare(row(FaultClass::Drift, of(Column::Ramp2), 0.0, 3.0), -3.0),
        of(Column::Offset2),
        0.0,
        BEGINS,
    )),
    brief(with(
        rare(row(FaultClass::Drift, Direction::Ramp0, 0.0, 3.0), -3.0),
        Direction::Offset0,
        0.0,
        BEGINS,
    )),
    stuck(Channel::T1, Column::Gain1, Column::Offset1, 0),
    stuck(Channel::T2, Column::Gain2, Column::Offset2, 1),
    brief(rare(
        within(
            with(
                row(FaultClass::HeaterPower, of(Column::Constant), 40.0, 40.0),
                of(Column::Power),
                -1.0,
                0.02,
            ),
            LEAST_CONSTANT,
            110.0,
        ),
        RARE,
    )),
    t1_detached(of(Column::Gain1)),
    lagging(t1_detached(of(Column::ShortLoss)), of(Column::ShortLag)),
    lagging(t1_detached(Direction::MidLoss), Direction::MidLag),
    lagging(t1_detached(of(Column::LongLoss)), of(Column::LongLag)),
    brief(rare(row(FaultClass::Swapped(Pair::T1T2), of(Column::Exchanged), 1.0, 0.05), RARE)),
    brief(rare(within(row(FaultClass::T2Detached, of(Column::Gain2), -0.7, 0.2), -1.3, -DETACHED), -3.0)),
    // With T0 where the air is hot: T1, or T2, is below it by its own rise, the other by what is left of that.
    with(swapped_with_t0(Pair::T0T1, Column::Gain1), of(Column::Gain2), HALF_SWAPPED.0, HALF_SWAPPED.1),
    with(swapped_with_t0(Pair::T0T2, Column::Gain2), of(Column::Gain1), HALF_SWAPPED.0, HALF_SWAPPED.1),
];

/// The same in one place of memory.
pub(super) static HYPOTHESES: [Hypothesis; COUNT] = ROWS;

/// The heater that gives the same whatever is asked for: its magnitude is no share of what is asked.
pub(super) const CONSTANT: usize = 16;

impl Hypothesis {
    /// How late a change of the process by `value` may begin, where it is a large one.
    pub(super) fn later(&self, value: f32) -> Option<Free> {
        let second = self.second.filter(|second| matches!(second.direction, Direction::Of(Column::Late)))?;
        (value.abs() > LARGE).then(|| Free { sd: WITHIN_A_TICK * value.abs(), ..second })
    }

    /// The gain of a freed hypothesis, with its prior; none where the magnitude is not one that it can have.
    pub(super) fn judged(&self, mut freed: Freed) -> Freed {
        let (low, high) = self.range;
        freed.gain =
            if freed.value > low && freed.value < high { freed.gain + self.prior } else { IMPOSSIBLE };
        freed
    }
}

/// A magnitude in the unit of its class.
pub(super) fn in_unit(class: FaultClass, value: f32) -> f32 {
    match class {
        FaultClass::AirFlow => 100.0 * (1.0 / larger(0.1, 1.0 + value) - 1.0),
        FaultClass::HeaterPower | FaultClass::T1Clogged | FaultClass::T1Detached | FaultClass::T2Detached => {
            100.0 * value
        }
        _ => value,
    }
}

/// Gain of what cannot be.
pub(super) const IMPOSSIBLE: f32 = -50.0;

/// By how much the power steps without being a fault, where nothing else is known: a share.
pub(super) const POWER_SD: f32 = 0.02;

/// What may move since an onset without being a fault: mains, sensors, inlet, what the model does not know of wall and time.
pub(super) const SINCE_ONSET: [Nuisance; 10] = [
    (of(Column::Power), POWER_SD),
    (of(Column::LessFlow), 0.006),
    (of(Column::MoreFlow), 0.006),
    (of(Column::Offset1), 0.08),
    (of(Column::Offset2), 0.08),
    (Direction::Offset0, 0.12),
    (of(Column::Wall), 0.03),
    (of(Column::Shift), 0.07),
    (of(Column::Inlet1), 1.0),
    (of(Column::Inlet2), 1.0),
];

/// The same since training.
pub(super) const SINCE_TRAINING: [Nuisance; 10] = [
    (of(Column::Power), 0.025),
    (of(Column::LessFlow), 0.012),
    (of(Column::MoreFlow), 0.012),
    (of(Column::Offset1), 0.15),
    (of(Column::Offset2), 0.15),
    (Direction::Offset0, 0.3),
    (of(Column::Gain1), 0.01),
    (of(Column::Gain2), 0.01),
    (of(Column::Wall), 0.03),
    (of(Column::Shift), 0.07),
];

/// By what the model may be wrong right after training, as its fast content shows.
pub(super) const MODEL_ERRORS: [Nuisance; 7] = [
    (of(Column::Power), 0.1),
    (of(Column::LessFlow), 0.1),
    (of(Column::MoreFlow), 0.1),
    (of(Column::Gain1), 0.05),
    (of(Column::Gain2), 0.05),
    (of(Column::Wall), 0.1),
    (of(Column::Shift), 0.5),
];

/// Where the dead time's error stands among [`SINCE_ONSET`].
pub(super) const SHIFT: usize = 7;

/// Nuisances since an onset where the power steps by the mean square `steps`; `bent` is that of the gain's error here. What was learnt wrong
/// with the gain looks like flow, too.
pub(super) fn since_onset(steps: f32, bent: f32) -> [Nuisance; 10] {
    let mut nuisances = SINCE_ONSET;
    nuisances[0].1 = sqrt(steps + bent);
    for (_, sd) in &mut nuisances[FLOW] {
        *sd = sqrt(*sd * *sd + bent);
    }
    nuisances
}

/// Nuisances since training where power, flow and both offsets wander by these mean squares, and T1 rises by `rise`, degC: the gain's error at
/// the mean power is another than that of its moves, so that an offset of both is left.
pub(super) fn since_training(wander: &[f32; 4], bent: f32, rise: f32) -> [Nuisance; 10] {
    let mut nuisances = SINCE_TRAINING;
    let [power, flow, offset1, offset2] = *wander;
    let more = [power + bent, flow + bent, flow + bent, offset1, offset2, bent * rise * rise];
    for ((_, sd), more) in nuisances.iter_mut().zip(more) {
        *sd = sqrt(*sd * *sd + more);
    }
    nuisances
}

/// Places of the flow in both lists.
const FLOW: core::ops::Range<usize> = 1..3;

#[cfg(test)]
mod tests;
