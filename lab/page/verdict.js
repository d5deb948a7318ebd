// The large sentence: the state, one claim, what it rests on, how much and how soon.
import { namings } from "lab/events.js";
import { recognise } from "lab/faults.js";
import { asTaught, blamed, delays, headline, isOffset, papers, support, unitOf } from "lab/say.js";
import { num, say, sayHtml } from "lab/strings.js";

const ICONS = {
  alarm: '<path d="M9 1.5 17 16H1z" fill="currentColor"/><path d="M9 6.5v4.6M9 13v.8" stroke="var(--bg)" stroke-width="1.8" stroke-linecap="round"/>',
  ok: '<circle cx="9" cy="9" r="8" fill="currentColor"/><path d="m5.2 9.4 2.6 2.6 5-5.6" fill="none" stroke="var(--bg)" stroke-width="1.9"/>',
  learn: '<circle cx="9" cy="9" r="7" fill="none" stroke="currentColor" stroke-width="2" stroke-dasharray="30 14"/>',
  off: '<circle cx="9" cy="9" r="7.2" fill="none" stroke="currentColor" stroke-width="2"/><path d="M4 14 14 4" stroke="currentColor" stroke-width="2"/>',
  ask: '<circle cx="9" cy="9" r="8" fill="currentColor"/><path d="M6.6 7a2.4 2.4 0 1 1 3.4 2.2c-.7.3-1 .7-1 1.5M9 13v.5" fill="none" stroke="var(--bg)" stroke-width="1.7" stroke-linecap="round"/>',
};
const icon = (name) => `<svg viewBox="0 0 18 18" width="18" height="18" aria-hidden="true">${ICONS[name]}</svg>`;
const button = (act, key, primary) => `<button class="${primary ? "primary" : "plain"}" data-act="${act}">${say(key)}</button>`;
// What heats wants a second press, at a button that says so meanwhile (board.js).
const heats = (what, label, primary) => `<button class="${primary ? "primary" : "plain"}" data-line="${what}" data-heats data-say="${label}">${say(label)}</button>`;
const row = (...buttons) => `<div class="row">${buttons.join("")}</div>`;
// The parts of which a trip speaks; those of the others begin with theirs.
const TRIPPED = { air_flow_lost: ["fan", "heater"], heater_stuck_on: ["heater"], sensors_disagree: ["T1", "T2"], t1_contradicted: ["T1", "T2"], no_response: ["T1"], excess_power: [], out_of_reach: [] };
// What to say of a row. `can` tells which buttons make sense, `since` when the state began, `begun` its first row.
export function verdict({ row: now, hello, events, since, begun, ts, settings, can, checking, lost, next }) {
  const at = now.t;
  const aside = say("for_s", { s: num(Math.max(0, at - since), 0) });
  const [order, mends] = [can.has("order"), can.has("break")];
  if (lost) {
    const s = num(lost / 1000, 0);
    const of = hello.kind === "board" ? "_board" : "";
    return { state: "lost", icon: "off", word: say("state_lost"), aside: say("for_s", { s }), head: say(`head_lost${of}`), sub: say(`sub_lost${of}`), more: "" };
  }
  if (now.mode === 4) {
    // First what is wrong, then the word that it was seen.
    const broken = events.active(at).length > 0;
    const acknowledge = button("ack", "acknowledge", !broken);
    const ways = mends ? [button("mend", "mend_all", broken), acknowledge] : [acknowledge];
    const more = order ? row(...(broken ? ways : ways.reverse())) : "";
    const reason = hello.trips[now.trip - 1] ?? "unknown";
    // A thermistor whose wires touch reads as hot as can be, and not as anything that is shown.
    const shorted = reason === "t2_over_temperature" && !Number.isFinite((begun ?? now).t2);
    const parts = TRIPPED[reason] ?? [reason.slice(0, 2).toUpperCase()];
    const off = say("heater_off_since", { s: num(since, 1) });
    return { state: "tripped", icon: "off", word: say("state_tripped"), aside: off, head: say(`trip_${shorted ? "t2_short" : reason}`), sub: say(mends && !broken ? "acknowledge_now" : "acknowledge_first"), more, parts };
  }
  // What leads on to monitoring, also while an alarm stands.
  const on = !order ? "" : now.mode === 0 ? (hello.kind === "board" ? firstDay(next) : row(button("arm", "arm", true))) : now.mode < 3 && can.has("run") ? row(button("skip", "skip", true)) : "";
  if (now.alarm > 0) {
    const said = alarm(now, hello, events, ts);
    return { ...said, more: said.more + (order && !mends && now.mode === 3 ? answers(now, named(now, hello)) : on) };
  }
  if (checking && now.mode === 0) {
    return { state: "learn", icon: "learn", word: say("state_check"), aside: "", head: say("head_check"), sub: say("sub_check"), more: "" };
  }
  if (now.mode === 0) {
    return { state: "off", icon: "off", word: say("state_off"), aside, head: say("head_off"), sub: say("sub_off"), more: on };
  }
  if (now.mode === 5) {
    return { state: "learn", icon: "learn", word: say("state_tune"), aside, head: say("head_tune"), sub: say("sub_tune"), more: "" };
  }
  if (now.mode < 3) {
    const [begins, ends] = ["learn_start", "learn_end"].map((name) => settings[`supervisor.${name}`]);
    const left = Math.max(0, (now.mode === 2 ? ends - begins : ends) - (at - since));
    const blocked = hello.blockers[now.blocked - 1];
    const waits = blocked && say("sub_blocked", { why: say(`block_${blocked}`) });
    const share = now.mode === 2 ? Math.min(1, (now.learned * ts) / (ends - begins)) : Math.min(1, (at - since) / begins);
    const bar = `<div class="progress"><i style="width:${(100 * share).toFixed(0)}%"></i></div>`;
    const head = now.mode === 2 ? say("head_learn") : say("head_settle", { setpoint: num(now.setpoint) });
    const word = say(now.mode === 2 ? "state_learn" : "state_settle");
    const sub = waits || say("sub_learn", { s: num(left, 0) });
    return { state: "learn", icon: "learn", word, aside: "", head, sub, more: bar + on };
  }
  const why = hello.readiness[now.readiness]?.match(/^(refused|restarted)/)?.[0];
  if (why) {
    return { state: "learn", icon: "learn", word: say("state_monitor"), aside, head: say(`head_${why}`), sub: say("sub_refused"), more: "" };
  }
  const expected = Number.isFinite(now.t1_expected);
  const sub = expected
    ? sayHtml("sub_monitor", { t1: num(now.t1), e1: num(now.t1_expected), t2: num(now.t2), e2: num(now.t2_expected) })
    : "";
  const more = mends ? row(button("surprise", "surprise", true), ...QUICK.map(([act, key]) => button(act, key))) : "";
  return { state: "monitor", icon: "ok", word: say("state_monitor"), aside, head: say("head_monitor"), sub, more };
}

