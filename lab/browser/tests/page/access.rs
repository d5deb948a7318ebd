//! Everything can be reached, named and read, on any screen, in both languages, light and dark.

use pt326_lab_browser::Browser;
use serde_json::json;

use crate::{address, assert_untroubled, on_page, script_on};

/// Everything that can be pressed has a name, no word is missing.
#[test]
fn every_control_has_a_name() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    for width in [400, 1400] {
        browser.resize(width, 900).expect("a size");
        let found = script_on(
            &browser,
            r##"await monitoring();
               lab.send({ command: "order", order: { order: "break", fault: { do: "clog", sensor: "t1", size: 0.85, lag: 0.4, at: 0, for: 60 } } });
               await step(60);
               click("[data-mode=tour]"); click("[data-part=T1]"); await said();
               const name = (n) => n.getAttribute("aria-label") || n.textContent.trim() || n.closest("label")?.textContent.trim();
               const nameless = [...document.querySelectorAll("button, input, select, [role=button], canvas, summary")].filter((n) => !name(n)).map((n) => n.outerHTML);
               const { languages } = await import("lab/strings.js");
               const paths = (words, at = "") => Object.entries(words).flatMap(([key, text]) => (typeof text === "object" ? paths(text, `${at}${key}.`) : text ? [at + key] : []));
               const [first, ...others] = Object.values(languages()).map((words) => new Set(paths(words)));
               // "Falls out" is said of every plant, "sai do tubo" of one.
               const own = (key) => /^plants\..*\.v_falls$/.test(key);
               const lacking = others.flatMap((other) => [...first.symmetricDifference(other)]).filter((key) => !own(key));
               const raw = document.body.innerText.match(/\b[a-z]+_[a-z0-9_]+\b|\{\w+\}/g);
               return [nameless, lacking, raw, first.size > 300];"##,
            &[],
        );
        assert_eq!(found, json!([[], [], null, true]), "at {width} px");
    }
    assert_untroubled(&browser);
}

/// WCAG's contrast of at least 4.5 of every ink on every ground.
#[test]
fn inks_can_be_read_on_their_grounds_light_and_dark() {
    let low = on_page(
        r##"await monitoring();
           const light = (hex) => { const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
           const low = [];
           for (const theme of ["light", "dark"]) {
             document.documentElement.dataset.theme = theme;
             const css = getComputedStyle(document.documentElement);
             const value = (name) => css.getPropertyValue("--" + name).trim();
             for (const ink of ["ink", "soft", "faint", "t0", "t1", "t2", "flow", "power", "alarm", "ok"]) for (const ground of ["bg", "card"]) {
               const [a, b] = [light(value(ink)), light(value(ground))].sort((x, y) => y - x);
               const ratio = (a + 0.05) / (b + 0.05);
               if (ratio < 4.5) low.push(`${theme} ${ink} on ${ground}: ${ratio.toFixed(2)}`);
             }
           }
           return low;"##,
        &[],
    );
    assert_eq!(low, json!([]));
}
