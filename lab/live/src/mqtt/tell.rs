//! The rows of a rig as messages: its state, and each finding and trip with a number of its own.

use std::time::SystemTime;

use fdi_core::TripReason;
use fdi_core::schema::{Entry, FIELDS};
use pt326_lab::time::as_written;
use serde_json::{Map, Value, json};

use crate::counts::number;
use crate::metrics::{class, name_of};
use crate::source::Numbers;

/// What a finding tells of its tick.
const OF_FINDING: [&str; 8] =
    ["tick", "alarm", "advice", "class", "confidence", "magnitude", "half_width", "onset"];

/// Looks for what is new.
#[derive(Default)]
pub(super) struct Teller {
    finding: Told<[Option<u32>; 3]>,
    trip: Told<Option<u32>>,
}

/// What was told last, and its number.
#[derive(Default)]
struct Told<T> {
    number: u64,
    last: Option<T>,
}

impl<T: PartialEq> Told<T> {
    /// The number of what is new.
    fn news(&mut self, now: T) -> Option<u64> {
        if self.last.as_ref() == Some(&now) {
            return None;
        }
        self.last = Some(now);
        self.number += 1;
        Some(self.number)
    }
}

impl Teller {
    /// The messages of a tick, each with the end of its topic. Of a tick that was not heard there are none.
    pub(super) fn row(&mut self, row: &Numbers) -> Vec<(&'static str, Value)> {
        let mut messages = Vec::new();
        if number(row, "mode").is_none() {
            return messages;
        }
        let of = |name| number(row, name).map(|number| number as u32);
        if let Some(number) = self.finding.news(["alarm", "advice", "class"].map(of)) {
            let fields = FIELDS.iter().zip(row).filter(|(field, _)| OF_FINDING.contains(&field.name));
            let mut message: Map<_, _> = fields.map(said).collect();
            message.insert("unit".into(), json!(class(row).map(|class| class.unit())));
            messages.push(("finding", numbered(message, number)));
        }
        if let Some(number) = self.trip.news(of("trip")) {
            let fields = FIELDS.iter().zip(row).filter(|(field, _)| ["tick", "trip"].contains(&field.name));
            let mut message: Map<_, _> = fields.map(said).collect();
            let reason = of("trip").and_then(|trip| TripReason::WORDS.get((trip as usize).checked_sub(1)?));
            message.insert("words".into(), json!(reason));
            messages.push(("trip", numbered(message, number)));
        }
        messages
    }
}

fn numbered(mut message: Map<String, Value>, number: u64) -> Value {
    message.insert("number".into(), json!(number));
    message.insert("time".into(), json!(now()));
    message.into()
}

/// Seconds since 1970.
fn now() -> Option<f64> {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).ok().map(|since| since.as_secs_f64())
}

/// All numbers of a tick, by the names and in the units of the schema; null where one is not defined.
pub(super) fn state(row: &Numbers, connected: bool) -> Value {
    let mut message: Map<_, _> = FIELDS.iter().zip(row).map(said).collect();
    message.insert("connected".into(), json!(connected));
    message.insert("time".into(), json!(now()));
    message.into()
}

fn said((field, value): (&Entry, &f32)) -> (String, Value) {
    let value = match name_of(field, *value) {
        Some(name) => json!(name),
        None if value.is_finite() => json!(as_written(*value)),
        None => Value::Null,
    };
    (field.name.into(), value)
}

#[cfg(test)]
mod tests {
    use fdi_core::likelihood::FaultClass;
    use fdi_core::schema;

    use super::*;

    fn row(numbers: &[(&str, f32)]) -> Numbers {
        let mut row = [f32::NAN; _];
        numbers.iter().for_each(|(name, number)| row[schema::field(name).unwrap()] = *number);
        row
    }

    #[test]
    fn a_finding_and_a_trip_are_told_when_they_change_and_numbered() {
        let class = FaultClass::T2Offset.number() as f32;
        let well = [("tick", 1.0), ("mode", 3.0), ("alarm", 0.0), ("advice", 0.0)];
        let faulty = [
            ("tick", 2.0),
            ("mode", 3.0),
            ("alarm", 1.0),
            ("advice", 0.0),
            ("class", class),
            ("magnitude", 1.5),
        ];
        let worse = [
            ("tick", 3.0),
            ("mode", 3.0),
            ("alarm", 1.0),
            ("advice", 0.0),
            ("class", class),
            ("magnitude", 1.6),
        ];
        let tripped =
            [("tick", 4.0), ("mode", 4.0), ("trip", 1.0), ("alarm", 1.0), ("advice", 0.0), ("class", class)];
        let mut teller = Teller::default();
        let all = [&well[..], &faulty, &[("tick", 9.0)], &faulty, &worse, &tripped, &well];
        let told: Vec<_> = all.iter().flat_map(|numbers| teller.row(&row(numbers))).collect();
        let topics: Vec<_> =
            told.iter().map(|(topic, told)| (*topic, told["number"].as_u64().unwrap())).collect();
        assert_eq!(
            topics,
            [("finding", 1), ("trip", 1), ("finding", 2), ("trip", 2), ("finding", 3), ("trip", 3)]
        );
        let finding = &told[2].1;
        assert_eq!((&finding["class"], &finding["unit"]), (&json!("t2_offset"), &json!("degC")));
        assert_eq!(
            (&finding["magnitude"], &finding["tick"], &finding["alarm"]),
            (&json!(1.5), &json!(2.0), &json!(1.0))
        );
        assert_eq!(
            (&told[0].1["class"], &told[1].1["trip"], &told[3].1["trip"]),
            (&Value::Null, &Value::Null, &json!("t1_open"))
        );
        assert_eq!(told[3].1["words"], TripReason::WORDS[0]);
    }

    #[test]
    fn the_state_has_every_number_by_its_name() {
        let state = state(&row(&[("t1", 35.3), ("mode", 3.0)]), true);
        assert_eq!(
            (&state["t1"], &state["mode"], &state["t2"]),
            (&json!(35.3), &json!("monitor"), &Value::Null)
        );
        assert!(FIELDS.iter().all(|field| state.get(field.name).is_some()));
    }
}
