//! What is kept in RAM over a reset: the crash record of a program that died, and what holds the heater off.
//!
//! RAM holds noise after power-up and perhaps half a write after a reset, so a magic number, a length and a CRC decide
//! whether it is believed.
//!
//! ```text
//! word 0 magic and version   word 1 death | restart << 4 | lockout << 8 | length << 16   words 2.. text   last word CRC-32 of the rest
//! ```

use core::fmt;

use crate::crc::CRC32;
use crate::interlock::Lockout;
use crate::reset_cause::{Death, Restart};

/// Size in words.
pub const WORDS: usize = 64;
/// Longest message in bytes; what is longer is cut.
pub const TEXT: usize = 4 * (WORDS - 3);
/// "PT32" and the version of this layout.
const MAGIC: u32 = 0x5054_3201;

/// The memory as it lies in RAM.
pub type Words = [u32; WORDS];

/// A message of bounded length that can be written to with `write!`; what does not fit is cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CrashMessage {
    text: [u8; TEXT],
    length: usize,
}

impl CrashMessage {
    /// No words.
    pub const EMPTY: Self = Self { text: [0; TEXT], length: 0 };

    /// The message, up to the first byte that is no UTF-8.
    pub fn as_str(&self) -> &str {
        let text = self.text.get(..self.length).unwrap_or_default();
        match core::str::from_utf8(text) {
            Ok(text) => text,
            Err(e) => {
                core::str::from_utf8(text.get(..e.valid_up_to()).unwrap_or_default()).unwrap_or_default()
            }
        }
    }
}

impl fmt::Write for CrashMessage {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        let free = self.text.get_mut(self.length..).unwrap_or_default();
        let n = s.len().min(free.len());
        for (to, from) in free.iter_mut().zip(s.bytes()) {
            *to = from;
        }
        self.length += n;
        Ok(())
    }
}

/// The content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Retained {
    /// How the program died, if it did.
    pub death: Option<Death>,
    /// How it was told to start anew, if it was.
    pub restart: Option<Restart>,
    /// What holds the heater off.
    pub lockout: Option<Lockout>,
    /// Its message.
    pub words: CrashMessage,
}

impl Retained {
    /// Nothing to tell.
    pub const EMPTY: Self = Self { death: None, restart: None, lockout: None, words: CrashMessage::EMPTY };

    /// As it lies in RAM.
    pub fn pack(&self) -> Words {
        let mut words = [0; WORDS];
        let death = self.death.map_or(0, death_number);
        let restart = self.restart.map_or(0, restart_number);
        let lockout = self.lockout.map_or(0, Lockout::number);
        words[0] = MAGIC;
        words[1] = u32::from(death)
            | u32::from(restart) << 4
            | u32::from(lockout) << 8
            | (self.words.length as u32) << 16;
        for (word, bytes) in words[2..WORDS - 1].iter_mut().zip(self.words.text.chunks_exact(4)) {
            *word = bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
        }
        words[WORDS - 1] = checksum(&words);
        words
    }

    /// What lies in RAM; `None` if it is not to be believed.
    pub fn unpack(words: &Words) -> Option<Self> {
        let length = (words[1] >> 16) as usize;
        if words[0] != MAGIC || length > TEXT || words[WORDS - 1] != checksum(words) {
            return None;
        }
        let mut text = [0; TEXT];
        for (bytes, word) in text.chunks_exact_mut(4).zip(&words[2..]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        Some(Self {
            death: death_from(words[1] as u8 & 0xF),
            restart: restart_from(words[1] as u8 >> 4),
            lockout: Lockout::from_number(words[1] >> 8 & 0xFF),
            words: CrashMessage { text, length },
        })
    }
}

fn death_number(death: Death) -> u8 {
    match death {
        Death::Panic => 1,
        Death::HardFault => 2,
        Death::ClockFailure => 3,
        Death::StrayInterrupt => 4,
    }
}

fn death_from(number: u8) -> Option<Death> {
    [Death::Panic, Death::HardFault, Death::ClockFailure, Death::StrayInterrupt]
        .into_iter()
        .find(|death| death_number(*death) == number)
}

fn restart_number(restart: Restart) -> u8 {
    match restart {
        Restart::Streaming => 1,
        Restart::Simulating => 2,
    }
}

fn restart_from(number: u8) -> Option<Restart> {
    [Restart::Streaming, Restart::Simulating].into_iter().find(|restart| restart_number(*restart) == number)
}

/// CRC of all words but the last.
fn checksum(words: &Words) -> u32 {
    let mut bytes = [0; 4 * (WORDS - 1)];
    for (four, word) in bytes.chunks_exact_mut(4).zip(words) {
        four.copy_from_slice(&word.to_le_bytes());
    }
    CRC32.checksum(&bytes)
}

#[cfg(test)]
mod tests {
    use core::fmt::Write;

    use super::*;
    use crate::reset_cause::ResetCause;

    fn example() -> Retained {
        let mut words = CrashMessage::EMPTY;
        write!(words, "src/main.rs:42: index 7, length 5 (T1 \u{b0}C)").expect("never fails");
        Retained {
            death: Some(Death::Panic),
            restart: None,
            lockout: Some(Lockout::Reset(ResetCause::Watchdog)),
            words,
        }
    }

    #[test]
    fn comes_back_as_it_was() {
        for death in [Death::Panic, Death::HardFault, Death::ClockFailure, Death::StrayInterrupt] {
            let retained = Retained { death: Some(death), ..example() };
            assert_eq!(Retained::unpack(&retained.pack()), Some(retained));
        }
        assert_eq!(Retained::unpack(&Retained::EMPTY.pack()), Some(Retained::EMPTY));
        for restart in [Restart::Streaming, Restart::Simulating] {
            let restarted = Retained { restart: Some(restart), ..Retained::EMPTY };
            assert_eq!(Retained::unpack(&restarted.pack()), Some(restarted));
        }
    }

    /// A program reads what the one before it left, which may be an older one. The checksum was computed elsewhere.
    #[test]
    fn the_layout_is_the_one_that_boards_have() {
        let words = Retained::EMPTY.pack();
        assert_eq!((words[0], words[1], words[WORDS - 1]), (0x5054_3201, 0, 0x5D2F_67A8));
    }

    #[test]
    fn any_flipped_bit_is_noticed() {
        let words = example().pack();
        for bit in 0..32 * WORDS {
            let mut damaged = words;
            damaged[bit / 32] ^= 1 << (bit % 32);
            assert_eq!(Retained::unpack(&damaged), None, "bit {bit}");
        }
    }

    #[test]
    fn noise_after_power_up_is_not_believed() {
        for noise in [0, u32::MAX, 0xCCCC_CCCC] {
            assert_eq!(Retained::unpack(&[noise; WORDS]), None);
        }
        let mut state = 1u32;
        let mut xorshift = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state
        };
        for _ in 0..1000 {
            let mut words: Words = core::array::from_fn(|_| xorshift());
            words[0] = MAGIC;
            assert_eq!(Retained::unpack(&words), None);
        }
    }

    #[test]
    fn too_long_a_message_is_cut_also_within_a_character() {
        let mut words = CrashMessage::EMPTY;
        for _ in 0..TEXT {
            words.write_str("\u{b0}C").expect("never fails");
        }
        assert_eq!(words.length, TEXT);
        assert!(words.as_str().len() >= TEXT - 1 && words.as_str().starts_with("\u{b0}C"));
    }
}
