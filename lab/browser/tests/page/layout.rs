//! Everything fits, in wide and narrow letters, in both languages, on small screens and at 200 % zoom, which halves a screen.

use pt326_lab_browser::{Browser, Font};
use serde_json::json;

use crate::{address, assert_untroubled, script_on};

/// Width and height, px: screens, then some of 768, 1280, 1400 and 2000 px at 200 %.
const SCREENS: [(u32, u32); 9] = [
    (400, 900),
    (768, 900),
    (1000, 900),
    (1400, 900),
    (2560, 900),
    (384, 450),
    (640, 360),
    (700, 400),
    (1000, 450),
];

/// What does not fit. `cut()` lists texts that go beyond the screen, their box, their drawing or what is around a part of it, or that
/// lie on one another in a drawing; of canvases it is what was drawn since `looks` was emptied.
pub(crate) const LOOK: &str = r##"
    if (!window.looks) {
      window.looks = [];
      const { fillText } = CanvasRenderingContext2D.prototype;
      CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        const w = this.measureText(text).width;
        const left = x - { left: 0, center: w / 2, right: w }[this.textAlign];
        if (text && (left < -0.5 || left + w > this.canvas.width / devicePixelRatio + 0.5)) looks.push(text);
        fillText.call(this, text, x, y);
      };
    }
    const beyond = (inner, outer) => inner.left < outer.left - 1 || inner.right > outer.right + 1;
    const onOneAnother = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 4 && b.top < a.bottom - 4;
    const cut = () => {
      const found = [...looks.splice(0)];
      const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      while (words.nextNode()) {
        const { data, parentElement } = words.currentNode;
        if (!data.trim() || !parentElement.checkVisibility({ opacityProperty: true }) || parentElement.closest(".unseen, .toast, .source, option, script, style")) continue;
        const range = document.createRange();
        range.selectNodeContents(words.currentNode);
        const all = [...range.getClientRects()];
        if (parentElement.matches(".bars output, .step output, .clock, .slide output") && all.length > 1) found.push(`${data} in ${all.length} lines`);
        for (const rect of all) {
          if (beyond(rect, { left: 0, right: innerWidth })) found.push(`${data} beyond the screen`);
          for (let box = parentElement; box; box = box.parentElement) {
            const { display, position } = getComputedStyle(box);
            if (display === "contents") continue;
            if (!box.closest("svg") && beyond(rect, box.getBoundingClientRect())) { found.push(`${data} beyond ${box.className || box.tagName}`); break; }
            if (/absolute|fixed/.test(position)) break;
          }
        }
      }
      for (const svg of document.querySelectorAll("svg")) {
        const texts = [...svg.querySelectorAll("text")].filter((n) => n.textContent).map((n) => [n, n.getBoundingClientRect()]);
        const boxes = [...svg.querySelectorAll(":scope > .box")];
        texts.forEach(([n, rect], i) => {
          const around = n.closest(".part")?.querySelector(".ring") ?? boxes.find((box) => onOneAnother(rect, box.getBoundingClientRect()));
          if (beyond(rect, (around ?? svg).getBoundingClientRect())) found.push(`${n.textContent} beyond its ${around ? "part" : "drawing"}`);
          for (const [other, place] of texts.slice(i + 1)) if (onOneAnother(rect, place)) found.push(`${n.textContent} on ${other.textContent}`);
        });
      }
      return found;
    };
"##;

