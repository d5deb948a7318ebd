//! A serial port for a page whose browser has none: a pseudo-terminal behind a WebSocket (RFC 6455), and `navigator.serial` on top of that.
//!
//! A connection is an open port. The server says "open" once it is, and closes where the port cannot be opened or has gone.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use anyhow::{Context, bail};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

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
      cancel: () => socket.close(),
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
    socket.close();
  }
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
fn connect(mut stream: TcpStream, path: &str) -> anyhow::Result<()> {
    shake_hands(&mut stream)?;
    let port = serialport::new(path, 115_200).timeout(PATIENCE).exclusive(false).open()?;
    frame(&mut stream, 0x1, b"open")?;
    let (mut to_page, mut from_board) = (stream.try_clone()?, port.try_clone()?);
    let (mut to_board, closed) = (port, Arc::new(AtomicBool::new(false)));
    let ended = closed.clone();
    thread::spawn(move || {
        let mut bytes = [0; 1024];
        while !ended.load(Ordering::Relaxed) {
            let n = match from_board.read(&mut bytes) {
                Ok(n @ 1..) => n,
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                _ => break,
            };
            if frame(&mut to_page, 0x2, &bytes[..n]).is_err() {
                break;
            }
        }
        let _ = to_page.shutdown(std::net::Shutdown::Both);
    });
    while let Ok(Some(bytes)) = read_frame(&mut stream) {
        to_board.write_all(&bytes)?;
    }
    closed.store(true, Ordering::Relaxed);
    Ok(())
}

fn shake_hands(stream: &mut TcpStream) -> anyhow::Result<()> {
    let mut key = None;
    for line in BufReader::new(stream.try_clone()?).lines() {
        let line = line?;
        if line.is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("sec-websocket-key")
        {
            key = Some(value.trim().to_owned());
        }
    }
    let key = key.context("no key")? + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    let accept = STANDARD.encode(sha1(key.as_bytes()));
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n"
    )?;
    Ok(())
}

/// Sends a frame of at most 65,535 bytes.
fn frame(stream: &mut TcpStream, kind: u8, bytes: &[u8]) -> std::io::Result<()> {
    let length = bytes.len() as u16;
    let mut head = vec![0x80 | kind];
    match length {
        ..126 => head.push(length as u8),
        _ => {
            head.push(126);
            head.extend(length.to_be_bytes());
        }
    }
    stream.write_all(&[&head, bytes].concat())
}

/// What a frame of the page holds, which is masked and short; `None` where it closes.
fn read_frame(stream: &mut TcpStream) -> anyhow::Result<Option<Vec<u8>>> {
    let mut head = [0; 6];
    stream.read_exact(&mut head)?;
    let length = usize::from(head[1] & 0x7F);
    if head[0] & 0xF == 0x8 {
        return Ok(None);
    }
    if length > 125 || head[1] & 0x80 == 0 {
        bail!("a long frame");
    }
    let mut bytes = vec![0; length];
    stream.read_exact(&mut bytes)?;
    bytes.iter_mut().zip(head[2..].iter().cycle()).for_each(|(byte, mask)| *byte ^= mask);
    Ok(Some(bytes))
}

/// FIPS 180-4, which a handshake wants; nothing rests on it.
fn sha1(data: &[u8]) -> [u8; 20] {
    let mut padded = data.to_vec();
    padded.push(0x80);
    padded.resize((padded.len() + 8).next_multiple_of(64) - 8, 0);
    padded.extend((8 * data.len() as u64).to_be_bytes());
    let mut h: [u32; 5] = [0x6745_2301, 0xEFCD_AB89, 0x98BA_DCFE, 0x1032_5476, 0xC3D2_E1F0];
    for block in padded.chunks_exact(64) {
        let mut w = [0; 80];
        for (word, bytes) in w.iter_mut().zip(block.chunks_exact(4)) {
            *word = bytes.iter().fold(0, |word, byte| word << 8 | u32::from(*byte));
        }
        for i in 16..80 {
            w[i] = (w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16]).rotate_left(1);
        }
        let [mut a, mut b, mut c, mut d, mut e] = h;
        for (i, word) in w.iter().enumerate() {
            let (f, k) = match i {
                0..20 => (b & c | !b & d, 0x5A82_7999),
                20..40 => (b ^ c ^ d, 0x6ED9_EBA1),
                40..60 => (b & c | b & d | c & d, 0x8F1B_BCDC),
                _ => (b ^ c ^ d, 0xCA62_C1D6),
            };
            let next = [a.rotate_left(5), f, e, k, *word].into_iter().fold(0, u32::wrapping_add);
            (a, b, c, d, e) = (next, a, b.rotate_left(30), c, d);
        }
        h = std::array::from_fn(|i| h[i].wrapping_add([a, b, c, d, e][i]));
    }
    let mut sum = [0; 20];
    sum.chunks_exact_mut(4).zip(h).for_each(|(bytes, word)| bytes.copy_from_slice(&word.to_be_bytes()));
    sum
}
