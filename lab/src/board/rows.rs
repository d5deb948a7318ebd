//! The lines of a board's stream as the numbers that the lab's page shows. Its ticks are counted from the first that was heard; what a record
//! does not hold (what the models expect, shares of the hypotheses, residuals in units of their thresholds) is not defined.

use crate::scene::Order;
use crate::told::Told;
use fdi_core::schema::{Entry, FIELDS, Kind, Numbers};
use fdi_core::sense::thermistor::Thermistor;
use fdi_core::{Command, Config, Validity};
use firmware_logic::control_loop::OrderKind;
use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;

/// Most rows that stand in for ticks that were not heard: of a longer gap, some ten minutes.
const MOST_MISSING: u32 = 6000;

/// What a line has brought.
#[derive(Debug, Default, PartialEq)]
pub(super) struct News {
    pub(super) told: Vec<Told>,
    /// Settings have changed.
    pub(super) settings: bool,
}

/// Counts rows, and knows the board's thermistors.
#[derive(Default)]
pub(super) struct Rows {
    /// None before its settings are known: nothing is shown then.
    thermistors: Option<[Thermistor; 3]>,
    /// Rows so far.
    count: u32,
    /// The board's tick that comes next, where one was heard.
    due: Option<u32>,
}

impl Rows {
    /// Other settings are in force.
    pub(super) fn retune(&mut self, config: &Config) -> anyhow::Result<()> {
        self.thermistors = Some(thermistors(config)?);
        Ok(())
    }

    pub(super) fn line(&mut self, line: &str) -> News {
        match LogLine::find(line) {
            Ok(Some(LogLine::Tick(tick))) => News { told: self.tick(&tick), settings: false },
            Ok(Some(LogLine::Start { .. })) => {
                self.due = Some(0);
                News::default()
            }
            Ok(Some(LogLine::Order { order, .. })) => News {
                told: carried_out(&order).map(Told::Order).into_iter().collect(),
                settings: order == OrderKind::Settings,
            },
            _ => News::default(),
        }
    }

    fn tick(&mut self, line: &TickLine) -> Vec<Told> {
        let Some(thermistors) = &self.thermistors else { return Vec::new() };
        // A tick before the one that is due is of another start.
        let missing = self.due.and_then(|due| line.tick().checked_sub(due)).unwrap_or(0).min(MOST_MISSING);
        let mut told: Vec<Told> = (0..missing).map(|k| Told::Row(unheard(self.count + k))).collect();
        let (micros, missed) = (line.late_us(), line.missed());
        if micros > 0 || missed {
            told.push(Told::Late { micros, missed });
        }
        told.push(Told::Row(numbers(line, self.count + missing, thermistors)));
        self.count += missing + 1;
        self.due = Some(line.tick().wrapping_add(1));
        told
    }
}

/// The numbers of a record, in its row.
fn numbers(line: &TickLine, row: u32, thermistors: &[Thermistor; 3]) -> Numbers {
    let [t0, t1, t2] = readings(line, thermistors);
    let number_of = |field: &Entry| match field.name {
        "tick" => row as f32,
        "t0" => t0,
        "t1" => t1,
        "t2" => t2,
        "truth" => 0.0,
        _ => match (field.number.kind, field.number.bits(&line.0)) {
            (_, None) => f32::NAN,
            (Kind::Float, Some(bits)) => f32::from_bits(bits),
            // Ticks are counted from the first that was heard.
            (Kind::Tick, Some(tick)) => (f64::from(row) - (f64::from(line.tick()) - f64::from(tick))) as f32,
            (_, Some(number)) => number as f32,
        },
    };
    std::array::from_fn(|i| number_of(&FIELDS[i]))
}

/// What T0, T1 and T2 read on a tick, degC; NaN where one reads nothing.
pub fn readings(line: &TickLine, [s0, s1, s2]: &[Thermistor; 3]) -> [f32; 3] {
    let raw = line.raw();
    let read = |validity, thermistor: &Thermistor, code| {
        let silent = Validity::READS_NOTHING.iter().any(|v| line.bits(validity) == Some(v.number()));
        if silent { f32::NAN } else { thermistor.celsius(code).0 }
    };
    [read("t0_validity", s0, raw.t0), read("t1_validity", s1, raw.t1), read("t2_validity", s2, raw.t2)]
}

