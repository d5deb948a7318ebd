// One panel: its axis, its curves, and what they are called.
import { niceStep, spread } from "lab/canvas.js";
import { BLOCK } from "lab/store.js";
import { num, say } from "lab/strings.js";

// `shown` are its series that are on.
export function drawPanel(pen, panel, { shown, y, high, left, edge, a, b, X, at, narrow, levels }) {
  const title = say(panel.id);
  const w = pen.text(title, left, y - 8, { css: "--ink", bold: true });
  const unit = pen.text(panel.unit(), left + w + 7, y - 8, { css: "--faint" });
  if (panel.id === "temperature" && shown.some((series) => series.kept)) pen.text(say("compared"), left + w + unit + 21, y - 8, { css: "--faint" });
  const kept = shown.filter((series) => series.kept);
  const [low, top] = range(panel, [...shown, ...kept.map((series) => series.kept)], a, b);
  const Y = (v) => y + high - ((Math.min(top, Math.max(low, v)) - low) / (top - low)) * high;
  const step = niceStep(top - low, high > 100 ? 5 : 3);
  const ticks = panel.ticks ?? Array.from({ length: Math.floor((top - low) / step + 1e-6) + 1 }, (_, i) => low + i * step);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (const v of ticks) {
    pen.box(left, Math.round(Y(v)), edge - left, 1, "--hair");
    pen.text(num(v, panel.ticks ? 0 : decimals), left - 7, Y(v) + 4, { css: "--faint", align: "right" });
  }
  for (const bound of panel.bounds ?? []) pen.line(left, Y(bound), edge, Y(bound), "--soft", { dash: [5, 4] });
  for (const level of levels ?? []) if (level > low && level < top) pen.line(left, Y(level), edge, Y(level), "--faint", { dash: [1, 3] });
  const labels = [];
  pen.within(left, y - 2, edge - left, high + 4, () => {
    pen.c.globalAlpha = 0.45;
    for (const { kept: run, css } of kept) drawSeries(pen, run, a, b, X, Y, { css, width: 1 });
    pen.c.globalAlpha = 1;
    for (const series of shown) {
      drawSeries(pen, series, a, b, X, Y);
      if (series.beyond) drawBeyond(pen, series, a, b, X, Y);
    }
  });
  for (const series of shown) {
    const v = series.value(at);
    if (v !== v || series.silent) continue;
    const out = series.beyond && Math.abs(v) > series.beyond;
    labels.push({ y: Y(v), v, label: series.label(narrow), css: out ? "--ink" : series.css, rank: series.beyond ? Math.abs(v) : v });
  }
  if (panel.most) labels.sort((p, q) => q.rank - p.rank).splice(panel.most);
  for (const { y: place, v, label, css } of spread(labels, y + 4, y + high - 2)) {
    const value = num(v, panel.decimals);
    if (narrow) pen.text(`${label} ${value}`, edge + 6, place + 4, { css, bold: true });
    else {
      pen.text(label, edge + 8, place + 4, { css, bold: true });
      pen.text(value, pen.width, place + 4, { css, align: "right" });
    }
  }
}

// How much room a curve's name and its value need right of the axis.
export function labelWidth(pen, panel, label, value, narrow) {
  const text = num(value, panel.decimals);
  return narrow ? 6 + pen.measure(`${label} ${text}`, true) : 8 + pen.measure(label, true) + 6 + pen.measure(text);
}

// A line through every tick where each has a pixel; else from the least to the largest of each pixel, of blocks where it has many ticks.
export function drawSeries(pen, series, a, b, X, Y, style = series) {
  const ticks = (b - a) / (X(b) - X(a));
  if (ticks <= 1) pen.curve(a, b, series.value, X, Y, style.css, style);
  else if (ticks <= BLOCK) pen.band(a, b, series.value, series.value, X, Y, style.css, style);
  else pen.band(Math.ceil(a / BLOCK), Math.floor(b / BLOCK), series.low, series.high, (k) => X((k + 0.5) * BLOCK), Y, style.css, style);
}

// Where a residual is beyond its threshold it is drawn strongly.
function drawBeyond(pen, series, a, b, X, Y) {
  const beyond = (of) => (k) => {
    const v = of(k);
    return Math.abs(v) > series.beyond ? v : NaN;
  };
  const strong = { value: beyond(series.value), low: beyond(series.low), high: beyond(series.high), css: "--ink", width: 2 };
  drawSeries(pen, strong, a, b, X, Y);
}

// Between which values a panel shows what is in view: round, and no narrower than it must be.
export function range(panel, shown, a, b) {
  if (panel.range) return panel.range;
  let [low, top] = [Infinity, -Infinity];
  const many = b - a > 100 * BLOCK; // then the blocks say it
  const [from, to] = many ? [Math.ceil(a / BLOCK), Math.floor(b / BLOCK)] : [a, b];
  for (const { value, low: least = value, high: most = value } of shown) {
    for (let k = from; k <= to; k++) {
      const [v, w] = many ? [least(k), most(k)] : [value(k), value(k)];
      if (v < low) low = v;
      if (w > top) top = w;
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
