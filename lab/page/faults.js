// What can be broken, part by part: how it is asked for, what the rig is told, and which name is right for it.
import { num, say } from "lab/strings.js";

export const FOREVER = 1e6; // s; until mended

const percent = (min, max, value, step = 1) => ({ min, max, value, step, unit: "%", decimals: 0 });
const degrees = (max, value) => ({ min: -max, max, value, step: 0.1, unit: "°C", decimals: 1 });
const drift = { min: -6, max: 6, value: 4, step: 0.5, unit: "°C/min", decimals: 1 };
const share = (x) => 1 + x / 100;

const sensor = (t) => {
  const s = t.toLowerCase();
  return {
    wrong: { verb: "v_wrong", name: `${s}_offset`, size: degrees(3, 1.5), fault: (size) => ({ do: "offset", sensor: s, size }) },
    drifts: { verb: "v_drifts", name: "drift", last: 40, size: drift, fault: (size) => ({ do: "drift", sensor: s, size }) },
    loose: { verb: "v_loose", name: `${s}_loose`, last: 600, size: degrees(3, 1.5), fault: (size) => ({ do: "loose", sensor: s, size }) },
    sticks: { verb: "v_sticks", name: `${s}_stuck`, fault: () => ({ do: "stuck", sensor: s }) },
    falls: { verb: "v_falls", name: `${s}_detached`, size: percent(50, 100, 80), fault: (x) => ({ do: "detach", sensor: s, size: x / 100, over: 1 }) },
    open: { verb: "v_open", name: `${s}_open`, fault: () => ({ do: "open", sensor: s }) },
    short: { verb: "v_short", name: `${s}_short`, fault: () => ({ do: "short", sensor: s }) },
  };
};

const { wrong, drifts, open } = sensor("T0");
const { wrong: wrong1, ...rest1 } = sensor("T1");
// A clogged thermistor sees less of the rise, and later.
const clogged = { verb: "v_clogged", name: "t1_clogged", size: percent(-30, -5, -15), fault: (x) => ({ do: "clog", sensor: "t1", size: share(x), lag: 0.4 }) };
const swap = { verb: "v_swap", name: "t1_t2_swapped", fault: () => ({ do: "swap", sensor: "t1", with: "t2" }) };

export const PARTS = {
  T0: { wrong: { ...wrong, name: "t0_fault" }, drifts, open },
  T1: { wrong: wrong1, clogged, ...rest1, swap },
  T2: sensor("T2"),
  fan: { more: { verb: "v_more", either: ["v_less_air", "v_more_air"], name: "air_flow", size: percent(-50, 50, 26), fault: (x) => ({ do: "air-flow", size: share(x) }) } },
  heater: {
    weak: { verb: "v_weak", either: ["v_weaker", "v_stronger"], name: "heater_power", size: percent(-60, 30, -25), fault: (x) => ({ do: "heater-power", size: share(x) }) },
    stuck: { verb: "v_stuck_on", name: "heater_power", size: percent(0, 100, 60), fault: (size) => ({ do: "heater-stuck", size }) },
  },
  mains: { sags: { verb: "v_sags", name: "heater_power", size: percent(-20, 10, -10), fault: (x) => ({ do: "supply-voltage", size: share(x) }) } },
  door: { opens: { verb: "v_opens", name: null, size: degrees(5, -3), fault: (size) => ({ do: "ambient", size }) } },
};

// A size for a rig whose air is so many times as hot above the room as the usual rig's: degrees go with it, shares do not.
export const sized = (size, heat) =>
  size?.unit === "°C" && heat > 1 ? { ...size, min: size.min * heat, max: size.max * heat, value: size.value * heat, step: 0.5 } : size;

const KINDS = Object.entries(PARTS).flatMap(([part, kinds]) => Object.values(kinds).map((kind) => ({ part, ...kind })));

// The kind that a fault is of, and its size as people give it.
export function recognise(fault) {
  const kind = KINDS.find((k) => {
    const like = k.fault(k.size?.value);
    return like.do === fault.do && like.sensor === (fault.sensor ?? undefined);
  });
  if (!kind) return { part: null, name: null, verb: null };
  const factor = ["clog", "air-flow", "heater-power", "supply-voltage"].includes(fault.do);
  const size = factor ? 100 * (fault.size - 1) : fault.do === "detach" ? 100 * fault.size : fault.size;
  // As the instrument means it: a supply counts by the power that it leaves, a power that is stuck is no share.
  const means = { "supply-voltage": 100 * (fault.size ** 2 - 1), "heater-stuck": null };
  return { ...kind, value: kind.size ? size : null, magnitude: fault.do in means ? means[fault.do] : kind.size ? size : null };
}

// "T2 reads wrong, +1.5 °C"
export function describe(fault) {
  const { part, verb, either, size, value } = recognise(fault);
  if (!verb) return (fault.name || fault.do).replace(/[<>&"']/g, ""); // a scene comes from anywhere, and this becomes HTML
  const did = either ? either[value < 0 ? 0 : 1] : verb;
  const what = `${say("part_" + part).split(",")[0]}: ${say(did).toLowerCase()}`;
  return size ? `${what}, ${signed(value, size)}` : what;
}

export function signed(value, { decimals, unit, min }) {
  return `${value > 0 && min < 0 ? "+" : ""}${num(value, decimals)}\u00a0${unit}`;
}

// For the quiz: faults that a student can tell, of a size that can be seen.
const QUIZ = [
  ["T1", "wrong"], ["T1", "clogged"], ["T2", "wrong"], ["T0", "wrong"], ["fan", "more"], ["heater", "weak"],
];
export const ANSWERS = QUIZ.map(([part, kind]) => ({ part, name: PARTS[part][kind].name }));

// One of them at random, of some parts, from half of the largest size to a share of it.
export function surprise(heat, { random = Math.random, parts = Object.keys(PARTS), largest = 1 } = {}) {
  const asked = QUIZ.filter(([part]) => parts.includes(part));
  const [part, kind] = asked[Math.floor(random() * asked.length)];
  const { fault } = PARTS[part][kind];
  const { min, max } = sized(PARTS[part][kind].size, heat);
  const end = min < 0 && (max <= 0 || random() < 0.5) ? min : max;
  const value = end * (0.5 + random() * (largest - 0.5));
  return { ...fault(Math.round(value * 10) / 10), at: 0, for: 30 };
}
