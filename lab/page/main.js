// The page: brings a source, what it says, and what the user does together.
import { Charts, CLASSES } from "lab/charts.js";
import { forgetColours } from "lab/canvas.js";
import { readTrace } from "lab/csv.js";
import { Events, meant, namings } from "lab/events.js";
import { FOREVER, PARTS, describe } from "lab/faults.js";
import { Quiz } from "lab/quiz.js";
import { Review } from "lab/review.js";
import { RigDrawing } from "lab/rig.js";
import { ownNames, short } from "lab/say.js";
import { DEFAULT, fromLink, toLink } from "lab/scene.js";
import { Sheet } from "lab/sheet.js";
import { floats, fromRecording, fromServer, inWorker } from "lab/sources.js";
import { Store } from "lab/store.js";
import { current, escape, num, say, speak } from "lab/strings.js";
import { Tour } from "lab/tour.js";
import { quizLine, secondOpinion, stateLine, verdict, wanted } from "lab/verdict.js";

const PROTOCOL = 1;
const TEXT_EVERY = 150; // ms: numbers in words change no faster than they can be read
const CLOSE_FROM = 0.25; // s after a fault its close-up has something to show
const $ = (id) => document.getElementById(id);
const embedded = (id) => $(id)?.textContent.trim();
const keep = {
  get: (key) => { try { return localStorage.getItem("pt326-lab-" + key); } catch { return null; } },
  set: (key, value) => { try { localStorage.setItem("pt326-lab-" + key, value); } catch { /* a page from a file may keep nothing */ } },
};

const lab = {
  hello: null, store: null, events: null, can: new Set(), scene: structuredClone(DEFAULT),
  mode: "explore", speed: 1, paused: false, lost: 0, since: 0, stateOf: NaN, name: "", turned: 0, heard: 0,
};
const quiz = new Quiz();
const charts = new Charts({ stack: $("stack"), overview: $("overview") }, () => (dirty = true));
const rig = new RigDrawing($("rig"), (part, place) => lab.can.has("break") && !quiz.hides && (sheet.open(part, place), (dirty = true)));
const sheet = new Sheet($("sheet"), { order, closed: (part) => ((dirty = true), part && rig.parts[part]?.focus({ preventScroll: true })) });
const tour = new Tour($("tour"), {
  act, order, again: () => (dirty = true),
  busy: () => lab.store.get(lab.store.last, "alarm") > 0 || lab.events.active(lab.store.now).length > 0,
});
const review = new Review($("review"));
let source = null;
let dirty = true;
let asked = 0;
const answers = new Map();

// --- What the source says ---------------------------------------------------------------------------------------------------------

const HEAR = {
  hello(message) {
    if (message.protocol !== PROTOCOL) throw new Error(`protocol ${message.protocol}`);
    lab.hello = message;
    ownNames.clear();
    for (const [number, name] of message.own_names ?? []) ownNames.set(number, name);
    lab.can = new Set(message.can);
    lab.lost = 0;
    if (!lab.store || lab.session !== message.session || message.session === undefined) {
      lab.store = new Store(message);
      lab.events = new Events(message);
      charts.use(lab.store);
    }
    lab.session = message.session;
    if (message.scene) lab.scene = message.scene;
    show();
    if (message.kind === "simulated") begin();
  },
  opened({ scene }) {
    if (scene) lab.scene = { ...scene, orders: [] };
    lab.store.clear();
    lab.events.clear();
    lab.stateOf = NaN;
    // As a session begins; what its orders have changed they change again.
    $("excite").checked = true;
    for (const input of document.querySelectorAll("[data-set]")) input.value = input.defaultValue;
    for (const [tick, order] of scene?.orders ?? []) HEAR.order({ tick, order });
    charts.follow();
    show();
  },
  rows({ from, values }) {
    const { store, events } = lab;
    store.push(from, values);
    events.push(from, values, store.at, store.given);
    for (let tick = from; tick < store.end; tick++) {
      const mode = store.get(tick, "mode");
      if (mode === mode && mode !== lab.stateOf) [lab.stateOf, lab.since] = [mode, tick * store.ts];
    }
    quiz.follow(events);
    lab.heard = performance.now();
    lab.lost = 0;
    if (store.end !== lab.hello.count) return;
    review.show({ ...lab, charts });
    charts.show(Infinity, store.now - store.first * store.ts);
  },
  order({ tick, order }) {
    lab.events.order(tick, order);
    if (order.order === "excite") $("excite").checked = order.on;
    if (order.order === "set") {
      const input = document.querySelector(`[data-set="${CSS.escape(order.name)}"]`);
      if (input) input.value = order.value;
    }
  },
  running({ speed }) {
    lab.paused = speed === 0;
    if (speed) lab.speed = speed;
    show();
  },
  refused({ why, command }) {
    const i = lab.hello.trip_words?.findIndex((words) => why.includes(words)) ?? -1;
    toast(i < 0 ? say("refused", { why }) : say("persists", { why: say(`trip_${lab.hello.trips[i]}`) }));
    if (command?.command === "open" && command.scene !== DEFAULT) open(DEFAULT);
  },
  lost() {
    lab.lost ||= performance.now();
  },
  // Between the server and the board.
  link({ up }) {
    lab.lost = up ? 0 : lab.lost || performance.now();
  },
};

