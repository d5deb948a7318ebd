//! Randomness of the rig: one seeded generator, and the processes that it feeds.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::air::phi1;
use crate::normal::standard_normal;

/// The seeded source.
pub(crate) struct Noise {
    generator: Xoshiro256PlusPlus,
}

/// Ingredients of the rig that are random; each draws from a stream of its own, so that it leaves all others alone.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stream {
    Mains = 1,
    Fan,
    Room,
    Pickup,
    Thermistors,
    Meter,
}

impl Noise {
    /// The stream of an ingredient.
    pub(crate) fn stream(seed: u64, stream: Stream) -> Self {
        Self::new(seed ^ (stream as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    pub(crate) fn new(seed: u64) -> Self {
        Self { generator: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    /// Standard normal.
    pub(crate) fn normal(&mut self) -> f64 {
        standard_normal(&mut self.generator)
    }

    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.generator.random_range(low..high)
    }
}

/// An Ornstein-Uhlenbeck process, stepped exactly at a fixed interval, from its stationary distribution.
pub(crate) struct OrnsteinUhlenbeck {
    value: f64,
    keep: f64,
    kick: f64,
}

impl OrnsteinUhlenbeck {
    pub(crate) fn new(sd: f64, time: f64, interval: f64, noise: &mut Noise) -> Self {
        let keep = libm::exp(-interval / time);
        Self { value: sd * noise.normal(), keep, kick: sd * libm::sqrt(1.0 - keep * keep) }
    }

    pub(crate) fn value(&self) -> f64 {
        self.value
    }

    pub(crate) fn step(&mut self, noise: &mut Noise) {
        self.value = self.keep * self.value + self.kick * noise.normal();
    }
}

/// Turbulence of the air, Ornstein-Uhlenbeck in continuous time, as a first-order sensor sees it.
///
/// Air n and sensor s obey `dn = -n/tc dt + sd sqrt(2/tc) dW`, `ds = (gain n - s)/lag dt`; over an interval both
/// are jointly normal, so one step of any length is exact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turbulence {
    sd: f64,
    time: f64,
    air: f64,
    sensor: f64,
    /// The (roughness, lag, gain, interval) that `step` was computed for.
    view: (f64, f64, f64, f64),
    transition: Transition,
}

/// One exact step: `n' = keep_air n + a z1`, `s' = keep_sensor s + pass n + b z1 + c z2`, z standard normal.
#[derive(Clone, Copy, Debug, Default)]
struct Transition {
    keep_air: f64,
    keep_sensor: f64,
    pass: f64,
    a: f64,
    b: f64,
    c: f64,
}

impl Turbulence {
    pub(crate) fn new(sd: f64, time: f64) -> Self {
        Self {
            sd,
            time,
            air: 0.0,
            sensor: 0.0,
            view: (0.0, 0.0, 0.0, 0.0),
            transition: Transition::default(),
        }
    }

    /// The part of the sensor's temperature that turbulence makes.
    pub(crate) fn at_sensor(&self) -> f64 {
        self.sensor
    }

    /// Sets the sensor through which the air is seen, and how rough the air is, relative to its standard deviation.
    pub(crate) fn see_through(&mut self, roughness: f64, lag: f64, gain: f64, interval: f64) {
        if self.view != (roughness, lag, gain, interval) {
            self.view = (roughness, lag, gain, interval);
            self.transition = transition(self.sd * roughness, 1.0 / self.time, lag, gain, interval);
        }
    }

    pub(crate) fn step(&mut self, noise: &mut Noise) {
        let t = &self.transition;
        let (z1, z2) = (noise.normal(), noise.normal());
        self.sensor = t.keep_sensor * self.sensor + t.pass * self.air + t.b * z1 + t.c * z2;
        self.air = t.keep_air * self.air + t.a * z1;
    }
}

/// Joint covariance of the two integrals over `h`, factored. `alpha` is the rate of the air.
fn transition(sd: f64, alpha: f64, lag: f64, gain: f64, h: f64) -> Transition {
    let mut beta = 1.0 / lag;
    if (beta - alpha).abs() < 1e-4 * alpha {
        beta = alpha * 1.0001; // equal rates make 0/0 of the formulae below; this errs by 1e-4 of the lag
    }
    let decay = |rate: f64| -libm::expm1(-rate * h) / rate; // integral of e^(-rate t) from 0 to h
    let ratio = beta / (beta - alpha);
    let power = 2.0 * alpha * sd * sd;
    let var_air = power * decay(2.0 * alpha);
    let covariance = gain * power * ratio * (decay(2.0 * alpha) - decay(alpha + beta));
    let squares = decay(2.0 * alpha) - 2.0 * decay(alpha + beta) + decay(2.0 * beta);
    let var_sensor = gain * gain * power * ratio * ratio * squares;
    let a = libm::sqrt(var_air);
    let b = if a > 0.0 { covariance / a } else { 0.0 };
    Transition {
        keep_air: libm::exp(-alpha * h),
        keep_sensor: libm::exp(-beta * h),
        pass: gain * beta * h * libm::exp(-beta * h) * phi1((beta - alpha) * h),
        a,
        b,
        c: libm::sqrt((var_sensor - b * b).max(0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stationary variance behind a lag is `sd^2 gain^2 tc / (tc + lag)`, at any interval, also with lag = tc.
    #[test]
    fn stationary_variance_is_exact() {
        for (lag, interval) in [(0.05, 0.11), (0.4, 0.11), (0.15, 0.002), (0.15, 0.5)] {
            let (sd, tc, gain) = (0.12, 0.15, 0.85);
            let mut turbulence = Turbulence::new(sd, tc);
            turbulence.see_through(1.0, lag, gain, interval);
            let mut noise = Noise::new(1);
            let (mut sum, n) = (0.0, 400_000);
            for _ in 0..n {
                turbulence.step(&mut noise);
                sum += turbulence.at_sensor() * turbulence.at_sensor();
            }
            let expected = (sd * gain).powi(2) * tc / (tc + lag);
            let measured = sum / f64::from(n);
            assert!((measured / expected - 1.0).abs() < 0.05, "lag {lag}: {measured} instead of {expected}");
        }
    }
}
