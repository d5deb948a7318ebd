//! A conversation with a board: lines of its stream, text of its console, commands and their answers.

use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use firmware_logic::console::line::LENGTH;
use firmware_logic::stream::frame::{self, Reader, Step};
use serialport::SerialPort;

use super::port;
use super::simulate::SimulatedRig;

/// Forgets what was typed of a line: whoever was here before may have left half of `arm`, which must not be ended now.
const FORGET: u8 = 0x15;
/// Ctrl-C: heater off, at once.
pub const STOP: u8 = 0x03;
/// What ends an answer.
const PROMPT: &str = "> ";
/// How long an answer may take: a save erases the flash, an order waits for a tick of up to 5 s.
pub(super) const PATIENCE: Duration = Duration::from_secs(15);
/// How long it may take to say that it has stopped: what it was printing goes before.
const STOPPING: Duration = Duration::from_secs(3);
/// How often a board is asked whether it is there, and how long each time.
const GREETINGS: u32 = 8;
const GREETING: Duration = Duration::from_millis(400);
/// Longest frame.
const FRAME: usize = 1024;

/// Something that the board has said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A line of its stream.
    Line(String),
    /// A piece of its console's text.
    Text(String),
    /// A line of its stream that did not come whole.
    Broken,
}

/// What stops a board by another hand closes it, so that nothing is typed behind that stop.
#[derive(Clone, Debug, Default)]
pub struct Gate(Arc<Mutex<bool>>);

impl Gate {
    /// Closes it for good, then stops; a line that is just being sent goes before.
    pub fn close<R>(&self, stop: impl FnOnce() -> R) -> R {
        let mut closed = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *closed = true;
        stop()
    }

    /// Whether it is open.
    ///
    /// # Errors
    /// Somebody has stopped the board.
    pub fn check(&self) -> anyhow::Result<()> {
        self.pass(|| Ok(()))
    }

    fn pass<R>(&self, send: impl FnOnce() -> anyhow::Result<R>) -> anyhow::Result<R> {
        let closed = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        ensure!(!*closed, "it was stopped by hand");
        send()
    }
}

/// A board that is connected. Its port is one of this machine, or whatever else bytes go in and out of.
pub struct Session<P = Box<dyn SerialPort>> {
    port: P,
    reader: Reader<FRAME>,
    /// Lines of the stream that came while an answer was waited for.
    waiting: Vec<Heard>,
    rig: Option<SimulatedRig>,
    gate: Gate,
}

impl Session {
    /// Opens a port, and asks who is there.
    ///
    /// # Errors
    /// The port cannot be opened, or nobody answers as a board does.
    pub fn open(name: &str) -> anyhow::Result<Self> {
        let port = port::open(name)?;
        port.clear(serialport::ClearBuffer::All)?;
        Self::over(port).with_context(|| format!("on {name}"))
    }

    /// The same port for another hand: that of whoever stops the board while an answer is waited for.
    ///
    /// # Errors
    /// The port has gone.
    pub fn other_hand(&self) -> anyhow::Result<Box<dyn SerialPort>> {
        Ok(self.port.try_clone()?)
    }
}

impl<P: Read + Write> Session<P> {
    /// Asks who is at the other end of a port that is open.
    ///
    /// # Errors
    /// Nobody answers as a board does.
    pub fn over(port: P) -> anyhow::Result<Self> {
        let mut session =
            Self { port, reader: Reader::default(), waiting: Vec::new(), rig: None, gate: Gate::default() };
        // A board that has just got its power hears nothing at first.
        let asked = (0..GREETINGS).find_map(|_| session.greet().transpose());
        asked.unwrap_or_else(|| bail!("no answer, expected a prompt: is this the board's port?"))?;
        Ok(session)
    }

    /// What another hand closes when it stops the board.
    pub fn gate(&self) -> Gate {
        self.gate.clone()
    }

    /// From now on, what the board streams is answered by a rig.
    pub fn simulate(&mut self, rig: SimulatedRig) {
        self.rig = Some(rig);
    }

    /// Asks who is there; `None` while nobody answers.
    fn greet(&mut self) -> anyhow::Result<Option<()>> {
        self.send(&[FORGET])?;
        Ok(self.hear_prompt(GREETING)?.map(drop))
    }

