// The stack of charts over one time axis, and the overview below it. Drawn is only what can be seen and has changed by a pixel.
import { Pen, niceStep } from "lab/canvas.js";
import { drawOverview } from "lab/overview.js";
import { Kept } from "lab/store.js";
import { drawPanel, labelWidth } from "lab/panel.js";
import { PANELS } from "lab/panels.js";
import { RIBBON, RIBBONS, drawFlags, drawRibbons } from "lab/ribbons.js";
import { lab } from "lab/state.js";
import { num, say } from "lab/strings.js";
import { View } from "lab/view.js";

const [TOP, HEAD, GAP, FOOT] = [24, 20, 12, 26];
// What of two runs is drawn together: what was measured and done.
const COMPARED = PANELS.filter((panel) => !panel.range).flatMap((panel) => panel.series.filter((series) => !series.dash));
const LEAST_MOVE = 0.5; // pixels

export class Charts extends View {
  constructor(canvases, changed) {
    super(canvases, changed);
    this.off = new Set(PANELS.flatMap((panel) => panel.series.filter((s) => s.off).map((s) => s.id)));
    this.drawn = null; // what the canvas shows
    this.cursors = this.levels = null; // of a measurement: name and tick of each; what is drawn across the first panel
    this.kept = null; // the run that others are compared with
    this.unseen = new Set();
    const watch = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) this.unseen[isIntersecting ? "delete" : "add"](target);
      changed();
    }, { rootMargin: "300px" }); // before it is scrolled to
    for (const canvas of Object.values(canvases)) watch.observe(canvas);
  }

  use(store, { kind }) {
    this.store = store;
    this.real = kind === "board";
    this.follow();
    // A recording lacks what was not recorded.
    this.panels = PANELS.filter((panel) => panel.series.some((series) => series.field in store.at));
    for (const panel of this.panels) {
      for (const series of panel.series) {
        const { ring, low, high } = store;
        const [at, scale] = [store.at[series.field], series.scale ?? 1];
        series.value = (tick) => ring[store.place(tick) + at] * scale;
        series.low = (block) => low[store.block(block) + at] * scale;
        series.high = (block) => high[store.block(block) + at] * scale;
      }
    }
    this.bind();
  }

  // Whether time has moved the picture so far that it would look otherwise.
  get moved() {
    const { drawn, area } = this;
    return !drawn || Math.abs(this.end - drawn.end) * (area?.width ?? 0) * devicePixelRatio >= LEAST_MOVE * this.span;
  }

  // `events` of the session; `hide` what would give the quiz away.
  draw(events, hide) {
    const { store } = this;
    if (!store || store.end <= store.first) return;
    if (!this.unseen.has(this.stack)) this.drawStack(events, hide);
    this.drawn = { end: this.end };
  }

  // All of it, be it seen or not.
  print(events, hide) {
    this.unseen.clear();
    this.draw(events, hide);
    this.drawOverview(events, hide);
  }

  drawOverview(events, hide) {
    const { store, narrow, panels } = this;
    if (!store || store.end <= store.first || this.unseen.has(this.overview)) return;
    const series = ["t2", "t1"].map((id) => panels[0].series.find((s) => s.id === id));
    const pen = new Pen(this.overview, 48);
    this.overArea = drawOverview(pen, { store, events, series, view: this, margins: this.margins(pen), narrow, hide });
  }

  // Left and right of the time axis: numbers, and what the curves are called, as wide as the letters make the widest of them.
  margins(pen) {
    const { narrow } = this;
    const names = this.panels.flatMap((panel) => panel.series.filter((s) => !s.silent).map((s) => labelWidth(pen, panel, s.label(narrow), -88.8, narrow)));
    return [7 + pen.measure(num(-88.8, 1)), Math.max(...names, ...this.ribbons.map(({ name }) => name(narrow)).map((name) => 8 + pen.measure(name)))];
  }

  // What is in view on another canvas, of so many pixels for each of the page's; its size.
  drawOn(canvas, events, ratio = 1) {
    const { clientWidth: width } = this.stack.parentNode;
    return this.drawStack(events, null, canvas, width, ratio);
  }

  // Keeps the numbers of a store to be seen beside those of the next runs; null forgets them.
  compare(store) {
    this.kept = store && new Kept(store, COMPARED.map((series) => series.field));
    this.bind();
    this.changed();
  }

  // The kept run, where it has the present one's times.
  bind() {
    const kept = this.kept?.ts === this.store.ts ? this.kept : null;
    for (const series of COMPARED) series.kept = kept?.of(series.field, series.scale) ?? null;
  }

  drawStack(events, hide, canvas = this.stack, ...size) {
    const { store, narrow } = this;
    const k = narrow ? 1 : 0;
    const shown = (panel) => panel.series.filter((series) => !this.off.has(series.id));
    const panels = this.panels.filter((panel) => shown(panel).length && (!panel.fold || lab.open.has(panel.fold)));
    const ribbons = hide ? [] : this.ribbons;
    const heights = panels.map((panel) => panel.high[k] + HEAD + GAP);
    const total = TOP + heights.reduce((sum, high) => sum + high, 0) + ribbons.length * RIBBON + FOOT;
    const pen = new Pen(canvas, total, ...size);
    const [left, right] = this.margins(pen);
    const width = pen.width - left - right;
    this.area = { left, width };
    const [t1, t0] = [this.end, this.end - this.span];
    const T = (t) => left + ((t - t0) / (t1 - t0)) * width;
    const X = (tick) => T(tick * store.ts);
    const a = Math.max(store.first, Math.floor(t0 / store.ts) - 1);
    const b = Math.min(store.last, Math.ceil(t1 / store.ts));
    const hovered = this.hover === null ? null : Math.min(b, Math.max(a, store.tickAt(this.hover)));
    const on = { left, edge: left + width, bottom: total - FOOT, a, b, X, T, t0, t1, narrow, hide };
    if (!hide) shade(pen, events, on);
    let y = TOP;
    panels.forEach((panel, i) => {
      drawPanel(pen, panel, { ...on, shown: shown(panel), y: y + HEAD, high: panel.high[k], at: hovered ?? b, levels: i === 0 ? this.levels : null });
      y += heights[i];
    });
    if (!hide) {
      drawRibbons(pen, ribbons, events, store, { ...on, y: y - 4 });
      drawFlags(pen, events, { ...on, hovers: hovered !== null });
    }
    if (hovered !== null && store.has(hovered)) drawHand(pen, hovered * store.ts, on);
    for (const [name, tick] of this.cursors ?? []) if (tick >= a && tick <= b) drawHand(pen, tick * store.ts, on, name);
    drawAxis(pen, on);
    return pen;
  }

  // What is said below the panels. What is true of a real board nobody knows.
  get ribbons() {
    return RIBBONS.filter(({ fold, truth }) => lab.open.has(fold) && !(truth && this.real));
  }

  // The curves that can be shown or not, for the list of them.
  get choices() {
    return (this.panels ?? PANELS).map((panel) => ({
      title: say(panel.id),
      series: panel.series.map((s) => ({ id: s.id, label: s.label(), css: s.css, on: !this.off.has(s.id) })),
    })).filter((group) => group.series.length);
  }

  toggle(id, on) {
    if (on) this.off.delete(id);
    else this.off.add(id);
    this.changed();
  }
}

