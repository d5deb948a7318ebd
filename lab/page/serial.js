// A real board at a serial port of this computer, by Web Serial: the fourth source. The port is here, so that a stop waits for nothing; what
// the board says is read by the instrument's own code in a worker (worker.js).
import { floats, work } from "lab/sources.js";

const ST = 0x0483; // the USB number of STMicroelectronics, whose ST-LINK brings the port
const OPEN = { baudRate: 115200, bufferSize: 1 << 22 }; // what is heard while a tab sleeps: some twenty minutes
const STOP = Uint8Array.of(3); // Ctrl-C: heater off, at once
const PIECE = 16; // bytes of a line that are on their way at once: a stop waits for no more
const AGAIN = 500; // ms between two attempts to open a port that has gone

// Why there is no board, by the key of its sentence.
class NoBoard extends Error {}
const refuse = (key) => () => { throw new NoBoard(key); };

const name = (port) => {
  const { usbVendorId: vendor, usbProductId: product } = port.getInfo();
  const hex = (n) => n.toString(16).padStart(4, "0");
  return vendor === undefined ? "" : vendor === ST ? "ST-LINK" : `USB ${hex(vendor)}:${hex(product)}`;
};
const same = (one, other) => ["usbVendorId", "usbProductId"].every((key) => one.getInfo()[key] === other.getInfo()[key]);

// Lets the user choose a port, and meets the board there. Gives what `use` wants.
export async function connect(any, parts) {
  const { serial } = navigator;
  if (!serial) throw new NoBoard("no_serial");
  const port = await serial.requestPort(any ? {} : { filters: [{ usbVendorId: ST }] }).catch(refuse("no_port"));
  await port.open(OPEN).catch(refuse("port_busy"));
  return meet(port, parts);
}

function meet(port, parts) {
  const early = []; // what is said before anybody hears
  let [hear, writer, reader, stops, closed, writing] = [(message) => early.push(message), null, null, 0, false, Promise.resolve()];
  const post = (command, ...more) => thread.postMessage(command, ...more);

  // A write that fails ends its stream. While the cable is in, the port has another, and whoever writes next has that one.
  function take() {
    writer ??= port.writable?.getWriter() ?? null;
    writer?.closed.catch(() => {});
  }
  async function put(bytes) {
    const used = writer;
    try {
      await used.write(bytes);
    } catch (why) {
      if (used === writer) {
        used?.releaseLock();
        writer = null;
        take();
      }
      throw why;
    }
  }

  async function read() {
    take();
    // Noise on the line and an overrun are no end: there is another stream then.
    while (port.readable && !closed) {
      reader = port.readable.getReader();
      try {
        for (let piece; !(piece = await reader.read()).done; ) post({ command: "heard", bytes: piece.value });
      } catch { /* told by the port, which has no stream any more */ } finally {
        reader.releaseLock();
      }
    }
    writer?.releaseLock();
    writer = null;
    await port.close().catch(() => {});
    if (!closed) again();
  }

  // The port has gone: it is tried until it is there again, be it as another of the same kind, where that is the only one.
  async function again() {
    post({ command: "lost", stops: ++stops });
    while (!closed) {
      await new Promise((done) => setTimeout(done, AGAIN));
      const like = (await navigator.serial.getPorts()).filter((one) => same(one, port));
      const [one] = like.length === 1 && !like.includes(port) ? like : [port];
      if (closed || !(await one.open(OPEN).then(() => true, () => false))) continue;
      port = one;
      if (closed) return port.close();
      read();
      return post({ command: "found" });
    }
  }

  const write = ({ bytes, stops: before }) => {
    writing = writing.then(async () => {
      for (let at = 0; at < bytes.length && before === stops && writer; at += PIECE) await put(bytes.slice(at, at + PIECE));
    }).catch(() => {}); // that the port has gone is seen where it is read
  };
  function stop() {
    put(STOP).catch(() => put(STOP)).catch(() => hear({ type: "refused", code: "stop_gone" }));
    post({ command: "stopped", stops: ++stops });
  }
  function close() {
    closed = true;
    thread.terminate();
    reader?.cancel().catch(() => {});
  }
  const send = (command) => {
    if (command.command === "order" && command.order.order === "stop") stop();
    else post(command);
  };

  let thread;
  return new Promise((resolve, reject) => {
    const inside = {
      send: write, stop,
      rows: (message) => hear({ ...message, values: floats(message.values) }),
      ended: ({ why }) => (close(), reject(new Error(why))),
      hello: (hello) => resolve((to) => {
        hear = to;
        for (const message of [{ ...hello, name: name(port) }, ...early]) to(message);
        return { send, close };
      }),
    };
    thread = work((message) => (inside[message.type] ?? hear)(message), parts, { board: true });
    read();
  });
}
