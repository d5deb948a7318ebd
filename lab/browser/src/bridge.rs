//! A serial port for a page whose browser has none: a pseudo-terminal behind a WebSocket, and `navigator.serial` on top of that.
//!
//! A connection is an open port. The server says "open" once it is, and closes where the port cannot be opened or has gone.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use anyhow::anyhow;
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

/// Puts `navigator.serial` into a page: one port, an ST-LINK's, at the address `args[0]`. `window.wire` tells what was chosen by (`asked`), what
/// was written and when (`sent`), and how long a byte takes (`ms`), since a WebSocket takes all at once.
pub const SERIAL: &str = r##"
class Port {
  getInfo() { return { usbVendorId: 0x0483, usbProductId: 0x374b }; }
  async open({ baudRate }) {
    if (this.socket) throw new DOMException("open already", "InvalidStateError");
    if (baudRate !== 115200) throw new TypeError("baudRate");
    const socket = new WebSocket(wire.address);
    socket.binaryType = "arraybuffer";
    await new Promise((done, fail) => {
      socket.onmessage = done;
      socket.onclose = socket.onerror = () => fail(new DOMException("Failed to open serial port.", "NetworkError"));
    });
    this.socket = socket;
    const lost = () => new DOMException("The device has been lost.", "NetworkError");
    let writes;
    this.readable = new ReadableStream({
      start: (bytes) => {
        socket.onmessage = ({ data }) => bytes.enqueue(new Uint8Array(data));
        socket.onclose = () => {
          if (this.socket !== socket) return;
          this.readable = this.writable = null;
          bytes.error(lost());
          writes.error(lost());
        };
      },
      cancel: () => hang_up(socket),
    });
    this.writable = new WritableStream({
      start: (controller) => void (writes = controller),
      write: async (bytes) => {
        for (const byte of bytes) {
          if (socket.readyState !== 1) throw lost();
          socket.send(Uint8Array.of(byte));
          wire.sent.push([byte, performance.now()]);
          if (wire.ms) await new Promise((done) => setTimeout(done, wire.ms));
        }
      },
    });
  }
  async close() {
    if (!this.socket) throw new DOMException("not open", "InvalidStateError");
    if (this.readable?.locked || this.writable?.locked) throw new TypeError("locked");
    const { socket } = this;
    this.socket = this.readable = this.writable = null;
    hang_up(socket);
  }
}
// First in words, so that the server says nothing any more when it answers the close.
function hang_up(socket) {
  if (socket.readyState === 1) socket.send("close");
  socket.close();
}
window.wire = { address: args[0], sent: [], asked: [], ms: 0 };
const port = new Port();
Object.defineProperty(navigator, "serial", { configurable: true, value: {
  requestPort: async (options) => (wire.asked.push(options), port),
  getPorts: async () => [port],
} });
"##;

/// Opens a port at `path` for whoever connects, for ever; the address.
///
/// # Errors
/// No port of this machine is free.
pub fn serve(path: String) -> anyhow::Result<String> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let address = format!("ws://{}", listener.local_addr()?);
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let path = path.clone();
            thread::spawn(move || connect(stream, &path));
        }
    });
    Ok(address)
}

/// How long a read waits for a byte: so long a port stays open behind a page that has closed it.
const PATIENCE: Duration = Duration::from_millis(20);

/// One connection, as long as the port lasts and the page wants it.
fn connect(stream: TcpStream, path: &str) -> anyhow::Result<()> {
    let mut page = tungstenite::accept(stream.try_clone()?).map_err(|error| anyhow!("{error}"))?;
    let mut to_board = serialport::new(path, 115_200).timeout(PATIENCE).exclusive(false).open()?;
    page.send(Message::text("open"))?;
    let mut from_board = to_board.try_clone()?;
    // A socket reads or writes: each thread has its own.
    let mut to_page = WebSocket::from_raw_socket(stream, Role::Server, None);
    let closed = Arc::new(AtomicBool::new(false));
    let ended = closed.clone();
    let mut telling = Some(thread::spawn(move || {
        let mut bytes = [0; 1024];
        while !ended.load(Ordering::Relaxed) {
            let n = match from_board.read(&mut bytes) {
                Ok(n @ 1..) => n,
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                _ => break,
            };
            if to_page.send(Message::binary(bytes[..n].to_vec())).is_err() {
                break;
            }
        }
        if !ended.load(Ordering::Relaxed) {
            let _ = to_page.get_ref().shutdown(std::net::Shutdown::Both);
        }
    }));
    while let Ok(message) = page.read() {
        match message {
            Message::Binary(bytes) => to_board.write_all(&bytes)?,
            Message::Text(_) => {
                closed.store(true, Ordering::Relaxed);
                let _ = telling.take().map(thread::JoinHandle::join);
            }
            _ => {}
        }
    }
    closed.store(true, Ordering::Relaxed);
    Ok(())
}
