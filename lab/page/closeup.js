// A few seconds around an event: what was measured over what was expected.
import { Pen, colour, niceStep } from "lab/canvas.js";
import { EITHER, namings } from "lab/events.js";
import { range } from "lab/panel.js";
import { blamed, short } from "lab/say.js";
import { num, say } from "lab/strings.js";

export function drawCloseup(canvas, event, store) {
  const high = 190;
  const pen = new Pen(canvas, high);
  const [left, right] = [7 + pen.measure(num(88.8, 1)), 6];
  const from = Math.min(event.onset ?? event.from, event.from);
  const names = namings(event);
  const [before, least, most, more] = [2, 4, 10, 3].map((s) => s * store.slow);
  const last = Math.max(least, Math.min(most, (names[names.length - 1]?.t ?? event.alarm ?? from) - from + more));
  const [t0, t1] = [from - before, from + last];
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
  const [low, top] = range({ least: 2 }, [{ value: measured }, { value: expected }], a, b);
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
  const apart = niceStep(before, 1);
  for (let s = Math.ceil(-before / apart) * apart; s <= last; s += apart) {
    const x = T(from + s);
    const align = x < left + 16 ? "left" : x > pen.width - right - 16 ? "right" : "center";
    pen.text(`${s > 0 ? "+" : ""}${num(s, 0)} s`, x, 180, { css: "--faint", align });
  }
}
