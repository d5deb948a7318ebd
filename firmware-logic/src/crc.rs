//! The checksum of what must not be believed after a bad power-down.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// CRC-32 of Ethernet and zip, bit by bit: a table would cost 1 KiB of flash for a few hundred bytes at boot.
pub const CRC32: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

#[cfg(test)]
mod tests {
    use super::CRC32;

    #[test]
    fn gives_the_check_value_of_the_catalogue() {
        assert_eq!(CRC32.checksum(b"123456789"), 0xCBF4_3926);
        assert_eq!(CRC32.checksum(b""), 0);
    }

    #[test]
    fn sees_every_single_bit_error() {
        let message = *b"T1 open";
        for bit in 0..8 * message.len() {
            let mut damaged = message;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(CRC32.checksum(&damaged), CRC32.checksum(&message), "bit {bit}");
        }
    }
}
