//! What a run did with the heat: how hot the air truly became, how soon the heater was off, and why.

use std::collections::VecDeque;

use fdi_core::{Mode, TripReason};
use serde::{Deserialize, Serialize};

use crate::experiment::scenario::Scenario;
use crate::experiment::{Row, as_written};
use crate::score::microseconds;
use pt326_rig::Rig;
use pt326_rig::fault::Fault;

/// An error of a thermistor above this is a contradiction that can be seen, degC: far above noise and turbulence.
const VISIBLE: f64 = 3.0;
/// Power above so many times what the set-point needed while learning is too much.
const OVERPOWER: f64 = 1.8;
/// The power is averaged over so long before it is called too much, s: the excitation is not meant.
const AVERAGE: f64 = 1.0;

/// What is kept of a run. "Since the onset" is since arming where that is later, or where no fault is scored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Heat {
    /// Highest true temperature of the air at T1 since the onset, degC.
    pub air_max_c: f64,
    /// The same less the set-point of that tick, degC.
    pub overshoot_max_c: f64,
    /// Why it tripped first; null: it did not.
    pub trip: Option<TripReason>,
    /// When, s.
    pub tripped_s: Option<f64>,
    /// Onset to heater off, s; null: never, or it was off already.
    pub off_delay_s: Option<f64>,
    /// The same from the first tick since the onset on which a thermistor read more than 3 degC away from what it would
    /// read without a fault of a sensor, or the controller asked for all the power there is.
    pub off_after_visible_s: Option<f64>,
    /// Longest time since the onset that the controller went on asking for all the power there is, s.
    pub saturated_s: f64,
    /// Longest time since the onset with more than 1.8 times the mean power of the second half of learning, each
    /// averaged over a second; null: it had not learnt.
    pub overpower_s: Option<f64>,
}

/// Measures a run.
pub(super) struct HeatMeter {
    onset: f64,
    sample_time: f64,
    /// The largest output of the controller, %.
    full: f32,
    heat: Heat,
    visible_at: Option<f64>,
    saturated: Spell,
    overpower: Spell,
    power: Power,
}

impl HeatMeter {
    pub(super) fn new(config: &fdi_core::Config, scenario: &Scenario, fault: Option<&Fault>) -> Self {
        let sample_time = as_written(config.sample_time.0);
        Self {
            onset: fault.map_or(0.0, |f| f.at).max(scenario.arm_at),
            sample_time,
            full: config.pid.output_max.0,
            heat: Heat { air_max_c: f64::MIN, overshoot_max_c: f64::MIN, ..Heat::default() },
            visible_at: None,
            saturated: Spell::default(),
            overpower: Spell::default(),
            power: Power::new((AVERAGE / sample_time).round().max(1.0) as usize),
        }
    }

    /// One tick, at `t`; the rig has not moved on from it.
    pub(super) fn observe(&mut self, t: f64, row: &Row, rig: &Rig) {
        let tick = &row.tick;
        self.note_trip(t, &tick.mode);
        self.power.observe(f64::from(tick.drive.0), &tick.mode);
        if t < self.onset {
            return;
        }
        let [air, _] = rig.air();
        self.heat.air_max_c = self.heat.air_max_c.max(air);
        self.heat.overshoot_max_c = self.heat.overshoot_max_c.max(air - f64::from(tick.setpoint.0));
        let saturated = tick.mode.is_heating() && tick.pid.0 >= self.full;
        self.saturated.observe(saturated);
        self.overpower.observe(self.power.is_too_much());
        if saturated || rig.sensor_error() > VISIBLE {
            self.visible_at.get_or_insert(t);
        }
    }

    fn note_trip(&mut self, t: f64, mode: &Mode) {
        let Mode::Tripped(trip) = mode else { return };
        if self.heat.trip.is_some() {
            return;
        }
        self.heat.trip = Some(trip.reason);
        self.heat.tripped_s = Some(t);
        if t >= self.onset {
            self.heat.off_delay_s = Some(microseconds(t - self.onset));
            self.heat.off_after_visible_s = Some(microseconds(t - self.visible_at.unwrap_or(t)));
        }
    }

    pub(super) fn finish(self) -> Heat {
        let seconds = |ticks: u32| microseconds(f64::from(ticks) * self.sample_time);
        Heat {
            saturated_s: seconds(self.saturated.longest),
            overpower_s: self.power.needed.map(|_| seconds(self.overpower.longest)),
            ..self.heat
        }
    }
}

/// Ticks in a row.
#[derive(Default)]
struct Spell {
    now: u32,
    longest: u32,
}

impl Spell {
    fn observe(&mut self, goes_on: bool) {
        self.now = if goes_on { self.now + 1 } else { 0 };
        self.longest = self.longest.max(self.now);
    }
}

