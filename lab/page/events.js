// From rows to what happened: a fault put in, an alarm raised, names given, the end. One event for each fault or alarm.
export const CALM = 15; // s: an alarm that rises so soon after its fault ended still belongs to it
const STANDS = 2; // s: the paper's fiv flickers while its models adapt; a name counts once it has stood for so long

// Two that look alike at first have a name in common.
export const EITHER = "air_flow_or_heater_power";
const ALIKE = ["air_flow", "heater_power"];
export const meant = (name) => (name === EITHER ? ALIKE : [name]);

// The page says how an event is called, in its language.
function label() {
  return Events.label(this);
}

export class Events {
  constructor(hello) {
    this.ts = hello.ts;
    this.names = new Map(hello.classes.map((c) => [c.number, c.name]));
    this.clear();
  }

  clear() {
    this.list = [];
    this.orders = []; // what was put in: {from, to, fault}
    this.before = { truth: 0, alarm: 0 };
    this.paper = {};
  }

  // An order took effect from a tick on.
  order(tick, order) {
    const now = tick * this.ts;
    if (order.order === "mend") {
      for (const put of this.orders) put.to = Math.min(put.to, now);
      this.orders = this.orders.filter((put) => put.from < put.to);
    }
    if (order.order === "break") {
      const from = now + order.fault.at;
      this.orders.push({ from, to: from + order.fault.for, fault: order.fault });
    }
  }

  active(t) {
    return this.orders.filter((put) => put.from <= t + 1e-9 && t < put.to);
  }

  get last() {
    return this.list[this.list.length - 1];
  }

  push(from, values, at, width) {
    for (let i = 0; i < values.length; i += width) {
      const v = (name) => values[i + at[name]];
      this.row((from + i / width) * this.ts, v("truth"), v("alarm"), v("class"), v("fdv"), v("fiv"), v("onset"), v("magnitude"));
    }
  }

  row(t, truth, alarm, number, fdv, fiv, onset, magnitude) {
    const was = this.before;
    let now = this.last;
    if (truth && truth !== was.truth) {
      if (now) now.to ??= t;
      // An onset lies between two ticks: the order knows when.
      const put = this.orders.findLast((order) => order.from <= t + 1e-9);
      now = { label, from: put?.from ?? t, truth, fault: put?.fault, names: new Map() };
      this.list.push(now);
    } else if (alarm && !was.alarm && !(now && (now.to === undefined || t - now.to < CALM))) {
      now = { label, from: t, truth: 0, names: new Map() };
      this.list.push(now);
    }
    if (now) {
      if (now.truth ? !truth : !alarm) now.to ??= t;
      const mine = now.to === undefined; // what is said after the end is about the end
      if (alarm && mine) now.alarm ??= t;
      if (mine && number === number) {
        const name = this.names.get(number);
        now.named = name;
        if (!now.names.has(name)) now.names.set(name, t);
        [now.onset, now.magnitude] = [onset * this.ts, magnitude];
      }
      if (mine && fdv > 0) now.detected ??= t;
      if (this.paper.event !== now || this.paper.fiv !== fiv) this.paper = { event: now, fiv, since: t };
      // The paper's tables know the first three faults: another name is no answer to them, and any is none to the rest.
      const answers = fiv > 0 && fiv === (now.truth || fiv);
      if (mine && answers && t - this.paper.since >= STANDS) now.isolated ??= this.paper.since;
    }
    this.before = { truth, alarm };
  }
}

// The names that an event was given on the way to the one it has: that, and before it, where these two looked alike, "one of both".
export function namings({ names, named } = {}) {
  if (!names?.has(named)) return [];
  const own = { name: named, t: names.get(named) };
  const t = ALIKE.includes(named) ? names.get(EITHER) : undefined;
  return t < own.t ? [{ name: EITHER, t }, own] : [own];
}

// When an event was named, be it as one of two; undefined before.
export const namedAt = (event) => namings(event)[0]?.t;
