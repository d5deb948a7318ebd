//! The words of RAM that no start clears.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

use firmware_logic::interlock::Lockout;
use firmware_logic::retained::{Retained, WORDS, Words};

struct Memory(UnsafeCell<MaybeUninit<Words>>);

// SAFETY: it is read once, at boot, before any task runs, and after that only written: by the thread-mode tasks, of
// which one runs at a time, or by a handler that never returns to what it interrupted.
unsafe impl Sync for Memory {}

#[unsafe(link_section = ".uninit.RETAINED")]
static MEMORY: Memory = Memory(UnsafeCell::new(MaybeUninit::uninit()));

/// Set by the interrupt of the voltage detector, which may come between the words above; noise after power-up, which is
/// [`UNDERVOLTAGE`] once in 2^32 times, and then a lockout too many.
#[unsafe(link_section = ".uninit.UNDERVOLTAGE")]
static SUPPLY: AtomicU32 = AtomicU32::new(0);
const UNDERVOLTAGE: u32 = 0x5655_3241;

/// The supply has failed while heating, and perhaps nobody will be there to store a lockout.
pub(crate) fn note_undervoltage() {
    SUPPLY.store(UNDERVOLTAGE, Ordering::Relaxed);
}

/// What the program before this one left, if it is to be believed. For the start only.
pub(crate) fn load() -> Option<Retained> {
    let left = load_words();
    if SUPPLY.load(Ordering::Relaxed) != UNDERVOLTAGE {
        return left;
    }
    let left = left.unwrap_or(Retained::EMPTY);
    Some(Retained { lockout: left.lockout.or(Some(Lockout::Undervoltage)), ..left })
}

fn load_words() -> Option<Retained> {
    let base = MEMORY.0.get().cast::<u32>();
    // SAFETY: the words are within the static and aligned. They are RAM, initialised by whatever was written before
    // the reset or by noise; a volatile read of plain memory gives some number for either.
    let words: Words = core::array::from_fn(|i| unsafe { base.add(i.min(WORDS - 1)).read_volatile() });
    Retained::unpack(&words)
}

/// Leaves something for the next program; a lockout by the detector is among it by now.
pub(crate) fn store(retained: &Retained) {
    SUPPLY.store(0, Ordering::Relaxed);
    let base = MEMORY.0.get().cast::<u32>();
    for (i, word) in retained.pack().into_iter().enumerate() {
        // SAFETY: within the static and aligned, see `Memory` for why nobody reads meanwhile. Volatile, since what
        // reads it is a program that the compiler does not know of.
        unsafe { base.add(i.min(WORDS - 1)).write_volatile(word) };
    }
}
