//! What goes between a source and a page: see PROTOCOL.md.

use fdi_core::likelihood::{FaultClass, Readiness};
use fdi_core::schema::{COLUMNS, Entry, FIELDS, Numbers};
use fdi_core::settings::{Setting, Value, Wider};
use fdi_core::supervisor::Blocker;
use fdi_core::{Config, Mode, TripReason};
use serde::de::DeserializeOwned;
use serde_json::{Map, json};

use crate::names::Names;
use crate::session::Session;
use crate::time::as_written;

/// Version of the protocol. A page refuses another.
pub const VERSION: u32 = 1;
/// Bytes of a row where its numbers go in binary.
pub const ROW_BYTES: usize = size_of::<Numbers>();

/// Reads what a client says. By way of a value: straight from the text serde_json takes no number of a tagged enum where its
/// `arbitrary_precision` is on, which any program built along with this one may ask for.
///
/// # Errors
/// What it lacks.
pub fn read<T: DeserializeOwned>(json: &[u8]) -> serde_json::Result<T> {
    serde_json::from_value(serde_json::from_slice(json)?)
}

/// What a client is told first: what the numbers mean, and what it may ask for.
pub fn hello(kind: &str, can: &[&str]) -> serde_json::Value {
    let class = |class: &FaultClass| {
        let unit = class.unit().replace("degC", "°C");
        let may_be = [class.may_be_shelved(), class.may_be_accepted()];
        json!({ "number": class.number(), "name": class.name(), "unit": unit, "shelved": may_be[0], "accepted": may_be[1] })
    };
    json!({
        "type": "hello",
        "protocol": VERSION,
        "kind": kind,
        "can": can,
        "version": env!("CARGO_PKG_VERSION"),
        "ts": as_written(Config::default().sample_time.0),
        "fields": FIELDS.iter().map(|field| field.name).collect::<Vec<_>>(),
        "classes": FaultClass::ALL.iter().map(class).collect::<Vec<_>>(),
        "trips": TripReason::NAMES,
        "blockers": Blocker::NAMES,
        "settings": numbers(&Config::default()),
        "bounds": bounds(),
        "limits": limits(),
        "modes": Mode::NAMES,
        "readiness": Readiness::NAMES,
        "columns": FIELDS.iter().map(column_of).collect::<Vec<_>>(),
    })
}

/// Name of the column of trace.csv with the number of a field.
fn column_of(field: &Entry) -> Option<&'static str> {
    COLUMNS.iter().find(|column| std::ptr::eq(column.number, field.number)).map(|column| column.name)
}

/// Unit, least and most of every setting that is a number.
fn bounds() -> Map<String, serde_json::Value> {
    let bounds = |setting: &Setting| {
        let (min, max) = setting.kind.bounds()?;
        let unit = setting.unit.replace("degC", "°C");
        Some((
            setting.name.to_owned(),
            json!({ "unit": unit, "min": as_written(min), "max": as_written(max) }),
        ))
    };
    Config::settings().filter_map(bounds).collect()
}

/// Default of every limit, and on which side of it a wider one lies.
fn limits() -> Map<String, serde_json::Value> {
    let limit = |setting: &Setting| {
        let limit = setting.limit?;
        let wider = if limit.wider == Wider::Above { "above" } else { "below" };
        Some((setting.name.to_owned(), json!({ "default": as_written(limit.default), "wider": wider })))
    };
    Config::settings().filter_map(limit).collect()
}

/// What a client is told where a scene begins.
pub fn opened(session: &Session) -> serde_json::Value {
    json!({
        "type": "opened",
        "scene": session.plan(),
        "ts": session.sample_time(),
        "settings": numbers(session.config()),
    })
}

/// What a recording with these settings tells of itself.
pub fn recorded(config: &Config) -> serde_json::Value {
    let Names { rows, taught } = Names::of(config);
    json!({
        "ts": as_written(config.sample_time.0),
        "settings": numbers(config),
        "own_names": rows,
        "taught_names": taught,
    })
}

/// The settings that are numbers, which are those that an order may change, and the limits that are switches, as 0 or 1.
fn numbers(config: &Config) -> Map<String, serde_json::Value> {
    let number = |setting: &Setting| match config.get(setting) {
        Value::Number(x) => Some((setting.name.to_owned(), json!(as_written(x)))),
        Value::Switch(on) if setting.limit.is_some() => Some((setting.name.to_owned(), json!(u8::from(on)))),
        _ => None,
    };
    Config::settings().filter_map(number).collect()
}

#[cfg(test)]
mod tests {
    use pt326_rig::RigConfig;

    use super::*;

    const WORDS: [&str; 2] = [include_str!("../page/words_en.js"), include_str!("../page/words_pt.js")];
    const PAGE: &str = include_str!("../page/index.html");

    #[test]
    fn every_trip_mode_and_blocker_has_words_on_the_page() {
        let trips = TripReason::NAMES.iter().map(|name| format!("trip_{name}"));
        let blockers = Blocker::NAMES.iter().map(|name| format!("block_{name}"));
        let modes = Mode::NAMES.iter().map(|name| format!("state_{name}"));
        let lacks: Vec<_> = trips.chain(blockers).chain(modes).filter(|key| !has_words(key)).collect();
        assert!(lacks.is_empty(), "{lacks:?}");
    }

    #[test]
    fn the_page_offers_every_preset_of_the_rig() {
        for name in RigConfig::presets() {
            assert!(
                PAGE.contains(&format!("<option value=\"{name}\" data-say=\"preset_{name}\">")),
                "{name}"
            );
            assert!(has_words(&format!("preset_{name}")), "{name}");
        }
    }

    fn has_words(key: &str) -> bool {
        WORDS.iter().all(|words| words.contains(&format!(" {key}: \"")))
    }
}
