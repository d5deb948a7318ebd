// The user's hand: what is pressed, typed, chosen.
import { act, course, setMode } from "lab/acts.js";
import { typed } from "lab/board.js";
import "lab/export.js";
import { forgetColours } from "lab/canvas.js";
import { begin } from "lab/hear.js";
import { charts, exam, hides, quiz, review, rig, sheet } from "lab/parts.js";
import { show, unfold } from "lab/show.js";
import { $, arms, changed, keep, lab, plant } from "lab/state.js";
import { current, following, speak } from "lab/strings.js";
import { begins, order, run, send } from "lab/talk.js";

document.addEventListener("click", ({ target }) => {
  const pressed = target.closest("[data-act]");
  if (pressed) act(pressed.dataset.act, pressed.dataset);
});
$("modes").addEventListener("click", ({ target }) => target.dataset.mode && setMode(target.dataset.mode));
$("transport").addEventListener("click", ({ target }) => {
  if (!target.closest("#pause")) return;
  if (lab.can.has("seek")) charts.moment();
  run(lab.paused ? lab.speed : 0);
});
$("speed").addEventListener("change", ({ target }) => {
  if (lab.can.has("seek")) charts.moment();
  run(Number(target.value));
});
$("folds").addEventListener("click", ({ target }) => {
  if (!target.dataset.fold) return;
  unfold(target.dataset.fold);
  keep.set("open", [...lab.open].join(" "));
});
$("stop").addEventListener("click", () => act(arms() ? "arm" : "stop"));
$("follow").addEventListener("click", () => charts.follow());
$("language").addEventListener("click", () => {
  speak(following());
  keep.set("language", current());
  rig.fit(plant(), lab.hello.kind === "board", true);
  if (sheet.part) sheet.build();
  course.show(lab.mode === "tour");
  show();
});
$("theme").addEventListener("click", () => {
  const { dataset } = document.documentElement;
  dataset.theme = dataset.theme === "dark" ? "light" : "dark";
  keep.set("theme", dataset.theme);
  forgetColours();
  show();
});
// On paper it is light.
addEventListener("beforeprint", () => {
  document.documentElement.dataset.theme = "light";
  forgetColours();
  show();
  if (lab.store?.end) charts.print(lab.events, hides());
});
$("excite").addEventListener("change", ({ target }) => order({ order: "excite", on: target.checked }));
for (const input of document.querySelectorAll("[data-set]")) {
  input.addEventListener("change", () => {
    const value = typed(input);
    if (value === null) show();
    else order({ order: "set", name: input.dataset.set, value });
  });
}
for (const id of ["preset", "disturbance", "seed"]) {
  $(id).addEventListener("change", () => {
    quiz.end();
    begins({ preset: $("preset").value, disturbance: $("disturbance").value, seed: Number($("seed").value) });
    run(lab.speed);
  });
}
$("series").addEventListener("change", ({ target }) => charts.toggle(target.value, target.checked));
$("seek").addEventListener("input", ({ target }) => {
  send({ command: "seek", tick: Number(target.value) });
  charts.moment();
});
addEventListener("hashchange", () => lab.hello?.kind === "simulated" && location.hash && !exam.hides && begin());
addEventListener("resize", () => {
  changed();
  if (sheet.part) sheet.arrange();
  if (!$("review").hidden) review.show(lab);
});
// What stands below the bar leaves room for it, in however many rows it is.
new ResizeObserver(([{ target }]) => document.documentElement.style.setProperty("--bar", `${target.offsetHeight}px`)).observe(document.querySelector(".bar"));
addEventListener("keydown", (event) => {
  // Nothing that is typed for a real board needs one of these: they stop it in the middle of a line, too, as on its console.
  if (lab.hello?.kind === "board" && (event.key === "!" || event.key === "Escape")) {
    event.preventDefault();
    return act("stop");
  }
  if (/INPUT|SELECT|TEXTAREA/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "!" ) act("stop");
});
