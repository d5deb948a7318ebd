//! The wall of the tube: air that has met it carries a share of the wall's temperature instead of its own.
//!
//! With the share s and the time constant tau_w, a sensor is in air of `(1 - s) T + s LP(T, tau_w)`, where T is the room and the rise
//! m; in steady state it is T. So a wall holds a draught back as it does the heat.

use crate::air::{AirStream, HeaterHistory};
use crate::constants::constants;

constants! {
    /// The wall of the tube, which exchanges heat with the air.
    pub struct WallConfig / WallChanges in "rig.wall" {
        /// Share of the rise at T1 that comes by way of the wall, at nominal flow (0: no wall).
        t1_share: f64 = 0.0, 0.0..=0.5;
        /// The same at T2, which has more wall before it.
        t2_share: f64 = 0.0, 0.0..=0.5;
        /// Time constant of the wall at nominal flow, s.
        time: f64 = 30.0, 0.1..=10000.0;
    }
}

/// Largest share, however little air flows.
const MOST: f64 = 0.95;

/// The wall upstream of one thermistor.
pub(crate) struct Wall {
    share: f64,
    time: f64,
    /// What it has of the room, degC.
    ambient: f64,
    /// Its rise above that, degC.
    rise: f64,
}

/// What the wall does over a stretch of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallEffect {
    /// Share of the rise that comes by way of the wall.
    share: f64,
    /// Time constant, s.
    time: f64,
    /// What it has of the room at the beginning and at the end, degC.
    ambient: [f64; 2],
    /// Rise of the wall at the beginning and at the end, degC.
    rise: [f64; 2],
}

impl Wall {
    /// Cold walls before T0, T1, T2, as warm as the room; none where the share is zero.
    pub(crate) fn before_each(config: &WallConfig, ambient: f64) -> [Option<Self>; 3] {
        let wall = |share| (share > 0.0).then_some(Self { share, time: config.time, ambient, rise: 0.0 });
        [None, wall(config.t1_share), wall(config.t2_share)]
    }

    /// Lets it follow the air before thermistor `i`. The film coefficient h goes with the time constants of the air: the wall's
    /// is as 1/h, and the share is as h/flow.
    pub(crate) fn follow(
        &mut self,
        air: &AirStream,
        heater: &HeaterHistory,
        i: usize,
        (from, to): (f64, f64),
    ) -> WallEffect {
        let (time, delay) = (self.time * air.slowness, air.delay[i]);
        let (room, rise) = (self.ambient, self.rise);
        self.ambient = air.ambient + (room - air.ambient) * libm::exp(-(to - from) / time);
        self.rise = heater.through(from - delay, to - delay, time, 0.0, air.share[i], rise);
        WallEffect { share: self.share_at(air), time, ambient: [room, self.ambient], rise: [rise, self.rise] }
    }

    fn share_at(&self, air: &AirStream) -> f64 {
        (self.share / air.slowness / air.flow).min(MOST)
    }

    /// The rise above the room of the air that arrives, if it would be `rise` without the wall.
    pub(crate) fn mix(&self, air: &AirStream, rise: f64) -> f64 {
        rise + self.share_at(air) * (self.ambient - air.ambient + self.rise - rise)
    }
}

impl WallEffect {
    /// A thermistor with a `lag` and the `gain`, after the stretch of time `span`: `direct` is it at both ends without a wall,
    /// `value` with it at the beginning.
    ///
    /// The lag of a lag is a difference of both: `LP(LP(m, tau_w), lag) = (tau_w LP(m, tau_w) - lag LP(m, lag)) / (tau_w - lag)`
    /// but for what decays with `lag`.
    pub(crate) fn through(&self, (gain, lag): (f64, f64), span: f64, direct: [f64; 2], value: f64) -> f64 {
        let apart = self.time - lag;
        let apart = if apart.abs() < 1e-6 * lag { 1e-6 * lag } else { apart };
        let follow = |end: usize| {
            let wall = self.ambient[end] + gain * self.rise[end];
            let twice = wall + lag * (wall - direct[end]) / apart;
            direct[end] + self.share * (twice - direct[end])
        };
        follow(1) + (value - follow(0)) * libm::exp(-span / lag)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AMBIENT: f64 = 22.5;

    fn stream(flow: f64, ambient: f64) -> AirStream {
        let slowness = libm::pow(flow, -0.8);
        let (delay, share) = ([0.0, 0.137 / flow, 0.2 / flow], [0.0, 1.0, 0.92]);
        AirStream { flow, slowness, ambient, delay, share }
    }

    /// The closed form against 20 microsecond Euler steps, with more and colder air from the middle on, and a share and a time
    /// constant that follow it.
    #[test]
    fn closed_form_agrees_with_small_steps() {
        let (heater_time, lag, gain, span) = (0.45, 0.4, 0.85, 0.11);
        let config = WallConfig { t1_share: 0.3, time: 3.0, ..WallConfig::default() };
        let [_, wall, _] = Wall::before_each(&config, AMBIENT);
        let mut wall = wall.unwrap();
        let mut heater = HeaterHistory::cold();
        let (mut direct, mut exact, mut small, mut small_wall) = (AMBIENT, AMBIENT, AMBIENT, AMBIENT);
        let h = 2e-5;
        for k in 0..100 {
            let air = if k < 50 { stream(1.0, AMBIENT) } else { stream(1.3, AMBIENT - 3.0) };
            let (from, to) = (f64::from(k) * span, f64::from(k + 1) * span);
            heater.drive(from, to, if k % 20 < 10 { 15.0 } else { 5.0 }, heater_time);
            let effect = wall.follow(&air, &heater, 1, (from, to));
            let before = direct;
            direct = air.through(&heater, 1, (from, to), (gain, lag), before);
            exact = effect.through((gain, lag), span, [before, direct], exact);

            let film = air.flow.powf(0.8);
            for n in 0..(span / h).round() as usize {
                let rise = heater.rise_at(from + (n as f64 + 0.5) * h - air.delay[1]);
                let direct = air.ambient + gain * rise;
                let mixed = direct + 0.3 * film / air.flow * (small_wall - direct);
                small += h / lag * (mixed - small);
                small_wall += h * film / 3.0 * (direct - small_wall);
            }
            assert!((exact - small).abs() < 2e-3, "tick {k}: exact {exact}, small steps {small}");
        }
        assert!((exact - direct).abs() > 0.1, "the wall is felt");
    }

    /// A step: at once (1 - s) of it, the rest with the wall's time constant, in the end all of it.
    #[test]
    fn a_step_comes_in_two_parts() {
        let [_, wall, _] = Wall::before_each(&WallConfig { t1_share: 0.1, ..WallConfig::default() }, AMBIENT);
        let mut wall = wall.unwrap();
        let mut heater = HeaterHistory::cold();
        heater.drive(0.0, 1000.0, 10.0, 0.001);
        let air = stream(1.0, AMBIENT);
        for (from, to) in [(0.0, 0.237), (0.237, 30.137), (30.137, 900.0)] {
            wall.follow(&air, &heater, 1, (from, to));
            let felt = to - 0.137;
            let expected = 10.0 - (-felt / 30.0_f64).exp();
            assert!((wall.mix(&air, 10.0) - expected).abs() < 1e-3, "after {felt} s");
        }
    }
}
