// The drawing of the rig: built once for a width, then only attributes change, so that clicks and focus stay.
import { PLANTS } from "lab/plants.js";
import { num, say } from "lab/strings.js";

const WIDE = {
  size: [820, 300], tube: [92, 800, 104, 190], hub: 142, coil: [232, 322], turns: 5, T0: 56, T1: 540, T2: 704,
  box: [330, 240, 172, 50], mains: [112, 240], door: [14, 240], lanes: 30,
};
const NARROW = {
  size: [368, 300], tube: [4, 364, 104, 176], hub: 42, coil: [86, 142], turns: 3, T0: 56, T1: 230, T2: 320,
  box: [122, 232, 97, 50], mains: [48, 238], door: [0, 238], lanes: 14,
};
// Where a narrow drawing's x lies in a wide one.
const far = (x) => 121 + 1.822 * x;
const tube = ({ tube: [x0, x1, y0, y1], ...more }) => ({
  ...more, tube: [x0, x1, y0, y1], stretch: null,
  warm: `M${x0} ${y0}H${x1}V${y1}H${x0}z`, lines: [["wall", `M${x0} ${y0}H${x1}M${x0} ${y1}H${x1}`]],
});
const narrow = (plant) => ({ ...NARROW, ...plant, stretch: null });
function wide(plant) {
  const { hub, coil, T1, T2, box } = NARROW;
  const [x0, x1, y0, y1] = plant.tube;
  const places = { hub: far(hub), coil: coil.map(far), T1: far(T1), T2: far(T2), box: [far(box[0]), 240, 172, 50], tube: [far(x0), far(x1), y0, y1] };
  return { ...WIDE, ...plant, ...places, stretch: `translate(${far(0)} 0) scale(1.822 1)` };
}
// Of every plant the wide and the narrow drawing.
const LAYOUTS = new Map(Object.entries(PLANTS).map(([name, plant]) => [name, [wide(plant), narrow(plant)]]));
const TUBE = [tube(WIDE), tube(NARROW)];
const FLOW = 60; // units a second at the usual flow
const RAMP = [[18, 112, 146, 184], [27, 172, 180, 180], [34, 238, 178, 106], [41, 228, 112, 48], [56, 184, 36, 60]];

// A colour for a temperature of a rig that regulates to a set-point: the ramp is for the usual 35 °C, and a hotter rig's is longer.
function warmth(measured, setpoint) {
  const celsius = RAMP[0][0] + ((measured - RAMP[0][0]) * 17) / Math.max(17, setpoint - RAMP[0][0]);
  if (!Number.isFinite(celsius)) return "var(--well)";
  let i = 1;
  while (i < RAMP.length - 1 && celsius > RAMP[i][0]) i++;
  const [a, b] = [RAMP[i - 1], RAMP[i]];
  const x = Math.min(1, Math.max(0, (celsius - a[0]) / (b[0] - a[0])));
  return `rgb(${[1, 2, 3].map((k) => Math.round(a[k] + (b[k] - a[k]) * x)).join()})`;
}

const NS = "http://www.w3.org/2000/svg";
function el(parent, tag, attributes = {}, text) {
  const node = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text != null) node.textContent = text;
  parent.append(node);
  return node;
}

export class RigDrawing {
  constructor(host, onPart) {
    [this.host, this.onPart] = [host, onPart];
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
  }

  // Draws anew where the width, the plant or the language asks for it.
  fit(plant, real, force) {
    const layout = (LAYOUTS.get(plant) ?? TUBE)[this.host.clientWidth < 560 ? 1 : 0];
    if (layout === this.layout && real === this.real && !force) return;
    [this.layout, this.real] = [layout, real];
    this.host.replaceChildren();
    this.build(layout);
  }