// While something was broken.
function shade(pen, events, { T, t0, t1, bottom }) {
  for (const event of events.list) {
    if (!event.truth || event.from > t1 || (event.to ?? Infinity) < t0) continue;
    const [x, e] = [T(Math.max(event.from, t0)), T(Math.min(event.to ?? t1, t1))];
    pen.box(x, TOP, e - x, bottom - TOP, "--shade");
  }
}

// The time that is pointed at, or a cursor.
function drawHand(pen, t, { T, left, edge, bottom }, text = `${num(t, 2)} s`) {
  const x = Math.round(T(t)) + 0.5;
  pen.line(x, 20, x, bottom, "--faint");
  const w = pen.measure(text, true) + 12;
  const place = Math.min(edge - w, Math.max(left, x - w / 2));
  pen.box(place, 1, w, 18, "--ink", 4);
  pen.text(text, place + 6, 14, { css: "--bg", bold: true });
}

function drawAxis(pen, { T, t0, t1, edge, bottom, narrow }) {
  const step = niceStep(t1 - t0, narrow ? 4 : 8);
  for (let t = Math.ceil(Math.max(0, t0) / step) * step; t <= t1; t += step) {
    const x = T(t);
    pen.box(Math.round(x), bottom, 1, 4, "--faint");
    if (x < edge - 6) pen.text(num(t, step < 1 ? 1 : 0), x, bottom + 17, { css: "--faint", align: "center" });
  }
  pen.text("s", edge + 8, bottom + 17, { css: "--faint" });
}
