// Two cursors on the charts with their readings, as on an oscilloscope. Of a step between them: its levels, and when it has done 28 and 63 %.
import { charts } from "lab/parts.js";
import { $, changed, lab, put } from "lab/state.js";
import { num, say } from "lab/strings.js";

const READ = ["t0", "t1", "t2", "drive"];
const SHARES = [0.283, 0.632]; // of the rise of a first-order lag, after a third of its time constant and after the whole
const LEVEL = 0.2; // of the time from A to B: over so much of it, before A and before B, a level is the mean
const SMOOTH = 150; // a mean over as many ticks as go so often into that time takes the noise from a crossing

let cursors = null; // ticks

// Begins, or ends.
export function measures(on) {
  if (!on) cursors = charts.cursors = charts.levels = null;
  else if (!cursors && lab.store?.end) between();
}

// Both in view, at a quarter and at three quarters.
function between() {
  const { store } = lab;
  cursors = [0.75, 0.25].map((part) => Math.min(store.last, Math.max(store.first, store.tickAt(charts.end - part * charts.span))));
}

export function measure() {
  if (!lab.open.has("measure")) return;
  const { store } = lab;
  if (!cursors?.every((tick) => store.has(tick))) between();
  [..."ab"].forEach((name, i) => {
    const from = Math.max(store.first, store.tickAt(charts.end - charts.span));
    Object.assign($(`cursor-${name}`), { min: from, max: Math.max(from + 1, Math.min(store.last, store.tickAt(charts.end))), value: cursors[i] });
    $(`cursor-${name}`).setAttribute("aria-valuetext", `${num(cursors[i] * store.ts, 2)} s`);
  });
  const step = readStep($("step-of").value, ...[...cursors].sort((a, b) => a - b));
  charts.cursors = cursors.map((tick, i) => ["AB"[i], tick]);
  charts.levels = step.levels;
  put("readings", table() + told(step));
}

// The mean of a column over ticks, without its gaps; NaN over none.
function mean(field, from, to) {
  let [sum, count] = [0, 0];
  for (let tick = from; tick <= to; tick++) {
    const v = lab.store.get(tick, field);
    if (v === v) [sum, count] = [sum + v, count + 1];
  }
  return sum / count;
}

function table() {
  const { store } = lab;
  const [a, b] = cursors;
  const at = (tick) => READ.map((field) => store.get(tick, field));
  const [first, second] = [at(a), at(b)];
  const means = READ.map((field) => mean(field, Math.min(a, b), Math.max(a, b)));
  const line = (name, t, values) => `<tr><th>${name}</th><td>${t}</td>${values.map((v) => `<td>${num(v, 2)}</td>`).join("")}</tr>`;
  const time = (ticks) => num(ticks * store.ts, 2);
  const rows = [line("A", time(a), first), line("B", time(b), second), line("B − A", time(b - a), second.map((v, i) => v - first[i])), line(say("mean"), "", means)];
  return `<table class="events readings"><thead><tr><th></th><th>s</th><th>T0, °C</th><th>T1, °C</th><th>T2, °C</th><th>${say("sent")}, %</th></tr></thead><tbody>${rows.join("")}</tbody></table>`;
}

// A step after `a` that is over at `b`: its levels, and the times from `a`, in s, at which it has done each share.
export function readStep(field, a, b) {
  const width = Math.max(1, Math.round((b - a) * LEVEL));
  const [before, after] = [mean(field, a - width, a), mean(field, b - width, b)];
  const half = Math.floor((b - a) / SMOOTH);
  const smooth = (tick) => mean(field, tick - half, tick + half);
  const way = Math.sign(after - before);
  const crossing = (share) => {
    const level = before + share * (after - before);
    for (let tick = a + 1; tick <= b; tick++) {
      const [last, now] = [smooth(tick - 1), smooth(tick)];
      if (way * (now - level) >= 0) return (tick - 1 - a + Math.max(0, (level - last) / (now - last))) * lab.store.ts;
    }
    return NaN;
  };
  const levels = [0, ...SHARES, 1].map((share) => before + share * (after - before));
  return { before, after, times: SHARES.map(crossing), levels };
}

function told({ before, after, times: [early, late] }) {
  return `<p class="note">${say("step_read", { before: num(before, 2), after: num(after, 2), early: num(early, 2), late: num(late, 2) })}</p>`;
}

for (const [i, name] of [..."ab"].entries()) {
  $(`cursor-${name}`).addEventListener("input", ({ target }) => {
    cursors[i] = Number(target.value);
    changed();
  });
}
$("step-of").addEventListener("change", changed);