  build(g) {
    const [x0, x1, y0, y1] = g.tube;
    const svg = el(this.host, "svg", { viewBox: `0 0 ${g.size.join(" ")}`, role: "group", "aria-label": say("region_rig") });
    const defs = el(svg, "defs");
    const air = el(defs, "linearGradient", { id: "air" });
    const at = (x) => `${(((x - x0) / (x1 - x0)) * 100).toFixed(1)}%`;
    this.stops = [0, at(g.coil[0]), at(g.coil[1] + 16), at(g.T1), 1].map((offset) => el(air, "stop", { offset }));
    const blur = el(defs, "filter", { id: "glow", x: "-60%", y: "-60%", width: "220%", height: "220%" });
    el(blur, "feGaussianBlur", { stdDeviation: 7 });
    const tip = el(defs, "marker", { id: "tip", viewBox: "0 0 8 8", refX: 6, refY: 4, markerWidth: 8, markerHeight: 8, orient: "auto" });
    el(tip, "path", { d: "M0 .8 6.5 4 0 7.2z", class: "tip" });
    const body = el(svg, "g", g.stretch ? { transform: g.stretch } : {});
    el(body, "path", { d: g.warm, fill: "url(#air)" });
    for (const [css, d] of g.lines) el(body, "path", { d, class: css, "vector-effect": "non-scaling-stroke" });
    const clip = el(defs, "clipPath", { id: "inside" });
    el(clip, "rect", { x: x0, y: y0, width: x1 - x0, height: y1 - y0 });
    this.streaks = el(svg, "g", { class: "streaks", "clip-path": "url(#inside)" });
    this.lanes = Array.from({ length: g.lanes }, (_, i) => {
      const y = y0 + 9 + (((i * 7919) % 97) / 97) * (y1 - y0 - 18);
      return el(this.streaks, "line", { y1: y.toFixed(1), y2: y.toFixed(1) });
    });
    this.loop(svg, g);
    this.parts = {};
    this.fan(svg, g);
    this.coil(svg, g);
    this.probes = { T1: this.probe(svg, g, "T1"), T2: this.probe(svg, g, "T2") };
    this.room(svg, g);
    if (this.real) return; // of a real board's mains and door nothing is known
    this.small(svg, g, "mains", "M16 6v8M30 6v8M11 14h24v6a12 9 0 0 1-24 0zM23 29v6");
    this.small(svg, g, "door", "M12 34V4h22v30M12 4l13 5v30l-13-5");
  }

