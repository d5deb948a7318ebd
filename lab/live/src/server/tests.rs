use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::channel;

use pt326_lab::fields::FIELDS;
use pt326_lab::names::Names;
use pt326_lab::scene::Scene;
use pt326_lab::session::Session;

use serde_json::json;

use super::*;
use crate::clock;
use crate::source::{Recording, Source, Told};

const TOKEN: &str = "0123456789abcdef";

fn serve(speed: f64) -> SocketAddr {
    serve_source(Session::new(Scene::default()).unwrap(), speed)
}

/// A server of its own in a thread; it ends with the tests.
fn serve_source(source: impl Source, speed: f64) -> SocketAddr {
    let access = Access { token: TOKEN.into(), open: false };
    let server = Server { clock: clock::start(source, speed).unwrap(), access };
    let (tell, told) = channel();
    std::thread::spawn(move || {
        listen(server, "127.0.0.1:0".parse().unwrap(), |address, _| Ok(tell.send(address)?))
    });
    told.recv().unwrap()
}

/// Sends a request that asks to close; what comes back.
fn answer(address: SocketAddr, request: &[u8]) -> (u16, String) {
    let mut stream = TcpStream::connect(address).unwrap();
    let _ = stream.write_all(request); // it may have turned away before the end
    all_of(stream)
}

fn all_of(mut stream: TcpStream) -> (u16, String) {
    let mut text = Vec::new();
    let _ = stream.read_to_end(&mut text);
    let text = String::from_utf8_lossy(&text).into_owned();
    let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    (status, text)
}

fn get_text(address: SocketAddr, path: &str, headers: &str) -> (u16, String) {
    answer(
        address,
        format!("GET {path} HTTP/1.1\r\nHost: {address}\r\n{headers}Connection: close\r\n\r\n").as_bytes(),
    )
}

