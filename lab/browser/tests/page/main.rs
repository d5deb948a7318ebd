//! lab.html, as a user has it, in Chromium. `LAB_PAGE` names the file, which `cargo lab` writes; without it, lab.html of the workspace.

mod access;
mod bits;
mod charts;
mod course;
mod day;
mod exam;
mod export;
mod heater;
mod hostile;
mod layout;
mod lessons;
mod mended;
mod plants;
mod port;
mod report;
mod scenes;
mod schedule;
mod taught;
mod verdict;
mod view;

use std::sync::Mutex;

use pt326_lab_browser::{Browser, page};
use serde_json::{Value, json};

/// What scripts use: a session that stands still where monitoring begins, with all that can be unfolded, and the user's hand.
const HELPERS: &str = r##"
const $ = (selector) => document.querySelector(selector);
const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const until = async (what) => { while (!what()) await frame(); };
const click = (selector) => $(selector).dispatchEvent(new MouseEvent("click", { bubbles: true }));
const step = async (ticks) => { await lab.ask({ command: "step", ticks }); await frame(); };
const SCENE = { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] };
const monitoring = async () => {
  await until(() => lab.lab.store?.end > 0);
  for (const fold of document.querySelectorAll("[data-fold][aria-expanded=false]")) fold.click();
  lab.send({ command: "run", speed: 0 });
  lab.send({ command: "open", scene: SCENE, skip: true });
  await step(1);
};
const copies = () => Object.defineProperty(navigator, "clipboard", { configurable: true, value: { writeText: async (text) => void (window.copied = text) } });
const copied = async (selector) => { window.copied = ""; click(selector); await until(() => window.copied); return window.copied; };
const paste = (text) => { const data = new DataTransfer(); data.setData("text", text); document.body.dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true })); };
const said = async () => { const before = $("#clock").textContent; await step(3); await until(() => $("#clock").textContent !== before); return $("#head").innerText; };
"##;

fn address() -> String {
    format!("file://{}", page().display())
}

/// Browsers that no test is using: it takes longer to start one than most tests do.
static IDLE: Mutex<Vec<Browser>> = Mutex::new(Vec::new());

/// Opens the page, runs a script on it, and sees that the console stays empty and that no request leaves the page. A browser in which
/// something failed is not used again.
fn on_page(script: &str, arguments: &[Value]) -> Value {
    let idle = IDLE.lock().expect("nobody fails with it").pop();
    let browser = idle.unwrap_or_else(|| Browser::start().expect("a browser"));
    browser.open(&address()).expect("lab.html");
    let value = script_on(&browser, script, arguments);
    assert_untroubled(&browser);
    browser.forget().expect("a page that can be left");
    IDLE.lock().expect("nobody fails with it").push(browser);
    value
}

fn script_on(browser: &Browser, script: &str, arguments: &[Value]) -> Value {
    browser.run(&format!("{HELPERS}{script}"), arguments).unwrap_or_else(|error| panic!("{error:#}"))
}

fn assert_untroubled(browser: &Browser) {
    assert_eq!(browser.complaints().expect("the console"), Vec::<String>::new());
    let asked = "return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !/^(data|blob):/.test(n))";
    assert_eq!(browser.run(asked, &[]).expect("entries"), json!([]));
}