    /// Sends bytes.
    ///
    /// # Errors
    /// The port has gone.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write_all(bytes)
    }

    /// Heater off, at once.
    ///
    /// # Errors
    /// The port has gone.
    pub fn stop(&mut self) -> io::Result<()> {
        self.send(&[STOP])
    }

    /// Heater off, at once; whether the board says so.
    pub fn stops(&mut self) -> bool {
        let (begin, mut text) = (Instant::now(), String::new());
        let mut sent = self.stop().is_ok();
        while sent && begin.elapsed() < STOPPING {
            let Ok(heard) = self.hear() else { return false };
            text.extend(heard.iter().filter_map(|heard| match heard {
                Heard::Text(text) => Some(&**text),
                _ => None,
            }));
            if text.contains("stopped") {
                return true;
            }
            // An answer that was under way is no reason to give up; a stop twice is one stop.
            sent = !heard.is_empty() || self.stop().is_ok();
        }
        false
    }

    /// What has come since the last call, and what comes while it waits a moment for something to come.
    ///
    /// # Errors
    /// The port has gone.
    pub fn hear(&mut self) -> io::Result<Vec<Heard>> {
        let mut heard = std::mem::take(&mut self.waiting);
        let mut bytes = [0; 1024];
        let n = match self.port.read(&mut bytes) {
            Ok(0) => return Err(io::ErrorKind::BrokenPipe.into()),
            Ok(n) => n,
            Err(error) if port::has_gone(&error) => return Err(error),
            Err(_) => 0,
        };
        for &byte in bytes.iter().take(n) {
            match self.reader.push(byte) {
                Step::Text(byte) => match heard.last_mut() {
                    Some(Heard::Text(text)) => text.push(byte.into()),
                    _ => heard.push(Heard::Text(char::from(byte).into())),
                },
                Step::Line(line) => {
                    let codes = self.rig.as_ref().and_then(|rig| rig.answer(line));
                    heard.push(Heard::Line(line.to_owned()));
                    if let Some(codes) = codes {
                        let mut answer = String::new();
                        let _ = frame::write(&codes, &mut answer);
                        self.port.write_all(answer.as_bytes())?;
                    }
                }
                Step::Broken => heard.push(Heard::Broken),
                Step::Nothing => {}
            }
        }
        Ok(heard)
    }

    /// Types a line, and waits for nothing.
    ///
    /// # Errors
    /// The port has gone.
    pub fn begin(&mut self, line: &str) -> anyhow::Result<()> {
        let fits = line.len() <= LENGTH && line.bytes().all(|byte| (b' '..=b'~').contains(&byte));
        ensure!(fits, "\"{line}\" is no line for a board, expected at most {LENGTH} plain characters");
        let gate = self.gate.clone();
        gate.pass(|| self.send(format!("{line}\r").as_bytes()).with_context(|| format!("before `{line}`")))
    }

    /// The answer to a line that was typed, without echo and prompt.
    ///
    /// # Errors
    /// The port has gone, or no answer comes in time.
    pub fn answer(&mut self, line: &str, patience: Duration) -> anyhow::Result<String> {
        let heard = self.hear_prompt(patience).with_context(|| format!("after `{line}`"))?;
        let text = heard.with_context(|| format!("no answer to `{line}` within {} s", patience.as_secs()))?;
        // What a check told meanwhile may stand before the echo.
        let answer = text.split_once(&format!("{line}\n")).map_or(&*text, |(_, answer)| answer);
        Ok(answer.to_owned())
    }

    /// Types a line; its answer.
    ///
    /// # Errors
    /// The port has gone, or no answer comes.
    pub fn ask(&mut self, line: &str) -> anyhow::Result<String> {
        self.begin(line)?;
        self.answer(line, PATIENCE)
    }

    /// The same where the answer must not be an error.
    ///
    /// # Errors
    /// Also what the board says.
    pub fn order(&mut self, line: &str) -> anyhow::Result<String> {
        let answer = self.ask(line)?;
        match refusal(&answer) {
            Some(error) => bail!("the board says to `{line}`: {error}"),
            None => Ok(answer),
        }
    }

    /// Has the board start anew, its stream on from the first tick: by `restart`, or `simulate on`.
    ///
    /// # Errors
    /// It refuses, or does not come back.
    pub fn restart(&mut self, command: &str) -> anyhow::Result<()> {
        self.send(format!("{command}\r").as_bytes())?;
        let (begin, mut text) = (Instant::now(), String::new());
        while begin.elapsed() < PATIENCE {
            let mut heard = self.hear()?;
            let is_start =
                |heard: &Heard| matches!(heard, Heard::Line(line) if line.starts_with("log format "));
            if let Some(start) = heard.iter().position(is_start) {
                self.waiting = heard.split_off(start);
                return Ok(());
            }
            text.extend(heard.iter().filter_map(|heard| match heard {
                Heard::Text(text) => Some(&**text),
                _ => None,
            }));
            if let Some((_, error)) = text.split_once("error: ").filter(|_| text.ends_with(PROMPT)) {
                bail!("the board does not start anew: {}", error.trim_end_matches(PROMPT).trim_end());
            }
        }
        bail!("the board does not start anew within {} s", PATIENCE.as_secs())
    }

    /// All text up to the next prompt; `None` where none comes.
    fn hear_prompt(&mut self, patience: Duration) -> io::Result<Option<String>> {
        let (begin, mut text, mut lines) = (Instant::now(), String::new(), Vec::new());
        loop {
            for heard in self.hear()? {
                match heard {
                    Heard::Text(more) => text += &more.replace('\r', ""),
                    line => lines.push(line),
                }
            }
            let ended = text.strip_suffix(PROMPT).filter(|text| text.is_empty() || text.ends_with('\n'));
            if let Some(text) = ended {
                self.waiting = lines;
                return Ok(Some(text.to_owned()));
            }
            if begin.elapsed() > patience {
                self.waiting = lines;
                return Ok(None);
            }
        }
    }
}

/// Takes the whole lines of a console's text, without its prompts and what is empty; the rest stays.
pub fn take_lines(text: &mut String) -> Vec<String> {
    let end = text.rfind('\n').map_or(0, |at| at + 1);
    let whole: String = text.drain(..end).collect();
    let lines = whole.lines().map(|line| line.trim_end().trim_start_matches(PROMPT).to_owned());
    lines.filter(|line| !matches!(line.as_str(), "" | ">")).collect()
}

/// Whether a line tells the end of a self-test, and then whether it has passed.
pub fn check_ended(line: &str) -> Option<bool> {
    let has = |words| line.starts_with(words);
    has("check passed").then_some(true).or((has("check failed") || has("check ended")).then_some(false))
}

/// Why a board has refused something, if its answer says so.
pub fn refusal(answer: &str) -> Option<&str> {
    answer.lines().find_map(|line| line.strip_prefix("error: "))
}
