//! What the page says of the rig, fault by fault.

use serde_json::json;

use crate::{on_page, page};

#[test]
fn it_opens_from_a_file_trained_and_at_the_point_of_monitoring() {
    assert!(std::fs::metadata(page()).expect("the page").len() < 1_500_000);
    let said = on_page(
        "await monitoring(); return [await said(), lab.row().mode, lab.row().readiness, document.title]",
        &[],
    );
    assert_eq!(said, json!(["Everything looks normal.", 3, 2, "PT-326 lab"]));
}

/// Each fault by its part's button: chosen, broken, named.
#[test]
fn each_fault_that_can_be_put_in_is_named_by_its_own_name() {
    let found = on_page(
        r##"
        const found = [];
        await monitoring();
        for (const part of ["T0", "T1", "T2", "fan", "heater", "mains", "door"]) {
          click(`[data-part=${part}]`);
          const kinds = [...document.querySelectorAll("#sheet [name=kind]")].map((input) => input.value);
          click("#sheet .x");
          for (const kind of kinds) {
            await monitoring();
            click(`[data-part=${part}]`);
            const radio = $(`#sheet [value=${kind}]`);
            radio.checked = true;
            radio.dispatchEvent(new Event("input", { bubbles: true }));
            $("#sheet .primary").click();
            await step({ drifts: 220, loose: 5000 }[kind] ?? 90);
            found.push([part, kind, lab.events().last?.named ?? "", await said()]);
          }
        }
        return found;"##,
        &[],
    );
    let expected = [
        ("T0", "wrong", "t0_fault", "T0 reads"),
        ("T0", "drifts", "", ""),
        ("T0", "open", "t0_open", "Wire of T0 broken."),
        ("T1", "wrong", "t1_offset", "T1 reads"),
        ("T1", "clogged", "t1_clogged", "less of the rise than it should."),
        ("T1", "drifts", "drift", "drifts up"),
        ("T1", "loose", "t1_loose", "too high again and again"),
        ("T1", "sticks", "t1_stuck", "T1 did not move"),
        ("T1", "falls", "t1_detached", "Far more power than was learnt."),
        ("T1", "open", "t1_open", "broken wire"),
        ("T1", "short", "t1_short", "short circuit"),
        ("T1", "swap", "t1_t2_swapped", "T1 and T2 swapped?"),
        ("T2", "wrong", "t2_offset", "T2 reads"),
        ("T2", "drifts", "drift", "drifts up"),
        ("T2", "loose", "t2_loose", "too high again and again"),
        ("T2", "sticks", "t2_stuck", "T2 stands still."),
        ("T2", "falls", "t2_detached", "Is T2 out of the tube?"),
        ("T2", "open", "t2_open", "Wire of T2 broken."),
        ("T2", "short", "t2_short", ""),
        ("fan", "more", "air_flow", "stronger than learnt."),
        ("heater", "weak", "heater_power", "less power than asked for."),
        ("heater", "stuck", "air_flow_or_heater_power", ""),
        ("mains", "sags", "heater_power", "less power than asked for."),
        ("door", "opens", "", "Everything looks normal."),
    ];
    let found: Vec<(String, String, String, String)> = serde_json::from_value(found).expect("texts");
    assert_eq!(found.len(), expected.len());
    for ((part, kind, named, head), (p, k, name, words)) in found.iter().zip(expected) {
        assert_eq!((part.as_str(), kind.as_str()), (p, k));
        assert!(named == name && head.contains(words), "{part} {kind}: \"{named}\", \"{head}\"");
    }
}

/// An alarm of a board offers what can be said of it, one of a rig in which faults can be put does not; once it is acknowledged or shelved it is advice.
#[test]
fn an_alarm_can_be_acknowledged_shelved_and_accepted() {
    let found = on_page(
        r##"
        const offered = () => [...document.querySelectorAll("[data-act]")].map((b) => b.dataset.act).filter((act) => ["ack", "shelve"].includes(act));
        const press = async (act) => { click(`[data-act=${act}]`); await step(5); return [lab.row().alarm, lab.row().advice]; };
        const found = [];
        for (const act of ["ack", "shelve"]) {
          await monitoring();
          lab.lab.can.add("break"); await said(); click("[data-act=quick-t2]"); await step(90); await said(); found.push(offered());
          lab.lab.can.delete("break"); await said(); // as of a board
          found.push(offered(), await press(act), offered());
          await press("accept");
          found.push(lab.row().mode < 3);
        }
        return found;"##,
        &[],
    );
    let once = [json!([]), json!(["ack", "shelve"]), json!([1, 1]), json!([]), json!(true)];
    assert_eq!(found, json!([once.clone(), once].concat()));
}

/// What the diagnosis can call a fault, the page can say, in each language.
#[test]
fn every_class_has_a_name_and_a_sentence() {
    let lacking = on_page(
        r##"
        await monitoring();
        const { headline, short } = await import("lab/say.js");
        const { say } = await import("lab/strings.js");
        const lacking = [];
        for (let language = 0; language < 2; language++) {
          click("#language");
          for (const { name } of lab.lab.hello.classes) {
            if (/[a-z]_[a-z]/.test(short(name))) lacking.push(short(name));
            if (name !== "unknown" && headline(name, 1) === say("f_unknown")) lacking.push(`sentence of ${name}`);
          }
        }
        return [lab.lab.hello.classes.length > 20, lacking];"##,
        &[],
    );
    assert_eq!(lacking, json!([true, []]));
}

/// Air and power look alike at first: both are shown, and when they were told apart.
#[test]
fn two_that_look_alike_are_shown_together_and_then_told_apart() {
    let seen = on_page(
        r##"
        await monitoring(); await step(100);
        lab.send({ command: "order", order: { order: "break", fault: { do: "air-flow", size: 1.26, at: 0, for: 20 } } });
        while (lab.events().last?.named !== "air_flow_or_heater_power") await step(1);
        await said();
        const marked = () => [[...document.querySelectorAll(".part.blamed")].map((p) => p.dataset.part), document.querySelectorAll(".bars .best").length];
        const all = [marked()];
        while (lab.events().last.named !== "air_flow") await step(1);
        await said();
        all.push(marked(), /Told apart after [2-9]/.test($("#sub").innerText), /Air or power 0\.\d+ s\s+\d/.test($("#events").innerText.replaceAll("\u00a0", " ")));
        click("[data-act=mend]"); await step(5);
        all.push(await said());
        return all;"##,
        &[],
    );
    assert_eq!(seen, json!([[["fan", "heater"], 2], [["fan"], 1], true, true, "The fault is ending."]));
}

/// The paper's fiv flickers while its models adapt: only what stands is a name, dated to its start.
#[test]
fn a_flicker_of_the_papers_scheme_is_no_name() {
    let isolated = on_page(
        r##"
        const { Events } = await import("lab/events.js");
        const events = new Events({ ts: 0.11, classes: [] });
        const fiv = [0, 3, 3, 0, 3, 3, 3, 3, 3];
        return fiv.map((number, k) => (events.row(k / 2, 3, 1, NaN, 2, number, NaN, NaN), events.last.isolated ?? null));"##,
        &[],
    );
    assert_eq!(isolated, json!([null, null, null, null, null, null, null, null, 2]));
}
