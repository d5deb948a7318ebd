//! The numbers of a tick that go to a page: a table of fields, one declaration each. What is not defined on a tick is NaN.

use fdi_core::diagnosis::baseline::Normal;
use fdi_core::diagnosis::residual::Residual;
use fdi_core::likelihood::{Channel, FaultClass, HYPOTHESES, Pair, Readiness};
use fdi_core::supervisor::Blocker;
use fdi_core::{Instrument, Mode, Percent, Reading, Report, Tick, TripReason, Validity};

/// Class and share of each hypothesis.
pub type Explained = [(FaultClass, f32); HYPOTHESES];

/// What each hypothesis explains of an alarm, on the tick that the instrument has just reported.
pub fn explained(instrument: &Instrument, report: &Report) -> Option<Explained> {
    report.likelihood.alarm.then(|| instrument.likelihood().explained()).flatten()
}

/// What the numbers are made of.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// First half of the tick.
    pub tick: &'a Tick,
    /// Second half of the tick.
    pub report: &'a Report,
    /// What the heater got from it on. That of a self-test is none of the controller's.
    pub applied: Percent,
    /// Number of the fault that acts, 0 for none.
    pub truth: u8,
    /// What each hypothesis explains of an alarm, where that was asked.
    pub explained: Option<&'a Explained>,
    /// What was learnt of the low-passed features.
    pub normal: Option<Normal>,
    /// Thresholds lie this many standard deviations from the mean.
    pub sigma_factor: f32,
}

/// A field.
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its number on a tick.
    pub number: fn(&Moment) -> Option<f32>,
}

const fn field(name: &'static str, number: fn(&Moment) -> Option<f32>) -> Field {
    Field { name, number }
}

macro_rules! explained {
    ($name:literal, $class:expr) => {
        field($name, |on| on.explained($class))
    };
}

use Channel::{T1, T2};

/// Every field, in its order. New ones come last.
pub static FIELDS: [Field; 45] = [
    field("tick", |on| Some(on.tick.index as f32)),
    // What the thermistors read, where they read anything, and what they should by the models, degC.
    field("t0", |on| read(on.tick.sample.t0)),
    field("t1", |on| read(on.tick.sample.t1)),
    field("t2", |on| read(on.tick.sample.t2)),
    field("t0_expected", |on| on.report.likelihood.expected[0]),
    field("t1_expected", |on| on.report.likelihood.expected[1]),
    field("t2_expected", |on| on.report.likelihood.expected[2]),
    field("setpoint", |on| Some(on.tick.setpoint.0)),
    // The controller's power, and what the heater got: that with the excitation, or the power of a self-test, %.
    field("pid", |on| Some(on.tick.pid.0)),
    field("drive", |on| Some(on.applied.0)),
    // 0 off, 1 settle, 2 learn, 3 monitor, 4 tripped, 5 tune; why, as in the list of trips.
    field("mode", |on| Some(mode(&on.tick.mode))),
    field("trip", |on| on.trip()),
    field("blocked", |on| on.tick.blocked.map(|b| position(&BLOCKERS, &b))),
    field("learned", |on| Some(on.report.learned as f32)),
    // 0 untrained, 1 training, 2 refused, 3 armed.
    field("readiness", |on| Some(readiness(on.report.likelihood.readiness))),
    // The paper's low-passed residuals, in units of their thresholds.
    field("rap", |on| on.residual(Residual::Rap)),
    field("ry12", |on| on.residual(Residual::Ry12)),
    field("rsg1", |on| on.residual(Residual::Rsg1)),
    field("rsg2", |on| on.residual(Residual::Rsg2)),
    field("rbw1", |on| on.residual(Residual::Rbw1)),
    field("fdv", |on| on.report.filtered.map(|v| v.fdv.into())),
    field("fiv", |on| on.report.filtered.map(|v| v.fiv.into())),
    // The likelihood diagnosis: alarm, number of the class, probability, size with half of its 95 % interval, tick of the onset.
    field("alarm", |on| Some(f32::from(u8::from(on.report.likelihood.alarm)))),
    field("class", |on| on.finding().map(|f| f.class.number() as f32)),
    field("confidence", |on| on.finding().map(|f| f.confidence)),
    field("magnitude", |on| on.finding().and_then(|f| f.magnitude).map(|m| m.value)),
    field("half_width", |on| on.finding().and_then(|f| f.magnitude).map(|m| m.half_width)),
    field("onset", |on| on.finding().map(|f| f.onset as f32)),
    // Number of the true fault, of a simulated rig.
    field("truth", |on| Some(on.truth.into())),
    // Share, 0 to 1, of what is unusual since the onset that each class would explain by itself.
    explained!("x_t1_offset", FaultClass::T1Offset),
    explained!("x_t2_offset", FaultClass::T2Offset),
    explained!("x_t0_fault", FaultClass::T0Fault),
    explained!("x_t1_clogged", FaultClass::T1Clogged),
    explained!("x_air_flow", FaultClass::AirFlow),
    explained!("x_heater_power", FaultClass::HeaterPower),
    explained!("x_drift", FaultClass::Drift),
    explained!("x_t1_stuck", FaultClass::Stuck(T1)),
    explained!("x_t2_stuck", FaultClass::Stuck(T2)),
    explained!("x_t1_detached", FaultClass::T1Detached),
    explained!("x_t2_detached", FaultClass::T2Detached),
    explained!("x_t1_t2_swapped", FaultClass::Swapped(Pair::T1T2)),
    explained!("x_t0_t1_swapped", FaultClass::Swapped(Pair::T0T1)),
    explained!("x_t0_t2_swapped", FaultClass::Swapped(Pair::T0T2)),
    // The fault of the user's own that it is: its place from 1 among those that were taught, and its size, % of what was taught.
    field("taught", |on| on.report.likelihood.taught.map(|taught| f32::from(taught.place) + 1.0)),
    field("taught_size", |on| on.report.likelihood.taught.map(|taught| taught.magnitude.value)),
];