/// The thermistors of these settings.
///
/// # Errors
/// A setting is out of bounds.
pub fn thermistors(config: &Config) -> anyhow::Result<[Thermistor; 3]> {
    let s = &config.sensors;
    Ok([Thermistor::new(&s.t0, 0)?, Thermistor::new(&s.t1, 1)?, Thermistor::new(&s.t2, 2)?])
}

/// The row of a tick that was not heard.
fn unheard(row: u32) -> Numbers {
    let number = |name| if name == "tick" { row as f32 } else { f32::NAN };
    std::array::from_fn(|i| number(FIELDS[i].name))
}

/// What the page calls an order that was carried out, by whomever it was given.
fn carried_out(order: &OrderKind) -> Option<Order> {
    let OrderKind::Command(command) = order else { return None };
    Some(match command {
        Command::Arm => Order::Arm,
        Command::Tune => Order::Tune,
        Command::Stop => Order::Stop,
        Command::Acknowledge => Order::Acknowledge,
        Command::Shelve(time) => Order::Shelve { seconds: time.0 },
        Command::Relearn => Order::Relearn,
        Command::Excite(on) => Order::Excite { on: *on },
        Command::SetPoint(wanted) => Order::Setpoint { celsius: wanted.0 },
        Command::Fan(level) => Order::Fan { percent: level.0 },
        // The check's, and nobody's order.
        Command::Gain(_) => return None,
    })
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{FaultClass, LikelihoodReport, Magnitude};
    use fdi_core::name::Name;
    use fdi_core::schema::{self, Moment};
    use fdi_core::{AdcCode, Celsius, Finding, Instrument, Percent, RawSample, Report, TripReason};
    use firmware_logic::control_loop::TickRecord;

    use super::*;

    /// From this tick on the wire of T1 is broken.
    const OPENED: u32 = 20;

    /// The record of each tick, and what the page is shown of it where the instrument itself is there.
    fn both(ticks: u32) -> Vec<(String, Numbers)> {
        let config = Config::default();
        let [s0, s1, _] = thermistors(&config).unwrap();
        let raw = RawSample {
            t0: s0.code(Celsius(24.0)),
            t1: s1.code(Celsius(33.0)),
            t2: AdcCode(f32::NAN),
            supply: AdcCode(0.0),
        };
        let mut instrument = Instrument::new(&config).unwrap();
        instrument.command(Command::Arm).unwrap();
        let both = |k| {
            // From then on it has tripped.
            let t1 = if k < OPENED { raw.t1 } else { AdcCode(4095.0) };
            let raw = RawSample { t1, ..raw };
            let tick = instrument.control(raw);
            // As in a self-test: the heater gets what the controller does not ask for.
            let applied = Percent(2.5);
            let report = instrument.diagnose(&tick, applied);
            let record = TickRecord::new(raw, tick, applied);
            let moment = Moment { applied, ..Moment::new(&tick, &report) };
            (TickLine::new(&record, &report).to_string(), schema::row(&moment))
        };
        (0..ticks).map(both).collect()
    }

    fn rows_of_a_board() -> Rows {
        let mut rows = Rows::default();
        rows.retune(&Config::default()).unwrap();
        rows
    }

    fn rows(told: Vec<Told>) -> Vec<Numbers> {
        told.into_iter().filter_map(|told| if let Told::Row(row) = told { Some(row) } else { None }).collect()
    }

    #[test]
    fn a_record_gives_the_numbers_that_the_instrument_gives() {
        let mut to_rows = rows_of_a_board();
        for (line, wanted) in both(50) {
            let [row] = rows(to_rows.line(&line).told)[..] else { panic!("one row a tick") };
            for (field, (ours, theirs)) in FIELDS.iter().zip(row.into_iter().zip(wanted)) {
                let unknown = field.name.ends_with("_expected"); // no record holds these
                let same = ours.to_bits() == theirs.to_bits() || ours.is_nan() && theirs.is_nan();
                assert!(same || unknown, "{}: {ours}, expected {theirs}", field.name);
            }
        }
    }

    #[test]
    fn why_it_tripped_is_told_by_its_number() {
        let mut to_rows = rows_of_a_board();
        let trips =
            both(50).into_iter().flat_map(|(line, _)| rows(to_rows.line(&line).told)).map(|row| row[11]);
        let trips: Vec<f32> = trips.filter(|trip| !trip.is_nan()).collect();
        assert_eq!((FIELDS[11].name, trips), ("trip", vec![TripReason::T1Open.number() as f32; 30]));
    }

    #[test]
    fn a_taught_fault_stands_beside_its_class_with_or_without_one() {
        let mut instrument = Instrument::new(&Config::default()).unwrap();
        let tick = instrument.control(RawSample::default());
        let report = instrument.diagnose(&tick, tick.drive);
        let record = TickRecord::new(RawSample::default(), tick, Percent(0.0));
        let taught =
            TaughtFinding { name: Name::NONE, place: 1, confidence: 0.97, magnitude: Magnitude::default() };
        let finding = Finding { class: FaultClass::Unknown, confidence: 0.96, magnitude: None, onset: 0 };
        let shown = |finding, taught| {
            let likelihood = LikelihoodReport { alarm: true, finding, taught, ..report.likelihood };
            let line = TickLine::new(&record, &Report { likelihood, ..report.clone() });
            let row = numbers(&line, 0, &thermistors(&Config::default()).unwrap());
            let number = |name| row[schema::field(name).unwrap()];
            ["class", "taught"].map(|name| Some(number(name)).filter(|number| !number.is_nan()))
        };
        let class = Some(FaultClass::Unknown.number() as f32);
        assert_eq!(shown(Some(finding), Some(taught)), [class, Some(2.0)]);
        assert_eq!(shown(None, Some(taught)), [None, Some(2.0)]);
        assert_eq!(shown(Some(finding), None), [class, None]);
    }

    #[test]
    fn ticks_are_counted_from_the_first_that_was_heard_and_gaps_are_empty_rows() {
        let lines: Vec<String> = both(30).into_iter().map(|(line, _)| line).collect();
        let mut to_rows = rows_of_a_board();
        let mut all = Vec::new();
        for i in [10, 11, 14] {
            all.extend(rows(to_rows.line(&lines[i]).told));
        }
        to_rows.line("log format 5");
        for i in [0, 1] {
            all.extend(rows(to_rows.line(&lines[i]).told));
        }
        let ticks: Vec<f32> = all.iter().map(|row| row[0]).collect();
        assert_eq!(ticks, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let t1: Vec<bool> = all.iter().map(|row| row[2].is_nan()).collect();
        assert_eq!(t1, [false, false, true, true, false, false, false]);
    }

    #[test]
    fn a_tick_that_was_not_in_time_is_told_before_its_row() {
        let mut to_rows = rows_of_a_board();
        let all = both(1);
        let Ok(Some(LogLine::Tick(line))) = LogLine::find(&all[0].0) else { panic!("a tick") };
        let mut told = |timing| {
            let mut words = line.0;
            words[1] = timing;
            to_rows.line(&TickLine(words).to_string()).told
        };
        assert_eq!(told(0).len(), 1);
        assert_eq!(told(70)[0], Told::Late { micros: 70, missed: false });
        assert_eq!(told(1 << 31)[0], Told::Late { micros: 0, missed: true });
    }

    #[test]
    fn what_was_ordered_is_told() {
        let mut to_rows = rows_of_a_board();
        let setpoint = f32::to_bits(36.0);
        let news = to_rows.line(&format!("order 12 setpoint {setpoint:x} (36 degC)"));
        assert_eq!(news.told, [Told::Order(Order::Setpoint { celsius: 36.0 })]);
        assert!(to_rows.line("order 13 settings").settings);
    }
}
