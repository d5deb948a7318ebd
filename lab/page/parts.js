// The parts of the page that keep something of their own.
import { Charts } from "lab/charts.js";
import { Exam } from "lab/exam.js";
import { Quiz } from "lab/quiz.js";
import { Review } from "lab/review.js";
import { RigDrawing } from "lab/rig.js";
import { Sheet } from "lab/sheet.js";
import { $, changed, heat, lab } from "lab/state.js";
import { order } from "lab/talk.js";

export const quiz = new Quiz();
export const exam = new Exam();
// Which events would give away what is asked; null where nothing is hidden.
export const hides = () => (exam.hides ? () => true : quiz.hides ? (event) => event === quiz.event : null);
export const charts = new Charts({ stack: $("stack"), overview: $("overview") }, changed);
export const review = new Review($("review"));
export const rig = new RigDrawing($("rig"), (part, place) => {
  if (!lab.can.has("break") || hides()) return;
  sheet.open(part, place);
  changed();
});
export const sheet = new Sheet($("sheet"), {
  order,
  slow: () => lab.store.slow,
  heat,
  closed(part) {
    changed();
    if (part) rig.parts[part]?.focus({ preventScroll: true });
  },
});
