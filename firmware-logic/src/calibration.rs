//! Calibration of the thermistors against a reference, at rest: points are taken one by one, the line through them is put in force only
//! when it is asked for, and what was in force before comes back when that is asked for.
//!
//! One temperature gives the offset; two that are [`APART`] give the gain as well, more of them the line of least squares.

use core::fmt;

use fdi_core::sense::thermistor::ThermistorConfig;
use fdi_core::{Config, Sample};
use heapless::Vec;

use crate::decimal::{Fixed, rounded};

/// Names of the thermistors, in the order of all arrays here.
pub const NAMES: [&str; 3] = ["t0", "t1", "t2"];
/// Points of one thermistor, at most.
pub const POINTS: usize = 4;
/// Readings in degC that must lie so far apart to tell the gain from the offset.
pub const APART: f32 = 10.0;
/// What a thermistor can be wrong by; beyond it something else is: the reference, a wire, its type.
const MOST_OFFSET: f32 = 10.0;
const MOST_GAIN: f32 = 1.1;

/// Shares of a new reading in the slow and in the fast mean, and ticks after which the slow one is one.
const SLOW: f32 = 1.0 / 32.0;
const FAST: f32 = 1.0 / 8.0;
const TICKS: u32 = 64;
/// The two means differ by less where a thermistor stands still, degC.
const STILL: f32 = 0.1;

/// What each thermistor reads while the heater is off, noise taken out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Still([Means; 3]);

#[derive(Clone, Copy, Debug, Default)]
struct Means {
    slow: f32,
    fast: f32,
    ticks: u32,
}

impl Still {
    /// One tick. Heat, and a reading that is not to be believed, begin anew.
    pub fn step(&mut self, sample: &Sample, heated: bool) {
        for (means, reading) in self.0.iter_mut().zip([sample.t0, sample.t1, sample.t2]) {
            match reading.good().filter(|_| !heated) {
                None => *means = Means::default(),
                Some(x) if means.ticks == 0 => *means = Means { slow: x, fast: x, ticks: 1 },
                Some(x) => {
                    means.slow += SLOW * (x - means.slow);
                    means.fast += FAST * (x - means.fast);
                    means.ticks = means.ticks.saturating_add(1);
                }
            }
        }
    }

    /// What a thermistor reads, degC.
    ///
    /// # Errors
    /// It does not stand still, or has not for long enough.
    pub fn reading(&self, thermistor: usize) -> Result<f32, CalibrationError> {
        let Some(means) = self.0.get(thermistor) else { return Err(CalibrationError::NotStill) };
        let still = means.ticks >= TICKS && (means.slow - means.fast).abs() < STILL;
        still.then_some(means.slow).ok_or(CalibrationError::NotStill)
    }
}

/// Why a calibration does not go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CalibrationError {
    /// The reading moves, is not to be believed, or has begun too lately.
    NotStill,
    /// There is no room for another point.
    Full,
    /// The line through the points is none that a thermistor can have.
    Unlikely(Line),
    /// There is nothing to put in force, or to undo.
    Nothing,
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotStill => f.write_str(
                "the thermistor does not stand still, expected 7 s without heat and within 0.1 degC; wait and try again",
            ),
            Self::Full => write!(f, "{POINTS} points are taken, expected `calibrate apply` or `calibrate clear`"),
            Self::Unlikely(line) => write!(
                f,
                "that is {line}, expected an offset within 10 degC and a gain within 10 %: is it the reference, or a wire?"
            ),
            Self::Nothing => f.write_str("there is nothing, expected `calibrate t1 25.0` first, or such"),
        }
    }
}

/// What a thermistor reads, without calibration, and what it should read, degC.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    reads: f32,
    is: f32,
    /// Points of one temperature that was typed have the same; the later, the higher.
    turn: u8,
}

