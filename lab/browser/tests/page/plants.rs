//! Plants that are no tube.

use serde_json::json;

use crate::on_page;

/// Each is drawn as what it is. Where no air flows along a tube, no word says so, in any language, and nothing is clogged.
#[test]
fn each_plant_has_its_own_drawing_and_words() {
    let seen = on_page(
        r##"await monitoring();
           const all = [];
           for (const preset of ["paper", "oven", "hotend", "tclab"]) {
             lab.send({ command: "open", scene: { ...SCENE, preset }, skip: true }); await step(1);
             lab.send({ command: "order", order: { order: "break", fault: { do: "clog", sensor: "t1", size: 0.85, lag: 0.4, at: 0, for: 1e5 } } });
             await step(90);
             const words = [];
             for (let language = 0; language < 2; language++) {
               click("#language"); await said();
               for (const part of ["T1", "T2", "fan", "heater"]) { click(`[data-part=${part}]`); words.push($("#sheet").innerText); click("#sheet .x"); }
               words.push($("main").innerText, $("#rig svg").getAttribute("aria-label"));
             }
             const found = new Set(words.join(" ").toLowerCase().match(/\b(tube|tubo|clogged|entupido|clog)\b/g));
             all.push([preset, $("#rig svg > g > path").getAttribute("d"), [...found].sort()]);
           }
           return [new Set(all.map(([, drawing]) => drawing).values().toArray()).size, all.map(([preset, , found]) => [preset, found])];"##,
        &[],
    );
    let said = json!([
        ["paper", ["clogged", "entupido", "tubo"]],
        ["oven", ["clogged", "entupido"]],
        ["hotend", []],
        ["tclab", []]
    ]);
    assert_eq!(seen, json!([4, said]));
}

/// The tour speaks of the PT-326: from another plant it leads there.
#[test]
fn the_tour_of_another_plant_leads_to_the_paper_rig() {
    let seen = on_page(
        r##"await monitoring();
           lab.send({ command: "open", scene: { ...SCENE, preset: "oven" }, skip: true }); await step(1);
           click("[data-mode=tour]"); const about = $("#tour").textContent;
           click("[data-act=paper]"); await until(() => $("#tour h2"));
           return [/about the PT-326/.test(about), lab.lab.scene.preset, $("#tour h2").textContent]"##,
        &[],
    );
    assert_eq!(seen, json!([true, "paper", "A tube, a fan, a heater"]));
}
