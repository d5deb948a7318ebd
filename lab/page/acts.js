// What can be done by a button, wherever it stands: on the desk, below the sentence, in the tour.
import { calibrate } from "lab/board.js";
import { toStep } from "lab/commissioning.js";
import { Course } from "lab/course.js";
import { PARTS, sized } from "lab/faults.js";
import { save } from "lab/files.js";
import { charts, exam, quiz, sheet } from "lab/parts.js";
import { DEFAULT } from "lab/scene.js";
import { show, unfold } from "lab/show.js";
import { $, changed, heat, keep, lab } from "lab/state.js";
import { say } from "lab/strings.js";
import { ask, begins, open, order, run, send } from "lab/talk.js";

export const course = new Course($("tour"), {
  act, order, keep,
  // A rig that is set up stands still, so that it can be measured.
  open(scene, at, span) {
    open({ ...DEFAULT, ...scene }, { at });
    run(0);
    ask({ command: "scene" }).then(() => span && charts.show(span[1], span[1] - span[0])); // once the rows are there
  },
  unfold: (fold) => lab.open.has(fold) || unfold(fold),
  finish: () => setMode("explore"),
});

const quick = (part, kind) => {
  const { fault, size } = PARTS[part][kind];
  order({ order: "break", fault: { ...fault(sized(size, heat()).value), at: 0, for: 25 } });
};
const ACTS = {
  arm: () => order({ order: "arm" }),
  stop: () => order({ order: "stop" }),
  ack: () => order({ order: "acknowledge" }),
  shelve: () => order({ order: "shelve", seconds: 8 * 3600 }),
  mend: () => order({ order: "mend" }),
  relearn: () => order({ order: "relearn" }),
  accept: () => order({ order: "accept" }),
  "next-step": toStep,
  skip: () => send({ command: "skip" }),
  anew: () => begins(lab.scene),
  paper: () => begins({ ...lab.scene, preset: "paper" }),
  surprise: () => (setMode("quiz"), startQuiz()),
  "quick-t2": () => quick("T2", "wrong"),
  "quick-air": () => quick("fan", "more"),
  "quiz-start": startQuiz,
  "quiz-answer": ({ name }) => quiz.answer(name),
  "quiz-end": () => setMode("explore"),
  "exam-start": () => exam.start(order, heat(), lab.store.now, lab.store.slow),
  "exam-answer": ({ name }) => exam.answer(name, lab.store.now),
  "exam-hand-in": () => exam.handIn(),
  "exam-save": () => save([exam.csv], "exam.csv", "text/csv", say("saved", { file: "exam.csv" })),
  "exam-end": () => exam.end(),
  calibrate,
  setpoint: ({ by }) => order({ order: "setpoint", celsius: Math.round(lab.store.get(lab.store.last, "setpoint")) + Number(by) }),
  look: ({ at }) => charts.show(Number(at) + 15 * lab.store.slow, 20 * lab.store.slow),
};
export function act(name, data = {}) {
  ACTS[name]?.(data);
  if (name.startsWith("exam")) show(); // what an exam hides on the desk
  changed();
}

function startQuiz() {
  quiz.start(order, lab.store.get(lab.store.last, "alarm") > 0, heat(), lab.events.last);
  if (sheet.part) sheet.close();
  charts.follow();
  run(1);
}

export function setMode(mode) {
  if (lab.mode === "quiz" && mode !== "quiz") quiz.end();
  lab.mode = mode;
  course.show(mode === "tour");
  show();
}
