//! Thermistors as they are made: each a little different, warmed by the current through it, and with a body that is slower than
//! its tip.

use crate::constants::constants;
use crate::noise::{Noise, Stream};

/// 0 degC in kelvin.
pub(crate) const KELVIN: f64 = 273.15;
/// 25 degC in kelvin.
pub(crate) const T25: f64 = 298.15;

constants! {
    /// Thermistors that differ from their data sheet: R25 and beta by so many %, and an offset.
    pub struct SensorConfig / SensorChanges in "rig.thermistor" {
        /// R25 of T0 above its nominal, %.
        t0_r25: f64 = 0.0, -20.0..=20.0;
        /// R25 of T1 above its nominal, %.
        t1_r25: f64 = 0.0, -20.0..=20.0;
        /// R25 of T2 above its nominal, %.
        t2_r25: f64 = 0.0, -20.0..=20.0;
        /// Standard deviation of R25 from one thermistor to the next, drawn from the seed, %.
        r25_sd: f64 = 0.0, 0.0..=5.0;
        /// Beta of T0 above its nominal, %.
        t0_beta: f64 = 0.0, -10.0..=10.0;
        /// Beta of T1 above its nominal, %.
        t1_beta: f64 = 0.0, -10.0..=10.0;
        /// Beta of T2 above its nominal, %.
        t2_beta: f64 = 0.0, -10.0..=10.0;
        /// Standard deviation of beta, drawn from the seed, %.
        beta_sd: f64 = 0.0, 0.0..=3.0;
        /// T0 reads so much too high, degC.
        t0_offset: f64 = 0.0, -10.0..=10.0;
        /// T1 reads so much too high, degC.
        t1_offset: f64 = 0.0, -10.0..=10.0;
        /// T2 reads so much too high, degC.
        t2_offset: f64 = 0.0, -10.0..=10.0;
        /// Standard deviation of the offset, drawn from the seed, degC.
        offset_sd: f64 = 0.0, 0.0..=3.0;
        /// Self-heating at 25 degC in still air, where T0 lies, degC (0: none).
        self_heating: f64 = 0.0, 0.0..=10.0;
        /// Moving air of nominal flow cools so many times as well as still air, on top of it; it goes as the root of the flow.
        self_cooling: f64 = 3.0, 0.0..=100.0;
        /// Share of the reading that is the body's, the second lag (0: none).
        body_share: f64 = 0.0, 0.0..=0.9;
        /// Time constant of the body behind the tip, s.
        body_time: f64 = 5.0, 0.1..=1000.0;
        /// The lags of T1 and T2 go with the flow to the power of minus this.
        lag_exponent: f64 = 0.0, 0.0..=3.0;
    }
}

/// How one thermistor differs from its data sheet.
#[derive(Clone, Copy, Debug)]
struct Departure {
    /// Logarithm of its R25 over the nominal one.
    r25: f64,
    /// Its beta over the nominal one.
    beta: f64,
    /// degC.
    offset: f64,
}

/// The three thermistors.
pub(crate) struct Thermistors {
    config: SensorConfig,
    beta: f64,
    r25_over_pull_up: f64,
    /// None if they are alike.
    departures: Option<[Departure; 3]>,
}

impl Thermistors {
    /// `beta` and `r25_over_pull_up` are those of the data sheet.
    pub(crate) fn new(config: &SensorConfig, beta: f64, r25_over_pull_up: f64, seed: u64) -> Self {
        Self { departures: departures(config, seed), beta, r25_over_pull_up, config: config.clone() }
    }

    /// The temperature at which a thermistor by the data sheet has the resistance of thermistor `i`, with its offset, degC.
    pub(crate) fn indicated(&self, i: usize, celsius: f64) -> f64 {
        let Some(departures) = &self.departures else { return celsius };
        let d = departures[i];
        let from_25 = 1.0 / (celsius + KELVIN) - 1.0 / T25;
        1.0 / (1.0 / T25 + d.r25 / self.beta + d.beta * from_25) - KELVIN + d.offset
    }

