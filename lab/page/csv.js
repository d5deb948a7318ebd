// A trace.csv as rows of the protocol. What the file does not hold is NaN.
import { say } from "lab/strings.js";

// What the heater got is in none: what the controller drove stands for it. The others have another form in a file.
const OTHERS = { drive: "pa_pct", tick: null, mode: null, class: null, onset: null };

export function readTrace(text, hello) {
  const lines = text.split(/\r?\n/).filter((line) => line);
  const header = lines[0]?.split(",") ?? [];
  for (const need of ["t_s", "t1_c", "t2_c", "pa_pct", "mode"]) {
    if (!header.includes(need)) throw new Error(say("no_trace", { name: need }));
  }
  const column = (name) => header.indexOf(name);
  const width = hello.fields.length;
  const at = Object.fromEntries(hello.fields.map((name, i) => [name, i]));
  const numbers = new Map(hello.classes.map((c) => [c.name, c.number]));
  const same = hello.fields.map((field, i) => [i, column(field in OTHERS ? OTHERS[field] : hello.columns[i])]).filter(([, from]) => from >= 0);
  const [mode, verdict, onset, time] = ["mode", "verdict", "onset_s", "t_s"].map(column);
  const values = new Float32Array((lines.length - 1) * width).fill(NaN);
  const cells = lines.length > 2 ? lines[2].split(",") : [];
  const ts = Number(cells[time]) || hello.ts;
  for (let i = 1; i < lines.length; i++) {
    const cell = lines[i].split(",");
    if (cell.length < header.length) throw new Error(`${i + 1}`);
    const place = (i - 1) * width;
    values[place + at.tick] = i - 1;
    for (const [to, from] of same) if (cell[from] !== "") values[place + to] = Number(cell[from]);
    values[place + at.mode] = hello.modes.indexOf(cell[mode]);
    if (cell[verdict]) values[place + at.class] = numbers.get(cell[verdict]) ?? NaN;
    if (cell[onset]) values[place + at.onset] = Math.round(Number(cell[onset]) / ts);
    values[place + at.readiness] = hello.readiness.indexOf("armed");
  }
  return { hello: { ...hello, ts, ...names(lines[1]?.split(",")[column("settings")] ?? "") }, values };
}

// The names that a user gave, of the settings at the start.
function names(settings) {
  const rows = settings.matchAll(/diagnosis\.isolation\.\d+=(\d+)(?: [-+01x]+){5} ([\w-]+)/g);
  const taught = settings.matchAll(/likelihood\.taught\.\d+=([\w-]+) /g);
  return { own_names: [...rows].map(([, number, name]) => [Number(number), name]), taught_names: [...taught].map(([, name]) => name) };
}
