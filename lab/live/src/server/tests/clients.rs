//! Many who watch one session: they see the same, and none delays another.

use std::collections::BTreeMap;
use std::io::Write;
use std::net::TcpStream;
use std::sync::mpsc::channel;

use serde_json::{Value, json};

use super::{JSON, TOKEN, post_text, rows, rows_in, serve, stream, until, with_token};

/// What one client orders, all see, at the same tick.
#[test]
fn fifty_clients_see_the_same() {
    let address = serve(20.0);
    let order = r#"{"command":"order","order":{"order":"break","fault":{"do":"offset","sensor":"t2","size":1.5,"at":0,"for":5}}}"#;
    let clients: Vec<_> = (0..50)
        .map(|_| {
            std::thread::spawn(move || {
                let mut ordered = false;
                let mut after = 0;
                stream(address, 0, "", |m| {
                    ordered |= m["type"] == "order";
                    after += u32::from(ordered && m["type"] == "rows");
                    after < 2
                })
            })
        })
        .collect();
    stream(address, 0, "", until(3000));
    assert_eq!(post_text(address, &with_token(), order).0, 200);
    let told: Vec<_> = clients.into_iter().map(|client| client.join().unwrap()).collect();
    let first_order = |all: &[Value]| all.iter().find(|m| m["type"] == "order").cloned();
    let tick = first_order(&told[0]).unwrap();
    // Every number of every tick, put together from messages that may be cut elsewhere.
    let numbers = |all: &[Value]| -> BTreeMap<u64, String> {
        let rows = all.iter().filter(|m| m["type"] == "rows");
        rows.map(|m| (m["from"].as_u64().unwrap(), m["values"].as_str().unwrap().to_owned())).collect()
    };
    let one = numbers(&told[0]);
    for other in &told {
        assert_eq!(first_order(other).as_ref(), Some(&tick));
        let theirs = numbers(other);
        let common: Vec<_> = one.iter().filter(|(from, _)| theirs.contains_key(from)).collect();
        assert!(!common.is_empty());
        for (from, values) in common {
            let shorter = values.len().min(theirs[from].len()) / 4 * 4 - 4;
            assert_eq!(values[..shorter], theirs[from][..shorter], "from tick {from}");
        }
        let rows = rows(other);
        assert!(rows.windows(2).all(|w| w[0].0 + w[0].1 == w[1].0), "without a gap");
    }
}

/// Whoever has the token begins another scene; all who watch are told at once, and who comes later hears of the new one only.
#[test]
fn another_scene_is_opened_for_all() {
    let address = serve(0.0);
    let before = stream(address, 0, "", until(3000));
    let open = r#"{"command":"open","scene":{"seed":4,"preset":"oven","disturbance":"calm","orders":[[0,{"order":"arm"}],[9,{"order":"setpoint","celsius":81.5}]]},"at":120}"#;
    assert_eq!(post_text(address, JSON, open).0, 403);
    let (tell, told) = channel();
    let watcher = std::thread::spawn(move || {
        let mut opened = false;
        stream(address, 0, "", |m| {
            if m["type"] == "rows" && !opened {
                let _ = tell.send(());
            }
            opened |= m["type"] == "opened";
            !opened || until(120)(m)
        })
    });
    told.recv().unwrap();
    assert_eq!(post_text(address, &with_token(), open).0, 200);
    let seen = watcher.join().unwrap();
    let place = seen.iter().position(|m| m["type"] == "opened").unwrap();
    let opened = &seen[place];
    assert_eq!((&opened["scene"]["preset"], &opened["ts"]), (&json!("oven"), &json!(2.0)));
    assert_eq!(opened["settings"]["pid.ti"], json!(60.0));
    assert_eq!(rows(&seen[place..])[0].0, 0);
    let later = stream(address, 0, "", until(120));
    assert_eq!((&later[0]["name"], &later[0]["ts"]), (&json!("oven, seed 4"), &json!(2.0)));
    assert_eq!((&later[0]["session"], rows_in(&later)), (&opened["session"], 120));
    // Who was with the last scene does not go on in this one.
    let stale = stream(address, 100, before[0]["session"].as_str().unwrap(), until(120));
    assert_eq!(rows(&stale)[0].0, 0);
    for (wrong, words) in [
        (r#"{"command":"open","scene":{"preset":"kettle"}}"#, "kettle"),
        (r#"{"command":"open","scene":{},"at":4000000000}"#, "\"code\":\"ticks\""),
    ] {
        let (status, why) = post_text(address, &with_token(), wrong);
        assert!(status == 409 && why.contains(words), "{why}");
    }
    assert_eq!(rows_in(&stream(address, 0, "", until(120))), 120, "what is refused changes nothing");
}

/// A client that reads nothing delays nobody, and one that comes back goes on where it was.
#[test]
fn a_slow_client_delays_nobody_and_one_that_comes_back_misses_nothing() {
    let address = serve(100.0);
    let mut slow = TcpStream::connect(address).unwrap();
    write!(slow, "GET /events?token={TOKEN} HTTP/1.1\r\nHost: {address}\r\n\r\n").unwrap();
    let before = stream(address, 0, "", until(4000));
    let session = before[0]["session"].as_str().unwrap().to_owned();
    let (from, count) = *rows(&before).last().unwrap();
    let again = stream(address, (from + count) as usize, &session, until(from + count + 500));
    assert_eq!(rows(&again)[0].0, from + count);
    let stranger = stream(address, 4000, "another", until(1));
    assert_eq!(rows(&stranger)[0].0, 0, "another life: all of it");
    drop(slow);
}
