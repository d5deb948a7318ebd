//! A record as the lab's page takes it: the numbers of each tick, and what was done to the rig.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fdi_core::schema::{self, FIELDS, Moment, Numbers};
use pt326_lab::protocol;
use pt326_lab::scene::Order;
use serde_json::{Value, json};

use crate::experiment::Record;

/// The numbers of all ticks, in the order of [`FIELDS`].
pub fn of(record: &Record) -> Vec<Numbers> {
    let mut explained = record.explained.iter().peekable();
    let row = |(k, row): (usize, &crate::experiment::Row)| {
        schema::row(&Moment {
            applied: row.applied,
            truth: row.truth,
            explained: explained.next_if(|(of, _)| *of == k).map(|(_, shares)| shares),
            normal: record.baseline.as_ref().map(|baseline| &baseline.filtered),
            sigma_factor: record.sigma_factor as f32,
            ..Moment::new(&row.tick, &row.report)
        })
    };
    record.rows.iter().enumerate().map(row).collect()
}

/// Rows that a page keeps: of a longer recording, the last.
const MOST: usize = 1 << 16;

/// The recording as it stands in a page, without the shares of the hypotheses where nobody asked for them.
pub fn json(record: &Record) -> String {
    let recorded = |name: &str| !record.explained.is_empty() || !name.starts_with("x_");
    let rows = of(record);
    let first = rows.len().saturating_sub(MOST);
    let kept = rows[first..].iter().flat_map(|row| row.iter().zip(&FIELDS));
    let bytes: Vec<u8> =
        kept.filter(|(_, field)| recorded(field.name)).flat_map(|(number, _)| number.to_le_bytes()).collect();
    let mut hello = protocol::hello("recording", &[]);
    hello["fields"] = FIELDS.iter().map(|field| field.name).filter(|name| recorded(name)).collect();
    hello["ts"] = json!(record.sample_time);
    let (learn_start, learn_end) = record.nominal_window;
    hello["settings"]["supervisor.learn_start"] = json!(learn_start);
    hello["settings"]["supervisor.learn_end"] = json!(learn_end);
    hello["own_names"] = json!(record.names.rows);
    hello["taught_names"] = json!(record.names.taught);
    // Of a recording without its summary nothing but the number of a fault is known, which is in the rows.
    let faults = record.faults.iter().filter(|fault| fault.validate("").is_ok());
    let orders: Vec<Value> = faults.map(|fault| json!([0, Order::Break { fault: fault.clone() }])).collect();
    json!({ "hello": hello, "name": record.origin.to_string(), "orders": orders, "first": first, "values": STANDARD.encode(bytes) }).to_string()
}