/// Why the heater was switched off, by the number that stands in the field `trip`.
pub const TRIPS: [TripReason; 13] = [
    TripReason::T1Open,
    TripReason::T1Short,
    TripReason::T1OutOfRange,
    TripReason::T1Lost,
    TripReason::T1Stuck,
    TripReason::T1OverTemperature,
    TripReason::T2OverTemperature,
    TripReason::AirFlowLost,
    TripReason::HeaterStuckOn,
    TripReason::SensorsDisagree,
    TripReason::NoResponse,
    TripReason::ExcessPower,
    TripReason::T1Contradicted,
];

/// What keeps a sample from being learnt, by the number that stands in the field `blocked`.
pub const BLOCKERS: [Blocker; 6] = [
    Blocker::Saturated,
    Blocker::OutOfRegulation,
    Blocker::Unexcited,
    Blocker::InvalidSample,
    Blocker::NotSteady,
    Blocker::NotIdentified,
];

/// All numbers of a tick.
pub fn numbers(on: &Moment) -> [f32; FIELDS.len()] {
    std::array::from_fn(|i| (FIELDS[i].number)(on).unwrap_or(f32::NAN))
}

impl Moment<'_> {
    fn finding(&self) -> Option<fdi_core::Finding> {
        self.report.likelihood.finding
    }

    fn trip(&self) -> Option<f32> {
        match &self.tick.mode {
            Mode::Tripped(trip) => Some(position(&TRIPS, &trip.reason)),
            _ => None,
        }
    }

    fn residual(&self, residual: Residual) -> Option<f32> {
        let (i, normal) = (residual as usize, self.normal?);
        self.report.filtered?;
        Some((self.report.features_filtered?[i] - normal.mean[i]) / (self.sigma_factor * normal.sigma[i]))
    }

    fn explained(&self, class: FaultClass) -> Option<f32> {
        let all = self.explained?.iter();
        all.filter(|(of, _)| *of == class).map(|(_, share)| *share).reduce(f32::max)
    }
}

/// What a thermistor reads, be it believed or not.
fn read(reading: Reading) -> Option<f32> {
    let none = matches!(reading.validity, Validity::Missing | Validity::Open | Validity::Short);
    (!none).then_some(reading.celsius.0)
}

fn mode(mode: &Mode) -> f32 {
    match mode {
        Mode::Off => 0.0,
        Mode::Settle { .. } => 1.0,
        Mode::Learn { .. } => 2.0,
        Mode::Monitor => 3.0,
        Mode::Tripped(_) => 4.0,
        Mode::Tune => 5.0,
    }
}

fn readiness(readiness: Readiness) -> f32 {
    match readiness {
        Readiness::Untrained => 0.0,
        Readiness::Training => 1.0,
        Readiness::Refused(_) => 2.0,
        Readiness::Armed => 3.0,
        Readiness::Restarted => 4.0,
    }
}

fn position<T: PartialEq>(all: &[T], one: &T) -> f32 {
    all.iter().position(|other| other == one).map_or(f32::NAN, |i| i as f32)
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{LikelihoodReport, Magnitude};
    use fdi_core::name::Name;
    use fdi_core::{Config, RawSample};

    use super::*;

    #[test]
    fn the_power_is_what_the_heater_got_not_what_the_controller_wanted() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let tick = instrument.control(RawSample::default());
        let applied = Percent(2.5);
        let report = instrument.diagnose(&tick, applied);
        let moment = Moment {
            tick: &tick,
            report: &report,
            applied,
            truth: 0,
            explained: None,
            normal: None,
            sigma_factor: 3.0,
        };
        let number = |name| numbers(&moment)[FIELDS.iter().position(|field| field.name == name).unwrap()];
        assert_eq!((tick.drive.0, number("drive"), number("pid")), (0.0, 2.5, 0.0));
    }

    /// Pages find the fields by name, and what was kept of older ones by place.
    #[test]
    fn a_taught_fault_stands_behind_all_that_was_there_before() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let tick = instrument.control(RawSample::default());
        let report = instrument.diagnose(&tick, tick.drive);
        let last_two = |taught| {
            let likelihood = LikelihoodReport { taught, ..report.likelihood };
            let report = Report { likelihood, ..report.clone() };
            let moment = Moment {
                tick: &tick,
                report: &report,
                applied: tick.drive,
                truth: 0,
                explained: None,
                normal: None,
                sigma_factor: 3.0,
            };
            [43, 44].map(|i| (FIELDS[i].name, numbers(&moment)[i]))
        };
        let magnitude = Magnitude { value: 96.0, half_width: 8.0 };
        let taught = TaughtFinding { name: Name::NONE, place: 1, confidence: 0.97, magnitude };
        assert_eq!(last_two(Some(taught)), [("taught", 2.0), ("taught_size", 96.0)]);
        assert!(last_two(None).iter().all(|(_, number)| number.is_nan()));
    }
}
