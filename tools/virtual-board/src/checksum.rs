//! The CRC unit: CRC-32 of Ethernet's polynomial over words from their highest bit on, begun with ones, nothing turned round at the end (RM0383).

use crate::registers::{File, Refusal, Register, bit, register};

const DR: u32 = 0x00;
const CR: u32 = 0x08;

static TABLE: [Register; 3] =
    [register(DR, "DR", u32::MAX, u32::MAX), register(0x04, "IDR", 0, 0xFF), register(CR, "CR", 0, 0)];

const POLYNOMIAL: u32 = 0x04C1_1DB7;

/// The unit.
pub struct Checksum(File);

impl Default for Checksum {
    fn default() -> Self {
        Self(File::new(&TABLE))
    }
}

impl Checksum {
    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        self.0.read(offset)
    }

    /// Writes a register: a word to the data register goes through the polynomial.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Refusal> {
        match offset {
            DR => {
                let step = |sum: u32, _| sum << 1 ^ if bit(sum, 31) { POLYNOMIAL } else { 0 };
                self.0.set(DR, (0..32).fold(self.0.get(DR) ^ value, step));
                Ok(())
            }
            CR if bit(value, 0) => {
                self.0.reset();
                Ok(())
            }
            _ => self.0.write(offset, value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_behind_what_it_is_of_leaves_nothing() {
        let mut unit = Checksum::default();
        unit.write(DR, 0x1234_5678).unwrap();
        let sum = unit.read(DR).unwrap();
        assert_eq!(sum, 0xDF8A_8A2B, "CRC-32/MPEG-2 of these bytes");
        unit.write(DR, sum).unwrap();
        assert_eq!(unit.read(DR).unwrap(), 0);
        unit.write(CR, 1).unwrap();
        assert_eq!(unit.read(DR).unwrap(), u32::MAX);
    }
}