/// A calibration: degC is `gain` times what is read, and `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Factor.
    pub gain: f32,
    /// In degC.
    pub offset: f32,
    /// Points that it was made from, and how far the worst lies from it, degC.
    pub points: usize,
    /// See `points`.
    pub error: f32,
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gain, offset, points, error } = *self;
        write!(f, "gain {}, offset {} degC from ", Fixed(gain, 4), Fixed(offset, 3))?;
        match points {
            1 => f.write_str("1 point"),
            n => write!(f, "{n} points, at most {} degC beside them", Fixed(error, 2)),
        }
    }
}

/// The points that were taken, and what was in force before.
#[derive(Clone, Debug, Default)]
pub struct Calibration {
    points: [Vec<Point, POINTS>; 3],
    turn: u8,
    before: Option<[(f32, f32); 3]>,
}

impl Calibration {
    /// The points that are taken from now on are withdrawn together.
    pub fn begin(&mut self) {
        self.turn = self.last_turn().wrapping_add(1);
    }

    /// Of the points that are there; 0 where there are none.
    fn last_turn(&self) -> u8 {
        self.points.iter().filter_map(|points| points.last()).map(|point| point.turn).max().unwrap_or(0)
    }

    /// Forgets the points of the last temperature that was typed.
    ///
    /// # Errors
    /// There is none.
    pub fn withdraw(&mut self) -> Result<(), CalibrationError> {
        let last = self.last_turn();
        let mut taken = Err(CalibrationError::Nothing);
        for points in &mut self.points {
            if points.last().is_some_and(|point| point.turn == last) {
                points.pop();
                taken = Ok(());
            }
        }
        taken
    }

    /// A thermistor that reads `reads` degC under these settings is at `is` degC: the line through its points.
    ///
    /// # Errors
    /// There is no room, or the line is none that a thermistor can have; the point is not taken then.
    pub fn add(
        &mut self,
        thermistor: usize,
        reads: f32,
        is: f32,
        config: &Config,
    ) -> Result<Line, CalibrationError> {
        let now = of(config, thermistor);
        let Some(points) = self.points.get_mut(thermistor) else { return Err(CalibrationError::Nothing) };
        let point = Point { reads: (reads - now.offset.0) / now.gain, is, turn: self.turn };
        points.push(point).map_err(|_| CalibrationError::Full)?;
        let line = line(points, now.gain);
        if likely(&line) {
            return Ok(line);
        }
        points.pop();
        Err(CalibrationError::Unlikely(line))
    }

    /// The settings with the lines through all points; the points are forgotten, and what was in force is kept.
    ///
    /// # Errors
    /// No point was taken.
    pub fn applied(&mut self, config: &Config) -> Result<Config, CalibrationError> {
        if self.points.iter().all(Vec::is_empty) {
            return Err(CalibrationError::Nothing);
        }
        let mut new = config.clone();
        for (i, points) in self.points.iter_mut().enumerate().filter(|(_, points)| !points.is_empty()) {
            let Line { gain, offset, .. } = line(points, of(config, i).gain);
            set(&mut new, i, (rounded(gain, 1e4), rounded(offset, 1e3)));
            points.clear();
        }
        self.before = Some([0, 1, 2].map(|i| (of(config, i).gain, of(config, i).offset.0)));
        Ok(new)
    }

    /// The settings with what was in force before the last calibration.
    ///
    /// # Errors
    /// There was none since the start.
    pub fn undone(&mut self, config: &Config) -> Result<Config, CalibrationError> {
        let before = self.before.take().ok_or(CalibrationError::Nothing)?;
        let mut old = config.clone();
        before.into_iter().enumerate().for_each(|(i, line)| set(&mut old, i, line));
        Ok(old)
    }

    /// Forgets the points.
    pub fn clear(&mut self) {
        self.points.iter_mut().for_each(Vec::clear);
    }
}

fn of(config: &Config, thermistor: usize) -> &ThermistorConfig {
    match thermistor {
        0 => &config.sensors.t0,
        1 => &config.sensors.t1,
        _ => &config.sensors.t2,
    }
}

