//! What goes between a source and a page: see PROTOCOL.md.

use fdi_core::TripReason;
use fdi_core::likelihood::FaultClass;
use serde_json::json;

use crate::fields::{BLOCKERS, FIELDS, TRIPS};
use crate::time::as_written;

/// Version of the protocol. A page refuses another.
pub const VERSION: u32 = 1;
/// Bytes of a row where its numbers go in binary.
pub const ROW_BYTES: usize = FIELDS.len() * size_of::<f32>();

/// What a client is told first: what the numbers mean, and what it may ask for.
pub fn hello(kind: &str, can: &[&str]) -> String {
    let class = |class: &FaultClass| json!({ "number": class.number(), "name": class.name(), "unit": class.unit().replace("degC", "°C") });
    json!({
        "type": "hello",
        "protocol": VERSION,
        "kind": kind,
        "can": can,
        "version": env!("CARGO_PKG_VERSION"),
        "ts": as_written(fdi_core::Config::default().sample_time.0),
        "fields": FIELDS.iter().map(|field| field.name).collect::<Vec<_>>(),
        "classes": FaultClass::ALL.iter().map(class).collect::<Vec<_>>(),
        "trips": TRIPS.map(|reason| format!("{reason:?}")),
        "trip_words": TRIPS.map(TripReason::words),
        "blockers": BLOCKERS.map(|blocker| format!("{blocker:?}")),
    })
    .to_string()
}
