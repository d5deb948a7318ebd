//! The room temperature that is believed, when T0 may be wrong: it moves no faster than a room does, and is set right
//! whenever the rig is at rest, where three thermistors should agree.

use super::model::{bounded, smaller};
use super::verdict::{FaultClass, Finding, Magnitude};

/// A room changes no faster than this, degC a minute.
const FASTEST: f32 = 1.0;
/// Beyond so much from what is believed T0 is not followed, degC: no room moves so far from itself.
const FOLLOWED: f32 = 3.0;
/// At rest: no power, T1 and T2 alike to so many degC and without a trend, for so long. The trend is the difference of
/// means over two memories, s: 0.1 degC is a change of 0.3 degC a minute, slower than a hot tube cools without its fan.
const ALIKE: f32 = 2.0;
const TREND: f32 = 0.1;
const TREND_TIMES: [f32; 2] = [5.0, 25.0];
const REST_TIME: f32 = 20.0;
/// At rest T0 reads wrong from so many degC on, and right again below so many.
const WRONG: f32 = 5.0;
const RIGHT: f32 = 4.0;

/// Shares that are renewed in a tick, and steps of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    shares: [f32; 2],
    fastest: f32,
    sample_time: f32,
}

/// The memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RoomState {
    believed: Option<f32>,
    /// Means of T1 and T2 over both memories.
    means: Option<[[f32; 2]; 2]>,
    /// For how long the rig has been at rest, s.
    rest: f32,
    /// By how much T0 was seen to be wrong at rest, degC, and since which tick.
    wrong: Option<(f32, u32)>,
}

impl Room {
    pub(super) fn new(sample_time: f32) -> Self {
        Self {
            shares: TREND_TIMES.map(|time| (sample_time / time).min(1.0)),
            fastest: FASTEST / 60.0 * sample_time,
            sample_time,
        }
    }

    /// Takes in T0, T1, T2 where good, and the power applied from now on, %.
    pub(super) fn step(&self, s: &mut RoomState, tick: u32, readings: [Option<f32>; 3], power: f32) {
        let [t0, t1, t2] = readings;
        let outlet = t1.zip(t2).and_then(|(t1, t2)| self.at_rest(s, [t1, t2], power));
        s.rest = if outlet.is_some() { smaller(REST_TIME, s.rest + self.sample_time) } else { 0.0 };
        match (outlet, t0, s.believed) {
            (Some(outlet), ..) if s.rest >= REST_TIME => s.set_right(tick, t0, outlet),
            (_, Some(t0), Some(room)) if (t0 - room).abs() < FOLLOWED => {
                s.believed = Some(room + bounded(t0 - room, -self.fastest, self.fastest));
            }
            (_, t0, believed) => s.believed = believed.or(t0),
        }
    }

    /// The mean of T1 and T2, where they are at rest.
    fn at_rest(&self, s: &mut RoomState, outlet: [f32; 2], power: f32) -> Option<f32> {
        let means = s.means.get_or_insert(outlet.map(|t| [t; 2]));
        let mut still = power <= 0.0;
        for (means, t) in means.iter_mut().zip(outlet) {
            for (mean, share) in means.iter_mut().zip(self.shares) {
                *mean += share * (t - *mean);
            }
            still &= (means[0] - means[1]).abs() < TREND;
        }
        let [near, far] = [means[0][0], means[1][0]];
        (still && (near - far).abs() < ALIKE).then_some(0.5 * (near + far))
    }
}

impl RoomState {
    /// At rest, with T1 and T2 at `outlet`.
    fn set_right(&mut self, tick: u32, t0: Option<f32>, outlet: f32) {
        let off = t0.map(|t0| t0 - outlet);
        self.wrong = match (off, self.wrong) {
            (Some(off), Some((_, since))) if off.abs() > RIGHT => Some((off, since)),
            (Some(off), None) if off.abs() > WRONG => Some((off, tick)),
            _ => None,
        };
        let close = t0.filter(|t0| (t0 - outlet).abs() < ALIKE);
        self.believed = Some(close.unwrap_or(outlet));
    }

    /// The room temperature that is believed, degC.
    pub(super) fn believed(&self) -> Option<f32> {
        self.believed
    }

    /// Whether T0 may be what the room is.
    pub(super) fn is_followed(&self, t0: Option<f32>) -> bool {
        t0.zip(self.believed).is_some_and(|(t0, room)| (t0 - room).abs() < FOLLOWED)
    }

    /// Rises of T1 and T2, where good, over the room that is believed, degC.
    pub(super) fn rises(&self, outlet: [Option<f32>; 2]) -> [Option<f32>; 2] {
        outlet.map(|t| Some(t? - self.believed?))
    }

    /// A T0 that was wrong when the rig was last at rest.
    pub(super) fn finding(&self) -> Option<Finding> {
        let (off, onset) = self.wrong?;
        let magnitude = Some(Magnitude { value: off, half_width: ALIKE });
        Some(Finding { class: FaultClass::T0Fault, confidence: 1.0, magnitude, onset })
    }
}