function hear(message) {
  dirty = true;
  if (message.id && answers.has(message.id)) {
    answers.get(message.id)(message);
    answers.delete(message.id);
  } else HEAR[message.type]?.(message);
}

// --- What the user does -----------------------------------------------------------------------------------------------------------

const send = (command) => source.send(command);
const ask = (command) => new Promise((resolve) => {
  const id = ++asked;
  answers.set(id, resolve);
  send({ ...command, id });
});
function order(what) {
  send({ command: "order", order: what });
}
function open(scene, more = { skip: true }) {
  send({ command: "open", scene, ...more });
}
function run(speed) {
  send({ command: "run", speed });
}

// A session of its own: what the link holds, or trained and at the point of monitoring.
function begin() {
  let linked = null;
  try {
    linked = fromLink(location.hash);
  } catch (error) {
    toast(say("bad_link", { why: error.message }));
  }
  if (linked) open(linked.scene, { at: linked.at });
  else open(DEFAULT);
  run(1);
}

const quick = (part, kind) => {
  const { fault, size } = PARTS[part][kind];
  order({ order: "break", fault: { ...fault(size.value), at: 0, for: 25 } });
};
const ACTS = {
  arm: () => order({ order: "arm" }),
  stop: () => order({ order: "stop" }),
  ack: () => order({ order: "acknowledge" }),
  mend: () => order({ order: "mend" }),
  relearn: () => order({ order: "relearn" }),
  skip: () => send({ command: "skip" }),
  surprise: () => (setMode("quiz"), startQuiz()),
  "quick-t2": () => quick("T2", "wrong"),
  "quick-air": () => quick("fan", "more"),
  "quiz-start": startQuiz,
  "quiz-answer": ({ name }) => quiz.answer(name),
  "quiz-end": () => setMode("explore"),
  setpoint: ({ by }) => order({ order: "setpoint", celsius: Math.round(lab.store.get(lab.store.last, "setpoint")) + Number(by) }),
  look: ({ at }) => charts.show(Number(at) + 15, 20),
};
function act(name, data = {}) {
  ACTS[name]?.(data);
  dirty = true;
}

function startQuiz() {
  quiz.start(order, lab.store.get(lab.store.last, "alarm") > 0);
  sheet.part && sheet.close();
  charts.follow();
  run(1);
}

function setMode(mode) {
  if (lab.mode === "quiz" && mode !== "quiz") quiz.end();
  lab.mode = mode;
  tour.show(mode === "tour");
  show();
}

