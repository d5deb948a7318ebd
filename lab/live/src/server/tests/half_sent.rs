//! Requests of which the rest never comes.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use pt326_lab::scene::Scene;
use pt326_lab::session::Session;

use super::{TOKEN, for_all, get_text, post_text, serve_to, with_token};
use crate::clock;
use crate::server::connections::Limits;

const STOP: &str = r#"{"command":"order","order":{"order":"stop"}}"#;
/// So long that nothing of a test waits for it.
const LONG: Duration = Duration::from_secs(3600);

fn serve(limits: Limits) -> SocketAddr {
    let session = Session::new(Scene::default()).unwrap();
    serve_to(for_all(), limits, clock::start(session, 0.0).unwrap()).0
}

/// A connection that sends something, and nothing more; a test that waits for it for a minute has failed.
fn sends(address: SocketAddr, text: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    stream.write_all(text.as_bytes()).unwrap();
    stream
}

fn is_closed(stream: &mut TcpStream) -> bool {
    match stream.read(&mut [0; 1]) {
        Ok(n) => n == 0,
        Err(error) => error.kind() == ErrorKind::ConnectionReset,
    }
}

/// The status of the answer that comes.
fn status(stream: &mut TcpStream) -> u16 {
    let mut text = [0; 12];
    stream.read_exact(&mut text).unwrap();
    str::from_utf8(&text[9..]).unwrap().parse().unwrap()
}

fn stop_on(stream: &mut TcpStream, address: SocketAddr) -> u16 {
    let (headers, length) = (with_token(), STOP.len());
    let head =
        format!("POST /command HTTP/1.1\r\nHost: {address}\r\n{headers}Content-Length: {length}\r\n\r\n");
    stream.write_all((head + STOP).as_bytes()).unwrap();
    let code = status(stream);
    let mut byte = [0; 1];
    let mut end = Vec::new();
    while !end.ends_with(b"}]") {
        stream.read_exact(&mut byte).unwrap();
        end.push(byte[0]);
    }
    code
}

#[test]
fn the_oldest_stranger_makes_room_and_who_has_shown_the_token_stays() {
    let address = serve(Limits { strangers: 4, patience: LONG });
    let half = format!("GET /metrics HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n");
    let mut page = sends(address, "");
    assert_eq!(stop_on(&mut page, address), 200);
    let mut watches =
        sends(address, &format!("GET /events?token={TOKEN} HTTP/1.1\r\nHost: {address}\r\n\r\n"));
    assert_eq!(status(&mut watches), 200);
    let mut strangers: Vec<_> = (0..5).map(|_| sends(address, &half)).collect();
    assert!(is_closed(&mut strangers[0]), "the fifth takes the place of the first");
    let newest = strangers.last_mut().unwrap();
    newest.write_all(b"\r\n").unwrap();
    assert_eq!(status(newest), 200);
    strangers.extend((0..20).map(|_| sends(address, &half)));
    assert!(is_closed(&mut strangers[10]));
    assert_eq!(stop_on(&mut page, address), 200);
    let mut text = [0; 64];
    watches.read_exact(&mut text).unwrap();
}

#[test]
fn a_head_or_a_body_that_does_not_end_is_not_waited_for() {
    let address = serve(Limits { patience: Duration::from_millis(50), ..Limits::default() });
    assert!(is_closed(&mut sends(address, "GET / HTTP/1.1\r\nHost: ")));
    assert!(is_closed(&mut sends(address, "")), "nor one that says nothing");
    let head = format!("POST /command HTTP/1.1\r\nHost: {address}\r\nContent-Length: 100\r\n");
    assert_eq!(status(&mut sends(address, &format!("{head}{}\r\n{{\"comm", with_token()))), 408);
}

#[test]
fn no_body_is_read_of_whoever_has_not_the_token() {
    let address = serve(Limits { patience: LONG, ..Limits::default() });
    let head = format!("POST /command HTTP/1.1\r\nHost: {address}\r\nContent-Length: 100\r\n");
    let mut stranger = sends(address, &format!("{head}\r\n{{\"comm"));
    assert_eq!(status(&mut stranger), 403);
    let mut rest = Vec::new();
    stranger.read_to_end(&mut rest).unwrap(); // it ends
}

/// Ten thousand requests are begun and none is ended, as many at once as the system allows; a stop is carried out within a second all the
/// while, by a page that was there before and by one that comes.
#[test]
#[ignore = "opens ten thousand connections; ./check runs it"]
fn a_stop_passes_ten_thousand_half_sent_requests() {
    const ALL: usize = 10_000;
    let address = serve(Limits::default());
    let mut page = sends(address, "");
    assert_eq!(stop_on(&mut page, address), 200);
    let flood = std::thread::spawn(move || {
        let mut open = Vec::new();
        let mut most = 0;
        for i in 0..ALL {
            let half = ["", "POST /comm", "POST /command HTTP/1.1\r\nX-Lab-Token: "][i % 3];
            match TcpStream::connect(address) {
                Ok(mut stream) => {
                    let _ = stream.write_all(half.as_bytes());
                    open.push(stream);
                }
                // This process may have no more: half of them go, the oldest first.
                Err(_) => drop(open.drain(..open.len() / 2)),
            }
            most = most.max(open.len());
        }
        (open, most)
    });
    let mut slowest = Duration::ZERO;
    let mut stop = |page: &mut TcpStream| {
        for known in [true, false] {
            let begin = Instant::now();
            let status =
                if known { stop_on(page, address) } else { post_text(address, &with_token(), STOP).0 };
            assert_eq!(status, 200);
            slowest = slowest.max(begin.elapsed());
        }
    };
    while !flood.is_finished() {
        stop(&mut page);
    }
    let (open, most) = flood.join().unwrap();
    stop(&mut page);
    println!("{most} connections open at once, the slowest stop {slowest:?}");
    assert!(slowest < Duration::from_secs(1), "{slowest:?}");
    drop(open);
    assert_eq!(get_text(address, "/", "").0, 200);
}