/// Breaks T1, looks at every mode in both languages, and at the sheet of every part.
const FITS: &str = r##"
    await monitoring();
    for (const details of document.querySelectorAll(".plan")) details.open = true;
    lab.send({ command: "order", order: { order: "break", fault: { do: "clog", sensor: "t1", size: 0.85, lag: 0.4, at: 0, for: 60 } } });
    await step(60);
    const wrong = [];
    const note = (where, list) => { for (const what of list) wrong.push(`${where}: ${what}`); };
    for (const mode of ["explore", "quiz", "tour"]) {
      for (let language = 0; language < 2; language++) {
        click("#language"); click(`[data-mode=${mode}]`); looks.length = 0; await said();
        const where = `${mode} ${document.documentElement.lang}`;
        note(where, cut());
        if (document.documentElement.scrollWidth > innerWidth) wrong.push(`${where} is wider than the screen`);
        const rows = new Set([...$(".bar").children].filter((n) => n.offsetWidth).map((n) => Math.round((n.offsetTop + n.offsetHeight / 2) / 20)));
        if (innerWidth >= 400 && rows.size > 2) wrong.push(`${where}: bar in ${rows.size} rows`);
        const edge = $(".bar").getBoundingClientRect().right - parseFloat(getComputedStyle($(".bar")).paddingRight);
        if ($("#stop").getBoundingClientRect().right > edge + 0.5) wrong.push(`${where}: Stop beyond the bar`);
        if (mode !== "explore") continue;
        for (const part of document.querySelectorAll("[data-part]")) {
          part.scrollIntoView({ block: "center" }); part.dispatchEvent(new MouseEvent("click", { bubbles: true })); await frame();
          const name = `${where}, sheet of ${part.dataset.part}`;
          note(name, cut());
          const [sheet, bar] = [$("#sheet"), $(".bar")].map((n) => n.getBoundingClientRect());
          if (sheet.top < bar.bottom - 1 || sheet.bottom > innerHeight + 1) wrong.push(`${name} from ${sheet.top} to ${sheet.bottom} px, below the bar of ${bar.bottom}`);
          for (const control of $("#sheet").querySelectorAll("button, input")) {
            const shown = control.closest("label") ?? control;
            shown.scrollIntoView({ block: "nearest" });
            const { left, right, top, bottom } = shown.getBoundingClientRect();
            const hit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
            if (!hit || !shown.contains(hit)) wrong.push(`${name}: ${control.value || control.textContent} can't be pressed`);
          }
          click("#sheet .x");
        }
      }
    }
    click("[data-mode=explore]");
    return [...new Set(wrong)];
"##;

fn fits(font: Font) {
    let browser = Browser::start_with(font).expect("a browser");
    browser.open(&address()).expect("lab.html");
    for (width, height) in SCREENS {
        browser.resize(width, height).expect("a size");
        let wrong = script_on(&browser, &format!("{LOOK}{FITS}"), &[]);
        assert_eq!(wrong, json!([]), "at {width} x {height} px with {font:?} letters");
    }
    assert_untroubled(&browser);
}

/// Every plant's drawing and words, on a phone and on a wide screen.
#[test]
fn every_plant_fits() {
    let browser = Browser::start_with(Font::Wide).expect("a browser");
    browser.open(&address()).expect("lab.html");
    for (width, height) in [(400, 900), (1400, 900)] {
        browser.resize(width, height).expect("a size");
        for preset in ["oven", "hotend", "tclab"] {
            let script = r##"await monitoring(); lab.send({ command: "open", scene: { ...SCENE, preset: args[0] }, skip: true }); await step(1);
                lab.send({ command: "order", order: { order: "break", fault: { do: "clog", sensor: "t1", size: 0.85, lag: 0.4, at: 0, for: 1e5 } } });
                await step(60); const wrong = [];
                for (let language = 0; language < 2; language++) {
                  click("#language"); looks.length = 0; await said(); wrong.push(...cut());
                  if (document.documentElement.scrollWidth > innerWidth) wrong.push("wider than the screen");
                }
                return wrong"##;
            let wrong = script_on(&browser, &format!("{LOOK}{script}"), &[json!(preset)]);
            assert_eq!(wrong, json!([]), "{preset} at {width} x {height} px");
        }
    }
    assert_untroubled(&browser);
}

#[test]
fn it_fits_with_wide_letters() {
    fits(Font::Wide);
}

#[test]
fn it_fits_with_narrow_letters() {
    fits(Font::Narrow);
}

/// How wide an "n" of 1000 px is in each font's own tables: another font would make the tests above look at the same letters twice.
#[test]
fn each_font_is_installed() {
    for (font, package, width) in
        [(Font::Wide, "fonts-dejavu-core", 634), (Font::Narrow, "fonts-liberation", 556)]
    {
        let browser = Browser::start_with(font).expect("a browser");
        browser.open(&address()).expect("lab.html");
        let script = r##"const c = document.createElement("canvas").getContext("2d");
            c.font = "1000px " + getComputedStyle(document.body).fontFamily;
            return Math.round(c.measureText("n").width);"##;
        assert_eq!(script_on(&browser, script, &[]), json!(width), "install the package {package}");
    }
}
