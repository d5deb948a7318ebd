// The sheet in which a part's fault is chosen: which, how much, for how long.
import { FOREVER, PARTS, signed, sized } from "lab/faults.js";
import { num, say } from "lab/strings.js";

const DURATIONS = [5, 10, 15, 25, 40, 60, 120, 600, FOREVER];

export class Sheet {
  constructor(form, { order, slow, heat, closed }) {
    Object.assign(this, { form, order, slow, heat, closed });
    this.part = null;
    [this.sizes, this.durations] = [{}, {}];
    form.addEventListener("submit", (event) => (event.preventDefault(), this.breakIt()));
    form.addEventListener("keydown", (event) => event.key === "Escape" && this.close());
    form.addEventListener("click", ({ target }) => target.closest(".x") && this.close());
    form.addEventListener("input", ({ target }) => this.changed(target));
  }

  open(part, place) {
    if (this.part === part) return this.close();
    [this.part, this.place, this.kind] = [part, place, Object.keys(PARTS[part])[0]];
    this.build();
    this.form.querySelector("input")?.focus({ preventScroll: true });
  }

  close() {
    const { part } = this;
    this.part = null;
    this.form.hidden = true;
    this.closed(part);
  }

  get chosen() {
    const kind = PARTS[this.part][this.kind];
    return { ...kind, size: sized(kind.size, this.heat()) };
  }

  get size() {
    return this.sizes[`${this.part} ${this.kind} ${this.heat()}`] ?? this.chosen.size?.value;
  }

  // Its place in the list.
  get duration() {
    return this.durations[`${this.part} ${this.kind}`] ?? DURATIONS.indexOf(this.chosen.last ?? 25);
  }

  build() {
    const { part, kind, chosen, form } = this;
    const [title, more] = say("part_" + part).split(", ");
    const chips = Object.entries(PARTS[part]).map(
      ([id, { verb }]) => `<label><input type="radio" name="kind" value="${id}" ${id === kind ? "checked" : ""}><span>${say(verb)}</span></label>`,
    );
    const { min, max, step } = chosen.size ?? {};
    const slider = chosen.size
      ? `<label class="slide"><span>${say("by")}</span><input type="range" name="size" min="${min}" max="${max}" step="${step}" value="${this.size}"><output id="size"></output></label>`
      : "";
    form.innerHTML = `<h2>${title}${more ? ` <small>${more}</small>` : ""}</h2><button type="button" class="x" aria-label="${say("close")}">✕</button>
      <div class="chips" role="radiogroup" aria-label="${title}">${chips.join("")}</div>${slider}
      <label class="slide"><span>${say("lasting")}</span><input type="range" name="for" min="0" max="${DURATIONS.length - 1}" value="${this.duration}"><output id="for"></output></label>
      <div class="row"><button class="primary">${say("break_it")}</button></div>`;
    form.hidden = false;
    form.setAttribute("aria-label", say("break_part", { part: say("part_" + part) }));
    this.label();
    this.arrange();
    this.form.scrollIntoView({ block: "nearest" });
  }

  // Under its part, within the drawing; on a narrow screen at its foot (by the style sheet).
  arrange() {
    const { width, height } = this.form.parentNode.getBoundingClientRect();
    this.form.style.left = `${Math.max(0, Math.min(width - 336, this.place.x * width - 168))}px`;
    this.form.style.top = `${Math.min(height, this.place.y * height + 8)}px`;
  }

  label() {
    const out = (id, text) => {
      const node = this.form.querySelector("#" + id);
      if (!node) return;
      node.textContent = text;
      node.parentNode.querySelector("input").setAttribute("aria-valuetext", text);
    };
    if (this.chosen.size) out("size", signed(Number(this.size), this.chosen.size));
    const s = DURATIONS[this.duration];
    out("for", s === FOREVER ? say("until_mended") : `${num(s * this.slow(), 0)} s`);
  }

  changed({ name, value }) {
    if (name === "kind") {
      this.kind = value;
      this.build();
      this.form.querySelector("input:checked").focus({ preventScroll: true });
    }
    if (name === "size") this.sizes[`${this.part} ${this.kind} ${this.heat()}`] = Number(value);
    if (name === "for") this.durations[`${this.part} ${this.kind}`] = Number(value);
    if (name !== "kind") this.label();
  }

  breakIt() {
    const fault = { ...this.chosen.fault(Number(this.size)), at: 0, for: DURATIONS[this.duration] };
    this.close();
    this.order({ order: "break", fault });
  }
}
