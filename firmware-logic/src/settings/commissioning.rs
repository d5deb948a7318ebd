//! The commissioning as it is kept in flash, in a record of its own: written once, while settings come and go.
//!
//! ```text
//! version u8 | number u32 | 16 x f32 | CRC-32
//! ```
//!
//! All numbers are little-endian. An empty record says that there is none any more.

use fdi_core::likelihood::{Commissioned, PARAMETERS};

use crate::crc::CRC32;

/// Bytes of a record.
pub const BYTES: usize = 1 + 4 + 4 * PARAMETERS + 4;
/// Changes with the layout, and with what the numbers are.
pub const VERSION: u8 = 1;

const _: () = assert!(BYTES <= 128);

/// A commissioning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commissioning {
    /// The how manieth of this board; a board has no date.
    pub number: u32,
    /// The models.
    pub models: Commissioned,
}

impl Commissioning {
    /// The record.
    pub fn encode(&self) -> [u8; BYTES] {
        let mut record = [0; BYTES];
        let words = self.models.parameters.map(f32::to_bits);
        let (content, crc) = record.split_at_mut(BYTES - 4);
        content[0] = VERSION;
        for (place, word) in content[1..].chunks_exact_mut(4).zip([self.number].into_iter().chain(words)) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        crc.copy_from_slice(&CRC32.checksum(content).to_le_bytes());
        record
    }

    /// Reads a record; `None` where it is none, is damaged, has another version, or cannot have been trained.
    pub fn decode(record: &[u8]) -> Option<Self> {
        let (content, crc) = record.split_last_chunk()?;
        let (version, words) = content.split_first()?;
        let intact = CRC32.checksum(content) == u32::from_le_bytes(*crc);
        if !intact || *version != VERSION || record.len() != BYTES {
            return None;
        }
        let mut words = words.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word));
        let number = words.next()?;
        let mut models = Commissioned::default();
        models.parameters.iter_mut().zip(words).for_each(|(x, bits)| *x = f32::from_bits(bits));
        models.validate().ok()?;
        Some(Self { number, models })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept() -> Commissioning {
        let parameters = core::array::from_fn(|i| 0.25 * (i as f32 + 1.0));
        Commissioning { number: 7, models: Commissioned { parameters } }
    }

    #[test]
    fn what_is_kept_comes_back_to_the_bit() {
        assert_eq!(Commissioning::decode(&kept().encode()), Some(kept()));
    }

    #[test]
    fn any_flipped_bit_and_any_other_length_is_seen() {
        let record = kept().encode();
        for bit in 0..8 * BYTES {
            let mut damaged = record;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Commissioning::decode(&damaged), None, "bit {bit}");
        }
        for length in 0..BYTES {
            assert_eq!(Commissioning::decode(&record[..length]), None, "{length} bytes");
        }
        assert_eq!(Commissioning::decode(&[0; BYTES]), None);
    }

    #[test]
    fn models_that_cannot_be_are_none() {
        let mut broken = kept();
        broken.models.parameters[3] = f32::NAN;
        assert_eq!(Commissioning::decode(&broken.encode()), None);
    }
}
