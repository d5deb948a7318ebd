//! How much stack each half of the tick needs: the free stack is painted, and looked at afterwards.

use core::arch::asm;
use core::fmt::{self, Write};
use core::hint::black_box;

use super::tick::{armed, control, diagnose};
use crate::codes::sample;
use crate::recording::Recording;

const PAINT: u32 = 0xDEAD_57AC;
/// Bytes that are painted: more than either half may ever need.
const PAINTED: usize = 8192;

/// Prints the deepest stack of each half over the whole run.
pub(super) fn measure(recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let mut instrument = armed();
    let (mut first, mut second) = (0, 0);
    for row in recording.rows().step_by(7) {
        let mut tick = None;
        first = first.max(used_by(|| {
            tick = Some(black_box(control(&mut instrument, sample(row.codes))));
        }));
        let Some(tick) = tick else { continue };
        second = second.max(used_by(|| {
            black_box(diagnose(&mut instrument, &tick, tick.drive));
        }));
    }
    writeln!(out, "stack {} control()", first)?;
    writeln!(out, "stack {} diagnose()", second)
}

/// Bytes of stack that `work` touches.
#[inline(never)]
fn used_by(work: impl FnOnce()) -> usize {
    let top: usize;
    // SAFETY: reads the stack pointer. Nothing below it is in use, and the stack is far larger than what is painted.
    unsafe {
        asm!("mov {}, sp", out(reg) top, options(nomem, nostack));
        for address in (top - PAINTED..top).step_by(4) {
            (address as *mut u32).write_volatile(PAINT);
        }
    }
    black_box(work)();
    // SAFETY: as above.
    let touched = |&address: &usize| unsafe { (address as *const u32).read_volatile() } != PAINT;
    top - (top - PAINTED..top).step_by(4).find(touched).unwrap_or(top)
}
