//! The wall of several rigs, as `pt326 live` serves it.

mod served;

use pt326_lab_browser::Browser;
use serde_json::json;
use served::{Server, on};

/// What the tiles say.
const TILES: &str = r##"
const tile = (name) => $(`.tile[data-board='${name}']`);
const state = (name) => tile(name)?.dataset.state;
const text = (name, what) => tile(name).querySelector(what).textContent.replaceAll("\u00a0", " ");
const post = (path, body) => fetch(path, { method: "POST", headers: { "Content-Type": "application/json", "X-Lab-Token": $("#token").textContent }, body: JSON.stringify(body) });
"##;

fn says(browser: &Browser, script: &str) -> serde_json::Value {
    on(browser, &format!("{TILES}{script}"))
}

#[test]
fn a_fault_is_on_the_tile_of_its_rig_and_one_press_stops_all() {
    let server = Server::with(0, &["--rigs", "3", "--preset", "paper", "--preset", "oven", "--speed", "10"]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the wall");
    let seen = says(
        &browser,
        r##"await until(() => ["rig-1", "rig-2", "rig-3"].every((name) => state(name) === "monitor"));
        const fault = { do: "offset", sensor: "t2", size: 1.5, at: 0, for: 1000 };
        await post("boards/rig-3/command", { command: "order", order: { order: "break", fault } });
        await until(() => state("rig-3") === "alarm" && /T2/.test(text("rig-3", ".head")));
        return [text("rig-3", "h2"), state("rig-1"), document.title, text("rig-3", ".sub").includes("confidence"), /^Alarm for \d+ s$/.test(text("rig-3", ".state")), $("#count").textContent]"##,
    );
    assert_eq!(
        seen,
        json!(["rig-3paper, seed 3", "monitor", "(1) PT-326: 3 rigs", true, true, "1 in alarm, 2 in order"])
    );
    let stopped = says(
        &browser,
        r##"$("#stop").click(); await until(() => /passed on to all 3/.test($("#told").textContent));
        await until(() => ["rig-1", "rig-2", "rig-3"].every((name) => state(name) === "off" && / 0\.0 %/.test(text(name, "dl").replace("Power", " "))));
        return [...document.querySelectorAll("button")].map((button) => button.id || button.textContent)"##,
    );
    assert_eq!(stopped, json!(["language", "theme", "stop", "×"]), "nothing that arms");
    assert_eq!(browser.complaints().expect("the console"), Vec::<String>::new());
}

/// A click opens the rig's own page, which is the one that it has alone; the way back leads to the wall.
#[test]
fn a_tile_opens_the_page_of_its_rig() {
    let server = Server::with(0, &["--rigs", "2", "--listen", "127.0.0.1"]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the wall");
    says(
        &browser,
        r#"await until(() => state("rig-2") === "monitor"); setTimeout(() => tile("rig-2").click())"#,
    );
    let own = r##"await until(() => window.lab?.lab.store?.end > 3300); return [location.pathname, location.search, $("#source").textContent.trim()]"##;
    // The page may load in the middle of a script: until then it is asked again.
    let own = (0..50).find_map(|_| browser.run(&format!("{}{own}", served::HELPERS), &[]).ok());
    assert_eq!(own, Some(json!(["/boards/rig-2/", "", "Live: paper, seed 2"])));
    // Of six connections that a browser has, a tab that nobody sees keeps none.
    let hidden = r##"const seen = (is) => { Object.defineProperty(document, "hidden", { value: !is, configurable: true }); document.dispatchEvent(new Event("visibilitychange")); };
        const watch = async () => /pt326_clients (\d)/.exec(await (await fetch("metrics", { headers: { Authorization: `Bearer ${$("#token").textContent}` } })).text())[1];
        const before = await watch(); seen(false); await until(async () => (await watch()) === "0"); const { end } = lab.lab.store;
        seen(true); await until(() => lab.lab.store.end > end + 3); return [before, lab.lab.store.first]"##;
    assert_eq!(on(&browser, hidden), json!(["1", 0]), "nothing is missed");
    on(&browser, "setTimeout(() => history.back())");
    let back = r##"await until(() => document.querySelectorAll(".tile").length === 2); return [location.pathname, location.search]"##;
    let back = (0..50).find_map(|_| browser.run(&format!("{}{back}", served::HELPERS), &[]).ok());
    assert_eq!(back, Some(json!(["/", ""])));
}

#[test]
fn it_says_when_its_server_is_gone_and_that_nothing_was_stopped() {
    let server = Server::with(0, &["--rigs", "2"]);
    let browser = Browser::start().expect("a browser");
    browser.open(&server.address).expect("the wall");
    says(&browser, r#"await until(() => state("rig-2") === "monitor")"#);
    drop(server);
    let gone = says(
        &browser,
        r##"await until(() => document.body.matches(".gone")); const said = $("#count").textContent;
        dispatchEvent(new KeyboardEvent("keydown", { key: "!" })); await until(() => $("#told").matches(".bad")); return [said, $("#told").textContent]"##,
    );
    let [said, told] = [0, 1].map(|i| gone[i].as_str().unwrap_or_default().to_owned());
    assert!(said.contains("what you see is old") && told.contains("did NOT go out"), "{gone}");
}

/// Nothing is cut off or beside the screen, from a telephone to a wide wall, in both languages.
#[test]
fn twelve_tiles_fit_every_width() {
    let server = Server::with(0, &["--rigs", "12"]);
    let browser = Browser::start().expect("a browser");
    for (width, columns) in [(400, 1), (1000, 3), (1920, 6)] {
        browser.resize(width, 1000).expect("a size");
        browser.open(&server.address).expect("the wall");
        let fits = says(
            &browser,
            r##"await until(() => document.querySelectorAll(".tile[data-state=monitor]").length === 12);
            const out = () => [...document.querySelectorAll("body *")].filter((node) => node.scrollWidth > node.clientWidth + 1 && node.clientWidth > 0 || node.getBoundingClientRect().right > innerWidth + 1).map((node) => node.outerHTML.slice(0, 80));
            const wide = [...out()]; $("#language").click(); await frame(); wide.push(...out()); const stop = $("#stop").textContent; $("#language").click();
            const tops = new Set([...document.querySelectorAll(".tile")].map((tile) => tile.getBoundingClientRect().left));
            return [wide, tops.size, stop, $("#stop").getBoundingClientRect().height >= 36]"##,
        );
        assert_eq!(fits, json!([[], columns, "Parar todas", true]), "{width} px");
        if let Some(folder) = std::env::var_os("LAB_PICTURE") {
            let file = std::path::Path::new(&folder).join(format!("wall-{width}.png"));
            browser.picture(&file).expect("a picture");
        }
    }
}
