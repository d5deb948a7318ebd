//! Several rigs on one page.

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use fdi_core::schema;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
use serde_json::{Value, json};

use super::{Limits, TOKEN, answer, for_all, get_text, post_text, rows_in, serve_rigs, until, with_token};
use crate::clock;
use crate::guard::Access;
use crate::source::scripted::Scripted;
use crate::source::{Numbers, Told};
use crate::wall::Rig;

/// A board that is there, has told all of `told`, and the orders that it is given.
fn board(name: &str, told: Vec<Told>, refuses: Option<&'static str>) -> (Arc<Rig>, Receiver<Order>) {
    let (mut board, tell, orders) = Scripted::new(0.5);
    board.refuses = refuses;
    told.into_iter().for_each(|told| tell.send(told).unwrap());
    let clock = clock::start(board, 1.0).unwrap();
    (Arc::new(Rig::of(name, clock)), orders)
}

fn row(numbers: &[(&str, f32)]) -> Told {
    let mut row: Numbers = [f32::NAN; _];
    numbers.iter().for_each(|(name, number)| row[schema::field(name).unwrap()] = *number);
    Told::Row(row)
}

fn simulated(name: &str, seed: u64) -> Arc<Rig> {
    let session = Session::new(Scene { seed, ..Scene::default() }).unwrap();
    Arc::new(Rig::of(name, clock::start(session, 0.0).unwrap()))
}

fn serve(rigs: Vec<Arc<Rig>>) -> std::net::SocketAddr {
    serve_rigs(for_all(), Limits::default(), rigs).0
}

fn body(text: &str) -> Value {
    serde_json::from_str(text.split_once("\r\n\r\n").unwrap().1).unwrap()
}

fn is_monitoring(tile: &Value) -> bool {
    tile["row"][schema::field("mode").unwrap()] == 3.0
}

/// The tiles, as soon as all that is wanted of them is there.
fn tiles(address: std::net::SocketAddr, wanted: impl Fn(&Value) -> bool) -> Value {
    loop {
        let (status, text) = get_text(address, "/tiles", &format!("X-Lab-Token: {TOKEN}\r\n"));
        assert_eq!(status, 200, "{text}");
        let tiles = body(&text);
        if wanted(&tiles) {
            return tiles;
        }
    }
}

fn stop_all(address: std::net::SocketAddr, headers: &str) -> (u16, String) {
    let head = format!("POST /stop HTTP/1.1\r\nHost: {address}\r\n{headers}Content-Length: 0\r\n");
    answer(address, format!("{head}Connection: close\r\n\r\n").as_bytes())
}

/// The wall shows what each rig was last seen doing, also one that has never been there, and says of one that has fallen silent that it has.
#[test]
fn each_rig_has_its_tile() {
    let alarmed = |t1| row(&[("mode", 3.0), ("t1", t1), ("alarm", 1.0)]);
    let (lost, _) =
        board("lost", vec![row(&[("mode", 0.0)]), alarmed(35.5), alarmed(36.5), Told::Link(false)], None);
    let missing = Arc::new(Rig::new("missing"));
    assert!(missing.is_missing("no such port"));
    assert!(!missing.is_missing("no such port"), "no news");
    let address = serve(vec![simulated("one", 7), lost, missing]);
    let tiles = tiles(address, |tiles| tiles[1]["lost"].is_number() && is_monitoring(&tiles[0]));
    let of = |tile: usize, name| tiles[tile]["row"][schema::field(name).unwrap()].clone();
    assert_eq!((&tiles[0]["name"], &tiles[0]["preset"]), (&json!("paper, seed 7"), &json!("paper")));
    assert_eq!(tiles[0]["lost"], Value::Null);
    assert_eq!((&tiles[1]["name"], &tiles[1]["kind"]), (&json!("/dev/some-port"), &json!("board")));
    assert_eq!((of(1, "t1"), of(1, "t2")), (json!(36.5), Value::Null));
    assert_eq!((&tiles[1]["mode_for"], &tiles[1]["alarm_for"]), (&json!(0.5), &json!(0.5)));
    assert_eq!(tiles[2], json!({ "board": "missing", "why": "no such port" }));
}