  part(svg, id, [x, y, w, h]) {
    const group = el(svg, "g", { class: "part", tabindex: 0, role: "button", "data-part": id });
    group.setAttribute("aria-label", say("break_part", { part: say("part_" + id) }));
    el(group, "rect", { class: "ring", x, y, width: w, height: h, rx: 11 });
    el(group, "rect", { class: "hit", x, y, width: w, height: h });
    const press = () => this.onPart(id, { x: (x + w / 2) / this.layout.size[0], y: (y + h) / this.layout.size[1] });
    group.addEventListener("click", press);
    group.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") (event.preventDefault(), press());
    });
    this.parts[id] = group;
    return group;
  }

  // The loop: T1 to the controller, the controller to the heater.
  loop(svg, g) {
    const [bx, by, bw, bh] = g.box;
    const [, , , y1] = g.tube;
    const middle = (g.coil[0] + g.coil[1]) / 2;
    el(svg, "path", { d: `M${g.T1} ${y1 - 26}V${by + bh / 2}H${bx + bw + 4}`, class: "wire sensed", "marker-end": "url(#tip)" });
    el(svg, "path", { d: `M${bx} ${by + bh / 2}H${middle}V${y1 + 6}`, class: "wire", "marker-end": "url(#tip)" });
    el(svg, "rect", { x: bx, y: by, width: bw, height: bh, rx: 10, class: "box" });
    el(svg, "text", { x: bx + bw / 2, y: by + 21, class: "name middle" }, say("controller"));
    this.wants = el(svg, "text", { x: bx + bw / 2, y: by + 39, class: "lab middle" });
    this.power = el(svg, "text", { x: middle + 10, y: y1 + 30, class: "val" });
  }

  fan(svg, g) {
    const [, , y0, y1] = g.tube;
    const y = (y0 + y1) / 2;
    const group = this.part(svg, "fan", [g.hub - 34, y0 - 6, 68, y1 - y0 + 12]);
    this.blades = null;
    if (g.fan) return void el(group, "path", { d: g.fan, class: "icon", transform: `translate(${g.hub - NARROW.hub} 0)` });
    el(group, "circle", { cx: g.hub, cy: y, r: 28, class: "housing" });
    this.blades = el(group, "g");
    for (const turn of [0, 120, 240]) {
      el(this.blades, "path", { d: `M${g.hub} ${y}q-13-9-2-23q14 6 2 23`, transform: `rotate(${turn} ${g.hub} ${y})`, class: "blade" });
    }
    el(group, "circle", { cx: g.hub, cy: y, r: 3.5, class: "housing" });
    this.hub = [g.hub, y];
  }

  coil(svg, g) {
    const [, , y0, y1] = g.tube;
    const [h0, h1] = g.coil;
    const group = this.part(svg, "heater", [h0 - 13, y0 - 6, h1 - h0 + 26, y1 - y0 + 12]);
    const step = (h1 - h0) / (2 * g.turns);
    let d = `M${h0} ${y1 - 13}`;
    for (let i = 1; i <= 2 * g.turns; i++) d += `L${(h0 + i * step).toFixed(1)} ${i % 2 ? y0 + 13 : y1 - 13}`;
    this.glow = el(group, "path", { d, class: "glow", filter: "url(#glow)" });
    el(group, "path", { d, class: "coil-edge" });
    this.wire = el(group, "path", { d, class: "coil" });
  }

  probe(svg, g, id) {
    const [x, [, , y0, y1]] = [g[id], g.tube];
    const wide = g.size === WIDE.size;
    const half = wide ? 58 : 44;
    const bead = (y0 + y1) / 2 + 2;
    const group = this.part(svg, id, [x - half, 12, 2 * half, bead + 4]);
    const css = id.toLowerCase();
    el(group, "line", { x1: x, x2: x, y1: 86, y2: bead, class: "stem" });
    el(group, "circle", { cx: x, cy: bead, r: 8, class: `bead ${css}` });
    el(group, "text", { x, y: 32, class: `name middle ${css}` }, id);
    const value = el(group, "text", { x, y: 56, class: "val middle" });
    const want = el(group, "text", { x, y: 76, class: "want middle" });
    return { value, want };
  }

  room(svg, g) {
    const group = this.part(svg, "T0", [g.T0 - 54, 12, 108, 88]);
    el(group, "text", { x: g.T0, y: 32, class: "name middle t0" }, `T0 ${say("room")}`);
    this.ambient = el(group, "text", { x: g.T0, y: 56, class: "val middle" });
    el(group, "circle", { cx: g.T0, cy: 80, r: 6, class: "bead t0" });
  }

  small(svg, g, id, d) {
    const [x, y] = g[id];
    const group = this.part(svg, id, [x, y, 54, 58]);
    el(group, "path", { d, class: "icon", transform: `translate(${x + 4} ${y + 2})` });
    el(group, "text", { x: x + 27, y: y + 53, class: "lab middle" }, say("part_" + id).toLowerCase());
  }

  // Shows a moment: readings, power, set-point, which part is blamed or chosen, what was expected.
  draw({ row, t, flow, blamed, chosen, wanted, off, tripped }) {
    const g = this.layout;
    const wide = g.size === WIDE.size;
    const unit = wide ? " °C" : "";
    const put = (node, text) => node.textContent !== text && (node.textContent = text);
    const read = (x) => (Number.isFinite(x) ? num(x) + unit : "–");
    // The air itself is thought to be as the models say, where they say it; after a trip, as is measured, for what they know is past.
    const order = tripped ? ["", "_expected"] : ["_expected", ""];
    const believed = (t) => order.map((more) => row[t + more]).find(Number.isFinite);
    const [room, one, two] = ["t0", "t1", "t2"].map(believed);
    (g.solid ? [one, one, one, one, two] : [room, room, one, one, two]).forEach((c, i) => this.stops[i].setAttribute("stop-color", warmth(c, row.setpoint)));
    put(this.ambient, read(row.t0));
    for (const id of ["T1", "T2"]) {
      const { value, want } = this.probes[id];
      put(value, read(row[id.toLowerCase()]));
      put(want, wanted?.part === id ? say(wide ? "expected_short" : "expected_narrow", { x: num(wanted.celsius) }) : "");
    }
    put(this.wants, off ? say("controller_off") : say(wide ? "wants" : "wants_narrow", { x: num(row.setpoint) }));
    put(this.power, `${num(row.drive, 0)} %`);
    const heat = Math.min(1, Math.max(0, row.drive / 80));
    this.glow.setAttribute("opacity", heat.toFixed(2));
    this.wire.setAttribute("stroke", `rgb(${[150 + 105 * heat, 84 + 130 * heat, 60 + 60 * heat].map(Math.round).join()})`);
    for (const [id, group] of Object.entries(this.parts)) {
      group.classList.toggle("blamed", blamed.includes(id));
      group.classList.toggle("chosen", id === chosen);
    }
    const moved = this.still.matches ? 0 : t;
    const [x0, x1] = g.tube;
    this.lanes.forEach((lane, i) => {
      const x = x0 + ((((i * 0.618 + (moved * FLOW * flow) / (x1 - x0)) % 1) + 1) % 1) * (x1 - x0);
      lane.setAttribute("x1", x.toFixed(1));
      lane.setAttribute("x2", (x + 10 * flow).toFixed(1));
    });
    this.blades?.setAttribute("transform", `rotate(${((moved * 300 * flow) % 360).toFixed(0)} ${this.hub.join(" ")})`);
  }
}
