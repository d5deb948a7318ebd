// What changes with language, mode and source, and not with time.
import { settings as all, asking, wide } from "lab/board.js";
import { measures } from "lab/measure.js";
import { charts, exam, review } from "lab/parts.js";
import { showPlan } from "lab/plan.js";
import { $, changed, embedded, lab, plant, put } from "lab/state.js";
import { escape, following, languages, say, speakOf } from "lab/strings.js";

export function show() {
  speakOf(plant());
  words();
  source();
  pressed();
  unfolded();
  offered();
  settings();
  if (lab.hello) showPlan();
  series();
  changed();
}

function words() {
  for (const node of document.querySelectorAll("[data-say]")) node.textContent = say(node.dataset.say);
  asking();
  for (const node of document.querySelectorAll("[data-label]")) node.setAttribute("aria-label", say(node.dataset.label));
  Object.assign($("language"), { textContent: languages()[following()].language, lang: following() });
  $("stack").setAttribute("aria-label", `${say("region_charts")}. ${say("charts_help")}`);
  $("overview").title = say("charts_help");
}

// Where the numbers come from.
function source() {
  const { kind, name } = lab.hello ?? {};
  document.title = kind === "recording" ? `PT-326: ${name}` : say("title");
  if (kind !== "recording") $("review").hidden = true;
  else if (lab.store.end === lab.hello.count) review.show(lab);
  if (!kind) return;
  const told = { simulated: say("source_simulated", { seed: lab.scene.seed }), recording: say("source_recording", { name: escape(name) }), board: say("source_board", { name: escape(name) }) };
  $("source").lastElementChild.innerHTML = lab.lost ? say("state_lost") : told[kind] ?? say("source_live", { name: escape(name ?? kind) });
}

function pressed() {
  for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === lab.mode);
  $("speed").value = lab.speed;
  $("pause").setAttribute("aria-label", say(lab.paused ? "play" : "pause"));
  $("pause").querySelector("path").setAttribute("d", lab.paused ? "M2 1l9 5-9 5z" : "M1.5 1h3v10h-3zM7.5 1h3v10h-3z");
}

// What is unfolded.
function unfolded() {
  const is = (fold) => lab.open.has(fold);
  for (const button of document.querySelectorAll("[data-fold]")) button.setAttribute("aria-expanded", is(button.dataset.fold));
  $("aside").hidden = !is("why");
  $("desk").hidden = !is("desk");
  $("measure").hidden = !is("measure");
  measures(is("measure"));
  document.querySelector("[data-fold=measure]").hidden = !is("charts") && !is("measure"); // the first view stays small
  $("residualsnote").hidden = !is("residuals");
  $("whole").hidden = document.querySelector(".series").hidden = !is("charts");
}
// Unfolds something, or folds it again. What is unfolded is brought into view.
export function unfold(fold, on = !lab.open.has(fold)) {
  lab.open[on ? "add" : "delete"](fold);
  show();
  if (on) reveal({ why: "aside", desk: "desk" }[fold] ?? "charts");
}
export function reveal(id) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  $(id).scrollIntoView({ block: "start", behavior: calm ? "auto" : "smooth" });
}

// What makes sense with this source.
function offered() {
  const { kind, count } = lab.hello ?? {};
  const can = (command) => lab.can.has(command);
  $("transport").hidden = !can("run");
  $("stop").hidden = !can("order");
  $("stop").classList.toggle("large", kind === "board");
  const asked = exam.hides; // then nothing may be opened, read or put in beside it
  $("modes").hidden = !can("break") || asked;
  $("desk-control").hidden = !can("order");
  $("excite").parentElement.hidden = $("excitation-note").hidden = kind === "board"; // a board has no command for it
  $("desk-rig").hidden = !can("open") || asked;
  $("desk-recording").hidden = asked;
  $("desk-plan").hidden = kind !== "simulated" || asked;
  $("desk-board").hidden = kind !== "board";
  $("connect").hidden = !embedded("wasm") || kind === "board" || asked;
  $("back").hidden = !lab.away;
  $("kept").hidden = !can("log");
  $("download").hidden = !can("trace") && !can("log");
  $("download").textContent = say(can("log") ? "save_log" : "download");
  $("link").hidden = !can("trace") || kind !== "simulated";
  $("again").hidden = kind !== "simulated";
  $("compare").textContent = say(charts.kept ? "compare_off" : "compare");
  $("seek").hidden = !can("seek");
  if (kind === "recording") $("seek").max = count;
}

function settings() {
  for (const id of ["preset", "disturbance", "seed"]) $(id).value = lab.scene[id];
  const typed = document.activeElement; // by the user, who has not finished yet
  for (const input of document.querySelectorAll("[data-set]")) if (input !== typed) input.value = lab.settings?.[input.dataset.set] ?? "";
  if (lab.hello?.kind === "board") all();
  const wider = wide(lab.hello?.limits ?? {}, lab.settings ?? {});
  $("wider").hidden = !wider.length;
  $("wider").textContent = say("wider", { what: wider.map((name) => `${name} = ${lab.settings[name]}`).join(", ") });
}

function series() {
  const choice = ({ id, on, css, label }) => `<label><input type="checkbox" value="${id}" ${on ? "checked" : ""}><i style="background:var(${css})"></i>${label}</label>`;
  put("series", charts.choices.map(({ title, series }) => `<fieldset><legend>${title}</legend>${series.map(choice).join("")}</fieldset>`).join(""));
}
