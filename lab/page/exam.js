// An exam: faults come at hidden times, the student names them, and the result can be saved. Which and when follows from a seed; until the end
// nothing that would tell is shown.
import { ANSWERS, describe, recognise, surprise } from "lab/faults.js";
import { num, say } from "lab/strings.js";

export const LASTS = 30; // s that each fault stays
const REST = 25; // s after a fault before the next may come
const EARLIEST = 5; // s
const LARGEST = 0.6; // of the largest size that a sheet offers: an exam in which the heater trips is over
export const LIMITS = { seed: [0, 4294967295], count: [1, 20], minutes: [1, 120] };

// Numbers from 0 to 1, the same of the same seed (mulberry32).
export function numbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let x = Math.imul(state ^ (state >>> 15), 1 | state);
    x = (x + Math.imul(x ^ (x >>> 7), 61 | x)) ^ x;
    return ((x ^ (x >>> 14)) >>> 0) / 4294967296;
  };
}

// How many faults so many minutes hold.
export const most = (minutes) => Math.floor((60 * minutes - EARLIEST) / (LASTS + REST));

// The scene in which an exam is held. Its seed is not that of the faults.
export const sceneOf = ({ seed, preset, disturbance }) => ({ seed: Math.floor(numbers(seed)() * 65536), preset, disturbance, orders: [[0, { order: "arm" }]] });

// The faults of an exam, each in its own part of the time; `at` in s from the start.
export function faultsOf({ seed, count, minutes, parts }, heat) {
  const random = numbers(seed ^ 0x5eed);
  const part = (60 * minutes - EARLIEST) / count;
  return Array.from({ length: count }, (_, i) => {
    const fault = surprise(heat, { random, parts, largest: LARGEST });
    return { ...fault, for: LASTS, at: Math.round(10 * (EARLIEST + i * part + random() * (part - LASTS - REST))) / 10 };
  });
}

export class Exam {
  constructor() {
    this.end();
  }

  end() {
    this.phase = "idle";
  }

  get on() {
    return this.phase !== "idle";
  }

  get hides() {
    return this.phase === "ready" || this.phase === "runs";
  }

  // Its scene is about to be opened.
  begin(paper) {
    Object.assign(this, { paper, phase: "ready", scene: sceneOf(paper), faults: [], answers: [], from: 0, until: Infinity });
  }

  // Another scene is no exam.
  opened({ seed }) {
    if (this.on && seed !== this.scene.seed) this.end();
  }

  // The faults go in now, at a time of the scene, with orders whose times are those of the usual rig.
  start(order, heat, now, slow) {
    this.phase = "runs";
    [this.from, this.until] = [now, now + 60 * this.paper.minutes * slow];
    for (const fault of faultsOf(this.paper, heat)) order({ order: "break", fault });
  }

  // A fault was put in, which begins then.
  ordered(now, { order, fault }) {
    if (this.phase === "runs" && order === "break") this.faults.push({ from: now + fault.at, fault });
  }

  answer(name, now) {
    if (this.phase === "runs") this.answers.push({ name, t: now });
  }

  // Whether its time is over just now.
  follow(now) {
    const over = this.phase === "runs" && now >= this.until;
    if (over) this.phase = "told";
    return over;
  }

  handIn() {
    this.phase = "told";
  }

  // What came of it: each fault with the first answer after it began and before the next, and answers that were none to any.
  get results() {
    const rows = this.faults.map(({ from, fault }, i) => {
      const next = this.faults[i + 1]?.from ?? Infinity;
      const answer = this.answers.find(({ t }) => t >= from && t < next);
      return { t: from, fault, right: answer?.name === recognise(fault).name, answer };
    });
    const taken = new Set(rows.map(({ answer }) => answer));
    const more = this.answers.filter((answer) => !taken.has(answer)).map((answer) => ({ t: answer.t, fault: null, right: false, answer }));
    return [...rows, ...more].sort((a, b) => a.t - b.t);
  }

  // Times from the start, in s.
  get csv() {
    const line = ({ t, fault, answer, right }) => {
      const delay = fault && answer ? (answer.t - t).toFixed(2) : "";
      return [(t - this.from).toFixed(2), fault ? recognise(fault).name : "", answer?.name ?? "", right ? "right" : "wrong", delay].join(",");
    };
    return ["time_s,fault,answer,result,delay_s", ...this.results.map(line), ""].join("\n");
  }

  // What stands in place of the sentence.
  view(now) {
    const { count, minutes } = this.paper;
    const button = (act, key, primary) => `<button class="${primary ? "primary" : "plain"}" data-act="${act}">${say(key)}</button>`;
    if (this.phase === "ready") {
      const more = `<div class="row">${button("exam-start", "exam_start", true)}${button("exam-end", "exam_leave")}</div>`;
      return { line: "", head: say("exam_ready", { count, minutes: num(minutes, 0) }), sub: say("exam_rules"), more };
    }
    if (this.phase === "runs") {
      const last = this.answers.at(-1);
      const answers = offered(this.paper).map((name) => `<button data-act="exam-answer" data-name="${name}">${say("a_" + name)}</button>`);
      const sub = last ? say("exam_noted", { s: num(last.t - this.from, 0), what: say("a_" + last.name) }) : say("exam_rules");
      const more = `<div class="answers">${answers.join("")}</div><div class="row">${button("exam-hand-in", "exam_hand_in")}</div>`;
      return { line: say("exam_left", { s: num(this.until - now, 0) }), head: say("exam_runs"), sub, more };
    }
    const { results } = this;
    const head = say("exam_told", { right: num(results.filter((one) => one.right).length, 0), count: num(this.faults.length, 0) });
    const cells = ({ t, fault, answer, right }) =>
      [num(t - this.from, 0), fault ? describe(fault) : "–", answer ? say("a_" + answer.name) : "–", `${right ? "✓" : "✗"}${fault && answer ? ` ${num(answer.t - t)} s` : ""}`];
    const rows = results.map((one) => `<tr>${cells(one).map((cell) => `<td>${cell}</td>`).join("")}</tr>`).join("");
    const table = `<table class="events"><thead><tr>${["col_time", "col_fault", "col_answer", "col_result"].map((key) => `<th>${say(key)}</th>`).join("")}</tr></thead><tbody>${rows}</tbody></table>`;
    return { line: "", head, sub: "", more: `${table}<div class="row">${button("exam-save", "exam_save", true)}${button("exam-end", "close")}</div>` };
  }
}

// The answers that the parts of an exam leave.
const offered = ({ parts }) => ANSWERS.filter(({ part }) => parts.includes(part)).map(({ name }) => name);
