// What the source says.
import { course, setMode } from "lab/acts.js";
import { agrees, image, kept, said } from "lab/board.js";
import { beginReport, noted } from "lab/commissioning.js";
import { Events } from "lab/events.js";
import { fromExam } from "lab/exam_text.js";
import { charts, exam, quiz, review } from "lab/parts.js";
import { hold } from "lab/plan.js";
import { ownNames, refusal, taughtNames } from "lab/say.js";
import { DEFAULT, fromLink } from "lab/scene.js";
import { reveal, show } from "lab/show.js";
import { $, lab, toast } from "lab/state.js";
import { Store } from "lab/store.js";
import { say } from "lab/strings.js";
import { open, run } from "lab/talk.js";

const PROTOCOL = 1;

let arrives = false; // the scene of a link, which is told once it has opened

// A session of its own: what the link holds, or trained and at the point of monitoring.
export function begin() {
  let linked = lab.left;
  try {
    const paper = !linked && fromExam(location.hash);
    if (paper) return hold(paper);
    const fromHash = linked ? null : fromLink(location.hash);
    arrives = !!fromHash;
    linked ??= fromHash;
  } catch (error) {
    toast(say("bad_link", { why: error.message }));
  }
  if (linked) open(linked.scene, { at: linked.at });
  else open(DEFAULT);
  lab.left = null;
  run(1);
}

// Once for all settings that come before the next frame: a scene may hold thousands.
let shows = 0;
function showSoon() {
  shows ||= requestAnimationFrame(() => ((shows = 0), show()));
}

function found() {
  if (!lab.lost) return;
  lab.lost = 0;
  show();
}

export const HEAR = {
  hello(message) {
    if (message.protocol !== PROTOCOL) throw new Error(`protocol ${message.protocol}`);
    lab.hello = message;
    lab.can = new Set(message.can);
    lab.lost = 0;
    Object.assign(lab, { agrees: null, image: null, kept: null });
    if (!lab.store || lab.session !== message.session || message.session === undefined) {
      lab.store = new Store(message);
      lab.events = new Events(message);
      charts.use(lab.store, message);
      lab.settings = message.settings; // changes since are told as orders
    }
    lab.session = message.session;
    HEAR.names(message);
    if (message.scene) lab.scene = message.scene;
    if (!lab.can.has("break") && lab.mode !== "explore") setMode("explore");
    if (message.kind === "board") lab.open.add("desk"); // what is done first is there
    show();
    if (message.kind === "board") beginReport();
    if (message.kind !== "simulated") return;
    lab.usual = message.settings;
    begin();
  },
  opened({ scene, ts = lab.hello.ts, settings = lab.hello.settings, session = lab.session, name = lab.hello.name }) {
    Object.assign(lab, { session });
    lab.hello.name = name;
    if (scene) lab.scene = { ...scene, orders: [] };
    lab.settings = settings;
    for (const kept of [lab.store, lab.events]) {
      kept.use(ts);
      kept.clear();
    }
    lab.stateOf = NaN;
    quiz.end(); // what it asked about is void, whoever opened the scene
    if (scene) exam.opened(scene);
    // As a session begins; what its orders have changed they change again.
    $("excite").checked = true;
    for (const [tick, order] of scene?.orders ?? []) HEAR.order({ tick, order });
    charts.bind();
    charts.follow();
    show();
    course.opened();
    if (!arrives) return;
    arrives = false;
    toast(say("opened", { what: say("scene") }));
    reveal("say");
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
    if (exam.follow(store.now)) show();
    lab.heard = performance.now();
    found();
    if (store.end !== lab.hello.count) return;
    review.show(lab);
    charts.show(Infinity, store.now - store.first * store.ts);
  },
  order({ tick, order }) {
    lab.events.order(tick, order);
    exam.ordered(tick * lab.store.ts, order);
    if (order.order === "excite") $("excite").checked = order.on;
    if (order.order === "set") {
      lab.settings = { ...lab.settings, [order.name]: order.value };
      showSoon();
    }
  },
  running({ speed }) {
    lab.paused = speed === 0;
    if (speed) lab.speed = speed;
    show();
  },
  refused(message) {
    toast(refusal(message), message.code === "stop_gone");
    if (message.command?.order?.order === "set") document.activeElement.blur();
    show(); // what was chosen and refused is not so
    if (message.command?.command === "open") arrives = false;
    if (message.command?.command === "open" && !lab.store.end) open(DEFAULT);
  },
  lost() {
    lab.checking = false; // how it goes on is not heard
    if (lab.lost) return;
    lab.lost = performance.now();
    show();
    if (lab.hello.kind === "board") toast(say("head_lost_board")); // also who works at the desk, far below the sentence, sees that
  },
  agrees, image, kept,
  said(message) {
    said(message);
    noted(message);
  },
  names({ own_names = [], taught_names = [] }) {
    ownNames.clear();
    for (const [number, name] of own_names) ownNames.set(number, name);
    taughtNames.splice(0, Infinity, ...taught_names);
  },
  // Between the server and the board.
  link({ up }) {
    if (up) found();
    else HEAR.lost();
  },
};
