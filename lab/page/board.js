// A real board: the steps of its commissioning, its console, all of its settings.
import { $, lab } from "lab/state.js";
import { escape, say } from "lab/strings.js";
import { order } from "lab/talk.js";

const LINES = 400; // of the console that are kept
const YES_WITHIN = 5000; // ms
const told = [];

const line = (text) => order({ order: "console", line: text });

export function said({ text }) {
  told.push(...text.split("\n"));
  if (/^check: |^> check\n/m.test(text)) lab.checking = true;
  if (/^check (passed|failed|ended)/m.test(text)) lab.checking = false;
  told.splice(0, told.length - LINES);
  const log = $("console");
  const atEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 30;
  log.textContent = told.join("\n");
  if (atEnd) log.scrollTop = log.scrollHeight;
}

export function calibrate() {
  if ($("celsius").value !== "") line(`calibrate all ${$("celsius").value}`);
}

// What heats wants a second press, at a button that says so meanwhile.
function pressed(button) {
  if (!("heats" in button.dataset) || button.dataset.asks) {
    rest(button);
    return line(button.dataset.line);
  }
  button.dataset.asks = "1";
  button.textContent = say("c_yes");
  setTimeout(() => rest(button), YES_WITHIN);
}

function rest(button) {
  if (!button.dataset.asks) return;
  delete button.dataset.asks;
  button.textContent = say(button.dataset.say);
}

// A row for each setting that is a number, with its unit and bounds, under the name of its section.
export function settings() {
  const place = $("settings");
  if (!place.children.length) {
    const row = ([name, { unit, min, max }]) =>
      `<label><span>${escape(name)}</span><input type="number" step="any" min="${min}" max="${max}" data-name="${escape(name)}"><small>${escape(unit)} ${min} … ${max}</small></label>`;
    place.innerHTML = Object.entries(lab.hello.bounds).filter(([name]) => name in lab.settings).map(row).join("");
  }
  for (const input of place.querySelectorAll("input")) {
    if (input !== document.activeElement) input.value = lab.settings[input.dataset.name];
  }
}

$("desk-board").addEventListener("click", ({ target }) => {
  const button = target.closest("[data-line]");
  if (button) pressed(button);
});
$("settings").addEventListener("change", ({ target }) => {
  if (target.reportValidity()) order({ order: "set", name: target.dataset.name, value: Number(target.value) });
});
$("typed").addEventListener("submit", (event) => {
  event.preventDefault();
  line($("line").value);
  $("line").value = "";
});
