//! ADC1: one regular conversion at a time, started by the program. A conversion takes the time that it takes, and a sample
//! that is too short keeps some of the one before: the sampling capacitor is charged through the switch and the source.

use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::{NEVER, Ps, SECOND, US};

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
    register(CCR, "CCR", 0, 3 << 16 | TSVREFE),
];

/// Bit of [`CCR`] that connects the reference.
const TSVREFE: u32 = 1 << 23;
/// Channel of the reference.
pub const REFERENCE: u8 = 17;
/// It needs a sample of 10 us.
const REFERENCE_SAMPLE: f64 = 10e-6;

const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const SWSTART: u32 = 1 << 30;
/// Cycles of sampling, by SMPx.
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
/// Cycles of a 12-bit conversion after sampling.
const CONVERSION: u64 = 12;
/// Highest clock of the converter, Hz.
const MAX_HZ: u64 = 36_000_000;
/// Sampling switch and capacitor at their worst by the data sheet: 6 kohm, 7 pF.
const SWITCH: f64 = 6_000.0;
const CAPACITOR: f64 = 7e-12;
/// What it needs after it has been switched on.
const STABILISATION: Ps = 3 * US;

/// The converter.
pub struct Adc {
    file: File,
    on_since: Ps,
    done_at: Ps,
    result: u32,
    /// Voltage on the sampling capacitor, in codes.
    held: f64,
    /// Time for which the capacitor is charged, s.
    charging: f64,
    /// It hangs: a conversion never ends.
    pub stuck: bool,
}

impl Default for Adc {
    fn default() -> Self {
        Self {
            file: File::new(&TABLE),
            on_since: NEVER,
            done_at: NEVER,
            result: 0,
            held: 0.0,
            charging: 0.0,
            stuck: false,
        }
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

    /// Begins to convert a channel; `pclk2` in Hz. When its sample ends.
    ///
    /// # Errors
    /// The clock is too fast.
    pub fn begin(&mut self, channel: u8, pclk2: u64, now: Ps) -> Result<Ps, Refusal> {
        let hz = pclk2 / [2, 4, 6, 8][field(self.file.get(CCR), 16, 2) as usize];
        if hz > MAX_HZ {
            return Err(format!("the converter's clock is {hz} Hz, at most {MAX_HZ} allowed"));
        }
        let channel = u32::from(channel);
        let (register, place) = if channel < 10 { (SMPR2, channel) } else { (SMPR1, channel - 10) };
        let cycles = SAMPLING[field(self.file.get(register), 3 * place, 3) as usize];
        let ends_at = now + (cycles + CONVERSION) * SECOND / hz;
        self.done_at = if self.stuck { NEVER } else { ends_at };
        self.charging = (cycles as f64 - 0.5) / hz as f64;
        Ok(now + cycles * SECOND / hz)
    }

    /// Converts the chip's own reference, which gives this code.
    ///
    /// # Errors
    /// It is not connected, or sampled for too short a time.
    pub fn sample_reference(&mut self, code: u16) -> Result<(), Refusal> {
        if self.file.get(CCR) & TSVREFE == 0 {
            return Err("channel 17 is converted without TSVREFE".into());
        }
        if self.charging < REFERENCE_SAMPLE {
            return Err(format!(
                "channel 17 is sampled for {:.1} us, at least 10 asked for",
                1e6 * self.charging
            ));
        }
        (self.held, self.result) = (code.into(), code.into());
        Ok(())
    }

    /// Converts the voltage at the pin, in codes, through a source of so many ohm.
    pub fn sample(&mut self, at_pin: f64, source: f64) {
        let time_constant = (SWITCH + source) * CAPACITOR;
        self.held = at_pin + (self.held - at_pin) * (-self.charging / time_constant).exp();
        self.result = self.held.round().clamp(0.0, 4095.0) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The code that a channel at 2000 gives after one at 1000, with so many ohm and this SMP.
    fn after_another(source: f64, smp: u32) -> u32 {
        let mut adc = Adc::default();
        adc.write(SMPR2, smp | smp << 3, 0).unwrap();
        adc.write(CR2, 1, 0).unwrap();
        for (i, code) in [1000.0, 2000.0].into_iter().enumerate() {
            let now = (i as Ps + 1) * 10 * US;
            adc.write(CR2, 1 | SWSTART, now).unwrap();
            adc.begin(i as u8, 50_000_000, now).unwrap();
            adc.sample(code, source);
            adc.settle(now + 10 * US);
        }
        adc.result
    }

    #[test]
    fn a_sample_settles_through_switch_and_source() {
        assert_eq!(after_another(0.0, 4), 2000, "84 cycles");
        assert_eq!(after_another(10_000.0, 4), 2000);
        // 2.5 cycles of 40 ns against 6 kohm and 7 pF: 9.2 % of each step are missing.
        assert_eq!(after_another(0.0, 0), 1899);
        assert!(after_another(5_000.0, 0) < 1800);
    }
}
