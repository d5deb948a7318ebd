//! Reset and clock control: which clock runs, how fast, who gets it, why the chip was reset.

use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::{NEVER, Ps, US};

const CR: u32 = 0x00;
const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CIR: u32 = 0x0C;
/// The first of the reset registers, one a bus.
pub const RESETS: u32 = 0x10;
/// The first of the enable registers.
const ENABLES: u32 = 0x30;
const CSR: u32 = 0x74;

static TABLE: [Register; 17] = [
    register(CR, "CR", 0x83, 1 << 24 | 0xF << 16 | 0xF9),
    register(PLLCFGR, "PLLCFGR", 0x2400_3010, 0x0F43_7FFF),
    register(CFGR, "CFGR", 0, 0xFCF3),
    register(CIR, "CIR", 0, 0x00BF_0000),
    register(RESETS, "AHB1RSTR", 0, 0x0060_109F),
    register(0x14, "AHB2RSTR", 0, 0x80),
    register(0x20, "APB1RSTR", 0, 0x10E2_C80F),
    register(0x24, "APB2RSTR", 0, 0x0017_7931),
    register(ENABLES, "AHB1ENR", 0, 0x0060_109F),
    register(0x34, "AHB2ENR", 0, 0x80),
    register(0x40, "APB1ENR", 0, 0x10E2_C80F),
    register(0x44, "APB2ENR", 0, 0x0017_7931),
    register(0x70, "BDCR", 0, 1 << 16 | 0x8300),
    register(CSR, "CSR", 0, 1 << 24 | 1),
    register(0x8C, "DCKCFGR", 0, 1 << 24),
    register(0x60, "APB1LPENR", 0x10E2_C80F, 0x10E2_C80F),
    register(0x64, "APB2LPENR", 0x0007_7930, 0x0007_7930),
];

const HSI: u64 = 16_000_000;
const HSEON: u32 = 1 << 16;
const HSEBYP: u32 = 1 << 18;
const CSSON: u32 = 1 << 19;
const PLLON: u32 = 1 << 24;
const CSSF: u32 = 1 << 7;
/// Start-up times: a clock fed from outside needs a few cycles, the PLL 200 µs at most.
const HSE_START: Ps = 20 * US;
const PLL_START: Ps = 200 * US;

/// Causes of a reset, as bits of CSR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Power came up.
    PowerOn,
    /// The supply sagged.
    BrownOut,
    /// The reset button.
    Pin,
    /// The program asked for it.
    Software,
    /// The independent watchdog.
    Watchdog,
}

impl Cause {
    /// The flags that the chip sets: every reset pulls the pin.
    fn flags(self) -> u32 {
        1 << 26
            | match self {
                Self::PowerOn => 1 << 27 | 1 << 25,
                Self::BrownOut => 1 << 25,
                Self::Pin => 0,
                Self::Software => 1 << 28,
                Self::Watchdog => 1 << 29,
            }
    }
}

/// Frequencies in Hz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frequencies {
    /// Core.
    pub core: u64,
    /// Slow bus.
    pub pclk1: u64,
    /// Fast bus.
    pub pclk2: u64,
}

impl Frequencies {
    /// Timers run at twice the bus unless the bus runs at the core's speed.
    fn timer(self, bus: u64) -> u64 {
        if bus == self.core { bus } else { 2 * bus }
    }

    /// Timers on the slow bus.
    pub fn timers1(self) -> u64 {
        self.timer(self.pclk1)
    }

    /// Timers on the fast bus.
    pub fn timers2(self) -> u64 {
        self.timer(self.pclk2)
    }
}

/// Clocks.
pub struct Clocks {
    file: File,
    /// Frequency at the OSC_IN pin; the ST-LINK's 8 MHz, or nothing.
    pub external: Option<u64>,
    hse_ready: Ps,
    pll_ready: Ps,
    /// The clock that runs, as a value of SW.
    running: u32,
    /// The clock's guard has fired and is to be told.
    pub guard: bool,
}

impl Clocks {
    /// After power-up.
    pub fn new(external: Option<u64>) -> Self {
        Self {
            file: File::new(&TABLE),
            external,
            hse_ready: NEVER,
            pll_ready: NEVER,
            running: 0,
            guard: false,
        }
    }

    /// As after reset; the flags of the causes add up until the program clears them.
    pub fn reset(&mut self, cause: Cause) {
        let flags = if cause == Cause::PowerOn { 0 } else { self.file.get(CSR) & 0xFE00_0000 };
        *self = Self::new(self.external);
        self.file.set(CSR, flags | cause.flags());
    }

