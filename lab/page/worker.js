// The session in a worker: the instrument's own code as WebAssembly, and a clock. It is a source of the protocol (PROTOCOL.md). Or the
// conversation with a board, whose port the page holds.
"use strict";
let wasm, width, ts;
let speed = 0, owed = 0, before = 0, tick = 0;
const MOST_AT_ONCE = 2000;

const text = (n) => new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, wasm.output(), Math.abs(n)).slice());
function put(value) {
  const bytes = value instanceof Uint8Array ? value : new TextEncoder().encode(typeof value === "string" ? value : JSON.stringify(value));
  const place = wasm.input(bytes.length);
  new Uint8Array(wasm.memory.buffer).set(bytes, place);
}
function done(n) {
  if (n < 0) throw JSON.parse(text(n)); // a refusal
  return n;
}

function numbers(bytes) {
  done(bytes);
  return new Float32Array(wasm.memory.buffer.slice(wasm.output(), wasm.output() + bytes));
}

function run(ticks) {
  const values = numbers(wasm.run(ticks));
  postMessage({ type: "rows", from: tick, values });
  tick += ticks;
  return values;
}

// On until it monitors, or heats no more; not forever, for it may never.
function untilMonitoring(mode) {
  for (let k = 0; k < 120; k++) {
    if (![1, 2].includes(run(50)[(50 - 1) * width + mode])) return;
  }
}

const COMMANDS = {
  open({ scene, at, skip }, hello) {
    put(scene);
    const opened = JSON.parse(text(done(wasm.open())));
    [tick, owed, ts] = [0, 0, opened.ts];
    postMessage(opened);
    for (let left = at ?? 0; left > 0; left -= 1000) run(Math.min(1000, left));
    if (skip) {
      untilMonitoring(hello.fields.indexOf("mode"));
      run(50);
    }
  },
  order({ order }) {
    put(order);
    done(wasm.order());
    postMessage({ type: "order", tick, order });
  },
  run(command) {
    [speed, owed, before] = [command.speed, 0, performance.now()];
    postMessage({ type: "running", speed });
  },
  step({ ticks, id }) {
    for (let left = ticks; left > 0; left -= 1000) run(Math.min(1000, left));
    postMessage({ type: "stepped", id, tick });
  },
  skip(_, hello) {
    untilMonitoring(hello.fields.indexOf("mode"));
  },
  trace({ id }) {
    done(wasm.trace());
    const parts = [];
    for (let n; (n = done(wasm.trace_next())) > 0; ) parts.push(text(n));
    postMessage({ type: "trace", id, parts });
  },
  replay({ id, trace }) {
    put(trace);
    const hello = JSON.parse(text(done(wasm.replay())));
    postMessage({ type: "replayed", id, hello, values: numbers(wasm.replayed()) });
  },
  scene({ id }) {
    postMessage({ type: "scene", id, tick, scene: JSON.parse(text(done(wasm.scene()))) });
  },
  digest({ id }) {
    postMessage({ type: "digest", id, digest: text(done(wasm.digest())) });
  },
};

const through = (data, by) => new Response(new Blob([data]).stream().pipeThrough(by));

// The log of a board, for a file. Hours of it are packed, piece by piece, into blobs, which a browser may keep on its disk.
const LOG_PIECE = 1 << 16;
const MOST_LOG = 1 << 29; // bytes; where a port floods, what comes later is not kept
const KEPT_EVERY = 5; // s
let log = { text: "", packed: [], bytes: 0, told: 0 };

function keep({ anew, text: lines }) {
  if (anew) log = { ...log, text: "", packed: [], bytes: 0 };
  if (log.bytes > MOST_LOG) return;
  log.text += lines;
  if (log.text.length < LOG_PIECE) return;
  const of = log;
  of.packed.push(through(of.text, new CompressionStream("gzip")).blob().then((blob) => ((of.bytes += blob.size), blob)));
  of.text = "";
}

async function logged() {
  const packed = await Promise.all(log.packed);
  const parts = [];
  for (const blob of packed) parts.push(await through(blob, new DecompressionStream("gzip")).blob());
  return [...parts, log.text];
}

// Between the board and the page. What was typed before a stop of which this has not heard is void there: each piece tells how often it had
// been stopped.
let stops = 0;
const seconds = () => performance.now() / 1000;
const INSIDE = {
  send: ({ bytes }) => postMessage({ type: "send", stops, bytes: Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0)) }),
  log: keep,
};
function tell(n) {
  for (const message of JSON.parse(text(done(n)))) (INSIDE[message.type] ?? postMessage)(message);
}
const BOARD = {
  heard({ bytes }) {
    put(bytes);
    tell(wasm.board_heard(seconds()));
  },
  order({ order }) {
    put(order);
    tell(wasm.board_order(seconds()));
  },
  stopped(command) {
    stops = command.stops;
    tell(wasm.board_stopped());
  },
  lost(command) {
    stops = command.stops;
    tell(wasm.board_lost());
  },
  found: () => tell(wasm.board_found(seconds())),
  log: ({ id }) => logged().then((parts) => postMessage({ type: "log", id, parts })),
};
function boardBeat() {
  tell(wasm.board_beat(seconds()));
  if (seconds() - log.told < KEPT_EVERY) return;
  log.told = seconds();
  postMessage({ type: "kept", bytes: log.bytes + log.text.length, full: log.bytes > MOST_LOG });
}

// The WebAssembly comes packed: it is most of the page.
const unpacked = (gzip) => through(gzip, new DecompressionStream("gzip")).arrayBuffer();

let hello, commands;
onmessage = ({ data }) => {
  if (data.wasm) {
    unpacked(data.wasm).then((bytes) => WebAssembly.instantiate(bytes, {})).then(({ instance }) => {
      wasm = instance.exports;
      commands = data.board ? BOARD : COMMANDS;
      if (data.board) {
        tell(wasm.board_begin(seconds()));
        return setInterval(boardBeat, 100);
      }
      hello = JSON.parse(text(wasm.hello()));
      [width, ts] = [hello.fields.length, hello.ts];
      postMessage(hello);
      before = performance.now();
      setInterval(beat, 16);
    });
    return;
  }
  try {
    commands[data.command](data, hello);
  } catch ({ message, why = message, code, values }) {
    postMessage({ type: "refused", command: data, why, code, values, id: data.id });
  }
};

// So many ticks as time has passed for. A tab that slept does not catch up with hours.
function beat() {
  const now = performance.now();
  owed += (Math.min(now - before, 250) / 1000 / ts) * speed;
  before = now;
  const ticks = Math.min(Math.floor(owed), MOST_AT_ONCE);
  if (ticks > 0) {
    run(ticks);
    owed -= ticks;
  }
}