fn post_text(address: SocketAddr, headers: &str, body: &str) -> (u16, String) {
    let length = body.len();
    let host = if headers.contains("Host:") { String::new() } else { format!("Host: {address}\r\n") };
    let head = format!(
        "POST /command HTTP/1.1\r\n{host}{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    answer(address, (head + body).as_bytes())
}

const JSON: &str = "Content-Type: application/json\r\n";

fn with_token() -> String {
    format!("{JSON}X-Lab-Token: {TOKEN}\r\n")
}

/// The messages of a stream, as long as `wanted` says.
fn stream(
    address: SocketAddr,
    from: usize,
    session: &str,
    mut wanted: impl FnMut(&Value) -> bool,
) -> Vec<Value> {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(
        stream,
        "GET /events?token={TOKEN}&from={from}&session={session} HTTP/1.1\r\nHost: {address}\r\n\r\n"
    )
    .unwrap();
    let mut all = Vec::new();
    for line in BufReader::new(stream).lines() {
        let line = line.unwrap();
        let Some(data) = line.strip_prefix("data: ") else { continue };
        let message: Value = serde_json::from_str(data).unwrap();
        let more = wanted(&message);
        all.push(message);
        if !more {
            break;
        }
    }
    all
}

fn rows(messages: &[Value]) -> Vec<(u64, u64)> {
    let rows = messages.iter().filter(|m| m["type"] == "rows");
    rows.map(|m| (m["from"].as_u64().unwrap(), m["count"].as_u64().unwrap())).collect()
}

/// Takes messages until there are rows up to a tick.
fn until(tick: u64) -> impl FnMut(&Value) -> bool {
    move |m| m["type"] != "rows" || m["from"].as_u64().unwrap() + m["count"].as_u64().unwrap() < tick
}

#[test]
fn the_page_its_numbers_and_nothing_else_are_served() {
    let address = serve(0.0);
    let (status, page) = get_text(address, "/", "");
    assert!(status == 200 && page.contains(TOKEN) && page.contains("id=\"token\""));
    assert!(page.contains("content-security-policy: default-src 'none'") && page.contains("no-store"));
    stream(address, 0, "", until(3000));
    let (status, text) = get_text(address, "/metrics", "");
    assert!(status == 200 && text.contains("pt326_temperature_celsius{sensor=\"t1\"} 3"), "{text}");
    for path in [
        "/lab.html",
        "/../Cargo.toml",
        "/%2e%2e/etc/passwd",
        "//",
        "/page/main.js",
        "/events/",
        "/favicon.ico",
    ] {
        assert_eq!(get_text(address, path, "").0, 404, "{path}");
    }
    assert_eq!(get_text(address, "/command", "").0, 405);
}

#[test]
fn commands_need_token_json_host_and_origin() {
    let address = serve(0.0);
    let run = r#"{"command":"run","speed":0}"#;
    assert_eq!(post_text(address, &with_token(), run).0, 200);
    let own = format!("{}Origin: http://{address}\r\n", with_token());
    assert_eq!(post_text(address, &own, run).0, 200);
    for (headers, status) in [
        (JSON.to_owned(), 403),
        (format!("{JSON}X-Lab-Token: {}\r\n", &TOKEN[1..]), 403),
        (format!("X-Lab-Token: {TOKEN}\r\n"), 415),
        (format!("Content-Type: text/plain\r\nX-Lab-Token: {TOKEN}\r\n"), 415),
        (format!("{}Origin: http://evil.example\r\n", with_token()), 403),
        (format!("{}Host: evil.example:80\r\n", with_token()), 421),
    ] {
        assert_eq!(post_text(address, &headers, run).0, status, "{headers}");
    }
    assert_eq!(get_text(address, "/events", "").0, 403);
    assert_eq!(get_text(address, "/events?token=wrong", "").0, 403);
    let refused = |body: &str| post_text(address, &with_token(), body);
    let (status, why) = refused(r#"{"command":"order","order":{"order":"setpoint","celsius":500}}"#);
    assert!(status == 409 && why.contains("set-point 500") && why.contains("\"code\":\"setpoint\""), "{why}");
    assert_eq!(refused(r#"{"command":"run","speed":1000000000}"#).0, 409);
    for body in ["", "{", "[]", r#"{"command":"open"}"#, r#"{"command":"order","order":{"order":"melt"}}"#] {
        assert!((400..500).contains(&refused(body).0), "{body}");
    }
    assert_eq!(refused(&format!("{{\"command\":\"{}\"}}", "x".repeat(LONGEST))).0, 413);
}

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

/// 100,000 requests that are none: nothing but 4xx or a closed connection, the server still serves, and holds no more memory than after the
/// first tenth of them. Memory is that of the process, with the client that asks: `-- --ignored --nocapture` tells it.
#[test]
#[ignore = "takes half a minute; ./check runs it"]
fn a_hundred_thousand_malformed_requests_change_nothing() {
    let address = serve(0.0);
    stream(address, 0, "", until(3000));
    let started = resident();
    malformed(address, 10_000);
    let before = resident();
    malformed(address, 90_000);
    let after = resident();
    println!("{started} kB at the start, {before} kB after 10,000 requests, {after} kB after 100,000");
    assert!(after < before + 2_000, "{before} kB, then {after} kB");
}

/// What the process holds of memory, kB; 0 where the system does not tell.
fn resident() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(0)
}

#[test]
fn malformed_requests_change_nothing() {
    let address = serve(0.0);
    stream(address, 0, "", until(3000));
    malformed(address, 1_500);
}

fn malformed(address: SocketAddr, count: u32) {
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = move |below: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random % below as u64) as usize
    };
    let methods = ["GET", "POST", "PUT", "DELETE", "OPTIONS", "get", "G\0T", "", "TRACE", "PATCH"];
    let paths = [
        "/command",
        "/events",
        "/events?token=",
        "/x",
        "*",
        "/%00",
        "http://evil/",
        "/\u{1}",
        "/events?from=-1&token=x",
    ];
    let headers = [
        "X-Lab-Token: wrong\r\n",
        "Content-Length: 5\r\n",
        "Content-Length: -1\r\n",
        "Transfer-Encoding: chunked\r\n",
        "Origin: null\r\n",
        "Content-Type: application/json\r\n",
        "Host: evil.example\r\n",
        "Upgrade: h2c\r\nConnection: upgrade\r\n",
        ": \r\n",
        "Expect: 100-continue\r\n",
    ];
    let bodies = ["", "{}", "5\r\n{\"a\":\r\n0\r\n\r\n", "\0\0\0\0", "{\"command\":\"trace\"}", "[[[[[[[["];
    // Of one who has the token, too: what is no JSON, no command, no order, no scene; too deep, too long.
    let deep = "[".repeat(3000);
    let long = format!("{{\"command\":\"{}\"}}", "x".repeat(LONGEST));
    let commands = [
        "",
        "nonsense",
        "[]",
        "{\"command\":7}",
        "{\"command\":\"run\",\"speed\":\"fast\"}",
        "{\"command\":\"run\",\"speed\":-1}",
        "{\"command\":\"order\",\"order\":{\"order\":\"setpoint\",\"celsius\":1e99}}",
        "{\"command\":\"order\",\"order\":{\"order\":\"break\",\"fault\":{\"do\":\"offset\"}}}",
        "{\"command\":\"order\",\"order\":{\"order\":\"set\",\"name\":\"pid.kp\",\"value\":-3}}",
        "{\"command\":\"open\",\"scene\":{\"preset\":\"\"}}",
        "{\"command\":\"open\",\"scene\":{\"orders\":[[5,{\"order\":\"arm\"}],[4,{\"order\":\"stop\"}]]}}",
        &deep,
        &long,
    ];
    let mut seen = BTreeMap::<u16, u32>::new();
    for _ in 0..count {
        if next(4) == 0 {
            let (status, _) = post_text(address, &with_token(), commands[next(commands.len())]);
            *seen.entry(status).or_default() += 1;
            continue;
        }
        let mut text = format!("{} {} HTTP/1.1\r\n", methods[next(methods.len())], paths[next(paths.len())]);
        if next(3) > 0 {
            text += &format!("Host: {address}\r\n");
        }
        (0..next(4)).for_each(|_| text += headers[next(headers.len())]);
        text += "Connection: close\r\n\r\n";
        text += bodies[next(bodies.len())];
        let mut bytes = text.into_bytes();
        for _ in 0..next(3) {
            let place = next(bytes.len());
            bytes[place] = next(256) as u8;
        }
        bytes.truncate(bytes.len() - next(bytes.len() / 4));
        if [b"GET / ", b"GET /?", b"GET /#"].iter().any(|good| bytes.starts_with(*good)) {
            continue; // it asks for the page
        }
        let mut stream = TcpStream::connect(address).unwrap();
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        *seen.entry(all_of(stream).0).or_default() += 1;
    }
    assert!(seen.keys().all(|status| *status == 0 || (400..500).contains(status)), "{seen:?}");
    assert!(seen.len() > 4, "{seen:?}");
    assert_eq!(get_text(address, "/", "").0, 200);
    let (_, text) = get_text(address, "/metrics", "");
    assert!(text.contains("pt326_clients 0"), "no stream is left open: {text}");
    assert!(text.contains("pt326_mode 3"), "the session is as it was: {text}");
    assert!(seen.contains_key(&409) && seen.contains_key(&413) && seen.contains_key(&422), "{seen:?}");
}

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

/// A board: its rows come when they come, and word of orders from itself.
struct Board(std::sync::mpsc::Receiver<Told>);

impl Source for Board {
    fn name(&self) -> String {
        "a port".into()
    }

    fn kind(&self) -> &'static str {
        "board"
    }

    fn can(&self) -> &'static [&'static str] {
        &["order"]
    }

    fn sample_time(&self) -> f64 {
        3600.0
    }

    fn has_own_time(&self) -> bool {
        true
    }

    fn next(&mut self) -> Option<Told> {
        self.0.try_recv().ok()
    }

    fn order(&mut self, _: Order) -> anyhow::Result<()> {
        Ok(())
    }
}

#[test]
fn what_a_board_tells_comes_in_its_own_time_and_order() {
    let (tell, told) = channel();
    let address = serve_source(Board(told), 1.0);
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
        Told::Refused("why".into()),
        Told::Names(Names { rows: Vec::new(), taught: vec!["cap".into()] }),
        Told::Link(false),
        row(),
    ];
    all.into_iter().for_each(|told| tell.send(told).unwrap());
    let heard = stream(address, 0, "", until(2));
    assert_eq!((&heard[0]["kind"], &heard[0]["can"]), (&json!("board"), &json!(["order"])));
    let types: Vec<&str> = heard[1..].iter().filter_map(|message| message["type"].as_str()).collect();
    assert_eq!(types, ["link", "rows", "order", "refused", "names", "link", "rows"]);
    assert_eq!((&heard[3]["tick"], &heard[6]["up"]), (&json!(1), &json!(false)));
    assert_eq!((&heard[5]["own_names"], &heard[5]["taught_names"]), (&json!([]), &json!(["cap"])));
}

fn rows_in(messages: &[Value]) -> u64 {
    rows(messages).iter().map(|(_, count)| count).sum()
}
