// A real board: the steps of its commissioning, its console, all of its settings.
import { $, isOff, lab, toast } from "lab/state.js";
import { escape, num, say } from "lab/strings.js";
import { order } from "lab/talk.js";

const [LINES, LONGEST] = [400, 2000]; // of the console that are kept, and characters of one
const [YES_AFTER, YES_WITHIN] = [500, 5000]; // ms: a double click is no second thought
const told = [];

const line = (text) => order({ order: "console", line: text });

let prints = 0;
export function said({ text }) {
  told.push(...text.split("\n").map((line) => (line.length > LONGEST ? `${line.slice(0, LONGEST)} …` : line)));
  if (/^check: |^> check\nok/m.test(text)) lab.checking = true;
  if (/^check (passed|failed|ended)/m.test(text)) lab.checking = false;
  told.splice(0, told.length - LINES);
  prints ||= requestAnimationFrame(print); // once a frame, however much a port floods
}
function print() {
  prints = 0;
  const log = $("console");
  const atEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 30;
  log.textContent = told.join("\n");
  if (atEnd) log.scrollTop = log.scrollHeight;
}

// Does a core beside the board come to the same bits? Where the log was not heard from the start, the board may start anew.
export function agrees(message) {
  lab.agrees = message;
}
// Which image the board runs, and whether it fits.
export function image(message) {
  lab.image = message;
  if (message.format !== message.expected) toast(ofImage());
}
function ofImage() {
  const { agrees: told, image, hello } = lab;
  if (!image) return told && !told.format ? say("image_silent") : "";
  const name = image.board.toLowerCase();
  return say(image.format === image.expected ? "image_fits" : "image_update", { ...image, own: hello.version, file: `pt326-${name}.bin`, drive: name.replace("nucleo-", "node_").toUpperCase() });
}
export function kept(message) {
  lab.kept = message;
}
export function beside() {
  const { agrees: told, image, kept: log } = lab;
  $("image").textContent = ofImage();
  const how = !told || (told.format && image) ? "" : told.format ? say("agrees_format", told) : told.why ? say("agrees_other", told) : !told.whole ? say("agrees_not") : "differs" in told ? say("agrees_differs", { ...told, tick: told.differs }) : say("agrees_same", told);
  $("agrees").textContent = how;
  $("restart").hidden = !told || told.whole || !isOff();
  $("kept").textContent = log ? say(log.full ? "kept_full" : "kept", { mb: num(log.bytes / 1e6, 1) }) : "";
}

export function calibrate() {
  if ($("celsius").value !== "") line(`calibrate all ${$("celsius").value}`);
}

let asks = null; // the line that was asked for, when, and its timer

function pressed({ dataset }) {
  const since = asks?.line === dataset.line ? performance.now() - asks.at : 0;
  if (since > 0 && since < YES_AFTER) return;
  clearTimeout(asks?.timer);
  asks = null;
  if (!("heats" in dataset) || since > 0) line(dataset.line);
  else asks = { line: dataset.line, at: performance.now(), timer: setTimeout(() => ((asks = null), asking()), YES_WITHIN) };
  asking();
}

// The buttons as they are: one of them may ask, also where it has just been made anew.
export function asking() {
  for (const button of document.querySelectorAll("[data-heats]")) {
    const yes = asks?.line === button.dataset.line;
    button.toggleAttribute("data-asks", yes);
    button.textContent = say(yes ? "c_yes" : button.dataset.say);
  }
}

// A number that was typed; null where it is none, or out of bounds.
export const typed = (input) => (input.value === "" || !input.reportValidity() ? null : Number(input.value));

// The limits that are wider than their defaults.
export const wide = (limits, settings) =>
  Object.entries(limits).filter(([name, { default: usual, wider }]) => (wider === "above" ? settings[name] > usual : settings[name] < usual)).map(([name]) => name);

// A row for each setting that is a number, with its unit and bounds, under the name of its section.
export function settings() {
  const place = $("settings");
  if (!place.children.length) {
    const row = ([name, { unit, min, max }]) =>
      `<label><span>${escape(name)}</span><input type="number" step="any" min="${min}" max="${max}" data-name="${escape(name)}"><small>${escape(unit)} ${min} … ${max}</small></label>`;
    place.innerHTML = Object.entries(lab.hello.bounds).filter(([name]) => name in lab.settings).map(row).join("");
  }
  for (const input of place.querySelectorAll("input")) {
    if (input !== document.activeElement || input.value === "") input.value = lab.settings[input.dataset.name];
  }
}

document.addEventListener("click", ({ target }) => {
  const button = target.closest("[data-line]");
  if (button) pressed(button);
});
$("settings").addEventListener("change", ({ target }) => {
  const value = typed(target);
  if (value === null) settings();
  else order({ order: "set", name: target.dataset.name, value });
});
$("typed").addEventListener("submit", (event) => {
  event.preventDefault();
  line($("line").value);
  $("line").value = "";
});
