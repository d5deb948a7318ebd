// What the page knows at the moment, and what its parts need of the document.
import { DEFAULT } from "lab/scene.js";

export const $ = (id) => document.getElementById(id);
export const embedded = (id) => $(id)?.textContent.trim();
export const keep = {
  get: (key) => { try { return localStorage.getItem("pt326-lab-" + key); } catch { return null; } },
  set: (key, value) => { try { localStorage.setItem("pt326-lab-" + key, value); } catch { /* a page from a file may keep nothing */ } },
};

export const lab = {
  hello: null, store: null, events: null, can: new Set(), scene: structuredClone(DEFAULT), settings: null,
  mode: "explore", speed: 1, paused: false, lost: 0, checking: false, since: 0, stateOf: NaN, turned: 0, heard: 0,
  usual: null, // the settings of a board to which nothing was done, where they are known
  away: false, left: null, // gone over to a recording or a board; the scene of the session that was left for it
  agrees: null, image: null, kept: null, // of a board: does a core beside it come to the same bits; what it runs; what its log takes
  open: new Set(keep.get("open")?.split(" ") ?? []), // what is unfolded
  dirty: true, // something else than time has changed: all is to be drawn
};
export const changed = () => (lab.dirty = true);

// How many times as hot above the room this rig's air is as the usual one's.
export const heat = () => Math.max(1, Math.round((lab.settings.setpoint - 20) / 15));

// The plant that is simulated, by its preset: a board and a recording are a tube.
export const plant = () => (lab.can.has("open") ? lab.scene.preset : "");

export const isOff = () => [0, 4].includes(lab.stateOf);
// Of a real board the button only ever stops: whoever presses it twice must not arm.
export const arms = () => isOff() && lab.hello.kind !== "board";

const shown = new Map();
// Changes a node only where its text has changed: what has the focus keeps it.
export function put(id, html) {
  if (shown.get(id) === html) return;
  shown.set(id, html);
  $(id).innerHTML = html;
}

const LONGEST = 300; // characters of a toast: what is refused may quote anything
let [toastUntil, urgent] = [null, ""];
// While something urgent stands there, such as a stop that has not arrived, other words come behind it.
export function toast(text, isUrgent = false) {
  const all = urgent && !isUrgent ? `${urgent} ${text}` : text;
  if (isUrgent) urgent = text;
  $("toast").textContent = all.length > LONGEST ? all.slice(0, LONGEST) + "…" : all;
  $("toast").classList.add("shown");
  clearTimeout(toastUntil);
  toastUntil = setTimeout(() => {
    urgent = "";
    $("toast").classList.remove("shown");
  }, 7000);
}
