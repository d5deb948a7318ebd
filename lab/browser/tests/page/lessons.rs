//! What leads through the page: the quiz and the tour.

use pt326_lab_browser::Browser;
use serde_json::{Value, json};

use crate::{address, assert_untroubled, on_page, script_on};

#[test]
fn the_quiz_hides_the_name_until_it_is_answered_and_keeps_the_score() {
    let [hidden, told] = serde_json::from_value::<[Value; 2]>(on_page(
        r##"
        await monitoring();
        click("[data-mode=quiz]");
        await until(() => $("[data-act=quiz-start]"));
        const before = { ...lab.quiz.score };
        Math.random = () => 0.4; // T2 reads too low: others, if large, trip within this minute, and the trip has the head
        click("[data-act=quiz-start]");
        lab.send({ command: "run", speed: 0 });
        while (lab.quiz.phase !== "ask") await step(5);
        await step(60);
        await until(() => $(".answers"));
        click("[data-part=T1]");
        const hidden = [$("#head").innerText, $("#why").hidden, $("#events").innerText, !!$(".part.blamed"), $("#hint").innerText, document.body.innerText.includes(lab.quiz.event.label()), $("#sheet").hidden, lab.quiz.score.it - before.it];
        click(`[data-name=${lab.quiz.right}]`);
        await until(() => !$(".answers"));
        return [hidden, [$("#head").innerText.slice(0, 6), lab.quiz.score.you - before.you, lab.quiz.score.it - before.it, $("#why").hidden]];"##,
        &[],
    ))
    .expect("two lists");
    let head = hidden[0].as_str().expect("text");
    assert!(head.starts_with("Something broke"), "{head}");
    assert_eq!(
        hidden.as_array().map(|all| &all[1..]),
        json!([true, "\tNothing has happened yet.", false, "", false, true, 1])
            .as_array()
            .map(|all| &all[..])
    );
    assert_eq!(told, json!(["Right:", 1, 1, false]));
}

/// Every step of the tour has its words in both languages, looks at something, and its button does something.
#[test]
fn the_tour_goes_to_its_end() {
    let steps = on_page(
        r##"await monitoring();
           click("[data-mode=tour]");
           const steps = [];
           for (;;) {
             const does = $("[data-do]");
             const before = lab.events().orders.length + lab.quiz.phase;
             if (does) { does.click(); await step(120); await said(); while ($("#waits")?.textContent) await said(); await said(); }
             const done = !does || lab.events().orders.length + lab.quiz.phase !== before || lab.events().list.length > 0;
             const english = $("#tour .text").textContent;
             const words = $("#tour h2").textContent.length > 5 && $("#tour .text").textContent.length > 100;
             click("#language");
             const other = lab.lab.mode !== "tour" || $("#tour .text").textContent.length > 100 && $("#tour .text").textContent !== english;
             click("#language");
             const looked = document.querySelector(".looked");
             await until(() => !looked || looked.getBoundingClientRect().top < innerHeight / 2);
             steps.push([!!looked || lab.lab.mode !== "tour", done, words, other]);
             if (lab.lab.mode !== "tour" || $("[data-step='1']").disabled) return steps;
             click("[data-step='1']");
           }"##,
        &[],
    );
    let steps: Vec<Vec<bool>> = serde_json::from_value(steps).expect("steps");
    assert!(steps.len() > 10 && steps.iter().flatten().all(|good| *good), "{steps:?}");
}

/// A step that has to wait for what was wrong before, or for a rig that has tripped, says so; and the last step ends the tour.
#[test]
fn the_tour_waits_until_all_is_quiet_and_finishes() {
    let seen = on_page(
        r##"await monitoring();
           click("[data-mode=tour]"); click("[data-step='1']"); click("[data-step='1']");
           const told = async () => { await said(); return $("#waits").textContent; };
           const put = () => lab.events().orders.filter(({ to }) => to > lab.lab.store.now).length;
           // Nothing is wrong: at once. Then an alarm stands: once it is over, however long that takes.
           $("[data-do]").click(); await step(1); const first = [await told(), put()];
           await step(100); $("[data-do]").click(); await step(1); const { alarm } = lab.row(); let alarms = lab.lab.store.now;
           const mended = [await told(), put(), alarm];
           for (let i = 0; i < 100 && !put(); i++) { alarms = lab.row().alarm > 0 ? lab.lab.store.now : alarms; await said(); }
           const quiet = lab.events().orders.at(-1).from - alarms;
           const second = [await told(), put(), quiet >= 2 && quiet < 4];
           // A rig that has tripped is told to monitor first.
           lab.send({ command: "order", order: { order: "break", fault: { do: "open", sensor: "t1", at: 0, for: 5 } } }); await step(120);
           $("[data-do]").click(); await step(30); const trips = [await told(), put()];
           for (const act of ["ack", "arm", "skip"]) { await said(); $(`#more [data-act=${act}]`).click(); await step(1); }
           for (let i = 0; i < 30 && !put(); i++) await said();
           const third = [await told(), put(), lab.row().mode];
           const list = $("#tour select"); list.value = list.length - 1; list.dispatchEvent(new Event("change", { bubbles: true }));
           const last = $("[data-step='1']").textContent;
           click("[data-step='1']");
           const end = [lab.lab.mode, $("#tour").hidden];
           click("[data-mode=tour]");
           return [first, mended, second, trips, third, last, end, $("#tour select").value]"##,
        &[],
    );
    let over = "The fault begins once the last one is over.";
    let monitors = "The fault begins once the rig monitors again.";
    let expected = json!([
        ["", 1],
        [over, 0, 1],
        ["", 1, true],
        [monitors, 0],
        ["", 1, 3],
        "Finish",
        ["explore", true],
        "0"
    ]);
    assert_eq!(seen, expected);
}

