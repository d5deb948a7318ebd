//! The page as `pt326 live` serves it: faults, two pages at once, and a server that is killed and comes back.

mod board;
mod served;

use board::Board;
use pt326::commands::run::carry_out as run_experiment;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::settings::read as read_settings;
use pt326_lab_browser::port::PORT;
use pt326_lab_browser::{Browser, page};
use serde_json::json;
use served::{HELPERS, Server, TOKEN, on};

#[test]
fn a_fault_put_in_on_one_page_is_named_on_another() {
    let server = Server::start(0);
    let [one, other] = [(); 2].map(|()| {
        let browser = Browser::start().expect("a browser");
        browser.open(&server.address).expect("the page");
        on(&browser, r#"await until(() => lab.lab.store?.end > 3300 && lab.row().mode === 3)"#);
        browser
    });
    on(
        &one,
        r##"$("#speed").value = 10; $("#speed").dispatchEvent(new Event("change")); click("[data-part=T2]"); $("#sheet .primary").click();"##,
    );
    let seen = r##"await until(() => /T2/.test($("#head").innerText)); return [lab.events().last.named, lab.events().last.label(), $("#source").textContent.trim()]"##;
    let expected = json!(["t2_offset", "T2: reads wrong, +1.5\u{a0}°C", "Live: paper, seed 1"]);
    assert_eq!(on(&other, seen), expected);
    assert_eq!(on(&one, seen), expected);
    let trace = on(
        &one,
        r#"const { parts } = await lab.ask({ command: "trace" }); return parts[0].split("\n").length > 3300"#,
    );
    assert_eq!(trace, json!(true));
    let refused = r##"lab.send({ command: "order", order: { order: "setpoint", celsius: 500 } }); await until(() => $("#toast").textContent); return $("#toast").textContent"##;
    assert!(on(&other, refused).as_str().is_some_and(|text| text.contains("500\u{a0}°C; 20 to 65")));
    // Another seed, chosen on one page, is another scene for both.
    on(
        &one,
        r##"$("#seed").value = 6; $("#seed").dispatchEvent(new Event("change", { bubbles: true })); await until(() => lab.lab.scene.seed === 6 && lab.lab.store.end > 3300)"##,
    );
    let told = r##"await until(() => lab.lab.scene.seed === 6 && lab.lab.store.end > 3300);
        return [$("#source").textContent.trim(), $("#seed").value, lab.events().list.length, lab.row().mode]"##;
    assert_eq!(on(&other, told), json!(["Live: paper, seed 6", "6", 0, 3]));
    on(&one, r##"click("#stop"); await until(() => lab.row().drive === 0)"##);
    assert_eq!(
        on(
            &other,
            r##"await until(() => lab.row().mode === 0 && $("#stop").textContent !== "Stop heater"); return $("#stop").textContent"##
        ),
        json!("Arm")
    );
    assert_eq!(one.complaints().expect("the console"), Vec::<String>::new());
}

#[test]
fn a_page_says_when_its_server_is_gone_and_goes_on_when_it_is_back() {
    let server = Server::start(0);
    let port = server.port();
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the page");
    on(&browser, r#"await until(() => lab.lab.store?.end > 3300)"#);
    drop(server);
    let said = on(
        &browser,
        r##"await until(() => document.body.dataset.state === "lost"); return /^No connection for \d+ s$/.test($("#state").textContent.trim().replaceAll("\u00a0", " "))"##,
    );
    assert_eq!(said, json!(true));
    let server = Server::start(port);
    assert_eq!(server.port(), port);
    // The page may load anew in the middle of a script: until then it is asked again.
    let back = (0..50).find_map(|_| browser.run(&format!("{HELPERS} await until(() => window.lab?.lab.store?.end > 3300 && document.body.dataset.state === 'monitor'); return 1"), &[]).ok());
    assert_eq!(back, Some(json!(1)));
}

/// With lab.html the page that is served can go over to a board at a port, and come back to the server.
#[test]
fn the_page_that_is_served_connects_a_board_and_comes_back() {
    let lab = page();
    let server = Server::with(0, &["--page", lab.to_str().expect("a path")]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the page");
    let script = r##"await until(() => lab.lab.store?.end > 3300);
        const before = [lab.lab.hello.kind, $("#connect").hidden, $("#back").hidden, isSecureContext && "serial" in navigator];
        const port = new Port(BOARD); offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        await until(() => !$("#back").hidden);
        click("#stop"); await until(() => port.heard.includes("\x03"));
        click("#back"); click("#back"); await until(() => lab.lab.hello.kind === "live" && lab.lab.store?.end > 3300);
        return [before, $("#connect").hidden, $("#back").hidden, $("#source").textContent.trim()]"##;
    let seen = on(&browser, &format!("{PORT}{script}"));
    assert_eq!(seen, json!([["live", false, true, true], false, true, "Live: paper, seed 1"]));
    assert_eq!(browser.complaints().expect("the console"), Vec::<String>::new());
}

/// A page that is for whoever has its link: the tab keeps the token, the address does not, and nobody else comes in.
#[test]
fn the_token_is_not_seen_and_outlives_a_reload() {
    let server = Server::with(0, &["--listen", "127.0.0.1"]);
    let (plain, token) = server.address.split_once('?').expect("a link with the token");
    assert_eq!(token, format!("token={TOKEN}"));
    let entered = r#"await until(() => lab.lab.store?.end > 3300); return [location.search, document.referrer, history.length]"#;
    let browser = Browser::start().expect("a browser");
    browser.open(&format!("{}#s=x", server.address)).expect("the page");
    let [search, referrer, before] =
        on(&browser, entered).as_array().expect("three").clone().try_into().expect("three");
    assert_eq!((search, referrer), (json!(""), json!("")));
    browser.open(plain).expect("the page again");
    let [search, _, after] =
        on(&browser, entered).as_array().expect("three").clone().try_into().expect("three");
    assert_eq!((search, after.as_u64()), (json!(""), before.as_u64().map(|n| n + 1)));
    let refused = |browser: &Browser, address: &str| {
        browser.open(address).expect("an answer");
        let text = on(browser, "return document.body.innerText");
        assert!(text.as_str().is_some_and(|text| text.contains("by its link only")), "{text}");
    };
    let stranger = Browser::start().expect("a browser");
    refused(&stranger, plain);
    // One of another server is forgotten, and does not come in by loading again.
    refused(&browser, &format!("{plain}?token=fedcba9876543210"));
    refused(&browser, plain);
}

/// A trace tells what was taught: nobody need say what settings it was made with.
#[test]
fn a_recording_that_is_served_has_the_names_of_its_settings() {
    let folder = std::env::temp_dir().join(format!("pt326-served-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let [settings, trace] = ["taught.toml", "trace.csv"].map(|name| folder.join(name));
    let taught = "likelihood.taught = [{ name = \"cap\", effects = [0, 0, 0, 0, 150, -150, 0, 0, 0, 0, 0] }]";
    std::fs::write(&settings, taught).expect("the settings");
    let config = read_settings(Some(&settings)).expect("settings");
    let scenario = Scenario { duration: 20.0, faults: Vec::new(), ..Scenario::default() };
    run_experiment(&config, &scenario, 1, &folder).expect("the run");
    let trace = trace.to_str().expect("a path");
    let server = Server::with(0, &["--recording", trace, "--speed", "100"]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the page");
    let named = on(
        &browser,
        r##"await until(() => lab.lab.store?.end > 10); return (await import("lab/say.js")).taughtName(1)"##,
    );
    assert_eq!(named, json!("cap"));
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
#[ignore = "needs `cargo fw` and a built virtual-board"]
fn a_real_board_is_commissioned_from_the_page_and_heats_at_a_second_press_only() {
    let board = Board::start(&[]);
    let server = Server::with(0, &["--board", &board.link]);
    assert!(server.address.contains("/?token="), "{}", server.address);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the page");
    let shown = r##"await until(() => lab.lab.store?.end > 5 && !$("#desk-board").hidden);
        const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
        const check = $("[data-line=check]"); check.click(); check.click(); // a double click is one press
        await sleep(400); lab.send({ command: "order", order: { order: "setpoint", celsius: 36 } }); await sleep(300);
        const asks = check.textContent; const before = $("#console").textContent.includes("check"); check.click();
        await until(() => $("#console").textContent.includes("check: thermistors at rest")); await until(() => lab.row().drive === 2.5); const head = (await until(() => /Self-test/.test($("#head").textContent)), true);
        return [asks, before, check.textContent, head]"##;
    assert_eq!(on(&browser, shown), json!(["Yes, it may heat", false, "Self-test (heats a little)", true]));
    let typed = r##"$("#line").focus(); $("#line").dispatchEvent(new KeyboardEvent("keydown", { key: "!", bubbles: true }));
        await until(() => $("#console").textContent.includes("check ended early: stopped") && /heater is off/.test($("#head").textContent)); return 1"##;
    assert_eq!(on(&browser, typed), json!(1));
    let settings = r##"const kp = $("#settings [data-name='pid.kp']"); const before = [kp.value, kp.min, kp.nextElementSibling.textContent];
        kp.value = ""; kp.dispatchEvent(new Event("change", { bubbles: true })); before.push(kp.value);
        kp.value = "2.5"; kp.dispatchEvent(new Event("change", { bubbles: true }));
        await until(() => lab.lab.settings["pid.kp"] === 2.5); return before"##;
    assert_eq!(on(&browser, settings), json!(["2.4", "0", "%/°C 0 … 1000", "2.4"]));
    let asked = r##"$("#line").value = "tune"; $("#typed").requestSubmit();
        await until(() => $("#console").textContent.includes("nothing yet: `tune start`")); return 1"##;
    assert_eq!(on(&browser, asked), json!(1));
    if let Some(file) = std::env::var_os("LAB_PICTURE") {
        browser.picture(file.as_ref()).expect("a picture");
    }
}

#[test]
#[ignore = "needs `cargo fw` and a built virtual-board"]
fn a_real_board_is_armed_stopped_and_missed() {
    let mut board = Board::start(&[]);
    let server = Server::with(0, &["--board", &board.link]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the page");
    let shown = r##"await until(() => lab.lab.store?.end > 5 && $("#stop").textContent === "Stop heater");
        return ["#modes", "#transport", "#desk-rig", "#desk-control"].map((id) => $(id).hidden)"##;
    assert_eq!(on(&browser, shown), json!([true, true, true, false]));
    let warm = r##"lab.send({ command: "order", order: { order: "setpoint", celsius: 36 } });
        await until(() => lab.row().setpoint === 36); return $("#setpoint").textContent"##;
    on(&browser, warm);
    // It wants its self-test passed first, and says so.
    let refused = r##"const arm = () => $("#more [data-line=arm]").click(); arm(); await new Promise((done) => setTimeout(done, 700));
        if ($("#toast").textContent.includes("check")) return "at the first press"; arm(); await until(() => $("#toast").textContent); return $("#toast").textContent"##;
    let refused = on(&browser, refused);
    assert!(refused.as_str().is_some_and(|text| text.contains("no `check`")), "{refused}");
    board.desk("unplug");
    let lost = r##"await until(() => document.body.dataset.state === "lost"); return [$("#stop").textContent, $("#sub").textContent]"##;
    let lost = on(&browser, lost);
    assert!(
        lost[0] == "Stop heater" && lost[1].as_str().is_some_and(|text| text.contains("trips by itself")),
        "{lost}"
    );
    let stop = r##"$("#toast").textContent = ""; click("#stop"); await until(() => /NOT/.test($("#toast").textContent)); return 1"##;
    assert_eq!(on(&browser, stop), json!(1));
    board.desk("plug");
    on(&browser, r##"await until(() => document.body.dataset.state === "off")"##);
    if let Some(file) = std::env::var_os("LAB_PICTURE") {
        browser.picture(file.as_ref()).expect("a picture");
    }
    let mut complaints = browser.complaints().expect("the console");
    complaints.retain(|text| !text.contains("409"));
    assert_eq!(complaints, Vec::<String>::new());
}