fn set(config: &mut Config, thermistor: usize, (gain, offset): (f32, f32)) {
    let sensor = match thermistor {
        0 => &mut config.sensors.t0,
        1 => &mut config.sensors.t1,
        _ => &mut config.sensors.t2,
    };
    (sensor.gain, sensor.offset.0) = (gain, offset);
}

fn likely(line: &Line) -> bool {
    (1.0 / MOST_GAIN..=MOST_GAIN).contains(&line.gain) && line.offset.abs() <= MOST_OFFSET
}

/// The line of least squares; with points too near each other, its gain is the one in force.
fn line(points: &[Point], gain: f32) -> Line {
    let n = points.len().max(1) as f32;
    let mean = |of: fn(&Point) -> f32| points.iter().map(of).sum::<f32>() / n;
    let (x, y) = (mean(|point| point.reads), mean(|point| point.is));
    let extreme = |pick: fn(f32, f32) -> f32, from: f32| points.iter().map(|p| p.reads).fold(from, pick);
    let apart = extreme(f32::max, f32::NEG_INFINITY) - extreme(f32::min, f32::INFINITY);
    let xx: f32 = points.iter().map(|p| (p.reads - x) * (p.reads - x)).sum();
    let xy: f32 = points.iter().map(|p| (p.reads - x) * (p.is - y)).sum();
    let gain = if apart >= APART { xy / xx } else { gain };
    let offset = y - gain * x;
    let error = points.iter().map(|p| (gain * p.reads + offset - p.is).abs()).fold(0.0, f32::max);
    Line { gain, offset, points: points.len(), error }
}

#[cfg(test)]
mod tests {
    use fdi_core::sense::thermistor::Thermistor;
    use fdi_core::{Celsius, Reading, Validity};
    use proptest::prelude::*;

    use super::*;

    fn sample(celsius: f32) -> Sample {
        let reading = Reading { celsius: Celsius(celsius), validity: Validity::Good };
        Sample { t0: reading, t1: reading, t2: reading }
    }

    #[test]
    fn a_reading_is_taken_where_it_stands_still_without_heat() {
        let mut still = Still::default();
        (0..63).for_each(|k| still.step(&sample(20.0 + 0.05 * (k % 2) as f32), false));
        assert_eq!(still.reading(1), Err(CalibrationError::NotStill));
        (0..63).for_each(|k| still.step(&sample(20.0 + 0.05 * (k % 2) as f32), false));
        assert!((still.reading(1).expect("still") - 20.025).abs() < 0.01);
        (0..10).for_each(|k| still.step(&sample(20.0 + 0.1 * k as f32), false));
        assert_eq!(still.reading(1), Err(CalibrationError::NotStill), "it warms");
        still.step(&sample(20.0), true);
        (0..63).for_each(|_| still.step(&sample(20.0), false));
        assert_eq!(still.reading(1), Err(CalibrationError::NotStill));
        still.step(&sample(20.0), false);
        assert!(still.reading(1).is_ok());
        let mut broken = sample(20.0);
        broken.t1.validity = Validity::Open;
        still.step(&broken, false);
        assert_eq!(still.reading(1), Err(CalibrationError::NotStill));
        assert!(still.reading(2).is_ok());
    }

    #[test]
    fn one_point_gives_the_offset_and_comes_back() {
        let (mut calibration, config) = (Calibration::default(), Config::default());
        assert_eq!(calibration.applied(&config).unwrap_err(), CalibrationError::Nothing);
        let line = calibration.add(1, 24.6, 25.0, &config).expect("likely");
        assert!(line.gain == 1.0 && (line.offset - 0.4).abs() < 1e-5, "{line}");
        let new = calibration.applied(&config).expect("a point");
        assert_eq!((new.sensors.t1.gain, new.sensors.t0.offset), (1.0, config.sensors.t0.offset));
        assert_eq!(new.sensors.t1.offset.0, 0.4);
        let old = calibration.undone(&new).expect("there was one");
        assert_eq!(old.sensors.t1.offset, config.sensors.t1.offset);
        assert_eq!(calibration.undone(&old).unwrap_err(), CalibrationError::Nothing);
    }

