//! What the hooks of the emulator share with the rest: the chip, the time, and why the emulator stopped.

use std::rc::Rc;

use crate::chip::Chip;
use crate::image::{FLASH, FLASH_SIZE, Image};
use crate::time::{NEVER, Ps};

/// Why the emulator stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stop {
    /// Something is to happen before the block at this address.
    Before(u32),
    /// A jump that returns from an exception.
    Return(u32),
    /// WFE or WFI at this address.
    Sleep { at: u32, for_event: bool },
    /// A watched address is reached.
    Watched(u32),
    /// A trap of the processor: supervisor call, breakpoint, undefined.
    Trap(u32),
}

/// What the hooks of the emulator share with the rest.
pub(super) struct Machine {
    /// The chip.
    pub(super) chip: Chip,
    /// The time.
    pub(super) now: Ps,
    pub(super) cycle: Ps,
    /// When the block hook has to look.
    pub(super) deadline: Ps,
    /// When the run is to end.
    pub(super) until: Ps,
    pub(super) stop: Option<Stop>,
    pub(super) event: bool,
    /// Where the block before began.
    pub(super) last: u32,
    /// Size of the block in bytes and its instructions, by the half of the flash at which it begins.
    pub(super) blocks: Vec<(u16, u16)>,
    pub(super) code: Rc<Image>,
    /// An access that nothing answers: address, and why it failed.
    pub(super) refused: Option<String>,
    /// A watched address that has just been reported is passed once.
    pub(super) passing: Option<u32>,
    /// The access that faulted: address, and whether it was a fetch.
    pub(super) faulted: Option<(u32, bool)>,
    /// Instructions since the start.
    pub(super) instructions: u64,
}

impl Machine {
    pub(super) fn new(chip: Chip, code: Rc<Image>) -> Self {
        Self {
            chip,
            now: 0,
            cycle: 62_500,
            deadline: 0,
            until: 0,
            stop: None,
            event: false,
            last: 0,
            blocks: vec![(0, 0); FLASH_SIZE / 2],
            code,
            refused: None,
            passing: None,
            faulted: None,
            instructions: 0,
        }
    }

    /// Instructions in the block at `address` of `size` bytes.
    pub(super) fn count(&mut self, address: u32, size: u32) -> u64 {
        let place = (address.wrapping_sub(FLASH) / 2) as usize;
        let Some(known) = self.blocks.get_mut(place) else { return u64::from(size / 2).max(1) };
        if u32::from(known.0) != size {
            let bytes = self.code.flash.get(2 * place..2 * place + size as usize).unwrap_or_default();
            *known = (size as u16, instructions(bytes));
        }
        known.1.into()
    }

    pub(super) fn reschedule(&mut self) {
        self.deadline = self.chip.next_event(self.now).min(self.until);
        self.cycle = self.chip.cycle().unwrap_or(NEVER);
        if self.must_stop() || self.chip.scs.nvic.any() {
            self.deadline = self.now;
        }
    }

    /// The emulator has to be left for something that is no interrupt.
    pub(super) fn must_stop(&self) -> bool {
        self.refused.is_some()
            || self.chip.reset.is_some()
            || self.chip.power_cut
            || self.chip.stands_until() > self.now
            || self.cycle == NEVER
    }

    pub(super) fn refuse(&mut self, why: String) {
        self.refused.get_or_insert(why);
        self.deadline = self.now;
    }
}

/// Number of Thumb instructions in some code.
fn instructions(code: &[u8]) -> u16 {
    let mut halves = code.chunks_exact(2);
    let mut n = 0;
    while let Some([_, high]) = halves.next() {
        n += 1;
        if high >> 3 >= 0b11101 {
            halves.next(); // the second half of a long one
        }
    }
    n
}