/// An event that began before a question is not its answer.
#[test]
fn next_while_a_fault_lasts_asks_about_the_next() {
    let asked = on_page(
        r##"await monitoring();
           click("[data-mode=quiz]"); await until(() => $("[data-act=quiz-start]")); click("[data-act=quiz-start]");
           lab.send({ command: "run", speed: 0 });
           while (lab.quiz.phase !== "ask") await step(5);
           const first = lab.quiz.event;
           await step(20); await until(() => $(".answers")); click(`[data-name=${lab.quiz.right}]`);
           await until(() => $("[data-act=quiz-start]")); click("[data-act=quiz-start]"); lab.send({ command: "run", speed: 0 });
           await step(1);
           const waits = lab.quiz.phase;
           while (lab.quiz.phase !== "ask") await step(5);
           return [waits, lab.quiz.event !== first, lab.quiz.event.fault.do === lab.quiz.fault.do, lab.quiz.event.from > first.to]"##,
        &[],
    );
    assert_eq!(asked, json!(["wait", true, true, true]));
}

/// What has tripped it is said as it was, and what is left to do as it is.
#[test]
fn a_trip_says_its_cause_and_what_is_left_to_do() {
    let told = on_page(
        r##"await monitoring();
           lab.send({ command: "order", order: { order: "break", fault: { do: "short", sensor: "t2", at: 0, for: 1e6 } } });
           await step(30); await until(() => document.body.dataset.state === "tripped");
           const first = [$("#head").innerText, /Repair the cause/.test($("#sub").innerText)];
           click("[data-act=mend]"); await step(30); await until(() => !/Repair the cause/.test($("#sub").innerText));
           return [...first, $("#head").innerText, /acknowledge/.test($("#sub").innerText)]"##,
        &[],
    );
    let head = "T2 reads as a short circuit.";
    assert_eq!(told, json!([head, true, head, true]));
}

/// A file that is no trace says what it lacks; from one that is, there is a way back to the rig as it was left.
#[test]
fn from_a_trace_there_is_a_way_back_to_the_rig() {
    let folder = std::env::temp_dir().join(format!("pt326-back-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let [other, trace] = ["other.csv", "trace.csv"].map(|name| folder.join(name));
    std::fs::write(&other, "time,temperature\n0,20\n").expect("a file");
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let text = script_on(
        &browser,
        r##"await monitoring(); $("#file").parentElement.hidden = false;
           lab.send({ command: "order", order: { order: "break", fault: { do: "ambient", size: -3, at: 0, for: 20 } } }); await step(300);
           const { parts } = await lab.ask({ command: "trace" }); return parts.join("")"##,
        &[],
    );
    std::fs::write(&trace, text.as_str().expect("text")).expect("a file");
    browser.choose("#file", &other).expect("an input");
    let lacks = script_on(
        &browser,
        r##"await until(() => /t_s/.test($("#toast").textContent)); return $("#toast").textContent"##,
        &[],
    );
    assert!(lacks.as_str().is_some_and(|text| text.contains("no column t_s")), "{lacks}");
    script_on(&browser, r##"click("[data-mode=quiz]"); return 1"##, &[]);
    // Dropped anywhere, it is opened as by the button; nothing else than a file or a text may be dropped.
    let dropped = script_on(
        &browser,
        r##"const data = new DataTransfer(); data.items.add(new File([args[0]], "dropped.csv"));
           const drag = (type, dataTransfer) => document.body.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
           const taken = [drag("dragover", data), drag("drop", data), drag("dragover", new DataTransfer())];
           await until(() => lab.lab.hello.kind === "recording"); const { name } = lab.lab.hello;
           click("#back"); await until(() => lab.lab.hello.kind === "simulated" && lab.lab.store?.end > 300);
           return [...taken, name]"##,
        &[text],
    );
    assert_eq!(dropped, json!([false, false, true, "dropped.csv"]));
    browser.choose("#file", &trace).expect("an input");
    let back = script_on(
        &browser,
        r##"await until(() => lab.lab.hello.kind === "recording"); const end = lab.lab.store.end;
           const door = lab.events().list.map((event) => event.label());
           click("#back"); await until(() => lab.lab.hello.kind === "simulated" && lab.lab.store?.end >= end); lab.send({ command: "run", speed: 0 });
           return [door, $("#back").hidden, lab.events().orders.length, lab.lab.mode]"##,
        &[],
    );
    assert_eq!(back, json!([["A fault that was put in"], true, 1, "explore"]));
    assert_untroubled(&browser);
    let _ = std::fs::remove_dir_all(folder);
}

/// Every button of the page has its words in the language of the page.
#[test]
fn no_button_is_left_untranslated() {
    let same = on_page(
        r##"await monitoring();
           const words = () => [...document.querySelectorAll("[data-line]")].map((button) => button.textContent);
           const english = words(); click("#language");
           return words().filter((word, i) => word === english[i])"##,
        &[],
    );
    assert_eq!(same, json!([]));
}

/// A page from a file copies its scene as text, and any copy of the page takes it.
#[test]
fn a_scene_is_copied_as_text_and_pasted() {
    let seen = on_page(
        r##"await monitoring();
           copies(); const text = await copied("#link"); const told = /paste it/.test($("#toast").textContent);
           lab.send({ command: "open", scene: { ...SCENE, seed: 9 }, skip: true }); await step(1);
           history.replaceState(null, "", "#");
           paste(`see ${text} there`);
           await until(() => lab.lab.scene.seed === 1 && lab.lab.store.end > 100);
           return [text.startsWith("#s="), told]"##,
        &[],
    );
    assert_eq!(seen, json!([true, true]));
}
