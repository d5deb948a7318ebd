//! A line that is known from text, and known to be whole: start of text (STX, 0x02), the line, an asterisk, its CRC-32 in eight
//! hexadecimal digits, carriage return and line feed.
//!
//! ```text
//! ␂tick 4d2 0 450d8000 ..*1a2b3c4d
//! ```
//!
//! A frame may stand anywhere in other text, in the middle of a line, too: who takes the frames out has the text again.

use core::fmt::{self, Display, Write};

use crc::{Digest, NoTable};
use heapless::Vec;

use crate::crc::CRC32;

/// Begins a frame. No line, and nothing that a console says, has this byte in it.
pub const START: u8 = 0x02;
/// Ends it.
pub const END: u8 = b'\n';
/// Bytes of a frame beside those of the line.
pub const AROUND: usize = 1 + 1 + 8 + 2;

/// Writes a frame.
///
/// # Errors
/// It does not fit.
pub fn write(line: &impl Display, out: &mut impl Write) -> fmt::Result {
    out.write_char(START.into())?;
    let mut summed = Summed { out, sum: CRC32.digest() };
    write!(summed, "{line}")?;
    let sum = summed.sum.finalize();
    write!(out, "*{sum:08x}\r\n")
}

/// The line in what stood between [`START`] and [`END`]; `None` where it is not whole.
pub fn read(frame: &[u8]) -> Option<&str> {
    let (line, sum) = core::str::from_utf8(frame).ok()?.trim_ascii_end().rsplit_once('*')?;
    let is_hex = sum.len() == 8 && sum.bytes().all(|byte| byte.is_ascii_hexdigit());
    let told = u32::from_str_radix(sum, 16).ok().filter(|_| is_hex)?;
    (CRC32.checksum(line.as_bytes()) == told).then_some(line)
}

/// What a byte did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// It is part of the text around the frames.
    Text(u8),
    /// It ended a frame, which holds this line.
    Line(&'a str),
    /// It ended a frame that is not whole, or began another before the end.
    Broken,
    /// It is part of a frame.
    Nothing,
}

/// Takes the frames out of a text, those of up to `N` bytes. A carriage return ends a frame as well: a stray byte that looks like the
/// begin of one costs no more than the line that somebody types after it.
#[derive(Clone, Debug, Default)]
pub struct Reader<const N: usize> {
    frame: Vec<u8, N>,
    inside: bool,
    too_long: bool,
    /// A carriage return has ended a frame: a line feed now belongs to it.
    returned: bool,
}

impl<const N: usize> Reader<N> {
    /// One byte.
    pub fn push(&mut self, byte: u8) -> Step<'_> {
        let after_return = core::mem::take(&mut self.returned);
        match byte {
            END if after_return => Step::Nothing,
            START => {
                self.frame.clear();
                self.too_long = false;
                if core::mem::replace(&mut self.inside, true) { Step::Broken } else { Step::Nothing }
            }
            text if !self.inside => Step::Text(text),
            b'\r' | END => {
                self.returned = byte == b'\r';
                self.inside = false;
                read(&self.frame).filter(|_| !self.too_long).map_or(Step::Broken, Step::Line)
            }
            byte => {
                self.too_long |= self.frame.push(byte).is_err();
                Step::Nothing
            }
        }
    }
}

/// Sums what it writes.
struct Summed<'a, W> {
    out: &'a mut W,
    sum: Digest<'static, u32, NoTable>,
}

impl<W: Write> Write for Summed<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.sum.update(text.as_bytes());
        self.out.write_str(text)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn framed(line: &str) -> std::vec::Vec<u8> {
        let mut frame = String::new();
        write(&line, &mut frame).expect("there is room");
        frame.into_bytes()
    }

    #[test]
    fn looks_as_it_is_told() {
        assert_eq!(framed("123456789"), b"\x02123456789*cbf43926\r\n");
        assert_eq!(framed("").len(), AROUND);
    }

    /// Text and lines of some bytes, and how many frames were broken.
    fn parted(bytes: &[u8]) -> (String, std::vec::Vec<String>, usize) {
        let mut reader = Reader::<32>::default();
        let (mut text, mut lines, mut broken) = (String::new(), vec![], 0);
        for &byte in bytes {
            match reader.push(byte) {
                Step::Text(byte) => text.push(byte.into()),
                Step::Line(line) => lines.push(line.to_owned()),
                Step::Broken => broken += 1,
                Step::Nothing => {}
            }
        }
        (text, lines, broken)
    }

    #[test]
    fn frames_stand_anywhere_and_leave_the_text_whole() {
        let (a, b) = (framed("tick 1"), framed("tick 2"));
        let bytes = [b"> sta", &*a, &*b, b"tus\r\nmode ", &*a, b"off\r\n"].concat();
        let lines = ["tick 1", "tick 2", "tick 1"].map(str::to_owned);
        assert_eq!(parted(&bytes), ("> status\r\nmode off\r\n".to_owned(), lines.to_vec(), 0));
    }

    #[test]
    fn half_a_frame_and_one_that_is_too_long_are_broken_and_the_next_is_read() {
        let (a, b) = (framed("tick 1"), framed("tick 2"));
        let half = [&a[..5], &*b].concat();
        assert_eq!(parted(&half), (String::new(), vec!["tick 2".to_owned()], 1));
        let long = [&*framed(&"x".repeat(40)), &*b].concat();
        assert_eq!(parted(&long), (String::new(), vec!["tick 2".to_owned()], 1));
    }

    #[test]
    fn a_stray_begin_costs_one_line() {
        assert_eq!(parted(b"\x02stop\rstatus\r\n"), ("status\r\n".to_owned(), vec![], 1));
        assert_eq!(parted(b"\x02\nstatus\n"), ("status\n".to_owned(), vec![], 1));
    }

    proptest! {
        #[test]
        fn comes_back(line in "[ -~]{0,300}") {
            let frame = framed(&line);
            let inside = &frame[1..frame.len() - 1];
            prop_assert_eq!(read(inside), Some(&*line));
        }

        #[test]
        fn any_changed_bit_is_noticed(line in "[ -~]{1,80}", at: prop::sample::Index, bit in 0..8u8) {
            let frame = framed(&line);
            let mut inside = frame[1..frame.len() - 2].to_vec();
            let at = at.index(inside.len());
            inside[at] ^= 1 << bit;
            let same_digit = inside.eq_ignore_ascii_case(&frame[1..frame.len() - 2]);
            prop_assert!(same_digit && at > line.len() || read(&inside).is_none());
        }

        #[test]
        fn no_bytes_panic(bytes: std::vec::Vec<u8>) {
            let _ = read(&bytes);
            parted(&bytes);
        }
    }
}