    #[test]
    fn the_last_temperature_is_withdrawn_and_those_before_stay() {
        let (mut calibration, config) = (Calibration::default(), Config::default());
        let take = |thermistors: &[usize], reads: f32, is: f32, calibration: &mut Calibration| {
            calibration.begin();
            for &i in thermistors {
                calibration.add(i, reads, is, &config).expect("likely");
            }
        };
        take(&[0, 1, 2], 22.0, 22.5, &mut calibration);
        take(&[0, 1, 2], 22.0, 22.9, &mut calibration);
        take(&[1], 1.0, 0.0, &mut calibration);
        assert_eq!(calibration.withdraw(), Ok(()), "that of T1 alone");
        assert_eq!(calibration.withdraw(), Ok(()), "that of all three");
        let new = calibration.clone().applied(&config).expect("the first is there");
        assert_eq!([new.sensors.t0.offset.0, new.sensors.t1.offset.0, new.sensors.t2.offset.0], [0.5; 3]);
        assert_eq!(calibration.withdraw(), Ok(()));
        assert_eq!(calibration.withdraw(), Err(CalibrationError::Nothing));
    }

    #[test]
    fn what_no_thermistor_can_be_wrong_by_is_refused_and_not_kept() {
        let (mut calibration, config) = (Calibration::default(), Config::default());
        assert!(matches!(calibration.add(0, 24.6, 60.0, &config), Err(CalibrationError::Unlikely(_))));
        calibration.add(0, 1.0, 0.0, &config).expect("ice");
        assert!(matches!(calibration.add(0, 40.0, 60.0, &config), Err(CalibrationError::Unlikely(_))));
        assert_eq!(calibration.add(0, 61.0, 60.0, &config).map(|line| line.points), Ok(2));
        for _ in 0..2 {
            calibration.add(0, 30.0, 29.0, &config).expect("room");
        }
        assert_eq!(calibration.add(0, 30.0, 29.0, &config), Err(CalibrationError::Full));
    }

    proptest! {
        /// A thermistor with another resistance and beta than its settings, a reference that is 0.05 degC wrong at most, ice water and
        /// hot water: right to 0.1 degC from 0 to 60.
        #[test]
        fn two_points_calibrate_to_a_tenth_of_a_degree(
            gain in 0.97f32..1.03, offset in -3.0f32..3.0, wrong in prop::array::uniform2(-0.05f32..0.05),
        ) {
            let reads = |truth: f32| (truth - offset) / gain;
            let (mut calibration, config) = (Calibration::default(), Config::default());
            for (truth, wrong) in [0.0, 60.0].into_iter().zip(wrong) {
                calibration.add(2, reads(truth), truth + wrong, &config).expect("likely");
            }
            let new = calibration.applied(&config).expect("points");
            let (before, after) = (Thermistor::new(&config.sensors.t2, 2), Thermistor::new(&new.sensors.t2, 2));
            let (before, after) = (before.expect("valid"), after.expect("valid"));
            for truth in [0.0, 15.0, 30.0, 45.0, 60.0] {
                let told = after.celsius(before.code(Celsius(reads(truth))));
                prop_assert!((told.0 - truth).abs() < 0.1, "{} at {truth}", told.0);
            }
        }

        /// Points under a calibration that is in force already give the same line.
        #[test]
        fn a_calibration_in_force_does_not_matter(gain in 0.95f32..1.05, offset in -3.0f32..3.0) {
            let mut config = Config::default();
            (config.sensors.t1.gain, config.sensors.t1.offset.0) = (gain, offset);
            let mut calibration = Calibration::default();
            for bare in [5.0f32, 55.0] {
                let line = calibration.add(1, gain * bare + offset, 1.01 * bare - 0.5, &config).expect("likely");
                if line.points == 2 {
                    prop_assert!((line.gain - 1.01).abs() < 1e-4 && (line.offset + 0.5).abs() < 1e-2, "{line}");
                }
            }
        }
    }
}