document.addEventListener("click", ({ target }) => {
  const pressed = target.closest("[data-act]");
  if (pressed) act(pressed.dataset.act, pressed.dataset);
});
$("modes").addEventListener("click", ({ target }) => target.dataset.mode && setMode(target.dataset.mode));
$("transport").addEventListener("click", ({ target }) => {
  const { speed } = target.closest("button")?.dataset ?? {};
  if (speed) run(Number(speed));
  else if (target.closest("#pause")) run(lab.paused ? lab.speed : 0);
});
$("stop").addEventListener("click", () => act(arms() ? "arm" : "stop"));
$("follow").addEventListener("click", () => charts.follow());
$("language").addEventListener("click", () => {
  speak(current() === "en" ? "pt" : "en");
  keep.set("language", current());
  rig.fit(true);
  if (sheet.part) sheet.build();
  tour.show(lab.mode === "tour");
  show();
});
$("theme").addEventListener("click", () => {
  const { dataset } = document.documentElement;
  dataset.theme = dataset.theme === "dark" ? "light" : "dark";
  keep.set("theme", dataset.theme);
  forgetColours();
  show();
});
// On paper it is light.
addEventListener("beforeprint", () => {
  document.documentElement.dataset.theme = "light";
  forgetColours();
  show();
  if (lab.store?.end) charts.draw(lab.events, quiz.hides);
});
$("excite").addEventListener("change", ({ target }) => order({ order: "excite", on: target.checked }));
for (const input of document.querySelectorAll("[data-set]")) {
  input.addEventListener("change", () => order({ order: "set", name: input.dataset.set, value: Number(input.value) }));
}
for (const id of ["preset", "disturbance", "seed"]) {
  $(id).addEventListener("change", () => {
    const scene = { ...DEFAULT, preset: $("preset").value, disturbance: $("disturbance").value, seed: Number($("seed").value) };
    quiz.end();
    open(scene);
    run(lab.speed);
  });
}
$("series").addEventListener("change", ({ target }) => charts.toggle(target.value, target.checked));
$("seek").addEventListener("input", ({ target }) => send({ command: "seek", tick: Number(target.value) }));
$("download").addEventListener("click", async () => {
  const { parts, type, why } = await ask({ command: "trace" });
  if (type !== "trace") return toast(say("refused", { why }));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(parts, { type: "text/csv" }));
  link.download = "trace.csv";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  toast(say("replay_with", { file: "trace.csv", seed: lab.scene.seed }));
});
$("link").addEventListener("click", async () => {
  const { scene, tick } = await ask({ command: "scene" });
  history.replaceState(null, "", "#" + toLink(scene, tick));
  try {
    await navigator.clipboard.writeText(location.href);
    toast(say("copied"));
  } catch {
    toast(say("link_in_bar"));
  }
});
$("file").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  if (!file) return;
  try {
    const { values, ts } = readTrace(await file.text(), lab.hello);
    use((hear) => fromRecording(hear, { hello: { ...lab.hello, ts, session: undefined }, name: file.name, values }));
  } catch (error) {
    toast(say("bad_trace", { why: error.message }));
  }
  target.value = "";
});
addEventListener("hashchange", () => lab.hello?.kind === "simulated" && location.hash && begin());
addEventListener("resize", () => {
  dirty = true;
  if (sheet.part) sheet.arrange();
  if (!$("review").hidden) review.show({ ...lab, charts });
});
addEventListener("keydown", (event) => {
  if (/INPUT|SELECT|TEXTAREA/.test(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "!" ) act("stop");
});

let toastUntil = null;
function toast(text) {
  $("toast").textContent = text;
  $("toast").classList.add("shown");
  clearTimeout(toastUntil);
  toastUntil = setTimeout(() => $("toast").classList.remove("shown"), 7000);
}

// --- What is shown ----------------------------------------------------------------------------------------------------------------

const isOff = () => [0, 4].includes(lab.stateOf);
// Of a real board the button only ever stops: whoever presses it twice must not arm.
const arms = () => isOff() && lab.hello.kind !== "board";
const shown = new Map();
// Changes a node only where its text has changed: what has the focus keeps it.
function put(id, html) {
  if (shown.get(id) === html) return;
  shown.set(id, html);
  $(id).innerHTML = html;
}

// What changes with language, mode and source.
function show() {
  for (const node of document.querySelectorAll("[data-say]")) node.textContent = say(node.dataset.say);
  for (const node of document.querySelectorAll("[data-label]")) node.setAttribute("aria-label", say(node.dataset.label));
  document.title = lab.hello?.kind === "recording" ? `PT-326: ${lab.hello.name}` : say("title");
  if (lab.hello?.kind !== "recording") $("review").hidden = true;
  else if (lab.store.end === lab.hello.count) review.show({ ...lab, charts });
  $("language").textContent = current() === "en" ? "PT" : "EN";
  $("language").lang = current() === "en" ? "pt" : "en";
  const { kind, name } = lab.hello ?? {};
  if (kind) {
    const text = { simulated: say("source_simulated", { seed: lab.scene.seed }), recording: say("source_recording", { name: escape(name) }), board: say("source_board", { name: escape(name) }) };
    $("source").lastElementChild.innerHTML = text[kind] ?? say("source_live", { name: escape(name ?? kind) });
  }
  for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === lab.mode);
  for (const button of document.querySelectorAll("[data-speed]")) {
    button.setAttribute("aria-pressed", !lab.paused && Number(button.dataset.speed) === lab.speed);
  }
  $("pause").setAttribute("aria-label", say(lab.paused ? "play" : "pause"));
  $("pause").querySelector("path").setAttribute("d", lab.paused ? "M2 1l9 5-9 5z" : "M1.5 1h3v10h-3zM7.5 1h3v10h-3z");
  $("transport").hidden = !lab.can.has("run");
  const orders = lab.can.has("order");
  $("stop").hidden = !orders;
  $("stop").classList.toggle("large", kind === "board");
  $("modes").hidden = !lab.can.has("break");
  $("desk-control").hidden = !orders;
  $("excite").parentElement.hidden = kind === "board"; // a board has no command for it
  $("desk-rig").hidden = !lab.can.has("open");
  $("download").hidden = !lab.can.has("trace");
  $("link").hidden = !lab.can.has("trace") || kind !== "simulated";
  $("seek").hidden = !lab.can.has("seek");
  if (kind === "recording") $("seek").max = lab.hello.count;
  Object.assign($("preset"), { value: lab.scene.preset });
  $("disturbance").value = lab.scene.disturbance;
  $("seed").value = lab.scene.seed;
  put("series", charts.choices.map(({ title, series }) => `<fieldset><legend>${title}</legend>${series.map((s) =>
    `<label><input type="checkbox" value="${s.id}" ${s.on ? "checked" : ""}><i style="background:var(${s.css})"></i>${s.label}</label>`).join("")}</fieldset>`).join(""));
  $("stack").setAttribute("aria-label", `${say("region_charts")}. ${say("charts_help")}`);
  $("stack").title = "";
  $("overview").title = say("charts_help");
  dirty = true;
}

