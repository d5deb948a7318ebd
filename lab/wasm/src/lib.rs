//! The session for a browser. A host writes text to [`input`], calls a function, and reads what [`output`] points to; numbers are
//! the bytes that the function said, or the text of a refusal where it is negative. Memory may have grown after every call.

use std::cell::RefCell;

use pt326_lab::protocol;
use pt326_lab::scene::Scene;
use pt326_lab::session::{Session, Trace};

#[derive(Default)]
struct Lab {
    input: Vec<u8>,
    output: Vec<u8>,
    session: Option<Session>,
    trace: Option<Trace>,
}

thread_local! {
    static LAB: RefCell<Lab> = RefCell::default();
}

/// Does something with the session; its output, or the words of its refusal, can be read then.
fn answer(act: impl FnOnce(&mut Lab) -> Result<Vec<u8>, String>) -> i32 {
    LAB.with_borrow_mut(|lab| {
        let (output, sign) = match act(lab) {
            Ok(output) => (output, 1),
            Err(why) => (why.into_bytes(), -1),
        };
        lab.output = output;
        sign * lab.output.len() as i32
    })
}

fn session(lab: &mut Lab) -> Result<&mut Session, String> {
    lab.session.as_mut().ok_or_else(|| "no scene is open".into())
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
    answer(|_| Ok(protocol::hello("simulated", &["order", "break", "open", "run", "trace"]).into_bytes()))
}

/// Begins the scene that the input holds as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> i32 {
    answer(|lab| {
        let scene: Scene = serde_json::from_slice(&lab.input).map_err(|e| e.to_string())?;
        lab.session = Some(Session::new(scene).map_err(|e| format!("{e:#}"))?);
        Ok(Vec::new())
    })
}

/// Does what the input orders.
#[unsafe(no_mangle)]
pub extern "C" fn order() -> i32 {
    answer(|lab| {
        let order = serde_json::from_slice(&lab.input).map_err(|e| e.to_string())?;
        session(lab)?.order(order).map_err(|e| format!("{e:#}"))?;
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
    answer(|lab| serde_json::to_vec(&session(lab)?.scene()).map_err(|e| e.to_string()))
}

/// Begins the trace of all ticks so far; [`trace_next`] gives it.
#[unsafe(no_mangle)]
pub extern "C" fn trace() -> i32 {
    answer(|lab| {
        lab.trace = Some(session(lab)?.trace().map_err(|e| format!("{e:#}"))?);
        Ok(Vec::new())
    })
}

/// Some lines of the trace; none at its end.
#[unsafe(no_mangle)]
pub extern "C" fn trace_next() -> i32 {
    const LINES: usize = 1000;
    answer(|lab| {
        let trace = lab.trace.as_mut().ok_or("no trace was begun")?;
        Ok(trace.take(LINES).flat_map(|line| [line, "\n".into()]).collect::<String>().into_bytes())
    })
}

/// A hash of all bits of the trace so far, in hexadecimal.
#[unsafe(no_mangle)]
pub extern "C" fn digest() -> i32 {
    answer(|lab| Ok(session(lab)?.digest().map_err(|e| format!("{e:#}"))?.into_bytes()))
}
