//! What is not simulated here: a recording and a board.

use std::sync::mpsc::{Sender, channel};

use fdi_core::schema::FIELDS;
use pt326_lab::names::Names;
use pt326_lab::scene::Order;
use serde_json::{Value, json};

use super::{post_text, rows_in, serve_source, stream, until, with_token};
use crate::source::scripted::Scripted;
use crate::source::{Recording, Source, Told};

/// A recording goes by with its own sample time, and takes no orders.
#[test]
fn a_recording_is_served_to_its_end() {
    let rows =
        (0..120).map(|tick| std::array::from_fn(|i| if i == 0 { tick as f32 } else { f32::NAN })).collect();
    let names = Names { rows: vec![(4, "hand".into())], taught: vec!["cap".into(), "low".into()] };
    let address = serve_source(Recording::new("old.csv".into(), 0.5, names, rows), 100.0);
    let all = stream(address, 0, "", until(120));
    assert_eq!(
        [&all[0]["own_names"], &all[0]["taught_names"]],
        [&json!([[4, "hand"]]), &json!(["cap", "low"])]
    );
    assert_eq!(
        (&all[0]["ts"], &all[0]["name"], &all[0]["scene"]),
        (&json!(0.5), &json!("old.csv"), &Value::Null)
    );
    assert_eq!(rows_in(&all), 120);
    for body in [
        r#"{"command":"order","order":{"order":"stop"}}"#,
        r#"{"command":"skip"}"#,
        r#"{"command":"open","scene":{}}"#,
        r#"{"command":"trace"}"#,
    ] {
        assert_eq!(post_text(address, &with_token(), body).0, 409, "{body}");
    }
}

/// A board that never falls silent. Whoever takes a million things from it without a look at what is asked has lost the stop.
struct Flood {
    taken: u32,
    begins: Sender<()>,
}

impl Source for Flood {
    fn name(&self) -> String {
        "a hostile port".into()
    }

    fn can(&self) -> &'static [&'static str] {
        &["order"]
    }

    fn sample_time(&self) -> f64 {
        0.11
    }

    fn has_own_time(&self) -> bool {
        true
    }

    fn next(&mut self) -> Option<Told> {
        let _ = self.begins.send(());
        self.taken += 1;
        assert!(self.taken < 1_000_000, "nobody asks between");
        Some(Told::Link(true))
    }

    fn order(&mut self, _: Order) -> anyhow::Result<()> {
        self.taken = 0;
        Ok(())
    }
}

#[test]
fn a_board_that_floods_is_stopped() {
    let (begins, begun) = channel();
    let address = serve_source(Flood { taken: 0, begins }, 1.0);
    begun.recv().unwrap();
    let stop = r#"{"command":"order","order":{"order":"stop"}}"#;
    assert_eq!(post_text(address, &with_token(), stop).0, 200);
}

#[test]
fn what_a_board_tells_comes_in_its_own_time_and_order() {
    let (board, tell, _orders) = Scripted::new(3600.0);
    let address = serve_source(board, 1.0);
    for body in [r#"{"command":"run","speed":0}"#, r#"{"command":"skip"}"#] {
        assert_eq!(post_text(address, &with_token(), body).0, 409, "{body}");
    }
    let arm = r#"{"command":"order","order":{"order":"arm"}}"#;
    assert_eq!(post_text(address, &with_token(), arm).0, 200);
    let row = || Told::Row([0.0; FIELDS.len()]);
    let all = [
        Told::Link(true),
        row(),
        Told::Order(Order::Arm),
        Told::Refused { why: "why".into(), persists: Some("t1_open") },
        Told::Names(Names { rows: Vec::new(), taught: vec!["cap".into()] }),
        Told::Link(false),
        row(),
    ];
    all.into_iter().for_each(|told| tell.send(told).unwrap());
    let heard = stream(address, 0, "", until(2));
    assert_eq!((&heard[0]["kind"], &heard[0]["can"]), (&json!("board"), &json!(["order"])));
    let types: Vec<&str> = heard[1..].iter().filter_map(|message| message["type"].as_str()).collect();
    assert_eq!(types, ["link", "rows", "order", "refused", "names", "link", "rows"]);
    assert_eq!((&heard[4]["code"], &heard[4]["values"]["trip"]), (&json!("persists"), &json!("t1_open")));
    assert_eq!((&heard[3]["tick"], &heard[6]["up"]), (&json!(1), &json!(false)));
    assert_eq!((&heard[5]["own_names"], &heard[5]["taught_names"]), (&json!([]), &json!(["cap"])));
}
