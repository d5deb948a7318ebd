//! What is seen when the page is opened, what unfolds, and what a real board's page leaves out.

use pt326_lab_browser::Browser;
use pt326_lab_browser::port::PORT;
use serde_json::json;

use crate::{address, assert_untroubled, on_page, script_on};

/// What can be pressed or chosen, besides the parts of the drawing; and what the charts write.
const SEEN: &str = r##"
const controls = () => [...document.querySelectorAll("button, input, select, summary")].filter((n) => n.checkVisibility() && !n.closest("details:not([open]) > :not(summary)")).length;
const written = async () => {
  const all = [], { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, ...place) { all.push(text); fillText.call(this, text, ...place); };
  $("#stack").scrollIntoView({ behavior: "instant" }); await until(() => !lab.charts.unseen.has($("#stack"))); lab.charts.changed(); await frame();
  CanvasRenderingContext2D.prototype.fillText = fillText;
  return ["Temperature", "Heater power", "Measured less expected", "Paper's residuals", "truth", "likelihood", "paper, fdv fiv"].filter((text) => all.includes(text));
};
"##;

/// Sentence, drawing, two charts, at most twelve controls; what is unfolded comes into view, and is so again when the page is.
#[test]
fn the_first_view_is_short_and_what_was_unfolded_is_remembered() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    browser.resize(1000, 600).expect("a size");
    let first = script_on(
        &browser,
        &format!(
            r##"{SEEN} await until(() => lab.lab.store?.end > 0); await frame();
            const first = [controls() <= 12, await written(), $("#aside").hidden, $("#desk").hidden];
            click("[data-fold=residuals]"); click("[data-fold=desk]"); await frame();
            await until(() => $("#desk").getBoundingClientRect().top < innerHeight / 2);
            return [...first, await written()]"##
        ),
        &[],
    );
    let two = ["Temperature", "Heater power"];
    let more = json!(["Temperature", "Heater power", "Paper's residuals", "paper, fdv fiv"]);
    assert_eq!(first, json!([true, two, true, true, more]));
    browser.open(&address()).expect("lab.html again");
    let again = script_on(
        &browser,
        &format!(
            r##"{SEEN} await until(() => lab.lab.store?.end > 0); return [await written(), $("#aside").hidden, $("#desk").hidden]"##
        ),
        &[],
    );
    assert_eq!(again, json!([more, true, false]));
    assert_untroubled(&browser);
}

/// An exam that is tried, and a link, open in view, and it is said what has opened.
#[test]
fn what_is_opened_comes_into_view() {
    let seen = on_page(
        r##"await monitoring();
           const opens = async (press, text) => {
             scrollTo({ top: 9999, behavior: "instant" }); $("#toast").textContent = ""; press();
             await until(() => $("#toast").textContent === text && $("#say").getBoundingClientRect().top >= 0);
             return true;
           };
           const exam = await opens(() => click("#exam-try"), "Opened: Exam.");
           click("[data-act=exam-end]"); await step(1); copies(); const text = await copied("#link"); history.replaceState(null, "", "#");
           return [exam, await opens(() => paste(text), "Opened: a scene.")]"##,
        &[],
    );
    assert_eq!(seen, json!([true, true]));
}

/// After Connect the dark button leads to the next step of the first day, and heats only where that is to arm. Of a board nobody knows what is
/// true, nor of its mains and door.
#[test]
fn a_boards_page_leads_on_and_shows_nothing_that_only_a_simulation_knows() {
    let script = r##"await monitoring();
        const port = new Port({ ...BOARD, "calibrate apply": "calibrate apply\r\nin force; `save` keeps it\r\n> ", check: "check\r\nok, see below for about 2 min\r\n> " });
        offer(port); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5);
        let n = 0;
        const tick = async () => { const end = lab.lab.store.end; port.says(framed(`tick ${(n++).toString(16)}${" 45000000".repeat(31)}`)); await until(() => lab.lab.store.end > end); };
        const next = async () => { for (let i = 0; i < 3; i++) await tick(); lab.lab.store.ring[lab.lab.store.place(lab.lab.store.last) + lab.lab.store.at.mode] = 0; lab.charts.changed(); await frame(); return $("#more .primary").textContent; };
        const type = async (line, done) => { $("#line").value = line; $("#typed").requestSubmit(); await until(() => $("#console").textContent.includes(done)); };
        const all = [await next()];
        click("#more .primary"); all.push(document.activeElement.id, $("#more [data-line=arm]").className);
        await type("calibrate apply", "in force"); all.push(await next());
        await type("check", "see below"); port.says("check passed\r\n"); await until(() => $("#console").textContent.includes("check passed")); all.push(await next());
        const real = [await written(), document.querySelectorAll("[data-part=door], [data-part=mains]").length];
        // An alarm of which nobody knows whether it is false, and which no share explains.
        lab.lab.events.row(1, 0, 1, lab.lab.hello.classes.find(({ name }) => name === "t2_offset").number, 0, 0, 0, 1);
        return [...all, ...real, lab.lab.events.last.label()]"##;
    assert_eq!(
        on_page(&format!("{PORT}{SEEN}{script}"), &[]),
        json!([
            "Next: Thermistors",
            "celsius",
            "plain",
            "Next: Wiring",
            "Next: Controller",
            [
                "Temperature",
                "Heater power",
                "Measured less expected",
                "Paper's residuals",
                "likelihood",
                "paper, fdv fiv"
            ],
            0,
            "T2 reads wrong"
        ])
    );
}

/// After it was mended a fault is ending until its alarm clears, whatever it is called by then.
#[test]
fn what_was_mended_is_called_nothing_else_until_it_is_over() {
    let heads = on_page(
        r##"await monitoring();
           const all = new Set();
           const run = async (preset, fault, excite) => {
             lab.send({ command: "open", scene: { ...SCENE, preset }, skip: true }); await step(100);
             if (!excite) { lab.send({ command: "order", order: { order: "excite", on: false } }); await step(100); }
             lab.send({ command: "order", order: { order: "break", fault: { ...fault, at: 0, for: 1e6 } } }); await step(Math.round(25 * lab.lab.store.slow / lab.lab.store.ts));
             click("[data-act=mend]"); await step(1);
             for (let i = 0; i < 25; i++) { await step(10); await said(); all.add($("#head").innerText); }
           };
           await run("hotend", { do: "offset", sensor: "t2", size: 15 }, true);
           await run("paper", { do: "air-flow", size: 1.26 }, false);
           return [...all].sort()"##,
        &[],
    );
    assert_eq!(heads, json!(["Everything looks normal.", "The fault is ending."]));
}
