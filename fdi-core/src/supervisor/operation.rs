//! What the supervisor has learnt of the rig: the little by which it judges whether power and temperatures go together.

use super::Situation;
use crate::bounds::{bounded, larger, smaller};
use crate::diagnosis::baseline::{Baseline, Statistics};
use crate::diagnosis::residual::Residual;
use crate::units::{Celsius, Seconds};

/// A room does not grow warmer faster than this, degC/s: 1 degC a minute.
pub(super) const AMBIENT_RATE: f32 = 1.0 / 60.0;
/// While the rig heats, the room is followed no faster than this, degC/s: 6 degC an hour. Chosen: a room that is heated by day only changes
/// by less, and T0 that drifts by 0.1 degC a minute is a fault.
const HEATED_RATE: f32 = 6.0 / 3600.0;
/// And only while T1 is as warm above T0 as the power makes it by what was learnt, within this factor. A T0 that reads too low then never raises the
/// power that is thought to be needed by more.
const CONSISTENT: f32 = 1.25;
/// A rig that needs less than this at its set-point says nothing about the power that it needs at another, %.
const MIN_POWER: f32 = 2.0;

/// The rig in regulation, as it was learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OperatingPoint {
    /// Rise of T1 over the room for each per cent of power, degC per %.
    gain: f32,
    /// T1 above T2, degC.
    t1_over_t2: f32,
}

impl OperatingPoint {
    /// From a baseline of before the restart.
    pub(super) fn restored(baseline: &Baseline) -> Self {
        let mean = |residual: Residual| baseline.raw.mean[residual as usize];
        Self { gain: mean(Residual::Rsg1), t1_over_t2: mean(Residual::Ry12) }
    }

    /// Whether T1 is as far above a room of `t0` as `power`, %, makes it.
    fn agrees(&self, power: f32, t1: f32, t0: f32) -> bool {
        let (rise, expected) = (t1 - t0, self.gain * power);
        power > MIN_POWER && expected > 0.0 && rise <= CONSISTENT * expected && expected <= CONSISTENT * rise
    }

    /// The power that the set-point needs above the room, %; None where the gain that was learnt says nothing.
    pub(super) fn power_for(&self, setpoint: Celsius, ambient: f32) -> Option<f32> {
        let power = (setpoint.0 - ambient) / self.gain;
        (!(self.gain <= 0.0 || power <= MIN_POWER)).then_some(power)
    }

    /// T1 above T2 when nothing is wrong, degC.
    pub(super) fn t1_over_t2(&self) -> f32 {
        self.t1_over_t2
    }
}

/// The room, and what is being learnt.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Operation {
    /// Ambient temperature, degC. While the heater is off T0 may read wrong: of T0 and the median of the three the
    /// lower is taken, for then the power that is thought to be needed errs upwards.
    ambient: Option<f32>,
    /// What it was when heating began.
    at_rest: Option<f32>,
    /// Power in %, T1 and T2 in degC, over the samples that belong to the baseline.
    sums: Statistics<3>,
    learnt: Option<OperatingPoint>,
}

impl Operation {
    /// What was learnt.
    pub(super) fn learnt(&self) -> Option<&OperatingPoint> {
        self.learnt.as_ref()
    }

    /// The power that the set-point needs by what was learnt, %.
    pub(super) fn power_for(&self, setpoint: Celsius) -> Option<f32> {
        self.learnt?.power_for(setpoint, self.ambient?)
    }

    pub(super) fn restore(&mut self, baseline: &Baseline) {
        self.learnt = Some(OperatingPoint::restored(baseline));
    }

    pub(super) fn forget(&mut self) {
        self.learnt = None;
    }

    /// Learning begins.
    pub(super) fn begin(&mut self) {
        self.sums = Statistics::default();
    }

    /// Learns from a sample of normal operation.
    pub(super) fn push(&mut self, now: &Situation) {
        self.sums.push(&[now.pid.0, now.sample.t1.celsius.0, now.sample.t2.celsius.0]);
    }

    /// Learning has ended well, if there was any.
    pub(super) fn end(&mut self) {
        if self.sums.count() == 0 {
            return;
        }
        let [power, t1, t2] = self.sums.mean();
        let gain = self.ambient.filter(|_| power > MIN_POWER).map_or(0.0, |ambient| (t1 - ambient) / power);
        self.learnt = Some(OperatingPoint { gain, t1_over_t2: t1 - t2 });
        self.sums = Statistics::default();
    }

    pub(super) fn knows_no_ambient(&self) -> bool {
        self.ambient.is_none()
    }

    /// Follows the room while nothing heats: down at once, up no faster than a room can.
    pub(super) fn follow_ambient(&mut self, now: &Situation, sample_time: Seconds) {
        let readings = [now.sample.t0, now.sample.t1, now.sample.t2].map(|reading| reading.good());
        let [Some(t0), Some(t1), Some(t2)] = readings else { return };
        let median = smaller(larger(t0, t1), larger(smaller(t0, t1), t2));
        let seen = smaller(t0, median);
        let highest = self.ambient.map_or(seen, |ambient| ambient + AMBIENT_RATE * sample_time.0);
        self.ambient = Some(smaller(seen, highest));
        self.at_rest = self.ambient;
    }

    /// Follows the room while it heats in regulation with the mean power `power`, %: slowly, only where T0 and what was learnt agree, and to no warmer
    /// than it was when heating began. Without that a cold night asks for more power than a room that was warm then lets expect. In a warmer room
    /// the power that is needed still errs upwards: a draught must not trip.
    pub(super) fn follow_heated_room(&mut self, now: &Situation, power: f32, sample_time: Seconds) {
        let (Some(ambient), Some(at_rest), Some(learnt)) = (self.ambient, self.at_rest, &self.learnt) else {
            return;
        };
        let (Some(t0), Some(t1)) = (now.sample.t0.good(), now.sample.t1.good()) else { return };
        let step = HEATED_RATE * sample_time.0;
        if !now.regulated.is_virtual && learnt.agrees(power, t1, t0) {
            self.ambient = Some(smaller(at_rest, bounded(t0, ambient - step, ambient + step)));
        }
    }
}
