//! An exam: made by a form, handed on as text, answered, and saved.

use pt326_lab_browser::Browser;
use serde_json::json;

use crate::layout::LOOK;
use crate::{address, assert_untroubled, on_page, script_on};

/// An exam as a lecturer makes it (three faults in four minutes), opened from its text and started.
const HELD: &str = r##"
await monitoring(); copies();
for (const [name, value] of [["seed", 7], ["count", 3], ["minutes", 4]]) $(`#exam-${name}`).value = value;
const text = await copied("#exam-copy");
const hold = async () => {
  paste(`see ${text} there`);
  await until(() => lab.exam.phase === "ready" && lab.lab.scene.seed === lab.exam.scene.seed && lab.row()?.mode === 3);
  lab.send({ command: "run", speed: 0 }); await step(1);
  await until(() => $("[data-act=exam-start]")); click("[data-act=exam-start]"); await step(1);
};
const reach = (t) => step(Math.ceil((t - lab.lab.store.now) / lab.lab.store.ts));
"##;

/// Nothing that would tell is shown or offered before the end; then each fault stands beside its answer, and in the file.
#[test]
fn an_exam_hides_its_faults_until_the_end_and_tells_what_was_right() {
    let script = r##"await hold();
        const { faults, from } = lab.exam;
        click("[data-mode=quiz]"); click("[data-part=T1]");
        await reach(faults[0].from + 3); await until(() => $(".answers")); await said();
        const labels = lab.events().list.map((event) => event.label());
        const hidden = [labels.length, labels.some((label) => document.body.innerText.includes(label)), !!$(".part.blamed"), $("#why").hidden, $("#sheet").hidden, $("#hint").innerText, $("#modes").hidden, $("#desk-recording").hidden, $("#desk-rig").hidden];
        paste("#s=AAAA"); const kept = lab.exam.phase;
        click("[data-name=t1_clogged]"); click("[data-name=t2_offset]");
        await reach(faults[1].from + 1); click("[data-name=t0_fault]");
        await reach(from + 241); await until(() => $("[data-act=exam-save]"));
        return [atob(text.slice(3).replaceAll("-", "+").replaceAll("_", "/")).includes("seed"), hidden, kept, $("#head").innerText, lab.exam.csv.split("\n"), $("#modes").hidden]"##;
    let seen = on_page(&format!("{HELD}{script}"), &[]);
    let hidden = json!([1, false, false, true, true, "", true, true, true]);
    assert_eq!(
        seen,
        json!([
            false,
            hidden,
            "runs",
            "1 of 3 right.",
            [
                "time_s,fault,answer,result,delay_s",
                "10.91,t1_clogged,t1_clogged,right,3.39",
                "14.30,,t2_offset,wrong,",
                "98.41,t2_offset,t0_fault,wrong,1.03",
                "181.51,air_flow,,wrong,",
                ""
            ],
            false
        ])
    );
}

/// Who opens the same text has the same faults at the same times; another text of the same exam looks otherwise.
#[test]
fn a_text_is_one_exam_for_everybody() {
    let script = r##"
        const all = [];
        for (let i = 0; i < 2; i++) {
          await hold();
          all.push(JSON.stringify([lab.exam.scene, lab.exam.faults.map(({ fault }) => fault)]));
          click("[data-act=exam-hand-in]"); await until(() => $("[data-act=exam-end]")); click("[data-act=exam-end]");
        }
        const { toExam } = await import("lab/exam_text.js");
        const paper = lab.exam.paper;
        return [all[0] === all[1], toExam(paper) !== toExam(paper), lab.exam.faults.length]"##;
    assert_eq!(on_page(&format!("{HELD}{script}"), &[]), json!([true, true, 3]));
}

/// Faults that do not fit, no parts, a text that is none: each is told with what was expected.
#[test]
fn what_makes_no_exam_is_told() {
    let told = on_page(
        r##"await monitoring();
           const toast = () => $("#toast").textContent;
           const all = [];
           $("#exam-count").value = 20; click("#exam-try"); all.push(toast());
           $("#exam-count").value = 2.5; click("#exam-try"); all.push(toast());
           $("#exam-count").value = 2; for (const box of document.querySelectorAll("#exam-parts input")) box.checked = false;
           click("#exam-try"); all.push(toast());
           paste("#x=AAAAAAAAAAAA"); await until(() => /holds no/.test(toast()));
           return [all, lab.exam.on]"##,
        &[],
    );
    let expected = [
        "At most 8 faults fit into 8 minutes.",
        "Faults: expected a whole number from 1 to 20.",
        "Choose at least one part that may fail.",
    ];
    assert_eq!(told, json!([expected, false]));
}

#[test]
fn an_exam_fits_on_a_phone() {
    let browser = Browser::start_with(pt326_lab_browser::Font::Wide).expect("a browser");
    browser.open(&address()).expect("lab.html");
    browser.resize(400, 900).expect("a size");
    let script = r##"await hold(); const wrong = [];
        const look = async () => { for (let i = 0; i < 2; i++) { click("#language"); looks.length = 0; await said(); wrong.push(...cut()); } };
        await reach(lab.exam.faults[0].from + 3); click("[data-name=t1_clogged]"); await look();
        click("[data-act=exam-hand-in]"); await look();
        return [wrong, document.documentElement.scrollWidth <= innerWidth]"##;
    let seen = script_on(&browser, &format!("{LOOK}{HELD}{script}"), &[]);
    assert_eq!(seen, json!([[], true]));
    assert_untroubled(&browser);
}
