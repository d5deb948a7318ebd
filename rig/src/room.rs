//! The room: draughts, night and day, and a rig that warms the air which it draws in.

use std::f64::consts::TAU;

use crate::constants::constants;
use crate::noise::{Noise, Stream};

constants! {
    /// The room: draughts, night and day, and the warmth of the rig itself.
    pub struct RoomConfig / RoomChanges in "rig.room" {
        /// Draughts an hour, in the mean (0: none).
        draughts: f64 = 0.0, 0.0..=3600.0;
        /// The air of a draught is so much colder, degC; from one to the next 0.5 to 1.5 times that.
        draught_depth: f64 = 0.5, -20.0..=20.0;
        /// How long a draught lasts, s; 0.5 to 1.5 times that.
        draught_time: f64 = 10.0, 0.01..=10000.0;
        /// Amplitude of the ambient temperature within 24 h, degC (0: none); the seed sets the hour.
        day_swing: f64 = 0.0, 0.0..=20.0;
        /// The inlet warms by so much once the heater has been switched on, degC.
        warm_up: f64 = 0.0, 0.0..=20.0;
        /// Time constant of that, s.
        warm_up_time: f64 = 900.0, 1.0..=1e6;
    }
}

const DAY: f64 = 86_400.0;

/// The room in motion; draughts begin and end at ticks.
pub(crate) struct Room {
    config: RoomConfig,
    noise: Noise,
    /// Probability that a draught begins within a tick.
    chance: f64,
    /// Depth and end of the present draught, degC and s.
    draught: Option<(f64, f64)>,
    phase: f64,
    /// When the heater was first on, s.
    warm_since: Option<f64>,
}

impl Room {
    /// None if nothing of it is on.
    pub(crate) fn new(config: &RoomConfig, interval: f64, seed: u64) -> Option<Self> {
        let is_on = config.draughts > 0.0 || config.day_swing > 0.0 || config.warm_up > 0.0;
        is_on.then(|| {
            let mut noise = Noise::stream(seed, Stream::Room);
            Self {
                phase: noise.uniform(0.0, TAU),
                noise,
                chance: -libm::expm1(-config.draughts * interval / 3600.0),
                draught: None,
                warm_since: None,
                config: config.clone(),
            }
        })
    }

    /// How much warmer the air at the inlet is than the rig's `ambient`, degC.
    pub(crate) fn warmer(&self, t: f64) -> f64 {
        let c = &self.config;
        let day = c.day_swing * libm::sin(TAU * t / DAY + self.phase);
        let warmth = |since: f64| -c.warm_up * libm::expm1(-(t - since) / c.warm_up_time);
        day + self.warm_since.map_or(0.0, warmth) - self.draught.map_or(0.0, |(depth, _)| depth)
    }

    /// Moves on to the tick at `t`; the heater was on or off. It draws as much whether a draught comes or not.
    pub(crate) fn step(&mut self, t: f64, heater_is_on: bool) {
        if heater_is_on {
            self.warm_since.get_or_insert(t);
        }
        let [chance, depth, time] =
            [(0.0, 1.0), (0.5, 1.5), (0.5, 1.5)].map(|(a, b)| self.noise.uniform(a, b));
        self.draught = self.draught.filter(|(_, end)| t < *end);
        if self.draught.is_none() && chance < self.chance {
            self.draught = Some((depth * self.config.draught_depth, t + time * self.config.draught_time));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draughts_come_as_often_last_as_long_and_are_as_deep_as_set() {
        let config = RoomConfig { draughts: 30.0, draught_depth: 2.0, ..RoomConfig::default() };
        let mut room = Room::new(&config, 0.1, 1).unwrap();
        let (mut begun, mut within, mut depths) = (0, 0, 0.0);
        let mut before = 0.0;
        let ticks = 3_600_000; // 100 h
        for n in 0..ticks {
            let t = f64::from(n) * 0.1;
            room.step(t, true);
            let colder = -room.warmer(t);
            within += u32::from(colder > 0.0);
            if colder > 0.0 && before == 0.0 {
                begun += 1;
                depths += colder;
            }
            before = colder;
        }
        // One begins only where none is: of an hour, 30 times 10 s are taken up by them
        let rate = 30.0 / (1.0 + 30.0 * 10.0 / 3600.0);
        let (rate_is, depth) = (f64::from(begun) / 100.0, depths / f64::from(begun));
        assert!((rate_is - rate).abs() < 1.5, "{rate_is} an hour instead of {rate}");
        assert!((depth - 2.0).abs() < 0.05, "{depth} degC");
        let time = f64::from(within) * 0.1 / f64::from(begun);
        assert!((time - 10.0).abs() < 0.3, "{time} s");
    }

    #[test]
    fn the_day_is_a_sine_and_the_rig_warms_from_when_it_is_on() {
        let config = RoomConfig { day_swing: 5.0, ..RoomConfig::default() };
        let mut room = Room::new(&config, 1.0, 3).unwrap();
        assert!((room.warmer(1000.0) + room.warmer(1000.0 + DAY / 2.0)).abs() < 1e-9);
        let quarter = room.warmer(1000.0).hypot(room.warmer(1000.0 + DAY / 4.0));
        assert!((quarter - 5.0).abs() < 1e-9, "{quarter}");

        room.config = RoomConfig { warm_up: 3.0, ..RoomConfig::default() };
        room.step(10.0, false);
        assert!(room.warmer(500.0) == 0.0);
        room.step(100.0, true);
        room.step(200.0, true);
        assert!((room.warmer(1000.0) - 3.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
    }
}
