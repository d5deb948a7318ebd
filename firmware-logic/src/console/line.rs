//! From bytes to lines. A line is taken whole or rejected whole: nothing is ever carried out that was not typed as such.

use core::fmt;

/// Longest line in characters.
pub const LENGTH: usize = 120;

/// Ctrl-C, ESC, `!`: heater off, at once, in the middle of a line, too. No command and no setting needs any of them.
pub const fn is_stop_key(byte: u8) -> bool {
    matches!(byte, 0x03 | 0x1B | b'!')
}

/// Why a line was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// It was longer than [`LENGTH`].
    TooLong,
    /// It contained a byte that is no printable ASCII.
    Byte {
        /// The first such byte.
        byte: u8,
        /// Where, from 1.
        column: usize,
    },
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "line too long, expected at most {LENGTH} characters"),
            Self::Byte { byte, column } => {
                write!(f, "byte {byte:#04x} at column {column}, expected printable ASCII")
            }
        }
    }
}

/// What a byte did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// It was added to the line; a terminal should show it.
    Typed(u8),
    /// It removed the character before.
    Erased,
    /// It ended a line that is now in [`LineReader::line`].
    Line,
    /// It ended a line that is to be ignored.
    Rejected(LineError),
    /// A stop key, see [`is_stop_key`]: what was typed of the line is forgotten.
    Stop,
    /// Nothing to do or to show.
    Nothing,
}

/// Collects a line.
#[derive(Clone, Debug)]
pub struct LineReader {
    buffer: [u8; LENGTH],
    length: usize,
    error: Option<LineError>,
    /// The byte before was a carriage return: a line feed now ends no second line.
    returned: bool,
    /// The line is complete: the next byte begins another.
    done: bool,
}

impl Default for LineReader {
    fn default() -> Self {
        Self { buffer: [0; LENGTH], length: 0, error: None, returned: false, done: false }
    }
}

impl LineReader {
    /// What a byte does to the line.
    pub fn push(&mut self, byte: u8) -> Step {
        if core::mem::take(&mut self.done) {
            self.length = 0;
        }
        let after_return = core::mem::replace(&mut self.returned, byte == b'\r');
        match byte {
            b'\n' if after_return => Step::Nothing,
            b'\r' | b'\n' => self.end(),
            0x08 | 0x7F if self.error.is_none() && self.length > 0 => {
                self.length -= 1;
                Step::Erased
            }
            0x08 | 0x7F => Step::Nothing,
            key if is_stop_key(key) => {
                self.error = None;
                self.length = 0;
                Step::Stop
            }
            0x15 => {
                // Ctrl-U: forget what was typed
                self.error = None;
                self.length = 0;
                Step::Rejected(LineError::Byte { byte, column: 1 })
            }
            b'\t' => self.add(b' '),
            b' '..=b'~' => self.add(byte),
            _ => {
                let column = self.length + 1;
                self.error.get_or_insert(LineError::Byte { byte, column });
                Step::Nothing
            }
        }
    }

    fn add(&mut self, byte: u8) -> Step {
        if self.error.is_some() {
            return Step::Nothing;
        }
        match self.buffer.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                Step::Typed(byte)
            }
            None => {
                self.error = Some(LineError::TooLong);
                Step::Nothing
            }
        }
    }

    fn end(&mut self) -> Step {
        self.done = true;
        match self.error.take() {
            Some(error) => {
                self.length = 0;
                Step::Rejected(error)
            }
            None => Step::Line,
        }
    }

    /// What has been typed of a line that has not ended.
    pub fn typed(&self) -> &str {
        if self.done { "" } else { self.line() }
    }

    /// The line that [`Step::Line`] ended.
    pub fn line(&self) -> &str {
        // Only ASCII is ever added.
        self.buffer.get(..self.length).and_then(|line| core::str::from_utf8(line).ok()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn feed(reader: &mut LineReader, bytes: &[u8]) -> Vec<Result<String, LineError>> {
        let mut lines = vec![];
        for &byte in bytes {
            match reader.push(byte) {
                Step::Line => lines.push(Ok(reader.line().to_owned())),
                Step::Rejected(error) => lines.push(Err(error)),
                _ => {}
            }
        }
        lines
    }

    #[test]
    fn all_three_line_ends_and_editing() {
        let mut reader = LineReader::default();
        let typed = b"stop\rarm\r\nack\nstatis\x7fus\x08\x08\x08\x08\x08\x08\x08\x08\x08help\n";
        let lines = feed(&mut reader, typed);
        let wanted = ["stop", "arm", "ack", "help"].map(|line| Ok(line.to_owned()));
        assert_eq!(lines, wanted);
    }

    #[test]
    fn too_long_is_rejected_whole_and_the_next_line_is_fine() {
        let mut reader = LineReader::default();
        let mut bytes = vec![b'a'; LENGTH];
        bytes.push(b'\n');
        bytes.extend(vec![b'b'; LENGTH + 1]);
        bytes.extend(b"\nstop\n");
        let lines = feed(&mut reader, &bytes);
        assert_eq!(lines, [Ok("a".repeat(LENGTH)), Err(LineError::TooLong), Ok("stop".to_owned())]);
    }

    #[test]
    fn stop_keys_are_seen_anywhere_and_forget_the_line() {
        for key in [0x03, 0x1B, b'!'] {
            let mut reader = LineReader::default();
            let long = [b'a'; 2 * LENGTH];
            for before in [&b""[..], b"arm", b"set \xff", &long] {
                before.iter().for_each(|&byte| {
                    reader.push(byte);
                });
                assert_eq!(reader.push(key), Step::Stop, "{key:#x} after {before:?}");
                assert_eq!(feed(&mut reader, b"\n"), [Ok(String::new())], "nothing is left of {before:?}");
            }
        }
    }

    #[test]
    fn a_foreign_byte_is_named_with_its_place() {
        let lines = feed(&mut LineReader::default(), b"st\xffop\n");
        assert_eq!(lines, [Err(LineError::Byte { byte: 0xFF, column: 3 })]);
    }

    #[test]
    fn erasing_cannot_turn_a_rejected_line_into_another() {
        let mut bytes = vec![b'a'; LENGTH + 4];
        bytes.extend([0x08; LENGTH]);
        bytes.extend(b"arm\n");
        assert_eq!(feed(&mut LineReader::default(), &bytes), [Err(LineError::TooLong)]);
    }

    proptest! {
        /// Whatever came before, a line end resynchronises, and only printable ASCII comes out.
        #[test]
        fn garbage_never_poisons_the_next_line(garbage in proptest::collection::vec(any::<u8>(), 0..400)) {
            let mut reader = LineReader::default();
            for line in feed(&mut reader, &garbage).into_iter().flatten() {
                prop_assert!(line.len() <= LENGTH && line.bytes().all(|b| (b' '..=b'~').contains(&b)));
            }
            feed(&mut reader, b"\n");
            prop_assert_eq!(feed(&mut reader, b"stop\n"), vec![Ok("stop".to_owned())]);
        }
    }
}
