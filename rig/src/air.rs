//! The heater node and what of it arrives downstream, in closed form.

use std::collections::VecDeque;

/// One segment of constant power: the rise of the air behind the heater is `target + distance e^(-(t - start) / time)`.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: f64,
    end: f64,
    target: f64,
    distance: f64,
    rate: f64,
}

impl Segment {
    fn distance_at(&self, t: f64) -> f64 {
        self.distance * libm::exp(-(t - self.start) * self.rate)
    }
}

/// The rise of the air at the heater, remembered for as long as it is under way to a sensor.
pub(crate) struct HeaterHistory {
    segments: VecDeque<Segment>,
}

impl HeaterHistory {
    /// A heater that has been off for ever.
    pub(crate) fn cold() -> Self {
        let always = Segment { start: 0.0, end: 0.0, target: 0.0, distance: 0.0, rate: 0.0 };
        Self { segments: VecDeque::from([Segment { start: f64::NEG_INFINITY, ..always }]) }
    }

    /// Adds a segment towards the rise `target` with the time constant `time`.
    pub(crate) fn drive(&mut self, from: f64, to: f64, target: f64, time: f64) {
        let before = self.rise_at(from);
        self.segments.push_back(Segment {
            start: from,
            end: to,
            target,
            distance: before - target,
            rate: 1.0 / time,
        });
    }

    /// The rise at a time; before what is remembered, the oldest that is.
    pub(crate) fn rise_at(&self, t: f64) -> f64 {
        let segment = self.segments.iter().rev().find(|s| s.start <= t).or(self.segments.front());
        segment
            .map_or(0.0, |s| if s.rate > 0.0 { s.target + s.distance_at(t.max(s.start)) } else { s.target })
    }

    /// Drops what no sensor will see any more.
    pub(crate) fn forget_before(&mut self, t: f64) {
        while self.segments.len() > 1 && self.segments[0].end < t {
            self.segments.pop_front();
        }
    }

    /// A first-order lag, at `value` at first, whose input is `base + gain rise(t)` for t from `from` to `to`.
    pub(crate) fn through(&self, from: f64, to: f64, lag: f64, base: f64, gain: f64, value: f64) -> f64 {
        let mut value = value;
        for segment in self.segments.iter().filter(|s| s.end > from && s.start < to) {
            let (a, b) = (from.max(segment.start), to.min(segment.end));
            let span = b - a;
            let keep = libm::exp(-span / lag);
            value = value * keep + (base + gain * segment.target) * (1.0 - keep);
            if segment.distance != 0.0 {
                let z = span * (1.0 / lag - segment.rate);
                value += gain * segment.distance_at(a) * (span / lag) * keep * phi1(z);
            }
        }
        value
    }
}

/// The air that flows past the three thermistors, over a time in which it does not change. Arrays are for T0,
/// T1, T2.
pub(crate) struct AirStream {
    /// Flow, relative.
    pub(crate) flow: f64,
    /// Time constants go with the flow by this.
    pub(crate) slowness: f64,
    /// Temperature before the heater, degC.
    pub(crate) ambient: f64,
    /// Time from the heater, s.
    pub(crate) delay: [f64; 3],
    /// Share of the rise that arrives.
    pub(crate) share: [f64; 3],
}

impl AirStream {
    /// The element of thermistor `i` at the end of that time, which sees `gain` times the rise with a `lag`.
    pub(crate) fn through(
        &self,
        heater: &HeaterHistory,
        i: usize,
        (from, to): (f64, f64),
        (gain, lag): (f64, f64),
        value: f64,
    ) -> f64 {
        if self.share[i] == 0.0 {
            return self.ambient + (value - self.ambient) * libm::exp(-(to - from) / lag);
        }
        let delay = self.delay[i];
        heater.through(from - delay, to - delay, lag, self.ambient, gain * self.share[i], value)
    }
}

/// (e^z - 1) / z, also at zero.
pub(crate) fn phi1(z: f64) -> f64 {
    if z.abs() < 1e-12 { 1.0 } else { libm::expm1(z) / z }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form against 20 microsecond Euler steps, over several segments, a dead time that is no multiple of
    /// anything, and a lag equal to the heater's time constant.
    #[test]
    fn closed_form_agrees_with_small_steps() {
        for (lag, dead) in [(0.05, 0.1), (0.45, 0.137), (0.40, 0.2)] {
            let (time, ts, ambient, gain) = (0.45, 0.11, 22.5, 0.85);
            let powers = [12.0, 3.0, 25.0, 25.0, 0.0, 14.0];
            let mut exact = HeaterHistory::cold();
            let mut sensor = ambient;
            for (k, &power) in powers.iter().enumerate() {
                let (from, to) = (k as f64 * ts, (k + 1) as f64 * ts);
                exact.drive(from, to, power, time);
                sensor = exact.through(from - dead, to - dead, lag, ambient, gain, sensor);
            }

            let h = 2e-5;
            let steps = (powers.len() as f64 * ts / h).round() as usize;
            let (mut rise, mut small) = (vec![0.0], ambient);
            for n in 0..steps {
                let t = n as f64 * h;
                let power = powers[((t / ts + 1e-9) as usize).min(powers.len() - 1)];
                let delayed = ((t - dead) / h).round();
                let input = if delayed < 0.0 { 0.0 } else { rise[delayed as usize] };
                small += h / lag * (ambient + gain * input - small);
                rise.push(rise[n] + h / time * (power - rise[n]));
            }
            assert!((sensor - small).abs() < 2e-3, "lag {lag}: exact {sensor}, small steps {small}");
        }
    }
}
