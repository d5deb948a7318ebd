//! The system control space of the Cortex-M4: system control block, SysTick, and the registers of the NVIC.

use crate::nvic::{FIRST_INTERRUPT, HARD_FAULT, NMI, Nvic, SYSTICK};
use crate::registers::{File, Refusal, Register, bit, register};
use crate::time::{NEVER, Ps};

const ALL: u32 = u32::MAX;
/// Software trigger of an interrupt; write only.
const STIR: u32 = 0xF00;
const STCSR: u32 = 0x010;
const STRVR: u32 = 0x014;
const STCVR: u32 = 0x018;
const ICSR: u32 = 0xD04;
const VTOR: u32 = 0xD08;
const AIRCR: u32 = 0xD0C;
const SCR: u32 = 0xD10;
const SHPR: u32 = 0xD18;
/// System handler control and state.
pub const SHCSR: u32 = 0xD24;
/// Configurable fault status.
pub const CFSR: u32 = 0xD28;
/// Hard fault status.
pub const HFSR: u32 = 0xD2C;
/// Address of a bus fault.
pub const BFAR: u32 = 0xD38;
/// Coprocessor access: whether the FPU is on.
pub const CPACR: u32 = 0xD88;

/// Debug exception and monitor control; its bit that gives the counter of cycles its clock.
const DEMCR: u32 = 0xDFC;
const TRCENA: u32 = 1 << 24;

/// The counter of cycles (DWT): control, whose read-only half says that there are four comparators, and count.
static CYCLES: [Register; 2] = [register(0, "DWT_CTRL", 0x4000_0000, 1), register(4, "DWT_CYCCNT", 0, ALL)];

static TABLE: [Register; 18] = [
    register(STCSR, "SYST_CSR", 0, 7),
    register(STRVR, "SYST_RVR", 0, 0x00FF_FFFF),
    register(STCVR, "SYST_CVR", 0, ALL),
    register(0xD00, "CPUID", 0x410F_C241, 0),
    register(ICSR, "ICSR", 0, ALL),
    register(VTOR, "VTOR", 0, 0x3FFF_FF80),
    register(AIRCR, "AIRCR", 0xFA05_0000, ALL),
    register(SCR, "SCR", 0, 0x10),
    register(0xD14, "CCR", 0x200, 0x218),
    register(SHCSR, "SHCSR", 0, 0x0007_0000),
    register(CFSR, "CFSR", 0, ALL),
    register(HFSR, "HFSR", 0, ALL),
    register(0xD34, "MMFAR", 0, ALL),
    register(BFAR, "BFAR", 0, ALL),
    register(DEMCR, "DEMCR", 0, TRCENA),
    register(CPACR, "CPACR", 0, 0x00F0_0000),
    register(0xF34, "FPCCR", 0xC000_0000, 0xC000_0000),
    register(0xF3C, "FPDSCR", 0, 0),
];

/// The space.
pub struct Scs {
    file: File,
    /// The controller of the exceptions.
    pub nvic: Nvic,
    /// Period of the core clock.
    pub cycle: Ps,
    systick_from: Ps,
    cycles: File,
    /// When the counter of cycles was 0, or would have been.
    cycles_from: Ps,
    /// The program has asked for a reset.
    pub reset_request: bool,
}

impl Default for Scs {
    fn default() -> Self {
        Self {
            file: File::new(&TABLE),
            nvic: Nvic::new(),
            cycle: 62_500,
            systick_from: 0,
            cycles: File::new(&CYCLES),
            cycles_from: 0,
            reset_request: false,
        }
    }
}

impl Scs {
    /// A register's content, as the fault logic of the core sees it.
    pub fn get(&self, offset: u32) -> u32 {
        self.file.get(offset)
    }

    /// Sets bits of a register, as the fault logic of the core does.
    pub fn raise(&mut self, offset: u32, bits: u32) {
        self.file.set(offset, self.file.get(offset) | bits);
    }

    /// Sets a register, as the fault logic of the core does.
    pub fn put(&mut self, offset: u32, value: u32) {
        self.file.set(offset, value);
    }

    /// Where the vector table lies; 0 is an alias of the flash.
    pub fn vector_table(&self) -> u32 {
        match self.file.get(VTOR) {
            0 => 0x0800_0000,
            table => table,
        }
    }

    /// When SysTick next interrupts.
    pub fn next_event(&self) -> Ps {
        let csr = self.file.get(STCSR);
        if csr & 3 == 3 { self.systick_from + self.systick_period() } else { NEVER }
    }

    fn systick_period(&self) -> Ps {
        self.cycle * Ps::from(self.file.get(STRVR) + 1)
    }

    /// Lets SysTick happen.
    pub fn advance(&mut self, now: Ps) {
        while self.next_event() <= now {
            self.systick_from += self.systick_period();
            self.raise(STCSR, 1 << 16);
            self.nvic.pend(SYSTICK);
        }
    }

    fn systick_count(&self, now: Ps) -> u32 {
        let period = self.systick_period();
        ((period - (now - self.systick_from) % period) / self.cycle) as u32 & self.file.get(STRVR)
    }

