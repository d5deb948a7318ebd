// Where the numbers come from: a session in a worker, a server, or a recording; a board at a port is in serial.js. All speak the protocol of PROTOCOL.md.

const decode = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
export const floats = (base64) => new Float32Array(decode(base64).buffer);

// The instrument's own code in a worker. Worker and WebAssembly lie in the page: no request is made.
export function work(hear, { worker, wasm }, more = {}) {
  const url = URL.createObjectURL(new Blob([worker], { type: "text/javascript" }));
  const thread = new Worker(url);
  thread.onmessage = ({ data }) => hear(data);
  thread.onerror = (event) => hear({ type: "refused", why: event.message });
  thread.postMessage({ wasm: decode(wasm).buffer, ...more });
  return thread;
}

// A session in it.
export function inWorker(hear, parts) {
  const thread = work(hear, parts);
  return { send: (command) => thread.postMessage(command), close: () => thread.terminate() };
}

// A trace.csv run through the instrument's own code again: hello and numbers, with what the file does not tell. Rejects where it comes to
// something else.
export const replay = (trace, parts) => new Promise((resolve, reject) => {
  let hello = null;
  const session = inWorker((message) => {
    if (message.type === "hello") {
      hello = message;
      return session.send({ command: "replay", trace });
    }
    session.close();
    if (message.type === "replayed") resolve({ hello: { ...hello, ...message.hello }, values: message.values });
    else reject(new Error(message.why));
  }, parts);
});

// A token that the address has brought is kept for this tab, so that it can load the page again (door.html), and seen no more.
function keep(token) {
  if (!location.search) return;
  try { sessionStorage.setItem("pt326-lab-token", token); } catch { /* then the link is to be opened again */ }
  history.replaceState(null, "", location.pathname + location.hash);
}

const ALIVE = 5000; // ms: more often than the server closes what is idle

// A server: server-sent events to here, commands by POST with the token of the page. What was missed is asked for when it comes back. A
// connection that has shown the token is kept in use: on it a stop need not wait behind others who want to connect.
export function fromServer(hear, token) {
  let [events, next, id, again, opened] = [null, 0, null, null, true];
  const told = new Set(); // orders since the last row: they may come twice
  const lost = () => {
    events?.close();
    hear({ type: "lost" });
    clearTimeout(again);
    again = setTimeout(() => fetch("metrics").then(connect, lost), 1500);
  };
  function connect() {
    // It answers, but not to this page any more: it has begun anew, with another token.
    if (!opened) return location.reload();
    opened = false;
    events = new EventSource(`events?token=${token}&from=${next}&session=${id ?? ""}`);
    events.onopen = () => (opened = true);
    events.onerror = lost;
    events.onmessage = ({ data }) => {
      const message = JSON.parse(data);
      if (message.type === "hello") {
        if (message.session !== id) next = 0;
        id = message.session;
      }
      if (message.type === "order") {
        if (told.has(data)) return;
        told.add(data);
      }
      if (message.type === "opened") [next, id] = [0, message.session];
      if (message.type === "rows") {
        message.values = floats(message.values);
        next = message.from + message.count;
        told.clear();
      }
      hear(message);
    };
  }
  // A browser opens six connections to a server at most: a tab that nobody sees keeps none from those that are seen.
  const seen = () => {
    if (!document.hidden) return connect();
    clearTimeout(again);
    events?.close();
  };
  document.addEventListener("visibilitychange", seen);
  keep(token);
  connect();
  const alive = setInterval(() => fetch("metrics", { headers: { Authorization: `Bearer ${token}` } }).catch(() => {}), ALIVE);
  const send = (command) =>
    fetch("command", {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Lab-Token": token },
      body: JSON.stringify(command),
    }).then(
      async (response) => {
        if (response.ok) for (const message of await response.json()) hear({ ...message, id: command.id });
        else hear({ ...(await refusal(response)), command, id: command.id });
      },
      () => hear({ type: "refused", command, code: "no_connection", id: command.id }),
    );
  return { send, close: () => (document.removeEventListener("visibilitychange", seen), clearTimeout(again), clearInterval(alive), events.close()) };
}

// Why the server did not do it: its own words, or that it does not know this page.
async function refusal(response) {
  if (response.headers.get("Content-Type")?.includes("json")) return response.json();
  return { type: "refused", code: response.status === 403 ? "stranger" : undefined, why: await response.text() };
}

// A recording: all rows are there; a clock walks through them.
export function fromRecording(hear, { hello, name, values, orders = [], first = 0 }) {
  const width = hello.fields.length;
  const count = values.length / width;
  let [at, speed, owed, before] = [0, 0, 0, performance.now()];
  const show = (to) => {
    if (to <= at) return;
    if (at === 0) for (const [tick, order] of orders) hear({ type: "order", tick, order });
    hear({ type: "rows", from: first + at, values: values.subarray(at * width, to * width) });
    at = to;
  };
  const seek = (tick) => {
    at = 0;
    hear({ type: "opened" });
    show(Math.min(count, Math.max(1, tick - first)));
  };
  const beat = setInterval(() => {
    const now = performance.now();
    owed += (Math.min(now - before, 250) / 1000 / hello.ts) * speed;
    before = now;
    const ticks = Math.floor(owed);
    owed -= ticks;
    if (ticks > 0) show(Math.min(count, at + ticks));
  }, 16);
  const commands = {
    // What has come to its end begins anew.
    run(command) {
      speed = command.speed;
      if (speed && at === count) seek(first + 1);
      hear({ type: "running", speed });
    },
    seek: ({ tick }) => seek(tick),
  };
  queueMicrotask(() => {
    hear({ ...hello, kind: "recording", name, can: ["run", "seek"], count: first + count });
    hear({ type: "running", speed });
    seek(count);
  });
  return { send: (command) => commands[command.command]?.(command), close: () => clearInterval(beat) };
}