let lastText = 0;
let before = performance.now();
function frame(now) {
  const passed = Math.min(0.1, (now - before) / 1000);
  before = now;
  const { store, hello } = lab;
  if (store && store.end > 0) {
    const moving = !lab.paused && !lab.lost;
    if (moving) lab.turned += passed * Math.min(3, lab.speed);
    if (lab.lost) dirty = true;
    // Between two ticks the axis moves on, so that it does not jerk.
    charts.lead = Math.min(0, ((now - lab.heard) / 1000) * lab.speed - store.ts);
    if (!moving) charts.lead = 0;
    const row = store.row(store.last);
    const said = verdict({ row, hello, events: lab.events, since: lab.since, can: lab.can, lost: lab.lost && now - lab.lost });
    const hide = quiz.hides;
    if (moving || dirty) drawRig(row, said, hide);
    if (dirty || (moving && charts.following)) charts.draw(lab.events, hide);
    if (dirty || now - lastText > TEXT_EVERY) {
      write(row, said, hide);
      lastText = now;
    }
    dirty = false;
  }
  requestAnimationFrame(frame);
}

function drawRig(row, said, hide) {
  rig.fit();
  const blamed = hide ? [] : said.parts ?? [];
  const should = hide ? null : wanted(row, said.name);
  const air = lab.events.active(row.t).find((p) => p.fault.do === "air-flow" && !hide);
  const off = isOff();
  rig.draw({ row, t: lab.turned, flow: air ? air.fault.size : 1, blamed, wanted: should, chosen: sheet.part, off, tripped: row.mode === 4 });
}

