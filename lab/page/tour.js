// A guided tour: what to look at, what to do, what to have seen. Steps are data (tour_steps.js); their words are those of the language.
import { STEPS } from "lab/tour_steps.js";
import { isTube, num, say, stepWords } from "lab/strings.js";

const SOON = 0.5; // s from the press to the fault
const QUIET = 2; // s without an alarm, after which what was wrong before is over

export class Tour {
  constructor(host, doing) {
    Object.assign(this, { host, ...doing }); // act, order, unfold, finish
    [this.at, this.waits, this.loud] = [0, null, 0]; // the fault that waits until all is quiet; when it was not
    host.addEventListener("click", ({ target }) => {
      const { step, do: does } = target.closest("[data-step], [data-do]")?.dataset ?? {};
      if (step) this.go(this.at + Number(step));
      if (does) this.does();
    });
  }

  show(on) {
    this.host.hidden = !on;
    if (on) return this.go(this.at);
    this.waits = null;
    this.mark(null);
  }

  go(step) {
    if (step === STEPS.length) return this.end();
    this.at = Math.max(0, step);
    this.waits = null;
    if (!isTube()) return this.elsewhere();
    const { id, look, opens } = STEPS[this.at];
    if (opens) this.unfold(opens);
    const [title, text, button] = stepWords(id);
    const doing = button ? `<button class="primary" data-do="1">${button}</button>` : "";
    const back = `<button class="plain" data-step="-1" ${this.at ? "" : "disabled"}>${say("tour_back")}</button>`;
    const next = `<button class="plain" data-step="1">${say(this.at < STEPS.length - 1 ? "tour_next" : "tour_finish")}</button>`;
    const paragraphs = text.split("\n").map((p) => `<p>${p}</p>`).join("");
    this.host.innerHTML = `<p class="note">${num(this.at + 1, 0)} / ${num(STEPS.length, 0)}</p><h2>${title}</h2><div class="text">${paragraphs}</div><div class="row">${doing}${back}${next}<span class="note" role="status"></span></div>`;
    this.mark(look);
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

  // On another plant most of what the steps say is not so.
  elsewhere() {
    this.host.innerHTML = `<p>${say("tour_about")}</p><div class="row"><button class="primary" data-act="paper">${say("tour_goto")}</button></div>`;
    this.mark(null);
  }

  does() {
    for (const what of STEPS[this.at].does ?? []) {
      if (typeof what === "string") this.act(what);
      else this.waits = what;
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
    const status = this.host.querySelector("[role=status]");
    const text = this.waits ? say(monitors ? "tour_wait" : "tour_wait_monitor") : "";
    if (status && status.textContent !== text) status.textContent = text;
  }

  // Frames what the step speaks of.
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
