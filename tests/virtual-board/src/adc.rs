//! ADC1: one regular conversion at a time, started by the program. A conversion takes the time that it takes.

use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::{NEVER, Ps, US};

const SR: u32 = 0x00;
const CR2: u32 = 0x08;
const SMPR1: u32 = 0x0C;
const SMPR2: u32 = 0x10;
const SQR3: u32 = 0x34;
const DR: u32 = 0x4C;
/// Control register that all converters share.
pub const CCR: u32 = 0x304;

/// Resolution, interrupts, scanning, triggers and DMA are not modelled.
static TABLE: [Register; 9] = [
    register(SR, "SR", 0, 0x3F),
    register(0x04, "CR1", 0, 0),
    register(CR2, "CR2", 0, 1 | 1 << 10 | 1 << 30),
    register(SMPR1, "SMPR1", 0, 0x07FF_FFFF),
    register(SMPR2, "SMPR2", 0, 0x3FFF_FFFF),
    register(0x2C, "SQR1", 0, 0),
    register(SQR3, "SQR3", 0, 0x1F),
    register(DR, "DR", 0, 0),
    register(CCR, "CCR", 0, 3 << 16),
];

const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const SWSTART: u32 = 1 << 30;
/// Cycles of sampling, by SMPx.
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
/// Cycles of a 12-bit conversion after sampling.
const CONVERSION: u64 = 12;
/// Highest clock of the converter, Hz.
const MAX_HZ: u64 = 36_000_000;
/// What it needs after it has been switched on.
const STABILISATION: Ps = 3 * US;

/// The converter.
pub struct Adc {
    file: File,
    on_since: Ps,
    done_at: Ps,
    result: u32,
}

impl Default for Adc {
    fn default() -> Self {
        Self { file: File::new(&TABLE), on_since: NEVER, done_at: NEVER, result: 0 }
    }
}

impl Adc {
    fn settle(&mut self, now: Ps) {
        if self.done_at <= now {
            self.done_at = NEVER;
            self.file.set(SR, self.file.get(SR) | EOC);
            self.file.set(DR, self.result);
        }
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        self.settle(now);
        let value = self.file.read(offset)?;
        if offset == DR {
            self.file.set(SR, self.file.get(SR) & !EOC);
        }
        Ok(value)
    }

    /// Writes a register; a channel that is to be converted now is returned.
    ///
    /// # Errors
    /// It is not modelled, or forbidden by the data sheet.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<Option<u8>, Refusal> {
        self.settle(now);
        if offset == SR {
            self.file.set(SR, self.file.get(SR) & value);
            return Ok(None);
        }
        self.file.write(offset, value & if offset == CR2 { !SWSTART } else { u32::MAX })?;
        if offset == CR2 {
            self.on_since = if bit(value, 0) { self.on_since.min(now) } else { NEVER };
            if value & SWSTART != 0 {
                return self.start(now).map(Some);
            }
        }
        Ok(None)
    }

    fn start(&mut self, now: Ps) -> Result<u8, Refusal> {
        if self.on_since.saturating_add(STABILISATION) > now {
            return Err("CR2: a conversion before the converter has been on for 3 us".into());
        }
        if self.done_at != NEVER {
            return Err("CR2: a conversion during another one".into());
        }
        self.file.set(SR, self.file.get(SR) | STRT);
        Ok(self.file.get(SQR3) as u8)
    }

    /// Takes in the code of the channel that is being converted; `pclk2` in Hz.
    ///
    /// # Errors
    /// The clock is too fast.
    pub fn convert(&mut self, channel: u8, code: u16, pclk2: u64, now: Ps) -> Result<(), Refusal> {
        let hz = pclk2 / [2, 4, 6, 8][field(self.file.get(CCR), 16, 2) as usize];
        if hz > MAX_HZ {
            return Err(format!("the converter's clock is {hz} Hz, at most {MAX_HZ} allowed"));
        }
        let channel = u32::from(channel);
        let (register, place) = if channel < 10 { (SMPR2, channel) } else { (SMPR1, channel - 10) };
        let sampling = SAMPLING[field(self.file.get(register), 3 * place, 3) as usize];
        self.done_at = now + (sampling + CONVERSION) * crate::time::SECOND / hz;
        self.result = u32::from(code);
        Ok(())
    }
}
