//! Lines of standard input, and how long none has come.

use std::io::{BufRead, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use anyhow::bail;

/// What is heard of a source.
pub(super) enum Heard {
    /// A line, without its end; or why it cannot be one.
    Line(anyhow::Result<String>),
    /// Nothing has come for as long as was asked.
    Silence,
    /// It has ended.
    End,
}

/// A row of a recording is no longer than this, bytes.
const LONGEST: u64 = 1 << 16;
/// Lines that may wait: whoever sends them waits then.
const WAITING: usize = 64;

/// Lines that a thread reads, so that somebody else may ask for how long none has come.
pub(super) struct Lines(Receiver<anyhow::Result<String>>);

impl Lines {
    pub(super) fn of_standard_input() -> Self {
        let (sender, receiver) = sync_channel(WAITING);
        std::thread::spawn(move || {
            let mut input = std::io::stdin().lock();
            // A read that fails is the end, once it is told.
            while let Some(line) = read(&mut input).transpose() {
                let failed = line.as_ref().is_err_and(|error| error.is::<std::io::Error>());
                if sender.send(line).is_err() || failed {
                    break;
                }
            }
        });
        Self(receiver)
    }

    /// The next line, waited for no longer than this.
    pub(super) fn next(&mut self, within: Option<Duration>) -> Heard {
        let received = match within {
            Some(within) => self.0.recv_timeout(within),
            None => self.0.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        match received {
            Ok(line) => Heard::Line(line),
            Err(RecvTimeoutError::Timeout) => Heard::Silence,
            Err(RecvTimeoutError::Disconnected) => Heard::End,
        }
    }
}

/// A line without its end; none after the last. Of one that is too long the rest is passed over.
fn read(input: &mut impl BufRead) -> anyhow::Result<Option<String>> {
    let mut bytes = Vec::new();
    if input.by_ref().take(LONGEST).read_until(b'\n', &mut bytes)? == 0 {
        return Ok(None);
    }
    if bytes.len() as u64 == LONGEST && bytes.last() != Some(&b'\n') {
        while input.by_ref().take(LONGEST).read_until(b'\n', &mut bytes)? > 0 && bytes.last() != Some(&b'\n')
        {
            bytes.clear();
        }
        bail!("a line of more than {LONGEST} bytes");
    }
    // Lossy: a degree sign in an old encoding must not keep anyone from the numbers.
    Ok(Some(String::from_utf8_lossy(&bytes).trim_end_matches(['\r', '\n']).to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_comes_is_cut_into_lines() {
        let long = "x".repeat(3 * LONGEST as usize);
        let text = [b"t,u\r\n".as_slice(), b"\xb0\xff\n", long.as_bytes(), b"\n\n1,2"].concat();
        let mut input = text.as_slice();
        let mut next = || read(&mut input).map_err(|error| error.to_string());
        assert_eq!(next(), Ok(Some("t,u".into())));
        assert_eq!(next(), Ok(Some("\u{fffd}\u{fffd}".into())));
        assert!(next().is_err_and(|why| why.contains("65536 bytes")));
        assert_eq!(next(), Ok(Some(String::new())));
        assert_eq!(next(), Ok(Some("1,2".into())));
        assert_eq!(next(), Ok(None));
    }
}