function write(row, said, hide) {
  const asks = lab.mode === "quiz" && (quiz.hides || !["tripped", "lost", "learn", "off"].includes(said.state));
  const view = asks ? { ...said, ...quiz.view(row.t) } : said;
  const { body } = document;
  body.dataset.state = asks ? "quiz" : said.state;
  put("state", asks ? quizLine(view.line) : stateLine(said));
  put("head", view.head);
  put("sub", view.sub);
  put("more", view.more);
  put("second", asks ? "" : row.mode === 3 ? secondOpinion(row) : "");
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
  const mend = `<button class="plain small" data-act="mend">${say("mend")}</button>`;
  const idle = lab.can.has("break") && !hide ? say("hint_click") : "";
  put("hint", lines.length ? `<span>${lines.join("<br>")}</span>${mend}` : idle);
}

function beside(row, said, hide) {
  $("why").hidden = hide || !("x_drift" in lab.store.at);
  const shares = CLASSES.map((c) => ({ ...c, share: row[c.field] })).filter((c) => c.share > 0.005);
  const any = row.alarm > 0 && shares.length > 0;
  const sensor = row.alarm > 0 && !shares.length && said.name && lab.hello.kind !== "recording";
  const s = num(Math.max(0.1, row.t - row.onset * lab.store.ts), 1);
  put("whynote", any ? say("why_note", { s }) : sensor ? say("why_sensor") : say("nothing_to_explain"));
  const blames = (c) => meant(said.name).includes(c.name);
  const rank = (c) => c.share + (blames(c) ? 0.01 : 0); // of two that explain it alike, the one that is named
  const order = (any ? shares.sort((a, b) => rank(b) - rank(a)) : []).slice(0, 7);
  const bar = (c) => {
    const { name, css, share } = c;
    const p = num(100 * share, 0);
    return `<li class="${blames(c) ? "best" : ""}" style="--c:var(${css})"><span>${short(name)}</span><span class="track"><i style="width:${(100 * share).toFixed(1)}%"></i></span><output>${p} %</output></li>`;
  };
  put("bars", order.map(bar).join(""));
  const list = lab.events.list.filter((event) => !(hide && event === quiz.event));
  const last = list[list.length - 1];
  const close = last && lab.store.has(lab.store.tickAt(last.from)) && row.t > last.from + CLOSE_FROM && (last.truth || last.alarm !== undefined);
  $("close").hidden = !close;
  if (close) {
    $("closetitle").textContent = say("closeup", { s: num(last.from) });
    $("closeup").setAttribute("aria-label", `${say("closeup", { s: num(last.from) })}: ${last.label()}`);
    charts.drawCloseup($("closeup"), last);
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
  if (event.truth) return TRUTHS[event.truth] ? say(TRUTHS[event.truth]) : short(event.named ?? "unknown");
  return say("no_fault", { what: short(event.named) });
};

// --- Begin ------------------------------------------------------------------------------------------------------------------------

function use(make) {
  source?.close();
  Object.assign(lab, { store: null, session: undefined });
  source = make(hear);
}
const useRig = () => use((hear) => inWorker(hear, { worker: embedded("worker"), wasm: embedded("wasm") }));

speak(keep.get("language") ?? (navigator.language?.startsWith("pt") ? "pt" : "en"));
document.documentElement.dataset.theme = keep.get("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
show();
if ($("recording")) {
  const { hello, name, values, orders, first } = JSON.parse(embedded("recording"));
  use((hear) => fromRecording(hear, { hello, name, orders, first, values: floats(values) }));
} else if ($("token")) use((hear) => fromServer(hear, embedded("token")));
else useRig();
requestAnimationFrame(frame);
// For tests and the curious.
window.lab = { lab, charts, quiz, events: () => lab.events, ask, send, row: () => lab.store.row(lab.store.last) };
