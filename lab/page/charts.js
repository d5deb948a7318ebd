// The stack of charts over one time axis, the overview below it, and the close-up of a fault.
import { Pen, colour, niceStep, spread } from "lab/canvas.js";
import { EITHER, namedAt, namings } from "lab/events.js";
import { BLOCK } from "lab/store.js";
import { num, say } from "lab/strings.js";
import { blamed, ownNames, short } from "lab/say.js";

const EXPLAINED = [
  ["x_t2_offset", "--t2"], ["x_t1_offset", "--t1"], ["x_t1_clogged", "--t1"], ["x_air_flow", "--flow"],
  ["x_heater_power", "--power"], ["x_t0_fault", "--t0"], ["x_drift", "--soft"], ["x_t1_stuck", "--soft"],
  ["x_t2_stuck", "--soft"], ["x_t1_detached", "--soft"], ["x_t2_detached", "--soft"], ["x_t1_t2_swapped", "--soft"],
  ["x_t0_t1_swapped", "--soft"], ["x_t0_t2_swapped", "--soft"],
];
export const CLASSES = EXPLAINED.map(([field, css]) => ({ field, name: field.slice(2), css }));

const one = (id, css, more = {}) => ({ id, css, field: id, ...more });
// Every panel: its curves, and between which values it shows them. `least` is the smallest range that it shows.
const PANELS = [
  {
    id: "temperature", unit: () => "°C", high: [150, 132], least: 4, decimals: 1,
    series: [
      one("setpoint", "--ink", { dash: [5, 4], width: 1, label: (narrow) => say(narrow ? "setpoint_short" : "setpoint") }),
      one("t1_expected", "--t1", { dash: [2, 3], width: 1.1, label: () => "T1 " + say("expected"), silent: true }),
      one("t2_expected", "--t2", { dash: [2, 3], width: 1.1, label: () => "T2 " + say("expected"), silent: true }),
      one("t0", "--t0", { label: () => "T0", off: true }),
      one("t1", "--t1", { label: () => "T1" }),
      one("t2", "--t2", { label: () => "T2" }),
    ],
  },
  {
    id: "power", unit: () => "%", high: [70, 62], least: 30, decimals: 1,
    series: [
      one("drive", "--soft", { step: true, width: 1.1, label: (narrow) => say(narrow ? "sent_short" : "sent") }),
      one("pid", "--ink", { width: 1.8, label: () => "PID" }),
    ],
  },
  {
    id: "departure", unit: () => "°C", high: [70, 62], least: 2, even: true, decimals: 2,
    series: [
      one("t1_left", "--t1", { label: () => "T1" }),
      one("t2_left", "--t2", { label: () => "T2" }),
    ],
  },
  {
    id: "explained", unit: () => say("explained_unit"), high: [78, 70], range: [0, 100], ticks: [0, 50, 100], decimals: 0, verdict: true, most: 3,
    series: CLASSES.map(({ field, name, css }) => one(field, css, { scale: 100, label: () => short(name), dash: name === "t1_clogged" ? [5, 3] : [], quiet: 8 })),
  },
  {
    id: "residuals", unit: () => say("residuals_unit"), high: [84, 76], range: [-3, 3], ticks: [-3, 0, 3], bounds: [1, -1], decimals: 1, most: 3,
    series: ["rap", "ry12", "rsg1", "rsg2", "rbw1"].map((id) => one(id, "--faint", { width: 1, label: () => id, beyond: 1 })),
  },
];
// Left and right of the time axis: numbers, and what the curves are called.
const margins = (narrow) => (narrow ? [30, 66] : [38, 126]);
const RIBBON = 21;
const MOST_A_PIXEL = 4; // ticks
const TOOLS = 84; // width of what stands over the corner of the charts
const SPANS = [2, 7200]; // s

export class Charts {
  constructor(canvases, changed) {
    Object.assign(this, canvases);
    this.changed = changed;
    this.off = new Set(PANELS.flatMap((panel) => panel.series.filter((s) => s.off).map((s) => s.id)));
    this.view = { end: null, span: null };
    this.hover = null;
    this.lead = 0;
    this.listen();
  }

  use(store) {
    this.store = store;
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
  }

  follow() {
    this.view.end = null;
    this.changed();
  }

  get following() {
    return this.view.end === null;
  }