const named = (now, hello) => hello.classes.find((c) => c.number === now.class);

// What a user can say of an alarm: only what has a size may be shelved or accepted.
function answers(now, found) {
  const may = (what) => Number.isFinite(now.magnitude) && found?.[what];
  const ways = now.advice > 0 ? [] : [button("ack", "acknowledge"), ...(may("shelved") ? [button("shelve", "shelve")] : [])];
  return row(...ways, ...(may("accepted") ? [button("accept", "accept")] : []));
}

// Of a board that is off, the step of the first day that comes next; only where that is to arm does a dark button heat.
function firstDay(next) {
  const arms = !next || next === "c_normal";
  const step = arms ? "" : `<button class="primary" data-act="next-step">${say("next_step", { what: say(next).split(/[:,]/)[0] })}</button>`;
  return row(step, heats("arm", "c_arm", arms));
}

// Two faults that are one click away.
const QUICK = [
  ["quick-t2", "quick_t2"],
  ["quick-air", "quick_air"],
];

function alarm(now, hello, events, ts) {
  const name = named(now, hello)?.name;
  const event = events.last;
  const aside = event?.alarm === undefined ? "" : say("for_s", { s: num(now.t - event.alarm, 0) });
  const advice = now.advice > 0;
  const common = { state: advice ? "advice" : "alarm", icon: "alarm", word: say(advice ? "state_advice" : "state_alarm"), aside };
  const over = event?.truth && event.alarm !== undefined ? now.t - event.to : NaN;
  const loose = /_loose$/.test(name); // its alarm stands until the contact has held for minutes
  if (loose && over >= 0) return { ...common, name, parts: blamed(name), head: say("head_ending"), sub: say("sub_ending_loose", { s: num(over, 0), part: blamed(name)[0] }), more: "" };
  // Until the alarm clears, whatever it is called by then: it is about what has ended.
  if (over >= 0) return { ...common, head: say("head_ending"), sub: say("sub_ending", { s: num(over, 0) }), more: "" };
  if (!name) return { ...common, head: say("head_unnamed"), sub: now.taught > 0 ? asTaught(now) : say("sub_unnamed"), more: "" };
  const more = [];
  if (Number.isFinite(now.magnitude)) more.push(howMuch(name, now, event));
  const names = namings(event);
  if (event?.truth && names.length) more.push(howSoon(event, names));
  const gauges = more.length ? `<div class="gauge">${more.join("")}</div>` : "";
  const apart = names.length > 1 ? ` ${say("told_apart", { s: num(names[1].t - event.from) })}` : "";
  return { ...common, name, parts: blamed(name), head: headline(name, now.magnitude), sub: support(name, now, ts) + apart, more: gauges };
}

export const secondOpinion = (now) => (now.fdv >= 0 ? say("paper_says", { what: papers(now.fdv, now.fiv) }) : "");

