//! Captures a response: the residuals since something stirs, interval by interval, over the repetitions of a fault.

use super::Departure;
use super::response::{BEGINS, INTERVALS, Response};
use crate::name::Name;

/// One repetition, as it goes on. What stirred last is followed; of all that stirred within a repetition, the longest counts.
#[derive(Clone, Debug, Default)]
pub struct Capture {
    current: Sums,
    longest: Sums,
}

/// The sums of one repetition.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    ticks: u32,
    sums: [[f32; 2]; INTERVALS],
    counts: [u16; INTERVALS],
}

/// What one repetition has shown: means over the intervals, degC.
pub type Captured = [[f32; 2]; INTERVALS];

/// A repetition that stirs for less long shows no response, ticks.
const SHORTEST: u32 = BEGINS[8] as u32;

impl Capture {
    /// A repetition begins. What has just begun to stir is taken for its fault: somebody is a little late with the word.
    pub fn begin(&mut self) {
        self.longest = Sums::default();
        if self.current.ticks > SHORTEST {
            self.current = Sums::default();
        }
    }

    /// One tick; `None` where nothing stirs.
    pub fn step(&mut self, departure: Option<Departure>) {
        let Some(Departure { age, residuals }) = departure else { return };
        if age == 0 {
            if self.current.ticks > self.longest.ticks {
                self.longest = self.current;
            }
            self.current = Sums::default();
        }
        self.current.add(age, residuals);
    }

    /// The repetition ends; `None` where nothing stirred for long enough.
    pub fn end(&mut self) -> Option<Captured> {
        let longest = if self.current.ticks > self.longest.ticks { self.current } else { self.longest };
        *self = Self::default();
        (longest.ticks >= SHORTEST).then(|| longest.means())
    }
}

impl Sums {
    /// Only a tick that follows the one before: what began unseen is not followed.
    fn add(&mut self, age: u32, residuals: [f32; 2]) {
        if age < self.ticks || (age > 0 && self.ticks == 0) {
            return;
        }
        self.ticks = age + 1;
        let begun = BEGINS.iter().take_while(|begin| u32::from(**begin) <= age).count();
        if let (Some(sums), Some(count)) = (self.sums.get_mut(begun - 1), self.counts.get_mut(begun - 1)) {
            sums.iter_mut().zip(residuals).for_each(|(sum, residual)| *sum += residual);
            *count += 1;
        }
    }

    /// An interval that nothing has been seen of is as the one before.
    fn means(&self) -> Captured {
        let mut means = Captured::default();
        let mut last = [0.0; 2];
        for ((mean, sums), count) in means.iter_mut().zip(&self.sums).zip(self.counts) {
            if count > 0 {
                last = sums.map(|sum| sum / f32::from(count));
            }
            *mean = last;
        }
        means
    }
}

impl Response {
    /// The mean of some repetitions.
    pub fn mean(name: Name, repetitions: &[Captured]) -> Self {
        let n = repetitions.len() as f32;
        let mean = |i: usize, m: usize| repetitions.iter().map(|captured| captured[i][m]).sum::<f32>() / n;
        Self::new(name, &core::array::from_fn(|i| [mean(i, 0), mean(i, 1)]))
    }
}
