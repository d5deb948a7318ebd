// The course: one exercise after another, each a file (docs/exercises.md): what to look at, what to set up, what to find out, what was right.
import { EXERCISES } from "lab/exercises.js";
import { judge } from "lab/judge.js";
import { current, escape, isTube, num, say } from "lab/strings.js";

const SOON = 0.5; // s from the press to the fault
const QUIET = 2; // s without an alarm, after which what was wrong before is over
const KEY = "course"; // under which is kept what was done with full marks

export class Course {
  constructor(host, doing) {
    Object.assign(this, { host, ...doing }); // act, order, unfold, finish, open, keep
    [this.at, this.waits, this.loud] = [0, null, 0]; // the fault that waits until all is quiet; when it was not
    [this.entered, this.told] = [[], []]; // to the questions of the exercise, and what was judged of it
    this.done = new Set(this.keep.get(KEY)?.split(" "));
    host.addEventListener("click", ({ target }) => {
      const { step, do: does } = target.closest("[data-step], [data-do]")?.dataset ?? {};
      if (step) this.go(this.at + Number(step));
      if (does) this.does();
    });
    host.addEventListener("change", ({ target }) => {
      if (target.matches("select")) this.go(Number(target.value));
      else if (target.name) this.entered[Number(target.name.slice(1))] = target.value;
    });
    host.addEventListener("submit", (event) => (event.preventDefault(), this.check()));
  }

  get exercise() {
    return EXERCISES[this.at];
  }

  show(on) {
    this.host.hidden = !on;
    if (on) return this.go(this.at);
    this.waits = null;
    this.mark(null);
  }

  go(at) {
    if (at === EXERCISES.length) return this.end();
    if (at !== this.at) [this.entered, this.told] = [[], []];
    this.at = Math.max(0, at);
    this.waits = null;
    const { look, opens, scene } = this.exercise;
    if (!scene && !isTube()) return this.elsewhere();
    if (opens) this.unfold(opens);
    this.write();
    this.mark(look);
  }

  write() {
    const { title, text, button, ask = [], after } = this.exercise;
    const of = (words) => escape(words[current()]);
    const paragraphs = (words) => of(words).split("\n").map((p) => `<p>${p}</p>`).join("");
    const choice = ({ title: name, id }, i) => `<option value="${i}" ${i === this.at ? "selected" : ""}>${num(i + 1, 0)} / ${num(EXERCISES.length, 0)} ${of(name)}${this.done.has(id) ? " ✓" : ""}</option>`;
    const doing = button ? `<button class="primary" data-do="1">${of(button)}</button>` : "";
    const back = `<button class="plain" data-step="-1" ${this.at ? "" : "disabled"}>${say("tour_back")}</button>`;
    const next = `<button class="plain" data-step="1">${say(this.at < EXERCISES.length - 1 ? "tour_next" : "tour_finish")}</button>`;
    const check = ask.length ? `<div class="row"><button class="primary">${say("check")}</button><span role="status">${this.marks()}</span></div>` : "";
    const whole = ask.length && this.right === ask.length ? `<div class="text">${paragraphs(after)}</div>` : "";
    this.host.innerHTML = `<select aria-label="${say("tour")}">${EXERCISES.map(choice).join("")}</select><h2>${of(title)}</h2><div class="text">${paragraphs(text)}</div>
      <form>${ask.map((one, i) => this.question(one, i, of)).join("")}${check}</form>${whole}<div class="row">${doing}${back}${next}<span class="note" id="waits" role="status"></span></div>`;
  }

  question({ ask, unit, choices }, i, of) {
    const [entered, told] = [this.entered[i], this.told[i]];
    const said = told ? `<p class="${told.right ? "right" : "wrong"}">${say(told.right ? "answer_right" : "answer_wrong")} ${told.say ? of(told.say) : ""}</p>` : "";
    const one = (choice, k) => `<label><input type="radio" name="q${i}" value="${k}" ${entered === String(k) ? "checked" : ""}>${of(choice.is)}</label>`;
    if (choices) return `<fieldset><legend>${of(ask)}</legend>${choices.map(one).join("")}${said}</fieldset>`;
    return `<div><label>${of(ask)} <span class="entry"><input name="q${i}" inputmode="decimal" autocomplete="off" value="${escape(entered ?? "")}"> ${escape(unit ?? "")}</span></label>${said}</div>`;
  }

  get right() {
    return this.told.filter((one) => one?.right).length;
  }

  marks() {
    if (!this.told.length) return "";
    const { ask } = this.exercise;
    const lacks = this.told.some((one) => !one) ? ` ${say("answer_lacks")}` : "";
    return say("marks", { got: num(this.right, 0), of: num(ask.length, 0) }) + lacks;
  }

  check() {
    const { ask, id } = this.exercise;
    this.told = ask.map((one, i) => judge(one, this.entered[i]));
    if (this.right === ask.length) this.keep.set(KEY, [...this.done.add(id)].join(" "));
    this.write();
    this.host.querySelector("form button").focus({ preventScroll: true });
  }

  // Another scene began.
  opened() {
    this.loud = 0;
    if (!this.host.hidden) this.go(this.at);
  }

  // The first step comes next time.
  end() {
    this.at = 0;
    this.finish();
  }

  // On another plant most of what is said is not so.
  elsewhere() {
    this.host.innerHTML = `<p>${say("tour_about")}</p><div class="row"><button class="primary" data-act="paper">${say("tour_goto")}</button></div>`;
    this.mark(null);
  }

  does() {
    const { scene, at, show, does = [] } = this.exercise;
    if (scene) this.open(scene, at, show);
    for (const what of does) {
      if (typeof what === "string") this.act(what);
      else if (what.order === "break") this.waits = what;
      else this.order(what);
    }
  }

  // Puts in what waits once all has been quiet for a while, and tells what it waits for. `busy`: an alarm stands, or a fault is in.
  follow({ t, mode }, busy) {
    const monitors = mode === 3;
    if (busy || !monitors) this.loud = t;
    if (this.waits && t - this.loud >= QUIET) {
      this.order({ ...this.waits, fault: { ...this.waits.fault, at: SOON } });
      this.waits = null;
    }
    const status = this.host.querySelector("#waits");
    const text = this.waits ? say(monitors ? "tour_wait" : "tour_wait_monitor") : "";
    if (status && status.textContent !== text) status.textContent = text;
  }

  // Frames what the exercise speaks of.
  mark(look) {
    for (const node of document.querySelectorAll(".looked")) node.classList.remove("looked");
    const node = look && document.querySelector(look);
    if (!node) return;
    node.classList.add("looked");
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    document.documentElement.style.setProperty("--tour", `${this.host.offsetHeight}px`);
    node.scrollIntoView({ block: "start", behavior: calm ? "auto" : "smooth" });
  }
}
