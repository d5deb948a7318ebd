//! The server over its port.

mod access;
mod clients;
mod half_sent;
mod malformed;
mod sources;
mod wall;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::mpsc::channel;

use pt326_lab::session::Session;

use super::*;
use crate::clock;
use crate::source::Source;

const TOKEN: &str = "0123456789abcdef";

fn serve(speed: f64) -> SocketAddr {
    serve_source(Session::new(Scene::default()).unwrap(), speed)
}

/// A page for every user of the machine.
fn for_all() -> Access {
    Access { token: TOKEN.into(), asks: false, open: false }
}

fn serve_source(source: impl Source, speed: f64) -> SocketAddr {
    serve_to(for_all(), Limits::default(), clock::start(source, speed).unwrap()).0
}

/// A server of its own in a thread, and the query that it wants; it ends with the tests.
fn serve_to(access: Access, limits: Limits, clock: Clock) -> (SocketAddr, String) {
    serve_rigs(access, limits, vec![Arc::new(Rig::of("rig", clock))])
}

fn serve_rigs(access: Access, limits: Limits, rigs: Vec<Arc<Rig>>) -> (SocketAddr, String) {
    let (tell, told) = channel();
    std::thread::spawn(move || {
        let tell = |address, query: &str| Ok(tell.send((address, query.to_owned()))?);
        let server = Server::new(rigs, access, None).unwrap();
        listen_within(limits, server, "127.0.0.1:0".parse().unwrap(), tell)
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
    post_at(address, "", headers, body)
}

/// To a rig at `base`.
fn post_at(address: SocketAddr, base: &str, headers: &str, body: &str) -> (u16, String) {
    let length = body.len();
    let host = if headers.contains("Host:") { String::new() } else { format!("Host: {address}\r\n") };
    let head = format!(
        "POST {base}/command HTTP/1.1\r\n{host}{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    answer(address, (head + body).as_bytes())
}

const JSON: &str = "Content-Type: application/json\r\n";

fn with_token() -> String {
    format!("{JSON}X-Lab-Token: {TOKEN}\r\n")
}

/// The messages of a stream, as long as `wanted` says.
fn stream(address: SocketAddr, from: usize, session: &str, wanted: impl FnMut(&Value) -> bool) -> Vec<Value> {
    stream_at(address, "", from, session, wanted)
}

/// Those of a rig at `base`.
fn stream_at(
    address: SocketAddr,
    base: &str,
    from: usize,
    session: &str,
    mut wanted: impl FnMut(&Value) -> bool,
) -> Vec<Value> {
    let mut stream = TcpStream::connect(address).unwrap();
    write!(
        stream,
        "GET {base}/events?token={TOKEN}&from={from}&session={session} HTTP/1.1\r\nHost: {address}\r\n\r\n"
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

fn rows_in(messages: &[Value]) -> u64 {
    rows(messages).iter().map(|(_, count)| count).sum()
}

/// Takes messages until there are rows up to a tick.
fn until(tick: u64) -> impl FnMut(&Value) -> bool {
    move |m| m["type"] != "rows" || m["from"].as_u64().unwrap() + m["count"].as_u64().unwrap() < tick
}
