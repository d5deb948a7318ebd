//! The session for a browser. A host writes text to [`input`], calls a function, and reads what [`output`] points to; numbers are
//! the bytes that the function said, or a refusal as a message where it is negative. Memory may have grown after every call.

use std::cell::RefCell;

use anyhow::Context;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fdi_core::Config;
use fdi_core::schema::Numbers;
use pt326_lab::board::{Conversation, Standing, stops};
use pt326_lab::protocol;
use pt326_lab::recording::Recording;
use pt326_lab::refusal;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::{Session, Trace};
use pt326_lab::told::Told;
use serde_json::{Value, json};

#[derive(Default)]
struct Lab {
    input: Vec<u8>,
    output: Vec<u8>,
    session: Option<Session>,
    trace: Option<Trace>,
    replayed: Vec<Numbers>,
    board: Option<Board>,
}

/// A board at the port that the page holds.
struct Board {
    conversation: Conversation,
    /// Rows so far.
    rows: usize,
    /// The page was told who is there.
    greeted: bool,
}

thread_local! {
    static LAB: RefCell<Lab> = RefCell::default();
}

/// Does something with the session; its output, or the words of its refusal, can be read then.
fn answer(act: impl FnOnce(&mut Lab) -> anyhow::Result<Vec<u8>>) -> i32 {
    LAB.with_borrow_mut(|lab| {
        let (output, sign) = match act(lab) {
            Ok(output) => (output, 1),
            Err(error) => (refusal::message(&error).to_string().into_bytes(), -1),
        };
        lab.output = output;
        sign * lab.output.len() as i32
    })
}

fn session(lab: &mut Lab) -> anyhow::Result<&mut Session> {
    lab.session.as_mut().context("no scene is open")
}

/// Where `length` bytes of input are to be written.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    LAB.with_borrow_mut(|lab| {
        lab.input = vec![0; length];
        lab.input.as_mut_ptr()
    })
}

/// Where the output of the last call is.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    LAB.with_borrow(|lab| lab.output.as_ptr())
}

/// What a client is told first, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn hello() -> i32 {
    answer(|_| {
        Ok(protocol::hello("simulated", &["order", "break", "open", "run", "trace"]).to_string().into_bytes())
    })
}

/// Begins the scene that the input holds as JSON; the message that says so.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> i32 {
    answer(|lab| {
        let scene: Scene = protocol::read(&lab.input)?;
        let session = lab.session.insert(Session::new(scene)?);
        Ok(protocol::opened(session).to_string().into_bytes())
    })
}

/// Does what the input orders.
#[unsafe(no_mangle)]
pub extern "C" fn order() -> i32 {
    answer(|lab| {
        let order = protocol::read(&lab.input)?;
        session(lab)?.order(order)?;
        Ok(Vec::new())
    })
}

/// So many ticks; their numbers, `f32` each.
#[unsafe(no_mangle)]
pub extern "C" fn run(ticks: u32) -> i32 {
    answer(|lab| {
        let session = session(lab)?;
        let mut bytes = Vec::with_capacity(ticks as usize * protocol::ROW_BYTES);
        for _ in 0..ticks {
            let row = session.step();
            session.numbers(&row).iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        }
        Ok(bytes)
    })
}

/// The scene that leads here, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn scene() -> i32 {
    answer(|lab| Ok(serde_json::to_vec(&session(lab)?.scene())?))
}

/// Begins the trace of all ticks so far; [`trace_next`] gives it.
#[unsafe(no_mangle)]
pub extern "C" fn trace() -> i32 {
    answer(|lab| {
        lab.trace = Some(session(lab)?.trace()?);
        Ok(Vec::new())
    })
}

/// Some lines of the trace; none at its end.
#[unsafe(no_mangle)]
pub extern "C" fn trace_next() -> i32 {
    const LINES: usize = 1000;
    answer(|lab| {
        let trace = lab.trace.as_mut().context("no trace was begun")?;
        Ok(trace.take(LINES).flat_map(|line| [line, "\n".into()]).collect::<String>().into_bytes())
    })
}

/// Runs the instrument again on the trace that the input holds; what a recording tells first, as JSON. [`replayed`] gives the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn replay() -> i32 {
    answer(|lab| {
        let text = str::from_utf8(&lab.input)?;
        let recording = Recording::read(text, &Config::default())?;
        lab.replayed = recording.numbers()?;
        Ok(protocol::recorded(&recording.config).to_string().into_bytes())
    })
}

/// The numbers of the trace that was replayed, `f32` each.
#[unsafe(no_mangle)]
pub extern "C" fn replayed() -> i32 {
    answer(|lab| {
        Ok(std::mem::take(&mut lab.replayed).into_iter().flatten().flat_map(f32::to_le_bytes).collect())
    })
}

