//! The course: every exercise as a student plays it.

use serde_json::json;

use crate::on_page;

/// Begins the course, and what a student does in it.
const COURSE: &str = r##"
await monitoring(); click("[data-mode=tour]"); await until(() => $("#tour select"));
const { EXERCISES } = await import("lab/exercises.js");
const choose = (i) => { const list = $("#tour select"); list.value = i; list.dispatchEvent(new Event("change", { bubbles: true })); };
const enter = (i, value) => {
  const input = $(`#tour [name=q${i}][value="${value}"][type=radio]`) ?? $(`#tour [name=q${i}]`);
  if (input.type === "radio") input.checked = true; else input.value = value;
  input.dispatchEvent(new Event("change", { bubbles: true }));
};
const check = (answers) => { answers.forEach((answer, i) => enter(i, answer)); click("#tour form button"); return $("#tour form [role=status]").textContent; };
"##;

/// By the rig's true values each exercise has full marks and is done; by each wrong answer of its file, and by what is far off, none.
#[test]
fn every_exercise_is_played_to_full_marks_and_to_none() {
    let script = r##"
        const failed = [];
        for (const [i, { id, ask }] of EXERCISES.entries()) {
          if (!ask) continue;
          choose(i);
          const of = `of ${ask.length}.`;
          const right = ask.map(({ choices, answer }) => (choices ? choices.findIndex((one) => one.right) : String(answer).replace(".", ",")));
          const wrong = ask.map(({ choices, answer }) => (choices ? choices.findIndex((one) => !one.right) : answer * 1.5 + 1));
          const told = [check(wrong), $("#tour .text + form + .text")];
          if (told[0] !== `0 ${of}` || told[1]) failed.push(`${id}: wrong answers have ${told[0]}`);
          for (const [k, one] of ask.entries()) {
            for (const { answer, say } of one.wrong ?? []) {
              check(right.with(k, answer));
              if (!$("#tour .wrong")?.textContent.includes(say.en)) failed.push(`${id}: ${answer} is not told what is wrong with it`);
            }
          }
          const full = check(right);
          if (full !== `${ask.length} ${of}` || !$("#tour form + .text")) failed.push(`${id}: true values have ${full}`);
        }
        const marked = [...$("#tour select").options].filter((option) => option.textContent.includes("✓")).length;
        return [failed, marked === EXERCISES.filter(({ ask }) => ask).length, marked > 10]"##;
    assert_eq!(on_page(&format!("{COURSE}{script}"), &[]), json!([[], true, true]));
}

/// What is no number is told, and not judged; numbers may be typed with a comma or a minus sign of print.
#[test]
fn what_is_no_number_is_told_and_not_judged() {
    let script = r##"
        choose(EXERCISES.findIndex(({ id }) => id === "14-t1-low"));
        const all = [check(["", "3,33", "much"])];
        all.push($("#tour .wrong") === null);
        all.push(check(["\u22121", "3.33", "0.92"]), $("#tour .wrong").textContent.slice(0, 27));
        click("#language"); all.push($("#tour input").value, $("#tour .wrong").textContent.slice(0, 4));
        return all"##;
    let told = json!([
        "1 of 3. Something is not a number, or not chosen.",
        true,
        "2 of 3.",
        "No. The controller believes",
        "\u{2212}1",
        "Não."
    ]);
    assert_eq!(on_page(&format!("{COURSE}{script}"), &[]), told);
}
