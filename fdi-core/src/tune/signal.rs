//! What the experiment measures with: the mean of a block, the relay, first harmonics.

use crate::root::sqrt;
use crate::turn::cos_sin;

/// Periods of the relay that are measured.
const MEASURED: f32 = 12.0;
/// So much of the first harmonic of a relay that keeps its period must be left.
const KEPT: f32 = 0.4;

/// Mean and deviation of some samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    pub(super) ticks: u32,
    first: f32,
    sum: f32,
    squares: f32,
}

impl Block {
    pub(super) fn add(&mut self, y: f32) {
        if self.ticks == 0 {
            self.first = y;
        }
        let x = y - self.first;
        (self.ticks, self.sum, self.squares) = (self.ticks + 1, self.sum + x, self.squares + x * x);
    }

    pub(super) fn mean(&self) -> f32 {
        self.first + self.sum / self.ticks.max(1) as f32
    }

    pub(super) fn deviation(&self) -> f32 {
        let n = self.ticks.max(1) as f32;
        sqrt((self.squares / n - self.sum * self.sum / (n * n)).max(0.0))
    }
}

/// A relay with hysteresis around a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relay {
    pub(super) level: f32,
    hysteresis: f32,
    high: bool,
    /// Ticks since it switched, and how often it has switched to high.
    pub(super) since: u32,
    pub(super) rises: u32,
}

impl Relay {
    pub(super) fn new(level: f32, hysteresis: f32) -> Self {
        Self { level, hysteresis, high: true, since: 0, rises: 0 }
    }

    /// Whether it has just switched to high.
    pub(super) fn step(&mut self, y: f32) -> bool {
        let edge =
            if self.high { y > self.level + self.hysteresis } else { y < self.level - self.hysteresis };
        self.since += 1;
        if edge {
            self.high = !self.high;
            self.since = 0;
            self.rises += u32::from(self.high);
        }
        edge && self.high
    }

    pub(super) fn sign(&self) -> f32 {
        if self.high { 1.0 } else { -1.0 }
    }
}

/// First harmonics of power and answer, over whole periods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Harmonics {
    /// Ticks of a period, and ticks to measure.
    pub(super) expected: f32,
    ticks: u32,
    done: u32,
    power: [f32; 2],
    answer: [f32; 2],
    /// Ticks of the first and the last rise of the power, and how many there were.
    rises: (u32, u32, u32),
}

impl Harmonics {
    pub(super) fn new(period: f32) -> Self {
        let ticks = (MEASURED * period + 0.5) as u32;
        Self { expected: period, ticks, done: 0, power: [0.0; 2], answer: [0.0; 2], rises: (0, 0, 0) }
    }

    pub(super) fn phase(&self) -> (f32, f32) {
        cos_sin(self.done as f32 / self.expected)
    }

    pub(super) fn add_answer(&mut self, y: f32) {
        let (c, s) = self.phase();
        self.answer = [self.answer[0] + c * y, self.answer[1] - s * y];
    }

    pub(super) fn add_power(&mut self, u: f32, rose: bool) {
        let (c, s) = self.phase();
        if rose {
            let first = if self.rises.2 == 0 { self.done } else { self.rises.0 };
            self.rises = (first, self.done, self.rises.2 + 1);
        }
        self.power = [self.power[0] + c * u, self.power[1] - s * u];
        self.done += 1;
    }

    pub(super) fn is_complete(&self) -> bool {
        self.done >= self.ticks
    }

    /// Whether the power really had this period: noise may make a relay with few samples a period go over to another.
    pub(super) fn is_kept(&self, swing: f32) -> bool {
        let [re, im] = self.power;
        let whole = self.ticks as f32 * swing * core::f32::consts::FRAC_2_PI;
        sqrt(re * re + im * im) > KEPT * whole
    }

    /// The period that it had in the mean, ticks.
    pub(super) fn period(&self) -> Option<f32> {
        let (first, last, count) = self.rises;
        (count > 1).then(|| (last - first) as f32 / (count - 1) as f32)
    }

    /// Answer over power: size in degC per %, and how far it lags behind, rad.
    pub(super) fn answer(&self) -> (f32, f32) {
        let [[yr, yi], [ur, ui]] = [self.answer, self.power];
        let (re, im) = (yr * ur + yi * ui, yi * ur - yr * ui);
        let size = sqrt((yr * yr + yi * yi) / (ur * ur + ui * ui));
        let ahead = libm::atan2f(im, re);
        (size, if ahead > 0.0 { core::f32::consts::TAU - ahead } else { -ahead })
    }
}
