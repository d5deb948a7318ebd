//! `cargo run -p pt326-lab-browser`: the pictures of the lab in README.md and docs/tutorial.md, from lab.html (`cargo lab`);
//! with `-- speed`, how fast the page is.

mod speed;

use std::path::Path;

use pt326_lab_browser::Browser;
use serde_json::json;

/// Name, width, height, theme, what is done to the rig, and how many ticks later. What is not the page as it opens has its charts unfolded.
const PICTURES: [(&str, u32, u32, &str, &str, u32); 5] = [
    ("lab", 1400, 880, "light", r#"{ "do": "offset", "sensor": "t2", "size": 1.5, "at": 0, "for": 60 }"#, 60),
    (
        "lab-t1-lies",
        1400,
        1160,
        "light",
        r#"{ "do": "offset", "sensor": "t1", "size": 1.5, "at": 0, "for": 60 }"#,
        90,
    ),
    (
        "lab-clogged",
        1400,
        1160,
        "light",
        r#"{ "do": "clog", "sensor": "t1", "size": 0.85, "lag": 0.4, "at": 0, "for": 60 }"#,
        90,
    ),
    ("lab-more-air", 1400, 1160, "dark", r#"{ "do": "air-flow", "size": 1.26, "at": 0, "for": 60 }"#, 180),
    ("lab-narrow", 400, 1100, "dark", r#"{ "do": "heater-power", "size": 0.75, "at": 0, "for": 60 }"#, 90),
];

const SCRIPT: &str = r##"
    const [fault, ticks, theme, opened] = args;
    const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    while (!(lab.lab.store?.end > 3000)) await frame();
    document.documentElement.style.scrollbarWidth = "none";
    if (!opened) for (const fold of ["why", "residuals", "charts"]) document.querySelector(`[data-fold=${fold}]`).click();
    if (document.documentElement.dataset.theme !== theme) document.querySelector("#theme").click();
    lab.send({ command: "run", speed: 0 });
    lab.send({ command: "open", scene: { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] }, skip: true });
    await lab.ask({ command: "step", ticks: 150 });
    lab.send({ command: "order", order: { order: "break", fault: JSON.parse(fault) } });
    await lab.ask({ command: "step", ticks });
    for (let i = 0; i < 20; i++) await frame();
    scrollTo({ top: 0, behavior: "instant" });
    await frame();
"##;

fn main() -> anyhow::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    if std::env::args().nth(1).as_deref() == Some("speed") {
        return speed::run(&root.join("lab.html"));
    }
    for (name, width, height, theme, fault, ticks) in PICTURES {
        let browser = Browser::start()?;
        browser.resize(width, height)?;
        browser.open(&format!("file://{}", root.join("lab.html").display()))?;
        browser.run(SCRIPT, &[json!(fault), json!(ticks), json!(theme), json!(name == "lab")])?;
        browser.picture(&root.join("docs").join(format!("{name}.png")))?;
        println!("docs/{name}.png");
    }
    Ok(())
}
