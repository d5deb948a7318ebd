//! A port within the page, at whose other end is what a test says.

/// A port that answers as a board does, until `says` says something else for it.
pub const PORT: &str = r##"
const toast = async (pattern) => { await until(() => pattern.test($("#toast").textContent)); return $("#toast").textContent; };
const bytes = (text) => Uint8Array.from(text, (c) => c.charCodeAt(0));
// A line of the stream with its CRC-32.
const framed = (line) => {
  let sum = -1;
  for (const byte of bytes(line)) { sum ^= byte; for (let k = 0; k < 8; k++) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0); }
  return `\x02${line}*${((sum ^ -1) >>> 0).toString(16).padStart(8, "0")}\r\n`;
};
class Port {
  constructor(answers) { Object.assign(this, { answers, heard: "", fails: 0 }); }
  getInfo() { return {}; }
  async open() {
    this.reads();
    this.writes();
  }
  // A write that fails ends the stream, and there is another. `fails` so many.
  writes() {
    this.writable = new WritableStream({ write: (some) => {
      if (this.fails-- > 0) {
        this.writes();
        throw new DOMException("Failed to write.", "UnknownError");
      }
      this.heard += String.fromCharCode(...some);
      const line = /(?:\x15|[^\r\x15]*\r)$/.exec(this.heard)?.[0].replace("\r", "");
      if (line in this.answers) this.says(this.answers[line]);
    } });
  }
  reads() { this.readable = new ReadableStream({ start: (to) => void (this.to = to) }); }
  // A tab that slept for too long: a browser throws away what has no room, and there is another stream.
  overruns() {
    const { to } = this;
    this.reads();
    to.error(new DOMException("Buffer overrun.", "BufferOverrunError"));
  }
  // The cable is pulled out; and in again.
  unplug() {
    const { to } = this;
    this.readable = this.writable = null;
    [this.opens, this.open] = [this.open, async () => { throw new DOMException("Failed to open serial port.", "NetworkError"); }];
    to.error(new DOMException("The device has been lost.", "NetworkError"));
  }
  plug() { this.open = this.opens; }
  says(text) { this.to.enqueue(bytes(text)); }
  async close() {}
}
const serial = (value) => Object.defineProperty(navigator, "serial", { configurable: true, value });
const BOARD = { "\x15": "\r\n> ", get: "get\r\nsetpoint = 36 degC\r\npid.kp = 2.5 %/degC\r\n> ", "stream on": "stream on\r\nok\r\n> " };
const offer = (port) => serial({ requestPort: async () => port, getPorts: async () => [port] });
"##;
