//! What is served, and to whom.

use pt326_lab::scene::Scene;
use pt326_lab::session::Session;

use std::sync::Arc;

use crate::wall::Rig;

use super::{
    JSON, LONGEST, Server, TOKEN, for_all, get_text, page, post_text, serve, serve_to, stream, until,
    with_token,
};
use crate::clock;
use crate::guard::Access;
use crate::server::connections::Limits;

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

/// Only a page that has a session within it may run WebAssembly, in a worker; and nothing else is taken for one.
#[test]
fn lab_html_is_served_with_what_is_in_it() {
    let clock = || clock::start(Session::new(Scene::default()).unwrap(), 0.0).unwrap();
    let server = |lab| Server::new(vec![Arc::new(Rig::of("rig", clock()))], for_all(), lab);
    let lab = page::html(page::Source::InPage(b"\0asm"));
    let [plain, whole] = [None, Some(&*lab)].map(|lab| server(lab).unwrap());
    let text = |server: &Server| String::from_utf8(server.page.html.to_vec()).unwrap();
    for part in [TOKEN, "id=\"worker\"", "AGFzbQ=="] {
        assert!(text(&whole).contains(part), "{part}");
    }
    assert!(!text(&plain).contains("id=\"worker\""));
    let allows = |server: &Server, what| server.policy.to_str().unwrap().contains(what);
    for what in ["'wasm-unsafe-eval'", "worker-src blob:"] {
        assert!(allows(&whole, what) && !allows(&plain, what), "{what}");
    }
    let other = server(Some("<!doctype html>")).err().unwrap().to_string();
    assert!(other.contains("cargo lab"), "{other}");
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

/// Where the page is for its user alone nobody else on the machine is told the token; the numbers stay for all, and commands for who has it.
#[test]
fn the_page_of_a_board_is_for_whoever_brings_the_token() {
    let clock = || clock::start(Session::new(Scene::default()).unwrap(), 0.0).unwrap();
    let (address, query) = serve_to(Access { asks: true, ..for_all() }, Limits::default(), clock());
    assert_eq!(query, format!("?token={TOKEN}"));
    let (status, page) = get_text(address, &format!("/{query}"), "");
    assert!(
        status == 200
            && page.contains(&format!(">{TOKEN}<"))
            && page.contains("referrer-policy: no-referrer")
    );
    for path in ["/", "/?token=", "/?token=0123456789abcdee", "/?from=1"] {
        let (status, door) = get_text(address, path, "");
        assert!(status == 403 && !door.contains(TOKEN), "{path}: {status}");
        assert!(
            door.contains("This page opens by its link only") && door.contains("pela sua liga"),
            "{path}"
        );
    }
    assert_eq!(get_text(address, "/metrics", "").0, 200);
    let run = r#"{"command":"run","speed":0}"#;
    assert_eq!((post_text(address, JSON, run).0, post_text(address, &with_token(), run).0), (403, 200));
    let (other_machines, _) = serve_to(Access::open(TOKEN).unwrap(), Limits::default(), clock());
    assert_eq!(get_text(other_machines, "/", "").0, 403);
    assert_eq!(get_text(other_machines, "/metrics", "").0, 401);
    assert_eq!(get_text(other_machines, "/metrics", &format!("Authorization: Bearer {TOKEN}\r\n")).0, 200);
}