    /// Reads a word.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        let word = offset >> 2 & 0x1F;
        Ok(match offset {
            0x100..0x120 | 0x180..0x1A0 => self.nvic.bank(false, word),
            0x200..0x220 | 0x280..0x2A0 => self.nvic.bank(true, word),
            0x400..0x4F0 => self.priorities(offset - 0x400 + 16),
            SHPR..SHCSR => self.priorities(offset - SHPR + 4),
            STCVR => self.systick_count(now),
            STCSR => {
                let value = self.file.get(STCSR);
                self.file.set(STCSR, value & !(1 << 16));
                value
            }
            ICSR => self.icsr(),
            _ => self.file.read(offset)?,
        })
    }

    /// Reads a word of the counter of cycles.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read_cycles(&self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        let runs = bit(self.cycles.get(0), 0) && self.file.get(DEMCR) & TRCENA != 0;
        match offset {
            4 if runs => Ok(((now - self.cycles_from) / self.cycle) as u32),
            _ => self.cycles.read(offset),
        }
    }

    /// Writes a word of the counter of cycles, which begins to count from 0 then.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write_cycles(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.cycles_from = now;
        // What the control register says of itself is written back with the rest.
        self.cycles.write(offset, if offset == 0 { value & 1 } else { value })
    }

    fn priorities(&self, first: u32) -> u32 {
        u32::from_le_bytes([0, 1, 2, 3].map(|i| self.nvic.priority_byte(first + i)))
    }

    fn icsr(&self) -> u32 {
        let pending = self.nvic.vect_pending();
        u32::from(self.nvic.running())
            | u32::from(pending) << 12
            | u32::from(pending >= 16) << 22
            | u32::from(self.nvic.is_pending(SYSTICK)) << 26
    }

    /// Writes a word.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        let word = offset >> 2 & 0x1F;
        match offset {
            0x100..0x120 => self.nvic.write_bank(false, true, word, value),
            0x180..0x1A0 => self.nvic.write_bank(false, false, word, value),
            0x200..0x220 => self.nvic.write_bank(true, true, word, value),
            0x280..0x2A0 => self.nvic.write_bank(true, false, word, value),
            0x400..0x4F0 => self.set_priorities(offset - 0x400 + 16, value),
            SHPR..SHCSR => self.set_priorities(offset - SHPR + 4, value),
            ICSR => self.write_icsr(value)?,
            CFSR | HFSR => self.file.set(offset, self.file.get(offset) & !value),
            AIRCR => self.write_aircr(value)?,
            STIR => self.nvic.pend(FIRST_INTERRUPT + (value & 0x1FF).min(111) as u16),
            STCSR | STCVR => {
                self.systick_from = now;
                if offset == STCSR {
                    self.file.write(STCSR, value)?;
                }
            }
            _ => self.file.write(offset, value)?,
        }
        Ok(())
    }

    /// Writes one byte, where the core allows for it: a priority.
    ///
    /// # Errors
    /// It is not a priority.
    pub fn write_byte(&mut self, offset: u32, value: u8) -> Result<(), Refusal> {
        match offset {
            0x400..0x4F0 => self.nvic.set_priority_byte(offset - 0x400 + 16, value),
            SHPR..SHCSR => self.nvic.set_priority_byte(offset - SHPR + 4, value),
            _ => return Err("byte access is modelled for priorities only".into()),
        }
        Ok(())
    }

    fn set_priorities(&mut self, first: u32, value: u32) {
        for (exception, byte) in (first..).zip(value.to_le_bytes()) {
            self.nvic.set_priority_byte(exception, byte);
        }
    }

    fn write_icsr(&mut self, value: u32) -> Result<(), Refusal> {
        for (place, exception) in [(31, NMI), (28, 14), (26, SYSTICK)] {
            if bit(value, place) {
                self.nvic.pend(exception);
            }
        }
        for (place, exception) in [(27, 14), (25, SYSTICK)] {
            if bit(value, place) {
                self.nvic.unpend(exception);
            }
        }
        Ok(())
    }

    fn write_aircr(&mut self, value: u32) -> Result<(), Refusal> {
        if value >> 16 != 0x05FA {
            return Err(format!("AIRCR: key {:#x}, expected 0x5fa", value >> 16));
        }
        if value & 0x700 != 0 {
            return Err("AIRCR: priority groups are not modelled".into());
        }
        self.reset_request = bit(value, 2);
        Ok(())
    }

    /// The exception that takes a fault, with the status set: its own handler where that is enabled and may interrupt,
    /// else the hard fault; `None` if the core locks up.
    pub fn fault(&mut self, exception: u16, status: u32, address: Option<u32>) -> Option<u16> {
        self.raise(CFSR, status);
        if let Some(address) = address {
            self.put(BFAR, address);
        }
        let running = self.nvic.active_priority();
        let own = bit(self.get(SHCSR), u32::from(exception) + 12) && self.nvic.priority(exception) < running;
        if own {
            return Some(exception);
        }
        self.raise(HFSR, 1 << 30);
        (running > -1).then_some(HARD_FAULT)
    }
}