    /// The lag of thermistor `i` at a flow, s, of one with `lag` at nominal flow.
    pub(crate) fn lag(&self, i: usize, lag: f64, flow: f64) -> f64 {
        let exponent = self.config.lag_exponent;
        if i == 0 || exponent == 0.0 { lag } else { lag * libm::pow(flow, -exponent) }
    }

    /// Steady self-heating of thermistor `i` at a temperature, degC: the power in the divider is largest where the thermistor
    /// has the resistance of the pull-up, and the air carries it away (King's law).
    fn self_heating(&self, i: usize, celsius: f64, flow: f64) -> f64 {
        let r = |celsius: f64| {
            self.r25_over_pull_up * libm::exp(self.beta * (1.0 / (celsius + KELVIN) - 1.0 / T25))
        };
        let power = |r: f64| r / (1.0 + r) / (1.0 + r);
        let cooling = if i == 0 { 1.0 } else { 1.0 + self.config.self_cooling * libm::sqrt(flow) };
        self.config.self_heating * power(r(celsius)) / power(self.r25_over_pull_up) / cooling
    }
}

/// From the settings and the seed.
fn departures(c: &SensorConfig, seed: u64) -> Option<[Departure; 3]> {
    let set = [
        (c.t0_r25, c.t0_beta, c.t0_offset),
        (c.t1_r25, c.t1_beta, c.t1_offset),
        (c.t2_r25, c.t2_beta, c.t2_offset),
    ];
    let spread = (c.r25_sd, c.beta_sd, c.offset_sd);
    let is_on = spread != (0.0, 0.0, 0.0) || set.iter().any(|&s| s != (0.0, 0.0, 0.0));
    is_on.then(|| {
        let mut noise = Noise::stream(seed, Stream::Thermistors);
        set.map(|(r25, beta, offset)| Departure {
            r25: libm::log1p((r25 + c.r25_sd * noise.normal()) / 100.0),
            beta: 1.0 + (beta + c.beta_sd * noise.normal()) / 100.0,
            offset: offset + c.offset_sd * noise.normal(),
        })
    })
}

/// What makes a thermistor read other than its tip: its slow body and its own heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bead {
    /// Temperature of the body, degC.
    body: f64,
    /// Its own heat, degC.
    own_heat: f64,
}

impl Bead {
    pub(crate) fn new(celsius: f64) -> Self {
        Self { body: celsius, own_heat: 0.0 }
    }

