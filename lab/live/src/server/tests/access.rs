//! What is served, and to whom.

use super::{JSON, LONGEST, TOKEN, get_text, post_text, serve, stream, until, with_token};

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