  get narrow() {
    return this.stack.parentNode.clientWidth < 480;
  }

  get span() {
    return this.view.span ?? (this.narrow ? 22 : 40);
  }

  get end() {
    return this.view.end ?? this.store.now + this.lead;
  }

  // Shows so many seconds, up to a time.
  show(end, span) {
    const least = this.store.first * this.store.ts;
    this.view.span = Math.min(SPANS[1], Math.max(SPANS[0], span));
    this.view.end = end >= this.store.now ? null : Math.max(least + 1, end);
    this.changed();
  }

  zoom(factor, t = this.end) {
    const span = Math.min(SPANS[1], Math.max(SPANS[0], this.span * factor));
    const right = (this.end - t) / this.span;
    this.show(this.following && t >= this.end - 0.02 * this.span ? Infinity : t + right * span, span);
  }

  listen() {
    const { stack, overview } = this;
    const time = (event) => this.area && this.end - this.span * (1 - (event.offsetX - this.area.left) / this.area.width);
    stack.addEventListener("wheel", (event) => {
      if (!this.store || event.ctrlKey) return;
      event.preventDefault();
      if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) this.show(this.end + (event.deltaX / this.area.width) * this.span, this.span);
      else this.zoom(1.0015 ** event.deltaY, time(event));
    }, { passive: false });
    let drag = null;
    stack.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      drag = { x: event.offsetX, end: this.end };
      stack.setPointerCapture(event.pointerId);
    });
    stack.addEventListener("pointermove", (event) => {
      if (drag && Math.abs(event.offsetX - drag.x) > 2) this.show(drag.end - ((event.offsetX - drag.x) / this.area.width) * this.span, this.span);
      this.hover = time(event);
      this.changed();
    });
    stack.addEventListener("pointerup", () => (drag = null));
    stack.addEventListener("pointerleave", () => ((this.hover = null), this.changed()));
    stack.addEventListener("dblclick", () => this.follow());
    stack.addEventListener("keydown", (event) => {
      const act = {
        ArrowLeft: () => this.show(this.end - this.span / 8, this.span),
        ArrowRight: () => this.show(this.end + this.span / 8, this.span),
        "+": () => this.zoom(0.7), "=": () => this.zoom(0.7), "-": () => this.zoom(1.4),
        Home: () => this.follow(), Escape: () => this.follow(),
      }[event.key];
      if (act) (event.preventDefault(), act());
    });
    const jump = (event) => {
      if (!this.overArea) return;
      const { left, width, from, to } = this.overArea;
      this.show(from + ((event.offsetX - left) / width) * (to - from) + this.span / 2, this.span);
    };
    overview.addEventListener("pointerdown", (event) => (overview.setPointerCapture(event.pointerId), jump(event)));
    overview.addEventListener("pointermove", (event) => event.buttons && jump(event));
  }

  // `events` of the session; `hide` what would give the quiz away.
  draw(events, hide) {
    const { store } = this;
    if (!store || store.end <= store.first) return;
    this.drawStack(events, hide);
    this.drawOverview(events, hide);
  }

  drawStack(events, hide) {
    const { store, narrow } = this;
    const k = narrow ? 1 : 0;
    const [head, gap] = [20, 12];
    const [left, right] = margins(narrow);
    const ribbons = hide ? 0 : 3;
    const total = 24 + this.panels.reduce((sum, panel) => sum + panel.high[k] + head + gap, 0) + ribbons * RIBBON + 26;
    const pen = new Pen(this.stack, total);
    const width = pen.width - left - right;
    this.area = { left, width };
    const [t1, t0] = [this.end, this.end - this.span];
    const X = (tick) => left + ((tick * store.ts - t0) / (t1 - t0)) * width;
    const T = (t) => left + ((t - t0) / (t1 - t0)) * width;
    const a = Math.max(store.first, Math.floor(t0 / store.ts) - 1);
    const b = Math.min(store.last, Math.ceil(t1 / store.ts));
    const hovered = this.hover === null ? null : Math.min(b, Math.max(a, store.tickAt(this.hover)));
    const edge = left + width;
    const bottom = total - 26;
    if (!hide) {
      for (const event of events.list) {
        if (!event.truth || event.from > t1 || (event.to ?? Infinity) < t0) continue;
        const [x, e] = [T(Math.max(event.from, t0)), T(Math.min(event.to ?? t1, t1))];
        pen.box(x, 24, e - x, bottom - 24, "--shade");
      }
    }
    let y = 24;
    for (const panel of this.panels) {
      const high = panel.high[k];
      this.drawPanel(pen, panel, { y: y + head, high, left, edge, a, b, X, at: hovered ?? Math.min(b, store.last), narrow, hide });
      y += head + high + gap;
    }
    if (!hide) this.drawRibbons(pen, events, { y: y - 4, left, edge, a, b, X, T, t0, t1, narrow });
    this.drawFlags(pen, events, { hide, T, t0, t1, edge, left, bottom });
    if (hovered !== null && store.has(hovered)) {
      const x = Math.round(X(hovered)) + 0.5;
      pen.line(x, 20, x, bottom, "--faint");
      const text = `${num(hovered * store.ts, 2)} s`;
      const w = pen.measure(text, true) + 12;
      const place = Math.min(edge - w, Math.max(left, x - w / 2));
      pen.box(place, 1, w, 18, "--ink", 4);
      pen.text(text, place + 6, 14, { css: "--bg", bold: true });
    }
    const step = niceStep(t1 - t0, narrow ? 4 : 8);
    for (let t = Math.ceil(Math.max(0, t0) / step) * step; t <= t1; t += step) {
      const x = T(t);
      pen.box(Math.round(x), bottom, 1, 4, "--faint");
      if (x < edge - 6) pen.text(num(t, step < 1 ? 1 : 0), x, bottom + 17, { css: "--faint", align: "center" });
    }
    pen.text("s", edge + 8, bottom + 17, { css: "--faint" });
  }

  drawPanel(pen, panel, { y, high, left, edge, a, b, X, at, narrow, hide }) {
    const title = say(panel.id);
    const w = pen.text(title, left, y - 8, { css: "--ink", bold: true });
    pen.text(panel.unit(), left + w + 7, y - 8, { css: "--faint" });
    const shown = panel.series.filter((series) => !this.off.has(series.id));
    const [low, top] = this.range(panel, shown, a, b);
    const Y = (v) => y + high - ((Math.min(top, Math.max(low, v)) - low) / (top - low)) * high;
    const step = niceStep(top - low, high > 100 ? 5 : 3);
    const ticks = panel.ticks ?? Array.from({ length: Math.floor((top - low) / step + 1e-6) + 1 }, (_, i) => low + i * step);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    for (const v of ticks) {
      pen.box(left, Math.round(Y(v)), edge - left, 1, "--hair");
      pen.text(num(v, panel.ticks ? 0 : decimals), left - 7, Y(v) + 4, { css: "--faint", align: "right" });
    }
    if (panel.verdict && hide) {
      pen.text(say("hidden"), (left + edge) / 2, y + high / 4 + 4, { css: "--faint", align: "center" });
      return;
    }
    for (const bound of panel.bounds ?? []) pen.line(left, Y(bound), edge, Y(bound), "--soft", { dash: [5, 4] });
    const labels = [];
    pen.within(left, y - 2, edge - left, high + 4, () => {
      for (const series of shown) {
        this.drawSeries(pen, series, a, b, X, Y);
        if (series.beyond) this.drawBeyond(pen, series, a, b, X, Y);
      }
    });
    for (const series of shown) {
      const v = series.value(at);
      if (v !== v || series.silent || (series.quiet && v < series.quiet)) continue;
      const out = series.beyond && Math.abs(v) > series.beyond;
      labels.push({ y: Y(v), v, label: series.label(narrow), css: out ? "--ink" : series.css, rank: series.beyond ? Math.abs(v) : v });
    }
    if (panel.most) labels.sort((p, q) => q.rank - p.rank).splice(panel.most);
    if (panel.verdict && !labels.length) pen.text(say("nothing_to_explain"), edge - 8, y + high / 4 + 4, { css: "--faint", align: "right" });
    for (const { y: place, v, label, css } of spread(labels, y + 4, y + high - 2)) {
      const value = num(v, panel.decimals);
      if (narrow) pen.text(panel.verdict ? value : `${label} ${value}`, edge + 6, place + 4, { css, bold: true });
      else {
        const room = pen.width - edge - 8 - pen.measure(value) - 6;
        pen.within(edge, place - 12, room + 8, 22, () => pen.text(label, edge + 8, place + 4, { css, bold: true }));
        pen.text(value, pen.width, place + 4, { css, align: "right" });
      }
    }
  }

  // Every tick where there is room for it, else blocks.
  drawSeries(pen, series, a, b, X, Y, style = series) {
    if (b - a < MOST_A_PIXEL * (X(b) - X(a))) pen.curve(a, b, series.value, X, Y, style.css, style);
    else pen.band(Math.ceil(a / BLOCK), Math.floor(b / BLOCK), series.low, series.high, (k) => X((k + 0.5) * BLOCK), Y, style.css, style);
  }

  // Where a residual is beyond its threshold it is drawn strongly.
  drawBeyond(pen, series, a, b, X, Y) {
    const beyond = (of) => (k) => {
      const v = of(k);
      return Math.abs(v) > series.beyond ? v : NaN;
    };
    const strong = { value: beyond(series.value), low: beyond(series.low), high: beyond(series.high), css: "--ink", width: 2 };
    this.drawSeries(pen, strong, a, b, X, Y);
  }

  // Between which values a panel shows what is in view: round, and no narrower than it must be.
  range(panel, shown, a, b) {
    if (panel.range) return panel.range;
    let [low, top] = [Infinity, -Infinity];
    const stride = Math.max(1, Math.floor((b - a) / 2000));
    for (const series of shown) {
      for (let k = a; k <= b; k += stride) {
        const v = series.value(k);
        if (v < low) low = v;
        if (v > top) top = v;
      }
    }
    if (low > top) [low, top] = [0, panel.least];
    if (panel.even) {
      top = Math.max(top, -low, panel.least / 2);
      low = -top;
    }
    const lack = Math.max(0, panel.least - (top - low)) / 2;
    const step = niceStep(top - low + 2 * lack, panel.even ? 2 : 4);
    return [Math.floor((low - lack) / step + 1e-6) * step, Math.ceil((top + lack) / step - 1e-6) * step];
  }

  drawRibbons(pen, events, { y, left, edge, a, b, X, T, t0, t1, narrow }) {
    const { store } = this;
    const put = (name, top) => {
      pen.text(name, edge + 8, top + 12, { css: "--soft" });
      pen.box(left, top, edge - left, 16, "--well", 2);
    };
    const bar = (from, to, text, css, top) => {
      const [x, e] = [Math.max(left, from), Math.min(edge, to)];
      if (e <= x) return;
      pen.box(x, top, Math.max(2, e - x), 16, css, 2);
      if (pen.measure(text) + 10 < e - x) pen.text(text, x + 6, top + 12, { css: "--bg" });
    };
    put(say("truth"), y);
    for (const event of events.list.filter((e) => e.truth)) bar(T(event.from), T(event.to ?? t1), event.label(), "--soft", y);
    const runs = (top, word, css) => {
      let [from, text] = [0, ""];
      const stride = Math.max(1, Math.floor((b - a) / (2 * (edge - left))));
      for (let k = a; k <= b + stride; k += stride) {
        const now = k <= b ? word(k) : "";
        if (now === text) continue;
        if (text) bar(X(from), X(k), text, css, top);
        [from, text] = [k, now];
      }
    };
    put(say(narrow ? "likelihood_short" : "likelihood"), y + RIBBON);
    const names = events.names;
    const said = (k) => (store.get(k, "alarm") > 0 ? short(names.get(store.get(k, "class"))) : "");
    runs(y + RIBBON, said, "--alarm");
    put(narrow ? "fdv fiv" : say("fdv_fiv"), y + 2 * RIBBON);
    const paper = (k) => {
      const [fdv, fiv] = [store.get(k, "fdv"), store.get(k, "fiv")];
      if (!(fdv > 0)) return "";
      return fiv > 0 ? `${fdv}, ${fiv} ${["T2", "T1", say("paper_says_3")][fiv - 1] ?? ownNames.get(fiv) ?? ""}` : say("paper_unnamed");
    };
    runs(y + 2 * RIBBON, paper, "--soft");
  }

  // When the last fault in view was put in, and when it was named.
  drawFlags(pen, events, { hide, T, t0, t1, edge, left, bottom }) {
    if (hide) return;
    const event = events.list.findLast((e) => e.from <= t1 && (namedAt(e) ?? e.alarm ?? e.from) >= t0);
    if (!event) return;
    const mark = (t, css, dash) => {
      if (!(t >= t0 && t <= t1)) return;
      const x = Math.round(T(t)) + 0.5;
      pen.line(x, 18, x, bottom, css, { dash, width: 1.2 });
    };
    const names = namings(event);
    const flags = names.map(({ name, t }) => ({ t, text: name === EITHER ? short(name) : say("named_s", { s: num(t - event.from, 2) }) }));
    if (!flags.length && event.alarm !== undefined) flags.push({ t: event.alarm, text: say("alarm_s", { s: num(event.alarm - event.from, 2) }) });
    if (event.truth) mark(event.from, "--soft", [2, 3]);
    mark(event.isolated, "--soft", [2, 3]);
    for (const { t } of flags) mark(t, "--alarm", []);
    const seen = flags.filter(({ t }) => t >= t0 && t <= t1);
    if (this.hover !== null || !seen.length) return;
    const wide = seen.map(({ text }) => pen.measure(text, true) + 14);
    // Each at its line, but none over another, nor beyond the edge.
    const places = seen.map(({ t }) => T(t));
    places.forEach((x, i) => i && (places[i] = Math.max(x, places[i - 1] + wide[i - 1] + 3)));
    for (let i = places.length - 1, most = edge; i >= 0; i--) {
      places[i] = Math.min(places[i], most - wide[i]);
      most = places[i] - 3;
    }
    seen.forEach(({ text }, i) => {
      pen.box(places[i], 1, wide[i], 18, "--alarm", 4);
      pen.text(text, places[i] + 7, 14, { css: "--bg", bold: true });
    });
    if (event.truth) {
      const start = Math.min(T(event.from), places[0]) - 6;
      if (start - pen.measure(say("put_in")) > left) pen.text(say("put_in"), start, 14, { align: "right" });
    }
    if (event.isolated <= t1) {
      const paper = say("paper_s", { s: num(event.isolated - event.from, 2) });
      const place = Math.max(T(event.isolated), places[places.length - 1] + wide[wide.length - 1]) + 7;
      if (place + pen.measure(paper) < pen.width - TOOLS) pen.text(paper, place, 14);
    }
  }

  drawOverview(events, hide) {
    const { store, narrow } = this;
    const pen = new Pen(this.overview, 48);
    const [left, right] = margins(narrow);
    const width = pen.width - left - right;
    const from = store.first * store.ts;
    const to = Math.max(store.now, from + 60);
    this.overArea = { left, width, from, to };
    const X = (tick) => left + ((tick * store.ts - from) / (to - from)) * width;
    const T = (t) => X(t / store.ts);
    pen.box(left, 0, width, 32, "--well", 4);
    const [low, top] = this.range({ least: 6 }, PANELS[0].series.filter((s) => s.id === "t1" || s.id === "t2"), store.first, store.last);
    const Y = (v) => 29 - ((Math.min(top, Math.max(low, v)) - low) / (top - low)) * 26;
    for (const id of ["t2", "t1"]) {
      const series = PANELS[0].series.find((s) => s.id === id);
      this.drawSeries(pen, series, store.first, store.last, X, Y, { css: series.css, width: 1 });
    }
    for (const event of events.list) {
      if (hide && event === events.last) continue;
      const [x, e] = [T(event.from), T(Math.min(event.to ?? store.now, to))];
      if (e > left) pen.box(Math.max(left, x), 0, Math.max(2, e - Math.max(left, x)), 3, "--alarm");
    }
    const [x, e] = [Math.max(left, T(this.end - this.span)), T(this.end)];
    pen.frame(x, 0.75, Math.max(4, e - x), 30.5, "--ink", 3);
    pen.text(narrow ? "" : say("whole_run"), left + width + 8, 20, { css: "--faint" });
    const step = niceStep(to - from, narrow ? 3 : 6);
    for (let t = Math.ceil(from / step) * step; t <= to; t += step) {
      if (T(t) < left + width - 8) pen.text(num(t, 0), T(t), 45, { css: "--faint", align: t === from ? "left" : "center" });
    }
    pen.text("s", left + width + 8, 45, { css: "--faint" });
  }

  // A few seconds around an event: what was measured over what was expected.
  drawCloseup(canvas, event) {
    const { store } = this;
    const high = 190;
    const pen = new Pen(canvas, high);
    const [left, right] = [28, 6];
    const from = Math.min(event.onset ?? event.from, event.from);
    const names = namings(event);
    const last = Math.max(4, Math.min(10, (names[names.length - 1]?.t ?? event.alarm ?? from) - from + 3));
    const [t0, t1] = [from - 2, from + last];
    const T = (t) => left + ((t - t0) / (t1 - t0)) * (pen.width - left - right);
    const X = (tick) => T(tick * store.ts);
    const a = Math.max(store.first, Math.ceil(t0 / store.ts));
    const b = Math.min(store.last, Math.floor(t1 / store.ts));
    const part = blamed(event.named)[0] === "T1" ? "t1" : "t2";
    const css = `--${part}`;
    const [measured, expected] = [part, `${part}_expected`].map((name) => {
      const { ring } = store;
      const at = store.at[name];
      return (tick) => ring[store.place(tick) + at];
    });
    const [low, top] = this.range({ least: 2 }, [{ value: measured }, { value: expected }], a, b);
    const Y = (v) => 160 - ((Math.min(top, Math.max(low, v)) - low) / (top - low)) * 134;
    const step = niceStep(top - low, 4);
    for (let v = low; v <= top + 1e-9; v += step) {
      pen.box(left, Math.round(Y(v)), pen.width - left - right, 1, "--hair");
      pen.text(num(v, step < 1 ? 1 : 0), left - 6, Y(v) + 4, { css: "--faint", align: "right" });
    }
    const { c } = pen;
    const start = Math.max(a, Math.ceil(from / store.ts));
    c.save();
    c.globalAlpha = 0.16;
    c.fillStyle = colour(css);
    c.beginPath();
    const both = (k) => Number.isFinite(measured(k) - expected(k));
    for (let k = start; k <= b; k++) if (both(k)) c.lineTo(X(k), Y(measured(k)));
    for (let k = b; k >= start; k--) if (both(k)) c.lineTo(X(k), Y(expected(k)));
    c.fill();
    c.restore();
    pen.curve(a, b, expected, X, Y, "--ink", { width: 1.3, dash: [2, 3] });
    pen.curve(a, b, measured, X, Y, css, { width: 2 });
    const said = names.map(({ name, t }) => [t, name === EITHER ? short(name) : say("named"), "--alarm", [], "left"]);
    if (!said.length && event.alarm !== undefined) said.push([event.alarm, say("c_alarm"), "--alarm", [], "left"]);
    const marks = [
      event.truth && [event.from, say("put_in"), "--soft", [2, 3], "right"],
      ...said,
      event.isolated !== undefined && [event.isolated, say("paper"), "--soft", [2, 3], "left"],
    ].filter((mark) => mark && mark[0] <= t1 && mark[0] <= store.now);
    let taken = 0;
    for (const [t, text, ink, dash, side] of marks) {
      const x = Math.round(T(t)) + 0.5;
      pen.line(x, 20, x, 162, ink, { dash, width: 1.4 });
      const place = side === "right" ? x - 5 : Math.max(x + 2, taken);
      if (place + (side === "left" ? pen.measure(text) : 0) < pen.width) pen.text(text, place, 13, { css: ink, align: side, bold: ink === "--alarm" });
      if (side === "left") taken = place + pen.measure(text, true) + 8;
    }
    pen.text(part.toUpperCase(), left + 4, 34, { css, bold: true });
    for (let s = -2; s <= last; s += 2) {
      pen.text(`${s > 0 ? "+" : ""}${num(s, 0)} s`, T(from + s), 180, { css: "--faint", align: s === -2 ? "left" : s + 2 > last ? "right" : "center" });
    }
  }

  // The curves that can be shown or not, for the list of them.
  get choices() {
    return (this.panels ?? PANELS).map((panel) => ({
      title: say(panel.id),
      series: panel.series.filter((s) => !s.quiet).map((s) => ({ id: s.id, label: s.label(), css: s.css, on: !this.off.has(s.id) })),
    })).filter((group) => group.series.length);
  }

  toggle(id, on) {
    if (on) this.off.delete(id);
    else this.off.add(id);
    this.changed();
  }
}
