// The session in a worker: the instrument's own code as WebAssembly, and a clock. It is a source of the protocol (PROTOCOL.md).
"use strict";
let wasm, width, ts;
let speed = 0, owed = 0, before = 0, tick = 0;
const MOST_AT_ONCE = 2000;

const text = (n) => new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, wasm.output(), Math.abs(n)).slice());
function put(value) {
  const bytes = new TextEncoder().encode(typeof value === "string" ? value : JSON.stringify(value));
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

// The WebAssembly comes packed: it is most of the page.
const unpacked = (gzip) => new Response(new Blob([gzip]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();

let hello;
onmessage = ({ data }) => {
  if (data.wasm) {
    unpacked(data.wasm).then((bytes) => WebAssembly.instantiate(bytes, {})).then(({ instance }) => {
      wasm = instance.exports;
      hello = JSON.parse(text(wasm.hello()));
      [width, ts] = [hello.fields.length, hello.ts];
      postMessage(hello);
      before = performance.now();
      setInterval(beat, 16);
    });
    return;
  }
  try {
    COMMANDS[data.command](data, hello);
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
