// A schedule of faults and an exam, made by forms on the desk.
import { LIMITS, most } from "lab/exam.js";
import { PARTS_ASKED, toExam, wrong } from "lab/exam_text.js";
import { PARTS, describe, sized } from "lab/faults.js";
import { copyText } from "lab/files.js";
import { exam } from "lab/parts.js";
import { toLink } from "lab/scene.js";
import { reveal } from "lab/show.js";
import { $, heat, lab, put, toast } from "lab/state.js";
import { escape, num, say } from "lab/strings.js";
import { ask, begins, order, run, scaled } from "lab/talk.js";

const plan = []; // orders to come, each with `at` in s from when it is run
const chosen = () => {
  const [part, kind] = $("plan-fault").value.split(" ");
  const { size, ...more } = PARTS[part][kind];
  return { ...more, size: sized(size, heat()) };
};
const kinds = (part) => Object.entries(PARTS[part]).map(([kind, { verb }]) => `<option value="${part} ${kind}">${say("part_" + part).split(",")[0]}: ${say(verb).toLowerCase()}</option>`);

// Words and choices, as the language and the plant have them.
export function showPlan() {
  const { value } = $("plan-fault");
  put("plan-fault", Object.keys(PARTS).flatMap(kinds).join(""));
  if (value) $("plan-fault").value = value;
  put("exam-parts", PARTS_ASKED.map((part) => `<label><input type="checkbox" value="${part}" checked>${say("part_" + part).split(",")[0]}</label>`).join(""));
  size();
  list();
}

function size() {
  const { size: of, last } = chosen();
  $("plan-size").parentElement.hidden = !of;
  if (of) Object.assign($("plan-size"), { min: of.min, max: of.max, step: of.step, value: of.value });
  $("plan-unit").textContent = of?.unit ?? "";
  $("plan-for").value = last ?? 25;
}

function list() {
  const line = ({ at, for: lasts, ...fault }, i) =>
    `<li><span>${num(at)} s: ${describe(fault)}, ${num(lasts, 0)} s</span><button type="button" class="quiet" data-drop="${i}" aria-label="${escape(say("plan_drop"))}">✕</button></li>`;
  put("plan-list", plan.map(line).join(""));
  for (const button of document.querySelectorAll("[data-plan]")) button.disabled = !plan.length;
}

$("plan-fault").addEventListener("change", size);
$("plan").addEventListener("submit", (event) => {
  event.preventDefault();
  const { fault, size: of } = chosen();
  plan.push({ ...fault(of && Number($("plan-size").value)), at: Number($("plan-at").value), for: Number($("plan-for").value) });
  plan.sort((a, b) => a.at - b.at);
  list();
});
$("plan-list").addEventListener("click", ({ target }) => {
  const { drop } = target.dataset;
  if (drop !== undefined) plan.splice(Number(drop), 1);
  list();
});
const orders = () => plan.map((fault) => ({ order: "break", fault }));
$("plan-run").addEventListener("click", () => {
  orders().forEach(order);
  run(lab.speed);
});
// The scene as it is, with the faults to come: whoever opens it has them from there on.
$("plan-copy").addEventListener("click", async () => {
  const { scene, tick } = await ask({ command: "scene" });
  const more = orders().map((what) => [tick, scaled(what)]);
  copyText("#" + toLink({ ...scene, orders: [...scene.orders, ...more] }, tick + 1));
});

function paper() {
  const number = (name) => Number($(`exam-${name}`).value);
  const parts = [...document.querySelectorAll("#exam-parts :checked")].map((box) => box.value);
  const { preset, disturbance } = lab.scene;
  const made = { seed: number("seed"), count: number("count"), minutes: number("minutes"), parts, preset, disturbance };
  const lacks = wrong(made);
  if (!lacks) return made;
  const [min, max] = LIMITS[lacks] ?? [];
  toast(say(lacks === "parts" ? "exam_no_parts" : lacks === "room" ? "exam_no_room" : "exam_range", { what: say(`exam_${lacks}`), min, max, most: most(made.minutes), minutes: made.minutes }));
}
$("exam-copy").addEventListener("click", () => {
  const made = paper();
  if (made) copyText("#" + toExam(made));
});
$("exam-try").addEventListener("click", () => {
  const made = paper();
  if (made) hold(made);
});

// Opens the scene of an exam, ready to be started.
export function hold(made) {
  exam.begin(made);
  begins(exam.scene);
  run(1);
  toast(say("opened", { what: say("exam") }));
  reveal("say");
}
$("exam-seed").value = crypto.getRandomValues(new Uint16Array(1))[0];
