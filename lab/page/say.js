// What a row says, in words.
import { EITHER, meant } from "lab/events.js";
import { escape, num, say } from "lab/strings.js";

// Classes whose size is an error of a thermistor.
export const isOffset = (name) => /_(offset|loose)$|^t0_fault$/.test(name);

const PART = { t0: "T0", t1: "T1", t2: "T2" };

// Class of a finding -> the parts that it blames.
export function blamed(name) {
  if (!name) return [];
  if (/^t\d_(?!t)/.test(name)) return [PART[name.slice(0, 2)]];
  return meant(name).map((one) => ({ air_flow: "fan", heater_power: "heater" })[one]).filter(Boolean);
}

// The short name of a class.
export const short = (name) => say("c_" + (name || "alarm"));

const part = (label, css) => `<span class="part-${css}">${label}</span>`;

// The sentence of a finding, as HTML.
export function headline(name, magnitude) {
  const signed = (plus, minus, decimals, label) =>
    say(magnitude >= 0 ? plus : minus, { part: label, size: num(Math.abs(magnitude), decimals) });
  const t = PART[name.slice(0, 2)];
  const T = t && part(t, t.toLowerCase());
  const air = part(say("air_flow"), "flow");
  const heater = part(say("heater"), "power");
  if (/_loose$/.test(name)) return Number.isFinite(magnitude) ? signed("f_loose_high", "f_loose_low", 2, T) : say("f_loose", { part: T });
  if (isOffset(name)) return signed("f_offset_high", "f_offset_low", 2, T);
  if (name === "t1_clogged") return signed("f_clogged_more", "f_clogged_less", 1, T);
  if (/_detached$/.test(name)) return say("f_detached", { part: T, seen: num(Math.max(0, 100 + (magnitude || -100)), 0) });
  if (name === "air_flow") return signed("f_flow_more", "f_flow_less", 1, air);
  if (name === "heater_power") {
    return Number.isFinite(magnitude) ? signed("f_power_more", "f_power_less", 1, heater) : say("f_power_same", { part: heater });
  }
  if (name === "air_flow_or_heater_power") return say("f_either", { part: part(say("Air_flow"), "flow"), other: part(say("heater_power"), "power") });
  if (name === "drift") return signed("f_drift_up", "f_drift_down", 2);
  if (name === "since_commissioning") return Number.isFinite(magnitude) ? signed("f_since_more", "f_since_less", 0) : say("f_since");
  const kind = /^t\d_(stuck|open|short|lost)$/.exec(name)?.[1];
  if (kind) return say("f_" + kind, { part: T });
  const pair = /^(t\d)_(t\d)_swapped$/.exec(name);
  if (pair) return say("f_swapped", { a: part(PART[pair[1]], pair[1]), b: part(PART[pair[2]], pair[2]) });
  return name === "unknown" ? say("f_unknown") : short(name) + ".";
}

// Measured against expected, since when, how surely.
export function support(name, row, ts) {
  const t = /^t[012]/.exec(name)?.[0];
  const out = [];
  if (t && !/open|short|lost|swapped/.test(name)) {
    const measured = row[t];
    const offset = isOffset(name) && Number.isFinite(row.magnitude);
    const expected = offset ? measured - row.magnitude : row[t + "_expected"];
    if (Number.isFinite(expected)) out.push(say("measured_expected", { measured: num(measured), expected: num(expected) }));
  }
  if (name === "air_flow_or_heater_power") out.push(say("sub_either"));
  if (name === "t0_fault") out.push(say("sub_alike"));
  if (name !== "unknown") {
    const confidence = row.confidence >= 0.995 ? say("above", { x: num(0.99, 2) }) : num(row.confidence, 2);
    out.push(say("since", { s: num(row.onset * ts), confidence }));
  }
  if (name === "air_flow" || name === "heater_power") out.push(say("others_true"));
  if (row.taught > 0) out.push(asTaught(row));
  return out.join(" ");
}

// The names of the faults that a user has taught, by their places from 1.
export const taughtNames = [];
export const taughtName = (place) => (place > 0 ? taughtNames[place - 1] ?? `${place}` : "");

// The taught fault that an alarm is, as HTML. A board does not stream its size.
export const asTaught = ({ taught, taught_size: size }) =>
  say(Number.isFinite(size) ? "as_taught_size" : "as_taught", { name: escape(taughtName(taught)), size: num(size, 0) });

// Why something was not done; of a refusal without a code, in its own words.
export function refusal({ why, code, values: { name, mode, trip, value, min, max, other, limit, times, of, scale } = {} }) {
  if (code === "persists") return say("persists", { why: say(`trip_${trip}`) });
  const exact = (x) => num(x, Number.isInteger(x) ? 0 : 2);
  const known = { name, mode: say(`state_${mode}`).toLowerCase(), value: exact(value), min: exact(min), max: exact(max), other, limit: exact(limit), times: exact(times), of, scale: exact(scale) };
  if (code) return say("refused", { why: say(`r_${code}`, known) });
  return say("refused", { why });
}

// What fdv and fiv say. Numbers of fiv to which a user has given a name of his own have it here.
export const ownNames = new Map();

export function papers(fdv, fiv) {
  if (!(fdv > 0 || ownNames.has(fiv))) return say("paper_says_nothing");
  if (ownNames.has(fiv)) return escape(ownNames.get(fiv));
  return say(`paper_says_${fiv <= 3 ? fiv : 0}`);
}

// How soon a name was given after the beginning, each of them where there are two.
export const delays = (names, from) =>
  names.map(({ name, t }) => {
    const who = names.length > 1 || name === EITHER ? short(name).toLowerCase() : say("likelihood");
    return say("delay", { who, s: num(t - from, 2) });
  }).join(", ");

export const unitOf = (name) => (isOffset(name) ? "°C" : name === "drift" ? "°C/min" : "%");