    /// The external clock stops. Without the guard, whoever ran from it stands still.
    pub fn fail_external(&mut self) {
        self.external = None;
        self.hse_ready = NEVER;
        let cr = self.file.get(CR);
        if cr & CSSON != 0 && cr & HSEON != 0 {
            self.file.set(CR, cr & !(HSEON | CSSON | PLLON));
            self.file.set(CIR, self.file.get(CIR) | CSSF);
            self.pll_ready = NEVER;
            self.running = 0;
            self.guard = true;
        }
    }

    /// Whether the guard's interrupt is pending.
    pub fn guard_flag(&self) -> bool {
        self.file.get(CIR) & CSSF != 0
    }

    fn settle(&mut self, now: Ps) {
        let wanted = field(self.file.get(CFGR), 0, 2);
        let ready = match wanted {
            0 => true,
            1 => self.hse_ready <= now,
            _ => self.pll_ready <= now,
        };
        if ready {
            self.running = wanted;
        }
    }

    /// Whether a peripheral gets its clock: place in the enable registers, which are 4 bytes apart.
    pub fn is_enabled(&self, register: u32, place: u32) -> bool {
        bit(self.file.get(ENABLES + register), place)
    }

    /// How fast all runs; `None` where the clock that is used has died.
    pub fn frequencies(&self) -> Option<Frequencies> {
        let cfgr = self.file.get(CFGR);
        let pllcfgr = self.file.get(PLLCFGR);
        let system = match self.running {
            0 => HSI,
            1 => self.external?,
            _ => {
                let input = if bit(pllcfgr, 22) { self.external? } else { HSI };
                let (m, n, p) = (field(pllcfgr, 0, 6), field(pllcfgr, 6, 9), field(pllcfgr, 16, 2));
                input * u64::from(n) / u64::from(m.max(1)) / (2 * u64::from(p) + 2)
            }
        };
        let ahb = field(cfgr, 4, 4);
        let core = if ahb < 8 { system } else { system >> [1, 2, 3, 4, 6, 7, 8, 9][(ahb - 8) as usize] };
        let bus = |place| match field(cfgr, place, 3) {
            low if low < 4 => core,
            high => core >> (high - 3),
        };
        Some(Frequencies { core, pclk1: bus(10), pclk2: bus(13) })
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        self.settle(now);
        let value = self.file.read(offset)?;
        let ready = |on: bool, place: u32| u32::from(on) << place;
        Ok(match offset {
            CR => {
                let hsi = ready(bit(value, 0), 1);
                value & !2 | hsi | ready(self.hse_ready <= now, 17) | ready(self.pll_ready <= now, 25)
            }
            CFGR => value & !0xC | self.running << 2,
            CSR => value | (value & 1) << 1,
            _ => value,
        })
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.settle(now);
        match offset {
            CR => self.write_cr(value & !(1 << 1 | 1 << 17 | 1 << 25), now)?,
            CFGR => self.file.write(CFGR, value & !0xC)?,
            CIR => {
                self.file.write(CIR, value & !CSSF)?;
                let flag = if bit(value, 23) { 0 } else { self.file.get(CIR) & CSSF };
                self.file.set(CIR, flag);
            }
            CSR => {
                self.file.write(CSR, value & !2)?;
                if bit(value, 24) {
                    self.file.set(CSR, value & 1);
                }
            }
            PLLCFGR if self.pll_ready <= now => return Err("PLLCFGR: written while the PLL runs".into()),
            _ => self.file.write(offset, value)?,
        }
        self.settle(now);
        Ok(())
    }

    fn write_cr(&mut self, value: u32, now: Ps) -> Result<(), Refusal> {
        if self.file.get(CR) & PLLON == 0 && value & PLLON != 0 {
            self.pll_ready = now + PLL_START;
        }
        if value & PLLON == 0 {
            self.pll_ready = NEVER;
        }
        // The ST-LINK gives a square wave, which needs the bypass.
        let fed = self.external.is_some() && value & HSEBYP != 0;
        let was_on = self.file.get(CR) & HSEON != 0;
        match (was_on, value & HSEON != 0) {
            (_, false) => self.hse_ready = NEVER,
            (false, true) if fed => self.hse_ready = now + HSE_START,
            _ => {}
        }
        self.file.write(CR, value)
    }
}
