// A guided tour: what to look at, what to do, what to have seen. Steps are data; their words are in tour_steps.js.
import { STEPS } from "lab/tour_steps.js";
import { current, num, say } from "lab/strings.js";

export class Tour {
  constructor(host, doing) {
    Object.assign(this, { host, ...doing }); // act, order, again, busy
    this.at = 0;
    host.addEventListener("click", ({ target }) => {
      const by = Number(target.closest("[data-step]")?.dataset.step);
      if (by) this.go(this.at + by);
      const does = target.closest("[data-do]");
      if (does) this.does();
    });
  }

  show(on) {
    this.host.hidden = !on;
    if (on) this.go(this.at);
    else this.mark(null);
  }

  go(step) {
    this.at = Math.min(STEPS.length - 1, Math.max(0, step));
    const { title, text, button, look } = STEPS[this.at];
    const words = (pair) => pair[current() === "pt" ? 1 : 0];
    const doing = button ? `<button class="primary" data-do="1">${words(button)}</button>` : "";
    const back = `<button class="plain" data-step="-1" ${this.at ? "" : "disabled"}>${say("tour_back")}</button>`;
    const next = `<button class="plain" data-step="1" ${this.at < STEPS.length - 1 ? "" : "disabled"}>${say("tour_next")}</button>`;
    this.host.innerHTML = `<p class="note">${num(this.at + 1, 0)} / ${num(STEPS.length, 0)}</p><h2>${words(title)}</h2><div class="text">${words(text)
      .split("\n")
      .map((p) => `<p>${p}</p>`)
      .join("")}</div><div class="row">${doing}${back}${next}</div>`;
    this.mark(look);
    this.again();
  }

  // What still is wrong is mended, and has some seconds to be over.
  does() {
    const at = this.busy() ? 9 : 0.5;
    for (const what of STEPS[this.at].does ?? []) {
      if (typeof what === "string") this.act(what);
      else this.order({ ...what, fault: { ...what.fault, at } });
    }
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
