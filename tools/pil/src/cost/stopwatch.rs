//! Counts instructions: under `-icount shift=0` the emulated timer TIM2 advances by exactly one with each.

use core::fmt::{self, Write};
use core::hint::black_box;

const TIM2_CR1: *mut u32 = 0x4000_0000 as *mut u32;
const TIM2_CNT: *const u32 = 0x4000_0024 as *const u32;
const CR1_CEN: u32 = 1;

/// Reads the timer. The host finds the ends of each interval in the trace by the name of this function.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn stopwatch_read() -> u32 {
    // SAFETY: reading a counter of the emulated chip has no effect.
    unsafe { TIM2_CNT.read_volatile() }
}

/// At most so many intervals a sample.
const MAX_NAMES: usize = 2;

/// The running timer, and what each name has cost in this pass.
pub(super) struct Stopwatch {
    totals: [u64; MAX_NAMES],
}

impl Stopwatch {
    pub(super) fn start() -> Self {
        // SAFETY: switches a timer of the emulated chip on; nothing else uses it.
        unsafe { TIM2_CR1.write_volatile(CR1_CEN) };
        Self { totals: Default::default() }
    }

    /// Measures `samples` times the intervals called `names`, in this order: `sample` must call [`Self::time`] once for
    /// each.
    pub(super) fn pass<const M: usize>(
        &mut self,
        out: &mut impl Write,
        names: [&str; M],
        samples: usize,
        mut sample: impl FnMut(&mut Self, usize),
    ) -> fmt::Result {
        self.stretch(out, &names, |watch| {
            (0..samples).for_each(|k| sample(watch, k));
            samples
        })
    }

    /// The same where `all` takes the samples, and says how many there were.
    pub(super) fn stretch(
        &mut self,
        out: &mut impl Write,
        names: &[&str],
        all: impl FnOnce(&mut Self) -> usize,
    ) -> fmt::Result {
        self.totals = Default::default();
        let samples = all(self);
        writeln!(out, "pass {} {samples}", names.len())?;
        for (name, total) in names.iter().zip(&self.totals) {
            writeln!(out, "part {total} {name}")?;
        }
        Ok(())
    }

    /// Counts what `work` takes; the call of an empty one is counted too, under its own name.
    #[inline(always)]
    pub(super) fn time<T>(&mut self, which: usize, work: impl FnOnce() -> T) -> T {
        let begin = stopwatch_read();
        let result = black_box(work());
        let taken = stopwatch_read().wrapping_sub(begin);
        self.totals[which] += u64::from(taken);
        result
    }
}
