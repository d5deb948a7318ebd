//! The heater and what else is ordered: stopped and armed, tripped and acknowledged, done or refused.

use serde_json::json;

use crate::on_page;

#[test]
fn the_heater_is_stopped_and_armed_by_one_button_and_a_trip_is_acknowledged() {
    let said = on_page(
        r##"
        await monitoring();
        const all = [];
        const note = async () => all.push([await said(), lab.row().drive > 0]);
        click("#stop"); await note();
        click("#stop"); await note();
        click("#stop"); await step(1);
        lab.send({ command: "order", order: { order: "tune" } }); await step(20); await note();
        click("#stop"); await step(1);
        click("#stop"); await step(1);
        lab.send({ command: "skip" }); await step(1); await note();
        lab.send({ command: "order", order: { order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 2 } } });
        await step(20); await note();
        await step(20);
        click("[data-act=ack]"); await note();
        return all;"##,
        &[],
    );
    let expected = json!([
        ["The heater is off.", false],
        ["Warming up to 35.0 °C.", true],
        ["Measuring the rig's response.", false],
        ["Everything looks normal.", true],
        ["T1 reads as a broken wire.", false],
        ["The heater is off.", false]
    ]);
    assert_eq!(said.to_string().replace('\u{a0}', " "), expected.to_string());
}

/// Until the cause is mended that is what to press first; what is refused is said in the page's language.
#[test]
fn a_trip_shows_its_part_and_the_way_on() {
    let seen = on_page(
        r##"
        await monitoring();
        click("#language");
        lab.send({ command: "order", order: { order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 100 } } });
        await said(); await step(20); await said();
        const all = [[$("#stop").hidden, $("#more .primary").dataset.act, $(".part.blamed").dataset.part]];
        click("[data-act=ack]"); await until(() => $("#toast").textContent);
        all.push($("#toast").textContent);
        click("[data-act=mend]"); await step(20); await said();
        all.push($("#more .primary").dataset.act);
        click("[data-act=ack]"); await said();
        all.push(!$("#stop").hidden && lab.row().mode);
        return all;"##,
        &[],
    );
    let refused = "Persiste: T1 lê como fio partido.";
    assert_eq!(seen, json!([[true, "mend", "T1"], refused, "ack", 0]));
}

/// What is refused is said in the page's language, and what was typed gives way to what is in force.
#[test]
fn a_refusal_is_said_in_the_pages_language() {
    let said = on_page(
        r##"
        await monitoring();
        click("#language");
        const all = [];
        const refused = async (order) => {
          $("#toast").textContent = "";
          lab.send({ command: "order", order });
          await until(() => $("#toast").textContent);
          all.push($("#toast").textContent.replaceAll("\u00a0", " "));
        };
        await refused({ order: "setpoint", celsius: 500 });
        await refused({ order: "arm" });
        await refused({ order: "set", name: "supervisor.over_temperature", value: 90 });
        const kp = $("[data-set='pid.kp']");
        kp.value = 1e6; $("#toast").textContent = "";
        kp.dispatchEvent(new Event("change", { bubbles: true }));
        await until(() => $("#toast").textContent);
        all.push(/^Recusado: pid.kp é 1000000; são possíveis/.test($("#toast").textContent), kp.value);
        return all;"##,
        &[],
    );
    let expected = json!([
        "Recusado: referência de 500 °C; são possíveis 20 a 65 °C.",
        "Recusado: não é possível agora (a vigiar).",
        "Recusado: supervisor.over_temperature só pode ser alargado com o aquecedor desligado.",
        true,
        "2.4"
    ]);
    assert_eq!(said, expected);
}

/// A stop goes out before anything has been heard of the rig.
#[test]
fn stop_waits_for_nothing() {
    let mode = on_page(
        r##"await monitoring();
           const { store } = lab.lab;
           lab.lab.store = null;
           document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "!", bubbles: true }));
           lab.lab.store = store;
           await step(2);
           return lab.row().mode;"##,
        &[],
    );
    assert_eq!(mode, json!(0));
}
