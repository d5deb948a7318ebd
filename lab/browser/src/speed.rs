//! How fast the page is here: first paint, session, frames. An hour is in the store, and six charts are shown.

use std::path::Path;

use anyhow::Context;
use pt326_lab_browser::Browser;
use serde_json::{Value, json};

/// Seconds in view, speed of the clock.
const CASES: [(u32, u32); 4] = [(40, 1), (3600, 1), (40, 100), (3600, 100)];

const FIRST: &str = r##"
    const frame = () => new Promise(requestAnimationFrame);
    while (!(lab.lab.store?.end > 3000)) await frame();
    lab.send({ command: "run", speed: 0 });
    const before = performance.now();
    await lab.ask({ command: "step", ticks: 32700 });
    const times = 32700 * lab.lab.store.ts * 1000 / (performance.now() - before);
    document.querySelector("#stack").scrollIntoView();
    // The same session in a worker of its own, to whose rows nobody listens.
    const text = (id) => document.getElementById(id).textContent.trim();
    const alone = await new Promise((done) => {
      const worker = new Worker(URL.createObjectURL(new Blob([text("worker")])));
      const scene = { orders: [[0, { order: "arm" }]] };
      let begin;
      worker.onmessage = ({ data: { type } }) => {
        if (type === "hello") {
          begin = performance.now();
          worker.postMessage({ command: "open", scene, at: 100000 });
          worker.postMessage({ command: "scene" });
        }
        if (type === "scene") done((100000 * 110) / (performance.now() - begin));
      };
      worker.postMessage({ wasm: Uint8Array.from(atob(text("wasm")), (c) => c.charCodeAt(0)).buffer });
    });
    return [performance.getEntriesByName("first-contentful-paint")[0].startTime, alone, times];
"##;

/// Frames a second, longest of them in ms, how fast the clock went.
const FRAMES: &str = r##"
    const [span, speed, seconds] = args;
    const frame = () => new Promise(requestAnimationFrame);
    const { store } = lab.lab;
    lab.charts.show(Infinity, span);
    lab.send({ command: "run", speed });
    for (let i = 0; i < 10; i++) await frame();
    const [first, begin] = [store.end, performance.now()];
    let [count, last, longest] = [0, begin, 0];
    while (last < begin + 1000 * seconds) {
      await frame();
      const now = performance.now();
      [count, longest, last] = [count + 1, Math.max(longest, now - last), now];
    }
    const passed = (last - begin) / 1000;
    const ticks = store.end - first;
    lab.send({ command: "run", speed: 0 });
    return [count / passed, longest, ticks * store.ts / passed];
"##;

/// Measures and prints.
///
/// # Errors
/// Those of the browser.
pub(crate) fn run(page: &Path) -> anyhow::Result<()> {
    let browser = Browser::start()?;
    browser.resize(1400, 1100)?;
    browser.open(&format!("file://{}", page.display()))?;
    let first = numbers(&browser.run(FIRST, &[])?)?;
    println!("size {} kB", std::fs::metadata(page)?.len() / 1000);
    println!("first paint {:.0} ms", first[0]);
    println!(
        "session {:.0} times real time alone, {:.0} with a page that takes every row",
        first[1], first[2]
    );
    for (span, speed) in CASES {
        let all = numbers(&browser.run(FRAMES, &[json!(span), json!(speed), json!(5)])?)?;
        println!(
            "{span} s in view at {speed}x: {:.0} frames a second, longest {:.0} ms, clock {:.1}x",
            all[0], all[1], all[2]
        );
    }
    Ok(())
}

fn numbers(value: &Value) -> anyhow::Result<Vec<f64>> {
    value.as_array().context("no list")?.iter().map(|x| x.as_f64().context("no number")).collect()
}
