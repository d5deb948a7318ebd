// The quiz: something breaks, hidden; you name it, then see what the instrument said. The score is kept.
import { meant, namings } from "lab/events.js";
import { ANSWERS, describe, recognise, surprise } from "lab/faults.js";
import { num, say } from "lab/strings.js";
import { short } from "lab/say.js";

const KEY = "pt326-lab-score";

export class Quiz {
  constructor() {
    this.phase = "idle";
    try {
      this.score = JSON.parse(localStorage.getItem(KEY)) ?? { you: 0, it: 0 };
    } catch {
      this.score = { you: 0, it: 0 };
    }
  }

  // Something is hidden until it has been answered.
  get hides() {
    return this.phase === "wait" || this.phase === "ask";
  }

  // Puts something in; `alarm` stands still from before, and `last` is the event before it, which is not its answer.
  start(order, alarm, heat, last) {
    const fault = surprise(heat);
    fault.at = 2.5 + 3 * Math.random() + (alarm ? 10 : 0);
    this.right = recognise(fault).name;
    [this.fault, this.event, this.guess, this.itSaid, this.before] = [fault, null, null, false, last];
    this.phase = "wait";
    order({ order: "mend" });
    order({ order: "break", fault });
  }

  follow(events) {
    const last = events.last;
    if (this.phase === "wait" && last !== this.before && last?.fault && last.to === undefined && last.truth) {
      this.phase = "ask";
      this.event = last;
    }
    // Air flow and heater power look alike at first: saying the one for the other is wrong, but "one of both" is not.
    if (this.event && !this.itSaid && meant(this.event.named).includes(this.right)) {
      this.itSaid = true;
      this.score.it++;
      this.keep();
    }
  }

  answer(guess) {
    if (this.phase !== "ask") return;
    this.guess = guess;
    this.phase = "told";
    if (guess === this.right) this.score.you++;
    this.keep();
  }

  keep() {
    try {
      localStorage.setItem(KEY, JSON.stringify(this.score));
    } catch {
      // A page from a file may keep nothing.
    }
  }

  end() {
    this.phase = "idle";
  }

  // What stands in place of the sentence; null where the sentence itself may stand.
  view(now) {
    const line = say("score", this.score);
    const button = (act, key, primary) => `<button class="${primary ? "primary" : "plain"}" data-act="${act}">${say(key)}</button>`;
    if (this.phase === "idle") {
      const more = `<div class="row">${button("quiz-start", "surprise", true)}</div>`;
      return { line, head: say("quiz_start_head"), sub: say("quiz_start_sub"), more };
    }
    if (this.phase === "wait") return { line, head: say("quiz_wait_head"), sub: say("quiz_wait_sub"), more: "" };
    if (this.phase === "ask") {
      const answers = ANSWERS.map(({ name }) => `<button data-act="quiz-answer" data-name="${name}">${say("a_" + name)}</button>`);
      const head = say("quiz_head", { s: num(now - this.event.from, 0) });
      return { line, head, sub: say("quiz_sub"), more: `<div class="answers">${answers.join("")}</div>` };
    }
    const { event } = this;
    const head = say(this.guess === this.right ? "quiz_right" : "quiz_wrong", { what: describe(this.fault) });
    const names = namings(event);
    const what = names.map(({ name, t }) => say("delay", { who: `“${short(name)}”`, s: num(t - event.from, 2) })).join(", ");
    const sub = names.length ? say("quiz_it", { what }) : say("quiz_it_not");
    return { line, head, sub, more: `<div class="row">${button("quiz-start", "quiz_next", true)}${button("quiz-end", "quiz_end")}</div>` };
  }
}