/// Every rig is told, whatever becomes of the others; of each that was not, the wall is told why. Nobody stops, or looks, without the token.
#[test]
fn one_press_stops_all() {
    let (well, given) = board("well", Vec::new(), None);
    let (gone, asked) = board("gone", Vec::new(), Some("the stop has NOT reached the board"));
    let address = serve(vec![gone, Arc::new(Rig::new("missing")), simulated("one", 1), well]);
    for (headers, status) in [("", 403), ("X-Lab-Token: 0123456789abcdee\r\n", 403)] {
        assert_eq!(stop_all(address, headers).0, status, "{headers}");
        assert_eq!(get_text(address, "/tiles", headers).0, status, "{headers}");
    }
    assert!(given.try_recv().is_err() && asked.try_recv().is_err());
    let (status, text) = stop_all(address, &format!("X-Lab-Token: {TOKEN}\r\n"));
    let told = body(&text);
    assert_eq!((status, given.recv().unwrap(), asked.recv().unwrap()), (200, Order::Stop, Order::Stop));
    assert_eq!(told[0], json!({ "board": "gone", "why": "the stop has NOT reached the board" }));
    let why = "the stop has NOT reached it: it has not answered yet";
    assert_eq!(told[1], json!({ "board": "missing", "why": why }));
    assert_eq!([&told[2]["why"], &told[3]["why"]], [&Value::Null, &Value::Null]);
    let all = stream_of(address, "one");
    assert!(all.iter().any(|m| m["order"]["order"] == "stop"), "the simulated one, too");
}

/// The messages of one rig, up to its last order.
fn stream_of(address: std::net::SocketAddr, name: &str) -> Vec<Value> {
    super::stream_at(address, &format!("/boards/{name}"), 0, "", |m| m["type"] != "order")
}

/// Each rig's own page is what it would be alone; what is ordered there is for that rig. There is nothing at the wall that heats.
#[test]
fn each_rig_has_its_page_and_the_wall_takes_no_orders() {
    let (board, given) = board("bench-2", Vec::new(), None);
    let address = serve(vec![simulated("one", 1), board, Arc::new(Rig::new("missing"))]);
    let (status, page) = get_text(address, "/boards/one/", "");
    assert!(status == 200 && page.contains(TOKEN) && page.contains("lab/main.js"));
    let (status, wall) = get_text(address, "/", "");
    assert!(status == 200 && wall.contains(TOKEN) && wall.contains("import(\"lab/wall.js\")"));
    let (status, absent) = get_text(address, "/boards/missing/", "");
    assert!(status == 503 && absent.contains("not there yet") && !absent.contains(TOKEN));
    let arm = r#"{"command":"order","order":{"order":"arm"}}"#;
    assert_eq!(post_text(address, &with_token(), arm).0, 404, "not for all of them");
    let post = |name: &str| super::post_at(address, &format!("/boards/{name}"), &with_token(), arm).0;
    assert_eq!([post("bench-2"), post("missing"), post("other")], [200, 503, 404]);
    assert_eq!(given.recv().unwrap(), Order::Arm);
    assert!(rows_in(&super::stream_at(address, "/boards/one", 0, "", until(3000))) >= 3000);
    for path in ["/boards/", "/boards/one", "/boards/one/tiles", "/boards/../tiles", "/events"] {
        assert_eq!(get_text(address, path, "").0, 404, "{path}");
    }
}

#[test]
fn the_numbers_of_all_rigs_have_their_names() {
    let address = serve(vec![simulated("a", 1), simulated("b", 2), Arc::new(Rig::new("c"))]);
    tiles(address, |tiles| is_monitoring(&tiles[0]) && is_monitoring(&tiles[1]));
    let (status, text) = get_text(address, "/metrics", "");
    assert_eq!(status, 200);
    for sample in [
        "pt326_connected{board=\"a\"} 1",
        "pt326_connected{board=\"c\"} 0",
        "pt326_mode_info{board=\"b\",mode=\"monitor\"} 1",
        "pt326_rig_info{board=\"b\",kind=\"live\",name=\"paper, seed 2\"} 1",
    ] {
        assert!(text.lines().any(|line| line == sample), "no {sample} in {text}");
    }
    assert_eq!(text.matches("# TYPE pt326_mode gauge").count(), 1, "one group of each name");
}

#[test]
fn a_wall_that_is_for_whoever_has_its_link_is_for_nobody_else() {
    let rigs = || vec![simulated("a", 1), simulated("b", 2)];
    let (address, query) = serve_rigs(Access { asks: true, ..for_all() }, Limits::default(), rigs());
    for path in ["/", "/boards/a/"] {
        assert_eq!(get_text(address, path, "").0, 403, "{path}");
        assert_eq!(get_text(address, &format!("{path}{query}"), "").0, 200, "{path}");
    }
    let (open, _) = serve_rigs(Access::open(TOKEN).unwrap(), Limits::default(), rigs());
    assert_eq!(get_text(open, "/metrics", "").0, 401);
}
