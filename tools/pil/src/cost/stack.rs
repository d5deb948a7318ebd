//! How much stack each half of the tick and each estimator needs: the free stack is painted, and looked at afterwards.

use core::arch::asm;
use core::fmt::{self, Write};
use core::hint::black_box;

use super::estimators::{full_matrix, textbook_double, textbook_single, update};
use super::tick::{armed, control, diagnose};
use crate::codes::sample;
use crate::peers::{self, FullMatrix, Textbook};
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
    writeln!(out, "stack {} diagnose()", second)?;
    estimators(out)
}

/// Prints the stack of one update, n = 6, of each estimator.
fn estimators(out: &mut impl Write) -> fmt::Result {
    let (phi, y) = black_box(([0.5; 6], 0.5));
    let (rls, mut full, mut single) = (peers::ours(), FullMatrix::default(), Textbook::default());
    let (mut state, mut double) = (rls.start(), Textbook::default());
    let (phi_double, y_double) = (phi.map(f64::from), f64::from(y));
    let ours = used_by(|| {
        black_box(update(&rls, &mut state, &phi, y));
    });
    let full = used_by(|| {
        black_box(full_matrix(&mut full, &phi, y));
    });
    let single = used_by(|| {
        black_box(textbook_single(&mut single, &phi, y));
    });
    let double = used_by(|| {
        black_box(textbook_double(&mut double, &phi_double, y_double));
    });
    writeln!(out, "stack {ours} RLS update, n = 6")?;
    writeln!(out, "stack {full} peer: full matrix, arrays, f32")?;
    writeln!(out, "stack {single} peer: nalgebra, textbook, f32")?;
    writeln!(out, "stack {double} peer: nalgebra, textbook, f64")
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
