//! What each part of the instrument costs, counted in instructions over the recorded run.
//!
//! Every part is measured alone, behind a call that is never inlined, on the inputs that it has in the run. The host
//! reads the lines printed here and, in a second emulation that is traced, the instructions themselves.

mod estimators;
mod likelihood;
mod parts;
mod stack;
mod stopwatch;
mod tick;

use core::fmt::{self, Write};

use crate::recording::Recording;
use stopwatch::Stopwatch;

/// Counts everything and prints a line for each part.
///
/// # Errors
/// Those of the writer.
pub fn count_all(recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let mut watch = Stopwatch::start();
    watch.pass(out, ["nothing"], 16, |watch, _| watch.time(0, || ()))?;
    tick::count(&mut watch, recording, out)?;
    likelihood::count(&mut watch, recording, out)?;
    parts::count(&mut watch, recording, out)?;
    estimators::count(&mut watch, recording, out)?;
    stack::measure(recording, out)
}
