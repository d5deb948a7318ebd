// What is seen in the charts as a picture. And a run that is kept, so that another can be compared with it.
import { colour } from "lab/canvas.js";
import { save } from "lab/files.js";
import { charts } from "lab/parts.js";
import { show } from "lab/show.js";
import { $, lab } from "lab/state.js";
import { say } from "lab/strings.js";
import { ask, open } from "lab/talk.js";

const SHARP = 2; // pixels of a PNG for each of the page's

async function png() {
  const canvas = document.createElement("canvas");
  charts.drawOn(canvas, lab.events, SHARP);
  const c = canvas.getContext("2d");
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.globalCompositeOperation = "destination-over";
  c.fillStyle = colour("--bg");
  c.fillRect(0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done));
}

$("save-png").addEventListener("click", async () => save([await png()], "charts.png", "image/png", say("saved", { file: "charts.png" })));
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
