// Below the panels: what was true, what the likelihood diagnosis said, what the paper's vectors said. And over all, when.
import { EITHER, namedAt, namings } from "lab/events.js";
import { ownNames, short, taughtName } from "lab/say.js";
import { num, say } from "lab/strings.js";

export const RIBBON = 21;
const TOOLS = 84; // width of what stands over the corner of the charts

// What they say of a tick, in which colour, and what must be unfolded for it to be seen. What was true has times of its own.
const likelihood = (store, k, names) => {
  if (!(store.get(k, "alarm") > 0)) return "";
  return [short(names.get(store.get(k, "class"))), taughtName(store.get(k, "taught"))].filter(Boolean).join(", ");
};
const paper = (store, k) => {
  const [fdv, fiv] = [store.get(k, "fdv"), store.get(k, "fiv")];
  if (!(fdv > 0)) return "";
  return fiv > 0 ? `${fdv}, ${fiv} ${["T2", "T1", say("paper_says_3")][fiv - 1] ?? ownNames.get(fiv) ?? ""}` : say("paper_unnamed");
};
export const RIBBONS = [
  { fold: "charts", name: () => say("truth"), css: "--soft", truth: true },
  { fold: "charts", name: (narrow) => say(narrow ? "likelihood_short" : "likelihood"), css: "--alarm", word: likelihood },
  { fold: "residuals", name: (narrow) => (narrow ? "fdv fiv" : say("fdv_fiv")), css: "--soft", word: paper },
];

export function drawRibbons(pen, ribbons, events, store, { y, left, edge, a, b, X, T, t1, narrow }) {
  ribbons.forEach(({ name, css, word }, i) => {
    const top = y + i * RIBBON;
    pen.text(name(narrow), edge + 8, top + 12, { css: "--soft" });
    pen.box(left, top, edge - left, 16, "--well", 2);
    const bar = (from, to, text) => {
      const [x, e] = [Math.max(left, from), Math.min(edge, to)];
      if (e <= x) return;
      pen.box(x, top, Math.max(2, e - x), 16, css, 2);
      if (pen.measure(text) + 10 < e - x) pen.text(text, x + 6, top + 12, { css: "--bg" });
    };
    if (!word) return events.list.filter((e) => e.truth).forEach((event) => bar(T(event.from), T(event.to ?? t1), event.label()));
    let [from, text] = [0, ""];
    const stride = Math.max(1, Math.floor((b - a) / (2 * (edge - left))));
    for (let k = a; k <= b + stride; k += stride) {
      const now = k <= b ? word(store, k, events.names) : "";
      if (now === text) continue;
      if (text) bar(X(from), X(k), text);
      [from, text] = [k, now];
    }
  });
}

// When the last fault in view was put in, and when it was named.
export function drawFlags(pen, events, { hovers, T, t0, t1, edge, left, bottom }) {
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
  if (hovers || !seen.length) return;
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
