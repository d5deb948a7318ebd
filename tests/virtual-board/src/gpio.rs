//! Ports A to E and H: what each pin is set to be, what is wired to it from outside.

use crate::registers::{File, Refusal, Register, field, register};

const MODER: u32 = 0x00;
const PUPDR: u32 = 0x0C;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;

const fn table(moder: u32, ospeedr: u32, pupdr: u32) -> [Register; 9] {
    const ALL: u32 = u32::MAX;
    [
        register(MODER, "MODER", moder, ALL),
        register(0x04, "OTYPER", 0, 0xFFFF),
        register(0x08, "OSPEEDR", ospeedr, ALL),
        register(PUPDR, "PUPDR", pupdr, ALL),
        register(IDR, "IDR", 0, 0),
        register(ODR, "ODR", 0, 0xFFFF),
        register(BSRR, "BSRR", 0, ALL),
        register(AFRL, "AFRL", 0, ALL),
        register(0x24, "AFRH", 0, ALL),
    ]
}

static PORT_A: [Register; 9] = table(0xA800_0000, 0x0C00_0000, 0x6400_0000);
static PORT_B: [Register; 9] = table(0x0000_0280, 0x0000_00C0, 0x0000_0100);
static OTHER: [Register; 9] = table(0, 0, 0);

/// What a pin is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Digital input.
    Input,
    /// Driven by the port.
    Output,
    /// Handed over to the peripheral of this number.
    Alternate(u8),
    /// Analogue input.
    Analog,
}

/// The pull inside the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PullInside {
    /// None, or both at once.
    None,
    /// To the supply.
    Up,
    /// To ground.
    Down,
}

/// A port.
pub struct Port {
    file: File,
    /// Levels that are wired to the pins; `None` floats.
    outside: [Option<bool>; 16],
}

impl Port {
    /// Port `letter`, as after reset.
    pub fn new(letter: char) -> Self {
        let table: &'static [Register] = match letter {
            'A' => &PORT_A,
            'B' => &PORT_B,
            _ => &OTHER,
        };
        Self { file: File::new(table), outside: [None; 16] }
    }

    /// As after reset; the wires stay.
    pub fn reset(&mut self) {
        self.file.reset();
    }

    /// Wires a pin to a level, or leaves it open.
    pub fn wire(&mut self, pin: usize, level: Option<bool>) {
        self.outside[pin & 15] = level;
    }

    /// What a pin is.
    pub fn mode(&self, pin: usize) -> Mode {
        let pin = pin as u32 & 15;
        match field(self.file.get(MODER), 2 * pin, 2) {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => Mode::Alternate(field(self.file.get(AFRL + 4 * (pin / 8)), 4 * (pin % 8), 4) as u8),
            _ => Mode::Analog,
        }
    }

    /// The level that the port itself drives.
    pub fn driven(&self, pin: usize) -> bool {
        self.file.get(ODR) >> (pin & 15) & 1 == 1
    }

    /// The pull that the program has set for a pin.
    pub fn pull(&self, pin: usize) -> PullInside {
        match field(self.file.get(PUPDR), 2 * (pin as u32 & 15), 2) {
            1 => PullInside::Up,
            2 => PullInside::Down,
            _ => PullInside::None,
        }
    }

    /// The level that an input sees: the wire's, or the pull's where nothing is wired.
    pub fn level(&self, pin: usize) -> bool {
        if self.mode(pin) == Mode::Output {
            return self.driven(pin);
        }
        self.outside[pin & 15].unwrap_or(self.pull(pin) == PullInside::Up)
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        match offset {
            IDR => Ok((0..16).filter(|&pin| self.level(pin)).fold(0, |bits, pin| bits | 1 << pin)),
            BSRR => Ok(0),
            _ => self.file.read(offset),
        }
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Refusal> {
        match offset {
            BSRR => {
                let odr = self.file.get(ODR) & !(value >> 16) | value & 0xFFFF;
                self.file.write(ODR, odr)
            }
            _ => self.file.write(offset, value),
        }
    }
}
