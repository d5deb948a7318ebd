//! A schedule of faults: made by a form, run, and handed on with the scene.

use serde_json::json;

use crate::on_page;

/// Two faults by the form, in any order.
const PLANNED: &str = r##"
await monitoring(); copies();
const set = (id, value) => { $(id).value = value; $(id).dispatchEvent(new Event("change", { bubbles: true })); };
const add = (at, fault, size, lasts) => { set("#plan-fault", fault); if (size !== null) $("#plan-size").value = size; $("#plan-at").value = at; $("#plan-for").value = lasts; $("#plan button").click(); };
add(40, "fan more", -20, 12); add(5, "T2 wrong", 1.2, 10); add(70, "T0 open", null, 9);
$("#plan-list").lastElementChild.querySelector("button").click();
const from = () => lab.events().list.map((event) => [event.label().replaceAll("\u00a0", " "), event.from, event.to]);
"##;

#[test]
fn a_schedule_runs_from_now_on() {
    let script = r##"const listed = [...document.querySelectorAll("#plan-list li span")].map((n) => n.textContent.replaceAll("\u00a0", " "));
        const now = lab.lab.store.end * lab.lab.store.ts;
        click("#plan-run"); lab.send({ command: "run", speed: 0 }); await step(600);
        return [listed, from().map(([label, a, b]) => [label, Math.round(a - now), Math.round(b - a)])]"##;
    let [sensor, fan] = ["T2: reads wrong, +1.2 °C", "Fan: less air, −20 %"];
    let listed = json!([format!("5.0 s: {sensor}, 10 s"), format!("40.0 s: {fan}, 12 s")]);
    assert_eq!(
        on_page(&format!("{PLANNED}{script}"), &[]),
        json!([listed, [[sensor, 5, 10], [fan, 40, 12]]])
    );
}

/// The text holds the scene and what is to come: pasted into another copy, it leads to the same bits as the schedule that is run here.
#[test]
fn a_copied_schedule_leads_to_the_same_bits() {
    let script = r##"const text = await copied("#plan-copy");
        click("#plan-run"); lab.send({ command: "run", speed: 0 }); await step(600);
        const [end, own] = [lab.lab.store.end, from()];
        const { digest } = await lab.ask({ command: "digest" });
        lab.send({ command: "open", scene: { ...SCENE, seed: 9 }, skip: true }); await step(1);
        paste(text); await until(() => lab.lab.scene.seed === 1 && lab.lab.store.end > 100); lab.send({ command: "run", speed: 0 }); await step(1);
        await step(end - lab.lab.store.end);
        return [JSON.stringify(from()) === JSON.stringify(own), own.length, (await lab.ask({ command: "digest" })).digest === digest]"##;
    assert_eq!(on_page(&format!("{PLANNED}{script}"), &[]), json!([true, 2, true]));
}
