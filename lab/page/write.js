// What changes with time: the rig's drawing, the sentence and what stands beside it.
import { course } from "lab/acts.js";
import { asking, beside as besideBoard } from "lab/board.js";
import { drawCloseup } from "lab/closeup.js";
import { Events, meant, namings } from "lab/events.js";
import { FOREVER, describe } from "lab/faults.js";
import { measure } from "lab/measure.js";
import { CLASSES } from "lab/panels.js";
import { charts, exam, quiz, rig, sheet } from "lab/parts.js";
import { short } from "lab/say.js";
import { $, arms, isOff, lab, plant, put } from "lab/state.js";
import { num, say } from "lab/strings.js";
import { askedLine, secondOpinion, stateLine, wanted } from "lab/verdict.js";

const CLOSE_FROM = 0.25; // s after a fault its close-up has something to show

export function drawRig(row, said, hide) {
  rig.fit(plant(), lab.hello.kind === "board");
  const blamed = hide ? [] : said.parts ?? [];
  const should = hide ? null : wanted(row, said.name);
  const air = lab.events.active(row.t).find((p) => p.fault.do === "air-flow" && !hide);
  const off = isOff();
  rig.draw({ row, t: lab.turned, flow: air ? air.fault.size : 1, blamed, wanted: should, chosen: sheet.part, off, tripped: row.mode === 4 });
}

export function write(row, said, hide) {
  const asked = lab.mode === "quiz" && (quiz.hides || !["tripped", "lost", "learn", "off"].includes(said.state)) ? quiz : null;
  const asks = exam.on ? exam : asked;
  const view = asks ? { ...said, ...asks.view(row.t) } : said;
  const { body } = document;
  body.dataset.state = asks ? "quiz" : said.state;
  put("state", asks ? askedLine(say(exam.on ? "exam" : "state_quiz"), view.line) : stateLine(said));
  put("head", view.head);
  put("sub", view.sub);
  put("more", view.more);
  asking();
  put("second", asks ? "" : [row.mode === 3 && secondOpinion(row), said.name && said.name !== "unknown" && say("confidence_note")].filter(Boolean).join(" "));
  $("head").classList.toggle("long", view.head.replace(/<[^>]*>/g, "").length > 44);
  announce(asks ? view.head.replace(/\d+/, "") : `${said.word}: ${said.name ? short(said.name) : said.head.replace(/<[^>]*>/g, "")}`);
  $("clock").textContent = `${num(row.t)} s`;
  // After a trip the way on stands below the sentence; a real board can always be told to stop.
  $("stop").hidden = !lab.can.has("order") || (row.mode === 4 && lab.can.has("break"));
  $("stop").textContent = say(arms() ? "arm" : "stop");
  $("stop").classList.toggle("rests", arms());
  $("setpoint").textContent = `${num(row.setpoint)} °C`;
  $("follow").hidden = charts.following;
  if (lab.can.has("seek")) $("seek").value = lab.store.end;
  if (lab.hello.kind === "board") besideBoard();
  course.follow(row, row.alarm > 0 || lab.events.active(row.t).length > 0);
  measure();
  hint(row, hide);
  beside(row, said, hide);
}

let announced = "";
function announce(text) {
  if (text === announced) return;
  announced = text;
  $("live").textContent = text;
}

function hint(row, hide) {
  const active = hide ? [] : lab.events.active(row.t);
  const lines = active.map(({ fault, to }) => {
    const what = describe(fault);
    return fault.for >= FOREVER ? what : say("left_s", { what, s: num(to - row.t, 0) });
  });
  const mend = lab.can.has("break") && `<button class="plain small" data-act="mend">${say("mend")}</button>`;
  const idle = lab.can.has("break") && !hide ? say("hint_click") : "";
  put("hint", lines.length ? `<span>${lines.join("<br>")}</span>${mend || ""}` : idle);
}

function beside(row, said, hide) {
  $("why").hidden = !!hide || !("x_drift" in lab.store.at);
  const shares = CLASSES.map((c) => ({ ...c, share: row[c.field] })).filter((c) => c.share > 0.005);
  const any = row.alarm > 0 && shares.length > 0;
  const sensor = row.alarm > 0 && /_(open|short|lost)$/.test(said.name);
  const s = num(Math.max(0.1, row.t - row.onset * lab.store.ts), 1);
  put("whynote", any ? say("why_note", { s }) : sensor ? say("why_sensor") : row.alarm > 0 ? "" : say("nothing_to_explain"));
  const blames = (c) => meant(said.name).includes(c.name);
  const rank = (c) => c.share + (blames(c) ? 0.01 : 0); // of two that explain it alike, the one that is named
  const order = (any ? shares.sort((a, b) => rank(b) - rank(a)) : []).slice(0, 7);
  const bar = (c) => {
    const { name, css, share } = c;
    const p = num(100 * share, 0);
    return `<li class="${blames(c) ? "best" : ""}" style="--c:var(${css})"><span>${short(name)}</span><span class="track"><i style="width:${(100 * share).toFixed(1)}%"></i></span><output>${p} %</output></li>`;
  };
  put("bars", order.map(bar).join(""));
  const list = lab.events.list.filter((event) => !hide?.(event));
  const last = list[list.length - 1];
  const close = last && lab.store.has(lab.store.tickAt(last.from)) && row.t > last.from + CLOSE_FROM * lab.store.slow && (last.truth || last.alarm !== undefined);
  $("close").hidden = !close;
  if (close && lab.open.has("why")) {
    $("closetitle").textContent = say("closeup", { s: num(last.from) });
    $("closeup").setAttribute("aria-label", `${say("closeup", { s: num(last.from) })}: ${last.label()}`);
    drawCloseup($("closeup"), last, lab.store);
  }
  const delay = (t, from) => (t === undefined ? "–" : `${num(t - from, 2)} s`);
  const named = (event) => {
    const [one, two] = namings(event);
    const either = two ? `<small>${short(one.name)} ${delay(one.t, event.from)}</small>` : "";
    return either + delay((two ?? one)?.t, event.from);
  };
  const lines = list.slice(-8).reverse().map((event) => {
    const now = event === last && row.alarm > 0;
    return `<tr class="${now ? "now" : ""}"><td>${num(event.from, 0)}</td><td><button data-act="look" data-at="${event.from}">${event.label()}</button></td><td>${event.truth ? named(event) : ""}</td><td>${event.truth ? delay(event.isolated, event.from) : ""}</td></tr>`;
  });
  put("events", lines.join("") || `<tr><td></td><td colspan="3">${say("nothing_yet")}</td></tr>`);
}

// What an event is called: the fault that was put in, as far as it is known, or what was said.
const TRUTHS = { 1: "c_t2_offset", 2: "c_t1_clogged", 3: "c_air_flow" };
Events.label = (event) => {
  if (event.fault) return describe(event.fault);
  if (event.truth) return TRUTHS[event.truth] ? say(TRUTHS[event.truth]) : (event.named ? short(event.named) : say("fault_put_in"));
  // Where nobody knows what was true, an alarm is no false one.
  const known = lab.can.has("break") || lab.events.list.some(({ truth }) => truth);
  return known ? say("no_fault", { what: short(event.named) }) : short(event.named);
};
