//! The hypotheses and the nuisances, a row each: what may have changed, by how much, and what it is called.

use super::class::{Channel, FaultClass};
use super::column::{Column, Direction};
use super::evidence::{Free, Nuisance};

/// A hypothesis about what is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hypothesis {
    /// What it is called.
    pub(super) class: FaultClass,
    /// What it frees: first its magnitude.
    pub(super) first: Free,
    pub(super) second: Option<Free>,
    /// The sign that its magnitude must have; zero for either.
    pub(super) sign: f32,
    /// A reading stays where it was: the second's mean is that level, degC.
    pub(super) stays: Option<usize>,
    /// It is asked when a whole minute is judged, too.
    pub(super) lasting: bool,
}

/// Hypotheses there are.
pub(super) const COUNT: usize = 19;

const fn of(column: Column) -> Direction {
    Direction::Of(column)
}

const fn row(class: FaultClass, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis {
        class,
        first: Free { direction, mean, sd },
        second: None,
        sign: 0.0,
        stays: None,
        lasting: true,
    }
}

const fn with(row: Hypothesis, direction: Direction, mean: f32, sd: f32) -> Hypothesis {
    Hypothesis { second: Some(Free { direction, mean, sd }), ..row }
}

const fn signed(row: Hypothesis, sign: f32) -> Hypothesis {
    Hypothesis { sign, ..row }
}

/// One that a minute's means would not tell from others.
const fn brief(row: Hypothesis) -> Hypothesis {
    Hypothesis { lasting: false, ..row }
}

/// Lag of a clogged thermistor as a share of the column's lag, and its spread.
const LAGGING: (f32, f32) = (0.9, 0.3);
/// A drift begins from within so many degC.
const BEGINS: f32 = 0.2;
/// What is stuck has lost its gain but for so much, and stays within so many degC of where it was.
const STUCK: (f32, f32) = (0.03, 0.3);

/// All hypotheses. Spreads are those of the faults that may come: degC, shares, `1/f - 1`, degC a minute.
pub(super) static HYPOTHESES: [Hypothesis; COUNT] = [
    row(FaultClass::T1Offset, of(Column::Offset1), 0.0, 2.0),
    row(FaultClass::T2Offset, of(Column::Offset2), 0.0, 2.0),
    row(FaultClass::T0Fault, Direction::Offset0, 0.0, 2.0),
    signed(row(FaultClass::AirFlow, of(Column::LessFlow), 0.0, 0.3), 1.0),
    signed(row(FaultClass::AirFlow, of(Column::MoreFlow), 0.0, 0.3), -1.0),
    row(FaultClass::HeaterPower, of(Column::Power), 0.0, 0.25),
    row(FaultClass::T1Clogged, of(Column::Gain1), 0.0, 0.25),
    with(row(FaultClass::T1Clogged, of(Column::Gain1), 0.0, 0.25), of(Column::ShortLag), LAGGING.0, LAGGING.1),
    with(row(FaultClass::T1Clogged, of(Column::Gain1), 0.0, 0.25), of(Column::LongLag), LAGGING.0, LAGGING.1),
    brief(with(row(FaultClass::Drift, of(Column::Ramp1), 0.0, 3.0), of(Column::Offset1), 0.0, BEGINS)),
    brief(with(row(FaultClass::Drift, of(Column::Ramp2), 0.0, 3.0), of(Column::Offset2), 0.0, BEGINS)),
    brief(with(row(FaultClass::Drift, Direction::Ramp0, 0.0, 3.0), Direction::Offset0, 0.0, BEGINS)),
    brief(stuck(Channel::T1, Column::Gain1, Column::Offset1, 0)),
    brief(stuck(Channel::T2, Column::Gain2, Column::Offset2, 1)),
    brief(with(row(FaultClass::HeaterPower, of(Column::Constant), 40.0, 40.0), of(Column::Power), -1.0, 0.02)),
    brief(row(FaultClass::T1Detached, of(Column::Gain1), -0.7, 0.2)),
    brief(with(row(FaultClass::T1Detached, of(Column::Gain1), -0.7, 0.2), of(Column::ShortLag), LAGGING.0, LAGGING.1)),
    brief(with(row(FaultClass::T1Detached, of(Column::Gain1), -0.7, 0.2), of(Column::LongLag), LAGGING.0, LAGGING.1)),
    brief(row(FaultClass::T2Detached, of(Column::Gain2), -0.7, 0.2)),
];

/// The heater that gives the same whatever is asked for: its magnitude is no share of what is asked.
pub(super) const CONSTANT: usize = 14;

const fn stuck(which: Channel, gain: Column, offset: Column, channel: usize) -> Hypothesis {
    let row = row(FaultClass::Stuck(which), of(gain), -1.0, STUCK.0);
    Hypothesis { stays: Some(channel), ..with(row, of(offset), 0.0, STUCK.1) }
}

/// What may move since an onset without being a fault: mains, sensors, inlet, what the model does not know of wall and time.
pub(super) const SINCE_ONSET: [Nuisance; 8] = [
    (of(Column::Power), 0.02),
    (of(Column::LessFlow), 0.006),
    (of(Column::MoreFlow), 0.006),
    (of(Column::Offset1), 0.08),
    (of(Column::Offset2), 0.08),
    (Direction::Offset0, 0.12),
    (of(Column::Wall), 0.03),
    (of(Column::Shift), 0.07),
];

/// The same since training.
pub(super) const SINCE_TRAINING: [Nuisance; 10] = [
    (of(Column::Power), 0.025),
    (of(Column::LessFlow), 0.015),
    (of(Column::MoreFlow), 0.015),
    (of(Column::Offset1), 0.2),
    (of(Column::Offset2), 0.2),
    (Direction::Offset0, 0.4),
    (of(Column::Gain1), 0.01),
    (of(Column::Gain2), 0.01),
    (of(Column::Wall), 0.03),
    (of(Column::Shift), 0.07),
];
