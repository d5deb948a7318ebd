// What goes to the source, and what comes from it.
import { FOREVER } from "lab/faults.js";
import { DEFAULT } from "lab/scene.js";
import { changed, lab } from "lab/state.js";

let source = null;
let hears = {};
let asked = 0;
const answers = new Map();

// Which function hears which type of message.
export const listen = (functions) => (hears = functions);

function hear(message) {
  if (message.type !== "rows") changed(); // what time brings is drawn in its time
  if (message.id && answers.has(message.id)) {
    answers.get(message.id)(message);
    answers.delete(message.id);
  } else hears[message.type]?.(message);
}

// Goes over to another source.
export function use(make) {
  source?.close();
  Object.assign(lab, { store: null, session: undefined });
  source = make(hear);
}

export const send = (command) => source.send(command);
export const ask = (command) => new Promise((resolve) => {
  const id = ++asked;
  answers.set(id, resolve);
  send({ ...command, id });
});

// Times of a fault are those of the usual rig: on a slower plant it lasts for as many samples. Nothing else waits for anything: a stop
// goes out before the first row has come.
export function scaled(what) {
  if (!what.fault) return what;
  const { slow } = lab.store;
  const { at, for: lasts } = what.fault;
  return { ...what, fault: { ...what.fault, at: at * slow, for: lasts === FOREVER ? lasts : Math.round(lasts * slow) } };
}
export const order = (what) => send({ command: "order", order: scaled(what) });
export const open = (scene, more = { skip: true }) => send({ command: "open", scene, ...more });
export const run = (speed) => send({ command: "run", speed });
// The scene of a rig that was chosen, from its beginning.
export const begins = (chosen) => open({ ...DEFAULT, ...chosen, orders: DEFAULT.orders });
