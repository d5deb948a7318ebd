//! Requests that are none.

use std::collections::BTreeMap;
use std::io::Write;
use std::net::{SocketAddr, TcpStream};

use super::{LONGEST, all_of, get_text, post_text, serve, stream, until, with_token};

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
