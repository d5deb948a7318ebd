//! CRC-32 (the one of Ethernet and zip) over what must not be believed after a bad power-down.

/// CRC-32/ISO-HDLC, bit by bit: a table would cost 1 KiB of flash for a few hundred bytes at boot.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            let carry = crc & 1;
            (crc >> 1) ^ (0xEDB8_8320 & carry.wrapping_neg())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::crc32;

    #[test]
    fn gives_the_check_value_of_the_catalogue() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(crc32(b""), 0);
    }

    #[test]
    fn sees_every_single_bit_error() {
        let message = *b"T1 open";
        for bit in 0..8 * message.len() {
            let mut damaged = message;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(crc32(&damaged), crc32(&message), "bit {bit}");
        }
    }
}
