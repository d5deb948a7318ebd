//! Ports A to E and H: what each pin is set to be, what is wired to it from outside, and the lock that keeps it so.

use crate::registers::{File, Refusal, Register, field, register};

const MODER: u32 = 0x00;
const PUPDR: u32 = 0x0C;
/// Levels at the pins.
pub const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const LCKR: u32 = 0x1C;
const AFRL: u32 = 0x20;

const fn table(moder: u32, ospeedr: u32, pupdr: u32) -> [Register; 10] {
    const ALL: u32 = u32::MAX;
    [
        register(MODER, "MODER", moder, ALL),
        register(0x04, "OTYPER", 0, 0xFFFF),
        register(0x08, "OSPEEDR", ospeedr, ALL),
        register(PUPDR, "PUPDR", pupdr, ALL),
        register(IDR, "IDR", 0, 0),
        register(ODR, "ODR", 0, 0xFFFF),
        register(BSRR, "BSRR", 0, ALL),
        register(LCKR, "LCKR", 0, 0x1_FFFF),
        register(AFRL, "AFRL", 0, ALL),
        register(0x24, "AFRH", 0, ALL),
    ]
}

static PORT_A: [Register; 10] = table(0xA800_0000, 0x0C00_0000, 0x6400_0000);
static PORT_B: [Register; 10] = table(0x0000_0280, 0x0000_00C0, 0x0000_0100);
static OTHER: [Register; 10] = table(0, 0, 0);

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

/// LCKK: the key of the lock, and the flag that it is closed.
const KEY: u32 = 1 << 16;
/// Registers that the lock freezes, with their bits a pin and their first pin.
const FROZEN: [(u32, u32, u32); 6] =
    [(MODER, 2, 0), (0x04, 1, 0), (0x08, 2, 0), (PUPDR, 2, 0), (AFRL, 4, 0), (0x24, 4, 8)];

/// The lock of a port: closed until the next reset by the key with 1, 0, 1 and the same pins, and a read.
#[derive(Clone, Copy, Default)]
struct Lock {
    pins: u32,
    /// Right writes so far.
    step: u32,
    closed: bool,
}

impl Lock {
    fn write(&mut self, value: u32) {
        if self.closed {
            return;
        }
        let (key, pins) = (value & KEY != 0, value & 0xFFFF);
        self.step = match (self.step, key) {
            (1, false) if pins == self.pins => 2,
            (2, true) if pins == self.pins => 3,
            (_, true) => 1,
            _ => 0,
        };
        self.pins = pins;
    }

    fn read(&mut self) -> u32 {
        self.closed |= self.step == 3;
        self.pins | if self.closed { KEY } else { 0 }
    }

    /// Bits of a register that are frozen.
    fn mask(&self, offset: u32) -> u32 {
        let row = FROZEN.iter().find(|(register, ..)| *register == offset && self.closed);
        let Some((_, width, first)) = row else { return 0 };
        let pins = (*first..16).filter(|pin| self.pins >> pin & 1 == 1 && (pin - first) * width < 32);
        pins.fold(0, |mask, pin| mask | ((1 << width) - 1) << ((pin - first) * width))
    }
}

/// A port.
pub struct Port {
    file: File,
    lock: Lock,
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
        Self { file: File::new(table), lock: Lock::default(), outside: [None; 16] }
    }

    /// As after reset; the wires stay.
    pub fn reset(&mut self) {
        self.file.reset();
        self.lock = Lock::default();
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
    pub fn read(&mut self, offset: u32) -> Result<u32, Refusal> {
        match offset {
            LCKR => Ok(self.lock.read()),
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
            LCKR => {
                self.lock.write(value);
                Ok(())
            }
            _ => {
                let frozen = self.lock.mask(offset);
                self.file.write(offset, value & !frozen | self.file.get(offset) & frozen)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_locked_pin_stays_what_it_is_and_the_others_do_not() {
        let mut port = Port::new('B');
        port.write(MODER, 2 << 20 | 2 << 16).unwrap();
        port.write(0x24, 1 << 8 | 1).unwrap();
        for value in [KEY | 1 << 10, 1 << 10, KEY | 1 << 10] {
            port.write(LCKR, value).unwrap();
        }
        assert_eq!(port.read(LCKR).unwrap(), KEY | 1 << 10);
        port.write(MODER, 1 << 20 | 1 << 16).unwrap();
        port.write(0x24, 0).unwrap();
        assert_eq!((port.mode(10), port.mode(8)), (Mode::Alternate(1), Mode::Output));
        port.reset();
        assert_eq!(port.mode(10), Mode::Input);
    }

    #[test]
    fn a_wrong_sequence_locks_nothing() {
        let mut port = Port::new('B');
        for value in [KEY | 1 << 10, 1 << 9, KEY | 1 << 10] {
            port.write(LCKR, value).unwrap();
        }
        assert_eq!(port.read(LCKR).unwrap() & KEY, 0);
    }
}
