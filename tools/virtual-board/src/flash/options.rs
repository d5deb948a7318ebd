//! The option bytes. Only the brown-out level may be changed here: the others can lock the chip for ever.

use crate::registers::{Refusal, field};

const OPTLOCK: u32 = 1;
const OPTSTRT: u32 = 1 << 1;
const BOR_LEV: u32 = 3 << 2;
const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
/// As the chip leaves the factory: brown-out reset off, no protection.
const FACTORY: u32 = 0x0FFF_AAEC;

/// The option bytes and their register.
pub struct Options {
    /// The chip refuses to write them.
    pub protected: bool,
    programmed: u32,
    register: u32,
    unlocked: bool,
    keys: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { protected: false, programmed: FACTORY, register: FACTORY, unlocked: false, keys: 0 }
    }
}

impl Options {
    pub(super) fn reset(&mut self) {
        (self.register, self.unlocked, self.keys) = (self.programmed, false, 0);
    }

    /// BOR_LEV as programmed: 3 is off, 0 is the highest threshold.
    pub fn brown_out(&self) -> u32 {
        field(self.programmed, 2, 2)
    }

    /// Programs BOR_LEV, as a debug probe does.
    pub fn set_brown_out(&mut self, level: u32) {
        self.programmed = self.programmed & !BOR_LEV | level << 2 & BOR_LEV;
        self.register = self.programmed;
    }

    pub(super) fn read(&self) -> u32 {
        self.register | u32::from(!self.unlocked)
    }

    pub(super) fn key(&mut self, value: u32) -> Result<(), Refusal> {
        if KEYS.get(self.keys) != Some(&value) || self.unlocked {
            return Err(format!("OPTKEYR: {value:#x} is not the key expected"));
        }
        self.keys = (self.keys + 1) % KEYS.len();
        self.unlocked = self.keys == 0;
        Ok(())
    }

    /// Takes a write of the register; what is to be programmed now, if anything.
    pub(super) fn write(&mut self, value: u32) -> Result<Option<u32>, Refusal> {
        if !self.unlocked {
            return Err("OPTCR: written while locked".into());
        }
        let bytes = value & !(OPTLOCK | OPTSTRT);
        if (bytes ^ FACTORY) & !BOR_LEV != 0 {
            return Err(format!("OPTCR: {value:#010x} changes more than the brown-out level"));
        }
        self.register = bytes;
        self.unlocked = value & OPTLOCK == 0;
        Ok((value & OPTSTRT != 0).then_some(bytes))
    }

    /// All bits are erased first; what is left half done is all ones: brown-out off.
    pub(super) fn program(&mut self, bytes: u32, half: bool) {
        self.programmed = if half { FACTORY | BOR_LEV } else { bytes };
    }
}
