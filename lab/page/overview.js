// The whole run on one line, with what is in view marked on it.
import { niceStep } from "lab/canvas.js";
import { drawSeries, range } from "lab/panel.js";
import { num, say } from "lab/strings.js";

// Gives back where its axis lies.
export function drawOverview(pen, { store, events, series, view, margins: [left, right], narrow, hide }) {
  const width = pen.width - left - right;
  const from = store.first * store.ts;
  const to = Math.max(store.now, from + 60);
  const X = (tick) => left + ((tick * store.ts - from) / (to - from)) * width;
  const T = (t) => X(t / store.ts);
  pen.box(left, 0, width, 32, "--well", 4);
  const [low, top] = range({ least: 6 }, series, store.first, store.last);
  const Y = (v) => 29 - ((Math.min(top, Math.max(low, v)) - low) / (top - low)) * 26;
  for (const one of series) drawSeries(pen, one, store.first, store.last, X, Y, { css: one.css, width: 1 });
  for (const event of events.list) {
    if (hide?.(event)) continue;
    const [x, e] = [T(event.from), T(Math.min(event.to ?? store.now, to))];
    if (e > left) pen.box(Math.max(left, x), 0, Math.max(2, e - Math.max(left, x)), 3, "--alarm");
  }
  const [x, e] = [Math.max(left, T(view.end - view.span)), T(view.end)];
  pen.frame(x, 0.75, Math.max(4, e - x), 30.5, "--ink", 3);
  pen.text(narrow ? "" : say("whole_run"), left + width + 8, 20, { css: "--faint" });
  const step = niceStep(to - from, narrow ? 3 : 6);
  for (let t = Math.ceil(from / step) * step; t <= to; t += step) {
    if (T(t) < left + width - 8) pen.text(num(t, 0), T(t), 45, { css: "--faint", align: t === from ? "left" : "center" });
  }
  pen.text("s", left + width + 8, 45, { css: "--faint" });
  return { left, width, from, to };
}
