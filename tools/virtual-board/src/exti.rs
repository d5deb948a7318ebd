//! External interrupts: edges of the pins of the ports (lines 0 to 15) and of the voltage detector (line 16).

use crate::registers::{File, Refusal, Register, field, register};

const IMR: u32 = 0x00;
const RTSR: u32 = 0x08;
const FTSR: u32 = 0x0C;
const SWIER: u32 = 0x10;
const PR: u32 = 0x14;
/// Lines of the pins, and of the voltage detector.
const LINES: u32 = 0x1_FFFF;
/// Line of the voltage detector.
pub const DETECTOR: usize = 16;

static TABLE: [Register; 6] = [
    register(IMR, "IMR", 0, LINES),
    register(0x04, "EMR", 0, 0),
    register(RTSR, "RTSR", 0, LINES),
    register(FTSR, "FTSR", 0, LINES),
    register(SWIER, "SWIER", 0, LINES),
    register(PR, "PR", 0, LINES),
];

/// Interrupts and the lines that raise each.
pub const INTERRUPTS: [(u16, u32); 8] = [
    (1, 1 << DETECTOR),
    (6, 1),
    (7, 1 << 1),
    (8, 1 << 2),
    (9, 1 << 3),
    (10, 1 << 4),
    (23, 0x03E0),
    (40, 0xFC00),
];

/// First register that says which port a line looks at, in the system configuration controller.
const EXTICR1: u32 = 0x08;
static SYSCFG: [Register; 5] = [
    register(EXTICR1, "EXTICR1", 0, 0x7777),
    register(0x0C, "EXTICR2", 0, 0x7777),
    register(0x10, "EXTICR3", 0, 0x7777),
    register(0x14, "EXTICR4", 0, 0x7777),
    register(0x20, "CMPCR", 0, 0),
];

/// The controller.
pub struct Exti {
    file: File,
    /// The registers of the system configuration controller.
    pub syscfg: File,
    levels: u32,
    /// Lines whose level was looked at before.
    known: u32,
}

impl Default for Exti {
    fn default() -> Self {
        Self { file: File::new(&TABLE), syscfg: File::new(&SYSCFG), levels: 0, known: 0 }
    }
}

impl Exti {
    /// The port that a line looks at.
    pub fn port(&self, line: usize) -> usize {
        let line = line as u32;
        field(self.syscfg.get(EXTICR1 + line / 4 * 4), 4 * (line % 4), 4) as usize
    }

    /// The levels of the lines that are looked at: edges that are asked for become pending.
    pub fn follow(&mut self, levels: u32) {
        let used = self.used();
        let (rose, fell) = (levels & !self.levels, self.levels & !levels);
        let edges = (rose & self.file.get(RTSR) | fell & self.file.get(FTSR)) & self.known;
        self.file.set(PR, self.file.get(PR) | edges);
        (self.levels, self.known) = (levels, used);
    }

    /// Whether any of these lines asks for its interrupt.
    pub fn level(&self, lines: u32) -> bool {
        self.file.get(PR) & self.file.get(IMR) & lines != 0
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        self.file.read(offset)
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Refusal> {
        match offset {
            PR => {
                self.file.set(PR, self.file.get(PR) & !value);
                self.file.set(SWIER, self.file.get(SWIER) & !value);
            }
            SWIER => {
                let fresh = value & !self.file.get(SWIER) & self.file.get(IMR);
                self.file.write(SWIER, value)?;
                self.file.set(PR, self.file.get(PR) | fresh);
            }
            _ => self.file.write(offset, value)?,
        }
        Ok(())
    }

    /// The lines that are looked at.
    pub fn used(&self) -> u32 {
        self.file.get(RTSR) | self.file.get(FTSR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_that_is_asked_for_is_pending_until_it_is_cleared() {
        let mut exti = Exti::default();
        exti.write(FTSR, 1 << 3).unwrap();
        exti.follow(1 << 3);
        exti.follow(0);
        assert!(!exti.level(1 << 3), "masked");
        exti.write(IMR, 1 << 3).unwrap();
        assert!(exti.level(1 << 3));
        exti.write(PR, 1 << 3).unwrap();
        assert!(!exti.level(1 << 3));
        exti.follow(1 << 3);
        assert!(!exti.level(1 << 3), "the other edge");
    }
}