/// The power applied lately, against what it was in the second half of learning.
struct Power {
    lately: VecDeque<f64>,
    window: usize,
    learning: Vec<f64>,
    needed: Option<f64>,
}

impl Power {
    fn new(window: usize) -> Self {
        Self { lately: VecDeque::new(), window, learning: Vec::new(), needed: None }
    }

    fn observe(&mut self, drive: f64, mode: &Mode) {
        self.lately.push_back(drive);
        if self.lately.len() > self.window {
            self.lately.pop_front();
        }
        match mode {
            Mode::Learn { .. } => self.learning.push(drive),
            Mode::Monitor if !self.learning.is_empty() => {
                let half = self.learning.split_off(self.learning.len() / 2);
                self.needed = Some(half.iter().sum::<f64>() / half.len() as f64);
                self.learning.clear();
            }
            Mode::Monitor => {}
            _ => self.learning.clear(),
        }
    }

    fn is_too_much(&self) -> bool {
        let mean = self.lately.iter().sum::<f64>() / self.lately.len() as f64;
        self.needed.is_some_and(|needed| mean > OVERPOWER * needed)
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::{AdcCode, Command, Config, Instrument, Percent, RawSample, Trip};

    use super::*;
    use pt326_rig::fault::{Sensor, Verb};
    use pt326_rig::{Disturbance, RigConfig};

    /// A tick on which nothing happens.
    fn quiet() -> Row {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let code = AdcCode(2160.0);
        let tick = instrument.control(RawSample { t0: code, t1: code, t2: code, ..RawSample::default() });
        Row { report: instrument.diagnose(&tick, Percent(0.0)), applied: Percent(0.0), tick, truth: 0 }
    }

    /// A trip that an instrument made, with another reason.
    fn tripped(reason: TripReason) -> Mode {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        instrument.command(Command::Arm).unwrap();
        let (ambient, open) = (AdcCode(2160.0), AdcCode(4095.0));
        let mode = (0..9)
            .map(|_| {
                instrument
                    .control(RawSample { t0: ambient, t1: open, t2: ambient, ..RawSample::default() })
                    .mode
            })
            .last();
        let Some(Mode::Tripped(trip)) = mode else { panic!("{mode:?}, expected a trip") };
        Mode::Tripped(Trip { reason, ..trip })
    }

    /// T1 leaves the tube at 20 s, having learnt until 10 s at 40 %; the controller asks for all until it trips at `off`.
    fn heat(off: f64) -> Heat {
        let fault = Fault::new(Verb::Detach, Some(Sensor::T1), Some(1.0), 20.0, 100.0);
        let still = RigConfig { turbulence: 0.0, white_noise: 0.0, ..RigConfig::default() };
        let mut rig = Rig::new(&still, Disturbance::None, 0.11, 1, std::slice::from_ref(&fault));
        let mut meter = HeatMeter::new(&Config::default(), &Scenario::default(), Some(&fault));
        for i in 0..400 {
            let t = f64::from(i) * 0.11;
            let mut row = quiet();
            (row.tick.mode, row.tick.pid) = match t {
                _ if t >= off => (tripped(TripReason::T2OverTemperature), Percent(0.0)),
                _ if t >= 20.0 => (Mode::Monitor, Percent(100.0)),
                _ if t >= 10.0 => (Mode::Monitor, Percent(40.0)),
                _ => (Mode::Learn { accepted: 0 }, Percent(40.0)),
            };
            row.tick.drive = row.tick.pid;
            rig.sample();
            meter.observe(t, &row, &rig);
            rig.advance(f64::from(row.tick.drive.0));
        }
        meter.finish()
    }

    #[test]
    fn heat_is_measured_by_the_true_air_and_the_heater() {
        let heat = heat(26.0);
        let near = |x: Option<f64>, expected: f64| (x.unwrap() - expected).abs() < 0.12;
        assert!(
            (heat.air_max_c - 52.5).abs() < 1e-3 && (heat.overshoot_max_c - 17.5).abs() < 1e-3,
            "{heat:?}"
        );
        assert!(near(heat.off_delay_s, 6.05) && near(heat.off_after_visible_s, 6.05), "{heat:?}");
        assert!(near(Some(heat.saturated_s), 5.94), "{heat:?}");
        assert!(near(heat.overpower_s, 5.94), "above 72 % half a second late, and as long after: {heat:?}");
        assert_eq!(heat.trip, Some(TripReason::T2OverTemperature));
    }

    #[test]
    fn what_tripped_before_the_fault_tried_nothing() {
        let early = heat(15.0);
        assert_eq!((early.off_delay_s, early.off_after_visible_s), (None, None));
        assert!(early.tripped_s.is_some_and(|t| (15.0..15.2).contains(&t)) && early.saturated_s == 0.0);
    }
}
