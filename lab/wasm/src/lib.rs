//! The session for a browser. A host writes text to [`input`], calls a function, and reads what [`output`] points to; numbers are
//! the bytes that the function said, or a refusal as a message where it is negative. Memory may have grown after every call.

use std::cell::RefCell;

use anyhow::Context;
use fdi_core::Config;
use fdi_core::schema::Numbers;
use pt326_lab::protocol;
use pt326_lab::recording::Recording;
use pt326_lab::refusal;
use pt326_lab::scene::Scene;
use pt326_lab::session::{Session, Trace};

#[derive(Default)]
struct Lab {
    input: Vec<u8>,
    output: Vec<u8>,
    session: Option<Session>,
    trace: Option<Trace>,
    replayed: Vec<Numbers>,
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