    /// What thermistor `i` has, degC, after the time `span` in which its tip went straight from one temperature to another,
    /// in air of a flow, with a `lag`. Straight will do: the body is much slower than a stretch of time is long.
    pub(crate) fn follow(
        &mut self,
        thermistors: &Thermistors,
        i: usize,
        span: f64,
        [before, tip]: [f64; 2],
        (flow, lag): (f64, f64),
    ) -> f64 {
        let c = &thermistors.config;
        let mut celsius = tip;
        if c.body_share > 0.0 {
            let keep = libm::exp(-span / c.body_time);
            let mean = (1.0 - keep) * c.body_time / span;
            self.body = keep * self.body + (mean - keep) * before + (1.0 - mean) * tip;
            celsius += c.body_share * (self.body - tip);
        }
        if c.self_heating > 0.0 {
            let steady = thermistors.self_heating(i, tip, flow);
            self.own_heat = steady + (self.own_heat - steady) * libm::exp(-span / lag);
            celsius += self.own_heat;
        }
        celsius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thermistors(config: SensorConfig, seed: u64) -> Thermistors {
        Thermistors::new(&config, 3950.0, 1.0, seed)
    }

    /// The resistance by its own R25 and beta is that of the data sheet at what it indicates.
    #[test]
    fn what_is_indicated_has_the_same_resistance() {
        let config = SensorConfig { t1_r25: 5.0, t1_beta: -1.0, ..SensorConfig::default() };
        let some = thermistors(config, 1);
        let r =
            |r25: f64, beta: f64, celsius: f64| r25 * (beta * (1.0 / (celsius + KELVIN) - 1.0 / T25)).exp();
        for celsius in [-10.0, 25.0, 35.0, 80.0] {
            let (own, sheet) =
                (r(10500.0, 3950.0 * 0.99, celsius), r(10000.0, 3950.0, some.indicated(1, celsius)));
            assert!((own / sheet - 1.0).abs() < 1e-9, "{celsius}: {own} {sheet}");
            assert!((some.indicated(2, celsius) - celsius).abs() < 1e-9);
        }
        // 1 % more ohm at 25 degC are 0.223 degC less
        let more = thermistors(SensorConfig { t0_r25: 1.0, ..SensorConfig::default() }, 1);
        assert!((more.indicated(0, 25.0) - 24.776).abs() < 1e-3);
        assert!(thermistors(SensorConfig::default(), 1).indicated(0, 35.1) == 35.1);
    }

    #[test]
    fn drawn_offsets_have_their_standard_deviation_and_go_by_the_seed() {
        let draw = |seed| {
            thermistors(SensorConfig { offset_sd: 0.5, ..SensorConfig::default() }, seed).indicated(1, 30.0)
                - 30.0
        };
        let sd = ((0..4000).map(|seed| draw(seed).powi(2)).sum::<f64>() / 4000.0).sqrt();
        assert!((sd - 0.5).abs() < 0.02, "{sd}");
        assert!(draw(1) == draw(1) && draw(1) != draw(2));
    }

    #[test]
    fn own_heat_is_as_set_at_25_degrees_in_still_air_and_falls_with_flow_and_heat() {
        let config = SensorConfig { self_heating: 0.4, ..SensorConfig::default() };
        let some = thermistors(config, 1);
        let heat = |i, celsius, flow| {
            let mut bead = Bead::new(celsius);
            bead.follow(&some, i, 1e3, [celsius; 2], (flow, 0.4)) - celsius
        };
        assert!((heat(0, 25.0, 1.0) - 0.4).abs() < 1e-9);
        assert!((heat(1, 25.0, 1.0) - 0.1).abs() < 1e-9);
        assert!((heat(1, 25.0, 4.0) - 0.4 / 7.0).abs() < 1e-9);
        assert!(heat(0, 60.0, 1.0) < 0.33);
    }

    /// The tip rises as 1 - e^(-t/a); behind it a body with b: the difference of two exponentials.
    #[test]
    fn the_body_is_a_second_lag() {
        let config = SensorConfig { body_share: 0.3, body_time: 4.0, ..SensorConfig::default() };
        let some = thermistors(config, 1);
        let (a, b, h) = (0.4_f64, 4.0_f64, 0.1);
        let tip = |n: i32| 1.0 - (-f64::from(n) * h / a).exp();
        let mut bead = Bead::new(0.0);
        for n in 0..200 {
            let celsius = bead.follow(&some, 1, h, [tip(n), tip(n + 1)], (1.0, a));
            let t = f64::from(n + 1) * h;
            let body = 1.0 - (b * (-t / b).exp() - a * (-t / a).exp()) / (b - a);
            let expected = 0.7 * tip(n + 1) + 0.3 * body;
            assert!((celsius - expected).abs() < 1e-3, "{t} s: {celsius}, expected {expected}");
        }
    }

    #[test]
    fn lags_in_the_air_fall_with_the_flow() {
        let some = thermistors(SensorConfig { lag_exponent: 0.5, ..SensorConfig::default() }, 1);
        assert!((some.lag(2, 0.4, 4.0) - 0.2).abs() < 1e-12 && some.lag(0, 0.4, 4.0) == 0.4);
    }
}
