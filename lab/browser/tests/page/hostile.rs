//! Links that were made to harm whoever opens them.

use pt326_lab_browser::Browser;
use serde_json::json;

use crate::{address, assert_untroubled, on_page, script_on};

/// Opens each link in turn and asks the session behind it for something afterwards. What went wrong; images; a seed that no object has; the
/// mode in the end; and how long the link to the largest scene is.
const LINKS: &str = r##"
        await monitoring();
        const { begin } = await import("lab/hear.js");
        const nested = (n, open, middle, close) => open.repeat(n) + middle + close.repeat(n);
        const linked = (scene) => `{"v":1,"at":0,"scene":${scene}}`;
        const orders = (...all) => linked(`{"orders":[${all.map((order) => `[0,${order}]`)}]}`);
        const set = (name, value = 1) => JSON.stringify({ order: "set", name, value });
        const html = "<img src=x onerror=alert(1)>";
        const deep = {
          nested: linked(nested(3000, "[", "", "]")), less: linked(nested(1000, "[", "", "]")), alone: nested(3000, "[", "", "]"),
          objects: linked(nested(3000, '{"a":', "1", "}")), within: orders(nested(3000, "[", "", "]")), mixed: linked(nested(1500, '[{"a":', "1", "}]")),
          quoted: `{"v":1,"at":0,"${"[".repeat(100)}\\"":1,"scene":${nested(3000, "[", "", "]")}}`,
        };
        const refused = {
          ...deep, nothing: "null", number: "7", text: '"scene"', none: "{}", no_scene: '{"v":1,"at":0}', early: '{"v":1,"at":-1,"scene":{}}', never: '{"v":1,"at":1e99,"scene":{}}',
          no_object: linked("7"), a_null: linked("null"), a_text: linked('"{}"'), a_list: linked("[]"),
          seed: linked('{"seed":1e300}'), negative: linked('{"seed":-1}'), preset: linked('{"preset":"__proto__"}'), other: linked('{"preset":"constructor"}'),
          proto: linked('{"__proto__":{"seed":3}}'), constructed: linked('{"constructor":{"prototype":{"seed":3}}}'), orders: linked('{"orders":{"length":1e9}}'),
          long: linked(`{"preset":"${"x".repeat(1e6)}"}`), html: linked(`{"preset":"${html}"}`),
          fault: orders('{"order":"break","fault":{"do":"offset","sensor":"t2","size":1e999,"at":0,"for":1}}'),
          huge: orders('{"order":"break","fault":{"do":"offset","sensor":"t2","size":1e300,"at":0,"for":1e300}}'),
        };
        const taken = {
          own: orders(set("__proto__"), set("constructor"), set("toString"), set(html), set("x".repeat(1e5)), set("pid.kp", 2)), console: orders(JSON.stringify({ order: "console", line: html })),
          large: orders(set("pid.kp", 1e300), '{"order":"setpoint","celsius":1e300}'),
          often: orders(...Array.from({ length: 10_000 }, (_, i) => set("pid.kp", 2 + (i % 2)))),
        };
        const wrong = [];
        for (const [name, text] of Object.entries({ ...refused, ...taken })) {
          $("#toast").textContent = "";
          const bytes = new TextEncoder().encode(text);
          let binary = "";
          for (const byte of bytes) binary += String.fromCharCode(byte);
          history.replaceState(null, "", "#s=" + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", ""));
          begin();
          const answered = await Promise.race([lab.ask({ command: "scene" }), new Promise((done) => setTimeout(done, 30_000))]);
          if (!answered) wrong.push(name + ": no answer");
          await frame();
          const toast = $("#toast").textContent;
          if (name in refused ? !toast || toast.startsWith("Opened") || toast.length > 400 : toast !== "Opened: a scene.") wrong.push(`${name}: ${toast.slice(0, 200)}`);
          if (name in deep && !/nested deeper/.test(toast)) wrong.push(`${name}: ${toast}`);
        }
        history.replaceState(null, "", "#");
        await step(1); // the orders are carried out then
        click("#link");
        await until(() => location.hash.length > 1);
        const largest = location.hash.length;
        lab.send({ command: "open", scene: SCENE, skip: true });
        await step(1);
        return [wrong, document.querySelectorAll("main img").length, ({}).seed ?? null, lab.row().mode, largest > 500_000];
"##;

/// What a board says is text, whatever stands in it.
#[test]
fn what_a_board_says_is_no_html() {
    let seen = on_page(
        r##"await monitoring();
           const { HEAR } = await import("lab/hear.js");
           const html = '<img src=x onerror="window.harmed = 1"><script>window.harmed = 1</' + "script>";
           Object.assign(lab.lab.hello, { kind: "board", name: html });
           HEAR.names({ own_names: [[4, html]], taught_names: [html] });
           HEAR.said({ text: html + "\n" + html });
           HEAR.refused({ why: html });
           HEAR.order({ tick: 1, order: { order: "set", name: html, value: 1 } });
           const row = new Float32Array(lab.lab.store.given).fill(NaN);
           const put = (values) => Object.entries(values).forEach(([name, value]) => (row[lab.lab.store.at[name]] = value));
           put({ tick: lab.lab.store.end, mode: 3, alarm: 1, class: 1, confidence: 0.98, taught: 1, fdv: 4, fiv: 4, readiness: 2, t1: 35, t2: 35, setpoint: 35 });
           for (let i = 0; i < 30; i++) HEAR.rows({ from: lab.lab.store.end, values: row });
           lab.lab.dirty = true;
           for (let i = 0; i < 20; i++) await frame();
           return [document.querySelectorAll("main img, header img, main script").length, window.harmed ?? 0,
             ["#console", "#toast", "#source"].map((id) => $(id).textContent.includes("<img")), document.body.innerText.includes("<img")];"##,
        &[],
    );
    assert_eq!(seen, json!([0, 0, [true, true, true], true]));
}

#[test]
fn a_link_harms_nobody() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    assert_eq!(script_on(&browser, LINKS, &[]), json!([[], 0, null, 3, true]));
    assert_untroubled(&browser);
}
