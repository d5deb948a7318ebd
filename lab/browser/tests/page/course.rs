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

/// Places the cursors and reads what the page shows: T0, T1, T2 and power at A, at B, their differences, and their means between the two.
const BENCH: &str = r##"
const setUp = async (id) => {
  const i = EXERCISES.findIndex((one) => one.id === id);
  choose(i); click("[data-do]"); await lab.ask({ command: "scene" });
  await until(() => lab.lab.store.end === EXERCISES[i].at);
  await frame();
};
const read = async (a, b) => {
  for (const [name, tick] of [["a", a], ["b", b]]) {
    const cursor = $(`#cursor-${name}`); cursor.value = tick; cursor.dispatchEvent(new Event("input", { bubbles: true }));
  }
  await frame();
  const rows = [...document.querySelectorAll("#readings tbody tr")].map((row) => [...row.cells].slice(2).map((cell) => Number(cell.textContent.replace("\u2212", "-"))));
  const step = $("#readings p").textContent.match(/\d+\.\d+/g).map(Number);
  return { at: rows[0], differs: rows[2], mean: rows[3], step };
};
"##;

/// A student who measures as it is written has full marks: what the rig shows is what its constants say, within the file's tolerance.
#[test]
fn what_is_measured_as_it_is_written_has_full_marks() {
    let script = r##"
        const steady = async (id, a = [200, 399], b = [600, 799]) => { await setUp(id); return [(await read(...a)).mean, (await read(...b)).mean]; };
        const told = {};
        let [p, q] = await steady("30-static-gain");
        told.gain = check([(q[1] - p[1]) / (q[3] - p[3]), (q[2] - p[2]) / (q[3] - p[3])]);
        [p, q] = await steady("31-static-line");
        const slope = (q[1] - p[1]) / (q[3] - p[3]);
        told.line = check([p[1] - slope * p[3], p[3] + (60 - p[1]) / slope]);
        for (const [id, a, b] of [["32-step-oven", 500, 798], ["33-step-tclab", 700, 1098]]) {
          await setUp(id);
          const { at, step: [before, after, early, late] } = await read(a, b);
          const tau = 1.5 * (late - early);
          told[id] = check([(after - before) / (0.5 * at[3]), tau, late - tau]);
        }
        [p, q] = await steady("34-proportional"); told.offset = check([50, 35 - q[1]]);
        [p, q] = await steady("35-integral"); told.integral = check([35 - q[1], q[3]]);
        [p, q] = await steady("37-fan"); told.fan = check([p[3], q[3], (q[1] - q[0]) / q[3]]);
        await setUp("36-oscillation");
        const swing = (from) => Array.from({ length: 100 }, (_, i) => lab.lab.store.get(from + i, "t1") - 35);
        const turns = swing(900).flatMap((x, i, all) => (i && x >= 0 && all[i - 1] < 0 ? [i] : []));
        const widest = [500, 700, 900].map((from) => Math.max(...swing(from)));
        told.swing = check([widest.findIndex((x) => x > 1), ((turns.at(-1) - turns[0]) * lab.lab.store.ts) / (turns.length - 1)]);
        for (const id of ["40-signature-t2", "41-signature-t1", "42-signature-air"]) {
          await setUp(id);
          const { store } = lab.lab;
          const mean = (name) => { let sum = 0; for (let k = 3545; k < 3818; k++) sum += store.get(k, name); return sum / (3818 - 3545); };
          const out = ["rap", "ry12", "rsg1", "rsg2", "rbw1"].filter((name) => Math.abs(mean(name)) > 1).join(", ");
          const { ask } = EXERCISES.find((one) => one.id === id);
          const chosen = (k, name) => ask[k].choices.findIndex(({ is }) => is.en === name);
          const fivs = new Set(Array.from({ length: 273 }, (_, k) => store.get(3545 + k, "fiv")));
          const air = id === "42-signature-air";
          told[id] = check([chosen(0, air ? "rbw1" : out), store.get(store.last, "fdv"), air ? chosen(2, `now ${[...fivs].sort().join(", now ")}`) : [...fivs].join()]);
          if (air && !(Math.abs(mean("rbw1") - 1) < 0.5)) told[id] += ` rbw1 ${mean("rbw1")}`;
        }
        return told"##;
    let full = json!({
        "gain": "2 of 2.", "line": "2 of 2.", "32-step-oven": "3 of 3.", "33-step-tclab": "3 of 3.", "offset": "2 of 2.", "integral": "2 of 2.",
        "fan": "3 of 3.", "swing": "2 of 2.", "40-signature-t2": "3 of 3.", "41-signature-t1": "3 of 3.", "42-signature-air": "3 of 3."
    });
    assert_eq!(on_page(&format!("{COURSE}{BENCH}{script}"), &[]), full);
}
