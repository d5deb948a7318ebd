// From rows to what happened: a fault put in, an alarm raised, names given, the end. One event for each fault or alarm.
export const CALM = 15; // s: an alarm that rises so soon after its fault ended still belongs to it

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
      // The paper's tables know the first three faults: another name is no answer to them, and any is none to the rest.
      if (mine && fiv > 0 && fiv === (now.truth || fiv)) now.isolated ??= t;
    }
    this.before = { truth, alarm };
  }
}

// When an event was named as it is named now, or as one of two of which one is that; undefined before.
export function namedAt(event) {
  const { names, named } = event ?? {};
  const either = ["air_flow", "heater_power"].includes(named) ? names.get("air_flow_or_heater_power") : undefined;
  const own = names?.get(named);
  return own === undefined ? own : Math.min(own, either ?? own);
}