// What a thermistor that is blamed should read.
export function wanted(now, name) {
  const [part] = blamed(name);
  if (!/^T[12]$/.test(part) || /open|short|lost/.test(name)) return null;
  const t = part.toLowerCase();
  const celsius = isOffset(name) && Number.isFinite(now.magnitude) ? now[t] - now.magnitude : now[t + "_expected"];
  return Number.isFinite(celsius) ? { part, celsius } : null;
}

const WIDTH = 330;
const svg = (label, body) => `<svg viewBox="0 0 ${WIDTH} 44" role="img" aria-label="${label}">${body}</svg>`;
const text = (x, y, words, more = "") => `<text x="${x.toFixed(1)}" y="${y}" ${more}>${words}</text>`;

function howMuch(name, now, event) {
  const unit = unitOf(name);
  const decimals = unit === "%" ? 1 : 2;
  const [value, half] = [Math.abs(now.magnitude), Number.isFinite(now.half_width) ? now.half_width : 0];
  const known = event?.fault && recognise(event.fault);
  const truth = known && known.name === name && known.magnitude != null ? Math.abs(known.magnitude) : null;
  const most = Math.max(value + half, truth ?? 0) * 1.15;
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((s) => most / s <= 6) ?? 200;
  const end = Math.ceil(most / step) * step;
  const X = (v) => 4 + (Math.max(0, v) / end) * (WIDTH - 8);
  let body = `<path d="M4 22H${WIDTH - 4}" class="axis"/>`;
  for (let v = 0; v <= end + 1e-9; v += step) {
    const last = v + step > end + 1e-9;
    body += `<path d="M${X(v)} 22v4" class="tick"/>`;
    body += text(X(v), 40, num(v, step < 1 ? 1 : 0) + (last ? ` ${unit}` : ""), `text-anchor="${last ? "end" : v ? "middle" : "start"}"`);
  }
  body += `<rect x="${X(value - half)}" y="15" width="${X(value + half) - X(value - half)}" height="14" rx="3" class="interval"/>`;
  body += `<path d="M${X(value)} 12v20" class="value"/>`;
  if (truth !== null) body += `<path d="M${X(truth)} 4l4 5-4 5-4-5z" class="truth"/>`;
  const interval = say("to", { a: num(value - half, decimals), b: num(value + half, decimals) });
  const place = Math.max(X(value + half), truth === null ? 0 : X(truth)) + 9;
  const fits = place + 84 < WIDTH;
  if (half) body += text(fits ? place : X(Math.min(value - half, truth ?? Infinity)) - 9, 11, interval, `class="strong" text-anchor="${fits ? "start" : "end"}"`);
  const label = `${say("how_much")}: ${num(value, decimals)} ${unit}, ${interval}`;
  return `<span>${say("how_much")}${truth === null ? "" : `<small>${say("truth_mark")}</small>`}</span>${svg(label, body)}`;
}

function howSoon(event, names) {
  const soon = names.map(({ t }) => t - event.from);
  const [a, b] = [soon[soon.length - 1], event.isolated - event.from];
  const detected = event.detected - event.from;
  const end = [2, 5, 10, 20, 40, 100, 200, 500, 1000].find((s) => s >= Math.max(a, b || 0) * 1.2) ?? 5000;
  const X = (s) => 4 + (Math.min(end, s) / end) * (WIDTH - 8);
  let body = `<path d="M4 22H${WIDTH - 4}" class="axis"/><path d="M4 22H${X(a)}" class="value"/>`;
  for (const s of soon) body += `<circle cx="${X(s)}" cy="22" r="5" class="dot"/>`;
  const own = delays(names, event.from);
  const late = names.length < 2 && X(a) > WIDTH / 2;
  body += text(names.length > 1 ? 4 : late ? Math.min(WIDTH - 4, X(a) + 4) : X(a) - 4, 10, own, `class="strong" text-anchor="${late ? "end" : "start"}"`);
  let paper = say("paper_nothing");
  if (b >= 0) {
    body += `<circle cx="${X(b)}" cy="22" r="5" class="other"/>`;
    paper = say("paper_s", { s: num(b, 2) });
  } else if (detected >= 0) paper = say("paper_detected", { s: num(detected, 2) });
  const right = !(b >= 0) || X(b) > WIDTH - 110;
  body += text(right ? WIDTH - 4 : Math.max(4, X(b) - 6), 40, paper, `text-anchor="${right ? "end" : "start"}"`);
  return `<span>${say("how_soon")}</span>${svg(`${say("how_soon")}: ${own}, ${paper}`, body)}`;
}

export const stateLine = ({ icon: name, word, aside }) => `${icon(name)}<span>${word}${aside ? ` <span class="aside">${aside}</span>` : ""}</span>`;
export const askedLine = (word, aside) => stateLine({ icon: "ask", word, aside });
