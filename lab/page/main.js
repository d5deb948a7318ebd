// The page: brings a source, what it says, and what the user does together, and draws, frame by frame.
import { nextStep } from "lab/commissioning.js";
import { home } from "lab/files.js";
import "lab/hand.js";
import { HEAR } from "lab/hear.js";
import { charts, exam, hides, quiz } from "lab/parts.js";
import { show } from "lab/show.js";
import { floats, fromRecording } from "lab/sources.js";
import { $, embedded, keep, lab } from "lab/state.js";
import { speak } from "lab/strings.js";
import { ask, listen, send, use } from "lab/talk.js";
import { verdict } from "lab/verdict.js";
import { drawRig, write } from "lab/write.js";

const TEXT_EVERY = 150; // ms: numbers in words change no faster than they can be read

let [before, told, toldTick] = [performance.now(), 0, -1];
function frame(now) {
  const passed = Math.min(0.1, (now - before) / 1000);
  before = now;
  if (lab.store?.end > 0) draw(now, passed);
  requestAnimationFrame(frame);
}

// The rig moves with every frame; the charts where a pixel would change; words, and all else that only data change, now and then.
function draw(now, passed) {
  const { store, hello, dirty } = lab;
  const moving = !lab.paused && !lab.lost;
  if (moving) lab.turned += passed * Math.min(3, lab.speed);
  // Between two ticks the axis moves on, so that it does not jerk.
  charts.lead = moving ? Math.min(0, ((now - lab.heard) / 1000) * lab.speed - store.ts) : 0;
  const due = dirty || (now - told > TEXT_EVERY && (store.end !== toldTick || lab.lost));
  const hide = hides();
  if (moving || due) {
    const row = store.row(store.last);
    const said = verdict({ row, hello, events: lab.events, since: lab.since, begun: store.row(store.tickAt(lab.since)), ts: store.ts, settings: lab.settings, can: lab.can, checking: lab.checking, lost: lab.lost && now - lab.lost, next: hello.kind === "board" && nextStep() });
    drawRig(row, said, hide);
    if (due) write(row, said, hide);
  }
  if (due || charts.moved) charts.draw(lab.events, hide);
  if (!due) return;
  charts.drawOverview(lab.events, hide);
  [told, toldTick] = [now, store.end];
  lab.dirty = false;
}

speak(keep.get("language") ?? (navigator.language?.slice(0, 2)));
document.documentElement.dataset.theme = keep.get("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
listen(HEAR);
show();
if ($("recording")) {
  const { hello, name, values, orders, first } = JSON.parse(embedded("recording"));
  use((hear) => fromRecording(hear, { hello, name, orders, first, values: floats(values) }));
} else use(home);
requestAnimationFrame(frame);
// For tests and the curious.
window.lab = { lab, charts, quiz, exam, events: () => lab.events, ask, send, row: () => lab.store.row(lab.store.last) };
