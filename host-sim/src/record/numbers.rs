//! A record as the lab's page takes it: the numbers of each tick, and what was done to the rig.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pt326_lab::fields::{FIELDS, Moment, numbers};
use pt326_lab::protocol;
use pt326_lab::scene::Order;
use serde_json::{Value, json};

use crate::experiment::Record;

/// The numbers of all ticks, in the order of [`FIELDS`]. What each hypothesis explains is not recorded.
pub fn of(record: &Record) -> Vec<[f32; FIELDS.len()]> {
    let row = |row: &crate::experiment::Row| {
        numbers(&Moment {
            tick: &row.tick,
            report: &row.report,
            truth: row.truth,
            explained: None,
            normal: record.baseline.map(|baseline| baseline.filtered),
            sigma_factor: record.sigma_factor as f32,
        })
    };
    record.rows.iter().map(row).collect()
}

/// The recording as it stands in a page.
pub fn json(record: &Record) -> String {
    let bytes: Vec<u8> = of(record).iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
    let mut hello: Value = serde_json::from_str(&protocol::hello("recording", &[])).unwrap_or_default();
    hello["ts"] = json!(record.sample_time);
    let faults = record.faults.iter().filter(|fault| fault.size.is_some());
    let orders: Vec<Value> = faults.map(|fault| json!([0, Order::Break { fault: fault.clone() }])).collect();
    json!({ "hello": hello, "name": record.origin.to_string(), "orders": orders, "values": STANDARD.encode(bytes) }).to_string()
}
