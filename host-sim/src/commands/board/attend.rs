//! Whoever is beside a board that heats: what he presses stops it at once, by a handle of its own; what he answers is a line.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serialport::SerialPort;

use super::Person;
use super::keys::{self, Single};
use super::signals::Heed;
use crate::commands::terminal::print;
use pt326_host::board::{ALONE, Gate, STOP, Session};

/// How often a question looks whether it has been stopped.
const LOOK: Duration = Duration::from_millis(50);

/// Stops a board by another hand than the one that talks with it.
#[derive(Clone)]
struct Stopper {
    gate: Gate,
    hand: Arc<Mutex<Box<dyn SerialPort>>>,
}

impl Stopper {
    /// Heater off, at once, and nothing typed behind it. Whether the board confirms it is asked for by whoever talks with it.
    fn stop(&self) {
        let first = !self.gate.is_closed();
        let mut hand = self.hand.lock().unwrap_or_else(PoisonError::into_inner);
        let sent = self.gate.close(|| hand.write_all(&[STOP]));
        let told = match sent {
            Ok(()) => "stop sent".to_owned(),
            Err(error) => format!("the stop could NOT be sent ({error}): {ALONE}"),
        };
        if first {
            let _ = writeln!(std::io::stderr(), "\n{told}"); // a terminal that was closed shows nothing
        }
    }
}

/// Somebody at a terminal, or a pipe that answers for him. The terminal has its mode back when this is dropped.
pub(super) struct Attendant {
    stopper: Stopper,
    keys: Option<Single>,
    typed: Option<Receiver<Option<u8>>>,
    _heed: Heed,
}

impl Attendant {
    /// From now on Ctrl-C, SIGTERM and SIGHUP stop the board, and where standard input is a terminal its stop keys do.
    ///
    /// # Errors
    /// The port has gone, or the system gives no signals.
    pub(super) fn new(session: &Session) -> anyhow::Result<Self> {
        let hand = Arc::new(Mutex::new(session.other_hand()?));
        let stopper = Stopper { gate: session.gate(), hand };
        let by_signal = stopper.clone();
        let heed = Heed::new(move || by_signal.stop())?;
        let keys = keys::are_ours().then(Single::keys).flatten();
        let mut attendant = Self { stopper, keys, typed: None, _heed: heed };
        if attendant.keys.is_some() {
            attendant.typed();
        }
        Ok(attendant)
    }

    /// Says what stops the board.
    ///
    /// # Errors
    /// Nobody can see it.
    pub(super) fn greet(&self) -> anyhow::Result<()> {
        print(match self.keys {
            Some(_) => "Ctrl-C, ESC and ! stop the heater at once, at any time.\n",
            None => "Ctrl-C stops the heater at once, at any time.\n",
        })
    }

    /// What is typed. A pipe is not read before anything is asked: it may be meant for another program.
    fn typed(&mut self) -> &Receiver<Option<u8>> {
        let Self { stopper, keys, typed, .. } = self;
        typed.get_or_insert_with(|| {
            let by_key = stopper.clone();
            keys::listen(keys.is_some(), move || by_key.stop())
        })
    }

    /// The next line of standard input; `None` at its end.
    ///
    /// # Errors
    /// The board was stopped meanwhile, or nobody can see what is typed.
    pub(super) fn line(&mut self) -> anyhow::Result<Option<String>> {
        let gate = self.stopper.gate.clone();
        let shown = self.keys.is_some();
        let mut line = Line { bytes: Vec::new(), shown };
        loop {
            gate.check()?;
            let byte = match self.typed().recv_timeout(LOOK) {
                Ok(Some(0x04)) if shown && line.bytes.is_empty() => return Ok(None),
                Ok(Some(byte)) => byte,
                Ok(None) | Err(RecvTimeoutError::Disconnected) => {
                    return Ok((!line.bytes.is_empty()).then(|| line.text()));
                }
                Err(RecvTimeoutError::Timeout) => continue,
            };
            if matches!(byte, b'\n' | b'\r') {
                line.show("\n")?;
                return Ok(Some(line.text()));
            }
            line.push(byte)?;
        }
    }
}

impl Person for Attendant {
    fn tell(&mut self, line: &str) -> anyhow::Result<()> {
        print(&format!("{line}\n"))
    }

    fn ask(&mut self, question: &str) -> anyhow::Result<Option<String>> {
        // A key that was pressed before anybody asked is no answer.
        if self.keys.is_some() {
            while let Ok(Some(_)) = self.typed().try_recv() {}
        }
        print(question)?;
        let line = self.line()?;
        if !std::io::stdin().is_terminal() {
            print(&format!("{}\n", line.as_deref().unwrap_or_default().trim()))?; // nobody has typed it here
        }
        Ok(line)
    }
}

/// A line that is being typed; on a terminal whose keys come singly it is shown and can be mended here.
struct Line {
    bytes: Vec<u8>,
    shown: bool,
}

impl Line {
    fn text(&self) -> String {
        String::from_utf8_lossy(&self.bytes).into_owned()
    }

    fn show(&self, text: &str) -> anyhow::Result<()> {
        if self.shown { print(text) } else { Ok(()) }
    }

    fn push(&mut self, byte: u8) -> anyhow::Result<()> {
        match byte {
            0x08 | 0x7F if self.shown => self.erase(),
            0x15 if self.shown => (0..self.text().chars().count()).try_for_each(|_| self.erase()),
            0..0x20 if self.shown => Ok(()),
            byte => {
                self.bytes.push(byte);
                // A letter of several bytes is shown with its last.
                let begin = self.bytes.iter().rposition(|byte| byte & 0xC0 != 0x80).unwrap_or(0);
                let letter = self.bytes.get(begin..).unwrap_or_default();
                std::str::from_utf8(letter).map_or(Ok(()), |letter| self.show(letter))
            }
        }
    }

    fn erase(&mut self) -> anyhow::Result<()> {
        let Some(begin) = self.bytes.iter().rposition(|byte| byte & 0xC0 != 0x80) else { return Ok(()) };
        self.bytes.truncate(begin);
        self.show("\x08 \x08")
    }
}
