//! Scenes: another seed, and those that come by a link.

use pt326_lab_browser::Browser;
use serde_json::{Value, json};

use crate::{address, on_page, script_on};

/// A new session begins as every session does, whatever the last one was set to.
#[test]
fn a_new_seed_resets_the_desk_and_draws_no_residual_before_its_time() {
    let seen = on_page(
        r##"
        await monitoring();
        lab.send({ command: "order", order: { order: "excite", on: false } });
        lab.send({ command: "order", order: { order: "set", name: "pid.kp", value: 2 } });
        await step(1);
        const desk = () => [$("#excite").checked, $("[data-set='pid.kp']").value];
        const before = desk();
        $("#seed").value = 2;
        $("#seed").dispatchEvent(new Event("change", { bubbles: true }));
        lab.send({ command: "run", speed: 0 });
        await step(1);
        const { store } = lab.lab;
        const first = (what) => { for (let k = store.first; k < store.end; k++) if (what(k)) return k * store.ts; };
        const swings = first((k) => Number.isFinite(store.get(k, "t1_left"))) - first((k) => store.get(k, "readiness") === 2);
        return [before, desk(), swings > 1.9 && swings < 3, first((k) => Number.isFinite(store.get(k, "t1_expected") - store.get(k, "t1_left"))) > 0];"##,
        &[],
    );
    assert_eq!(seen, json!([[false, "2"], [true, "2.4"], true, true]));
}

/// A link holds the whole scene: who opens it comes to the same bits.
#[test]
fn a_link_leads_to_the_same_scene() {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let link = script_on(
        &browser,
        r##"await monitoring();
           lab.send({ command: "order", order: { order: "break", fault: { do: "air-flow", size: 1.26, at: 0, for: 25 } } });
           await step(60);
           click("#link");
           await until(() => location.hash.length > 10);
           return [location.href, lab.lab.store.end, (await lab.ask({ command: "digest" })).digest];"##,
        &[],
    );
    browser.open("about:blank").expect("a blank page");
    browser.open(link[0].as_str().expect("a link")).expect("the link");
    let again = script_on(
        &browser,
        r##"lab.send({ command: "run", speed: 0 });
           await until(() => lab.lab.store?.end > 0);
           await frame();
           const more = lab.lab.store.end - args[1];
           const { scene } = await lab.ask({ command: "scene" });
           lab.send({ command: "open", scene, at: args[1] });
           return [more < 200, (await lab.ask({ command: "digest" })).digest, lab.events().last.label()];"##,
        &[Value::Null, link[1].clone()],
    );
    assert_eq!(again, json!([true, link[2], "Fan: more air, +26\u{a0}%"]));
    browser.open(&format!("{}#s=broken", address())).expect("the page");
    let toast = script_on(
        &browser,
        r##"await until(() => $("#toast").textContent); await monitoring(); return $("#toast").textContent"##,
        &[],
    );
    assert_eq!(toast, json!("This link holds no scene: it has another form."));
}

/// A name that comes with a scene is text, whatever stands in it.
#[test]
fn a_name_from_a_link_is_no_html() {
    let found = on_page(
        r##"await monitoring();
           const fault = { do: "spike", sensor: "t2", size: 3, at: 0, for: 9, name: "<img src=x onerror=alert(1)>" };
           const scene = { ...SCENE, orders: [...SCENE.orders, [3310, { order: "break", fault }]] };
           lab.send({ command: "open", scene, at: 3330 });
           await until(() => /spike|img/.test($("#hint").textContent) && $("#events button"));
           return [document.querySelectorAll("main img").length, $("#hint span").textContent.startsWith("img src=x onerror=alert(1)")];"##,
        &[],
    );
    assert_eq!(found, json!([0, true]));
}
