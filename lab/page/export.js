// What is seen in the charts as a file: SVG, PNG, CSV. And a run that is kept, so that another can be compared with it.
import { colour } from "lab/canvas.js";
import { Drawing } from "lab/drawing.js";
import { save } from "lab/files.js";
import { charts } from "lab/parts.js";
import { show } from "lab/show.js";
import { $, lab } from "lab/state.js";
import { say } from "lab/strings.js";
import { ask, open } from "lab/talk.js";

const SHARP = 2; // pixels of a PNG for each of the page's

const saved = (parts, file, type) => save(parts, file, type, say("saved", { file }));

export function svg() {
  const drawing = new Drawing();
  const { width, height } = charts.drawOn({ style: {}, getContext: () => drawing }, lab.events);
  return drawing.svg(width, height, colour("--bg"));
}

export async function png() {
  const canvas = document.createElement("canvas");
  charts.drawOn(canvas, lab.events, SHARP);
  const c = canvas.getContext("2d");
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.globalCompositeOperation = "destination-over";
  c.fillStyle = colour("--bg");
  c.fillRect(0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done));
}

// A row for each tick in view, a column for each number; empty where there is none.
export function csv() {
  const { store } = lab;
  const [from, to] = [Math.max(store.first, store.tickAt(charts.end - charts.span)), Math.min(store.last, store.tickAt(charts.end))];
  const cell = (x) => (Number.isFinite(x) ? String(Math.fround(x)) : "");
  const lines = [["t_s", ...store.fields].join(",")];
  for (let tick = from; tick <= to; tick++) lines.push([(tick * store.ts).toFixed(3), ...store.fields.map((name) => cell(store.get(tick, name)))].join(","));
  return lines.join("\n") + "\n";
}

$("save-svg").addEventListener("click", () => saved([svg()], "charts.svg", "image/svg+xml"));
$("save-png").addEventListener("click", async () => saved([await png()], "charts.png", "image/png"));
$("save-csv").addEventListener("click", () => saved([csv()], "view.csv", "text/csv"));
$("compare").addEventListener("click", () => {
  charts.compare(charts.kept ? null : lab.store);
  show();
});
// The same scene from its beginning with the gains as they are now, beside the run so far.
$("again").addEventListener("click", async () => {
  const { scene, tick } = await ask({ command: "scene" });
  charts.compare(lab.store);
  const names = [...document.querySelectorAll("[data-set]")].map((input) => input.dataset.set);
  const gains = names.map((name) => [0, { order: "set", name, value: lab.settings[name] }]);
  const others = scene.orders.filter(([, { name }]) => !names.includes(name));
  open({ ...scene, orders: [...gains, ...others] }, { at: tick });
  show();
});