/// A hash of all bits of the trace so far, in hexadecimal.
#[unsafe(no_mangle)]
pub extern "C" fn digest() -> i32 {
    answer(|lab| Ok(session(lab)?.digest()?.into_bytes()))
}

/// Begins a conversation with a board; `now` is the time here and below, s. Each of these functions gives messages of the protocol as a
/// JSON list, and between them what is for whoever holds the port: bytes to `send`, that it is to `stop` the board, lines of the `log` to
/// keep, and that nobody is there (`ended`).
#[unsafe(no_mangle)]
pub extern "C" fn board_begin(now: f64) -> i32 {
    answer(|lab| {
        let conversation = Conversation::new(now);
        Ok(lab.board.insert(Board { conversation, rows: 0, greeted: false }).messages())
    })
}

fn board(act: impl FnOnce(&mut Conversation, &[u8]) -> anyhow::Result<()>) -> i32 {
    answer(|lab| {
        let board = lab.board.as_mut().context("no board is there")?;
        act(&mut board.conversation, &lab.input)?;
        Ok(board.messages())
    })
}

/// The input has come from the board.
#[unsafe(no_mangle)]
pub extern "C" fn board_heard(now: f64) -> i32 {
    board(|conversation, input| {
        conversation.hear(input, now);
        Ok(())
    })
}

/// Does what the input orders.
#[unsafe(no_mangle)]
pub extern "C" fn board_order(now: f64) -> i32 {
    answer(|lab| {
        let order: Order = protocol::read(&lab.input)?;
        if stops(&order) {
            return Ok(json!([{ "type": "stop" }]).to_string().into_bytes());
        }
        let board = lab.board.as_mut().context("no board is there")?;
        board.conversation.order(&order, now)?;
        Ok(board.messages())
    })
}

/// The page has stopped the board.
#[unsafe(no_mangle)]
pub extern "C" fn board_stopped() -> i32 {
    board(|conversation, _| {
        conversation.stopped();
        Ok(())
    })
}

/// The port has gone.
#[unsafe(no_mangle)]
pub extern "C" fn board_lost() -> i32 {
    board(|conversation, _| {
        conversation.lost();
        Ok(())
    })
}

/// It is open again.
#[unsafe(no_mangle)]
pub extern "C" fn board_found(now: f64) -> i32 {
    board(|conversation, _| {
        conversation.found(now);
        Ok(())
    })
}

/// Time has passed.
#[unsafe(no_mangle)]
pub extern "C" fn board_beat(now: f64) -> i32 {
    board(|conversation, _| {
        conversation.pass(now);
        Ok(())
    })
}

impl Board {
    /// All that there is to tell.
    fn messages(&mut self) -> Vec<u8> {
        let mut messages = Vec::new();
        let bytes = self.conversation.take_bytes();
        if !bytes.is_empty() {
            messages.push(json!({ "type": "send", "bytes": STANDARD.encode(bytes) }));
        }
        let (anew, log) = self.conversation.take_log();
        if anew || !log.is_empty() {
            messages.push(json!({ "type": "log", "anew": anew, "text": String::from_utf8_lossy(&log) }));
        }
        match self.conversation.standing() {
            Standing::Ended(why) => messages.push(json!({ "type": "ended", "why": why })),
            Standing::Speaks if !self.greeted => {
                self.greeted = true;
                let mut hello = protocol::hello("board", &["order", "log"]);
                let told = protocol::recorded(self.conversation.config());
                if let (Value::Object(hello), Value::Object(told)) = (&mut hello, told) {
                    hello.extend(told);
                }
                messages.push(hello);
            }
            _ => {}
        }
        if self.greeted {
            self.tell(&mut messages);
        }
        Value::Array(messages).to_string().into_bytes()
    }

    /// What the conversation tells; rows that follow each other go together.
    fn tell(&mut self, messages: &mut Vec<Value>) {
        let mut rows = Vec::new();
        let mut from = self.rows;
        let flush = |rows: &mut Vec<u8>, from: usize, to: usize, messages: &mut Vec<Value>| {
            if !rows.is_empty() {
                let values = STANDARD.encode(std::mem::take(rows));
                messages.push(json!({ "type": "rows", "from": from, "count": to - from, "values": values }));
            }
        };
        while let Some(told) = self.conversation.take_told() {
            if let Some(message) = told.message(self.rows) {
                flush(&mut rows, from, self.rows, messages);
                from = self.rows;
                messages.push(message);
            } else if let Told::Row(row) = told {
                row.iter().for_each(|number| rows.extend(number.to_le_bytes()));
                self.rows += 1;
            }
        }
        flush(&mut rows, from, self.rows, messages);
    }
}
