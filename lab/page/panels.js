// What the charts show: each panel's curves, and between which values it shows them.
import { SHARES } from "lab/classes.js";
import { say } from "lab/strings.js";

// What explains an alarm, the parts that have a colour first.
const COLOURS = {
  t2_offset: "--t2", t1_offset: "--t1", t1_clogged: "--t1", air_flow: "--flow", heater_power: "--power", t0_fault: "--t0",
};
const shares = [...Object.keys(COLOURS), ...SHARES.filter((name) => !COLOURS[name])];
export const CLASSES = shares.map((name) => ({ field: "x_" + name, name, css: COLOURS[name] ?? "--soft" }));

const one = (id, css, more = {}) => ({ id, css, field: id, ...more });
// `least` is the smallest range that it shows, `fold` what must be unfolded for it to be seen.
export const PANELS = [
  {
    id: "temperature", unit: () => `°C, ${say("dotted")}`, high: [150, 132], least: 4, decimals: 1,
    series: [
      one("setpoint", "--ink", { dash: [5, 4], width: 1, label: (narrow) => say(narrow ? "setpoint_short" : "setpoint") }),
      one("t1_expected", "--t1", { dash: [2, 3], width: 1.1, label: () => "T1 " + say("expected"), silent: true }),
      one("t2_expected", "--t2", { dash: [2, 3], width: 1.1, label: () => "T2 " + say("expected"), silent: true }),
      one("t0", "--t0", { label: () => "T0", off: true }),
      one("t1", "--t1", { label: () => "T1" }),
      one("t2", "--t2", { label: () => "T2" }),
    ],
  },
  {
    id: "power", unit: () => "%", high: [70, 62], least: 30, decimals: 1,
    series: [
      one("drive", "--soft", { step: true, width: 1.1, label: (narrow) => say(narrow ? "sent_short" : "sent") }),
      one("pid", "--ink", { width: 1.8, label: () => "PID" }),
    ],
  },
  {
    id: "departure", fold: "charts", unit: () => "°C", high: [70, 62], least: 2, even: true, decimals: 2,
    series: [
      one("t1_left", "--t1", { label: () => "T1" }),
      one("t2_left", "--t2", { label: () => "T2" }),
    ],
  },
  {
    id: "residuals", fold: "residuals", unit: () => say("residuals_unit"), high: [84, 76], range: [-3, 3], ticks: [-3, 0, 3], bounds: [1, -1], decimals: 1, most: 3,
    series: ["rap", "ry12", "rsg1", "rsg2", "rbw1"].map((id) => one(id, "--faint", { width: 1, label: () => id, beyond: 1 })),
  },
];
