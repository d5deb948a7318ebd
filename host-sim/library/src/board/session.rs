//! A conversation with a board: lines of its stream, text of its console, commands and their answers.

use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail, ensure};
use firmware_logic::console::ANSWER;
use firmware_logic::console::line::{LENGTH, is_stop_key};
use firmware_logic::console::request::Request;
use firmware_logic::stream::frame::{self, Reader, Step};
use pt326_lab::board::text::{PROMPT, between, refusal, without_prompts};
use pt326_lab::board::{ALONE, FORGET, FRAME, STOP, visible};
use serialport::SerialPort;

use super::gate::Gate;
use super::port::{self, Lost};
use super::simulate::SimulatedRig;

/// How long an answer may take: a save erases the flash, an order waits for a tick of up to 5 s.
const PATIENCE: Duration = Duration::from_secs(15);
/// How long it may take to say that it has stopped: what it was printing goes before.
const STOPPING: Duration = Duration::from_secs(3);
/// How often a board is asked whether it is there, and how long each time.
const GREETINGS: u32 = 8;
const GREETING: Duration = Duration::from_millis(400);
/// A board that has said nothing for so long is asked whether it is still there.
const QUIET: Duration = Duration::from_secs(5);
/// Most characters up to a prompt: an answer, its echo, and as much of what a check or an experiment tells meanwhile.
const MOST_TEXT: usize = 2 * ANSWER + LENGTH;
/// Most lines of the stream beside them: a port of 115200 Bd carries fewer within [`PATIENCE`].
const MOST_LINES: usize = 20_000;

/// Something that the board has said, in printable characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A line of its stream.
    Line(String),
    /// A piece of its console's text.
    Text(String),
    /// A line of its stream that did not come whole.
    Broken,
}

/// A board that is connected. Its port is one of this machine, or whatever else bytes go in and out of.
pub struct Session<P = Box<dyn SerialPort>> {
    port: P,
    reader: Reader<FRAME>,
    /// Lines of the stream that came while an answer was waited for.
    waiting: Vec<Heard>,
    rig: Option<SimulatedRig>,
    gate: Gate,
    /// When it was last heard.
    heard: Instant,
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
        let (reader, gate, heard) = (Reader::default(), Gate::default(), Instant::now());
        let mut session = Self { port, reader, waiting: Vec::new(), rig: None, gate, heard };
        session.meet()?;
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

    /// Waits for a prompt: a board that starts hears nothing at first.
    fn meet(&mut self) -> anyhow::Result<()> {
        let asked = (0..GREETINGS).find_map(|_| self.greet().transpose());
        asked.unwrap_or_else(|| bail!("no answer, expected a prompt: is this the board's port?"))
    }

    /// Asks who is there; `None` while nobody answers.
    fn greet(&mut self) -> anyhow::Result<Option<()>> {
        self.send(&[FORGET])?;
        Ok(self.hear_answer("", GREETING)?.map(drop))
    }

    /// Sends bytes.
    ///
    /// # Errors
    /// The port has gone.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), Lost> {
        self.port.write_all(bytes).map_err(Lost::Gone)
    }

    /// Heater off, at once.
    ///
    /// # Errors
    /// The port has gone.
    pub fn stop(&mut self) -> Result<(), Lost> {
        self.send(&[STOP])
    }

    /// Heater off, at once; whether the board says so.
    pub fn stops(&mut self) -> bool {
        let (begin, mut text) = (Instant::now(), String::new());
        let mut sent = self.stop().is_ok();
        while sent && begin.elapsed() < STOPPING {
            let Ok(heard) = self.listen() else { return false };
            text.extend(texts(&heard));
            if text.contains("stopped") {
                return true;
            }
            // An answer that was under way is no reason to give up; a stop twice is one stop.
            sent = !heard.is_empty() || self.stop().is_ok();
        }
        false
    }

    /// Stops the board because of an error, which then says whether the board has confirmed it.
    pub fn stopped_after(&mut self, error: &anyhow::Error) -> anyhow::Error {
        match self.stops() {
            true => anyhow!("{error:#}; the board says that its heater is off"),
            false => anyhow!("{error:#}; it does NOT say that its heater is off: {}", ALONE),
        }
    }

    /// What has come since the last call, and what comes while it waits a moment for something to come.
    ///
    /// # Errors
    /// The port has gone, or somebody has stopped the board.
    pub fn hear(&mut self) -> anyhow::Result<Vec<Heard>> {
        self.gate.check()?;
        Ok(self.listen()?)
    }

    /// The same where a board that falls silent is lost: it is asked something, whatever it is.
    ///
    /// # Errors
    /// Also where it does not answer.
    pub fn hear_alive(&mut self) -> anyhow::Result<Vec<Heard>> {
        if self.heard.elapsed() > QUIET {
            self.ask("get sample_time")?;
        }
        self.hear()
    }

    fn listen(&mut self) -> Result<Vec<Heard>, Lost> {
        let mut heard = std::mem::take(&mut self.waiting);
        let mut bytes = [0; 1024];
        let n = match self.port.read(&mut bytes) {
            Ok(0) => return Err(Lost::Gone(io::ErrorKind::UnexpectedEof.into())),
            Ok(n) => n,
            Err(error) if port::has_gone(&error) => return Err(Lost::Gone(error)),
            Err(_) => 0,
        };
        if n > 0 {
            self.heard = Instant::now();
        }
        for &byte in bytes.iter().take(n) {
            match self.reader.push(byte) {
                Step::Text(b'\r') | Step::Nothing => {}
                Step::Text(byte) => {
                    let shown = visible(char::from(byte).encode_utf8(&mut [0; 4]));
                    match heard.last_mut() {
                        Some(Heard::Text(text)) => *text += &shown,
                        _ => heard.push(Heard::Text(shown)),
                    }
                }
                Step::Line(line) => {
                    let codes = self.rig.as_ref().and_then(|rig| rig.answer(line));
                    heard.push(Heard::Line(visible(line)));
                    if let Some(codes) = codes {
                        let mut answer = String::new();
                        let _ = frame::write(&codes, &mut answer);
                        self.port.write_all(answer.as_bytes()).map_err(Lost::Gone)?;
                    }
                }
                Step::Broken => heard.push(Heard::Broken),
            }
        }
        Ok(heard)
    }

    /// Types a line, and waits for nothing. Of a line with a stop key in it only that is typed: the rest would be another line.
    ///
    /// # Errors
    /// The port has gone, somebody has stopped the board, or it is no line.
    pub fn begin(&mut self, line: &str) -> anyhow::Result<()> {
        let typed = match line.bytes().any(is_stop_key) {
            true => String::from(char::from(STOP)),
            false => format!("{line}\r"),
        };
        let fits = line.len() <= LENGTH && line.bytes().all(|byte| (b' '..=b'~').contains(&byte));
        ensure!(
            fits || typed.len() == 1,
            "\"{}\" is no line for a board, expected at most {LENGTH} plain characters",
            visible(line)
        );
        let gate = self.gate.clone();
        gate.pass(|| self.send(typed.as_bytes()).with_context(|| format!("before `{line}`")))
    }

    /// The answer to a line that was typed, without echo and prompt. What starts the board anew is answered by its start.
    ///
    /// # Errors
    /// The port has gone, no answer comes in time, or it does not end.
    pub fn answer(&mut self, line: &str, patience: Duration) -> anyhow::Result<String> {
        if let Ok(Request::Restart | Request::Simulate) = Request::parse(line) {
            return self.hear_start();
        }
        let echo = if line.bytes().any(is_stop_key) { "" } else { line };
        let answer = self.hear_answer(echo, patience).with_context(|| format!("after `{line}`"))?;
        Ok(answer.ok_or_else(|| Lost::silent(&format!("no answer to `{line}`"), patience))?)
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

    /// A board that starts anew, its stream on from the first tick; or why it does not.
    fn hear_start(&mut self) -> anyhow::Result<String> {
        let (begin, mut text) = (Instant::now(), String::new());
        while begin.elapsed() < PATIENCE {
            let mut heard = self.hear()?;
            let is_start =
                |heard: &Heard| matches!(heard, Heard::Line(line) if line.starts_with("log format "));
            if let Some(start) = heard.iter().position(is_start) {
                self.waiting = heard.split_off(start);
                self.meet()?;
                return Ok("the board has started anew\n".to_owned());
            }
            text.extend(texts(&heard));
            ensure!(text.len() <= MOST_TEXT, endless());
            if let Some((_, error)) = text.split_once("error: ").filter(|_| text.ends_with(PROMPT)) {
                return Ok(format!("error: {}\n", error.trim_end_matches(PROMPT).trim_end()));
            }
        }
        Err(Lost::silent("the board does not start anew", PATIENCE).into())
    }

    /// The text between an echo and the prompt behind it; `None` where no prompt comes. What the board tells by itself before and after
    /// that waits with the lines of its stream.
    fn hear_answer(&mut self, echo: &str, patience: Duration) -> anyhow::Result<Option<String>> {
        let (begin, mut text, mut lines) = (Instant::now(), String::new(), Vec::new());
        loop {
            for heard in self.hear()? {
                match heard {
                    Heard::Text(more) => text += &more,
                    line => lines.push(line),
                }
            }
            let late = begin.elapsed() > patience;
            // A byte that was lost on the wire makes another echo.
            let answer = between(&text, echo).or_else(|| between(&text, "").filter(|_| late));
            ensure!(text.len() <= MOST_TEXT && lines.len() <= MOST_LINES, endless());
            if late || answer.is_some() {
                self.waiting = lines;
                let told = answer.iter().flat_map(|(before, _, after)| [*before, *after]);
                let told = told.filter(|told| !told.is_empty()).map(|told| Heard::Text(told.to_owned()));
                self.waiting.extend(told);
                return Ok(answer.map(|(_, answer, _)| without_prompts(answer)));
            }
        }
    }
}

/// The pieces of its console's text.
fn texts(heard: &[Heard]) -> impl Iterator<Item = &str> {
    heard.iter().filter_map(|heard| match heard {
        Heard::Text(text) => Some(&**text),
        _ => None,
    })
}

fn endless() -> anyhow::Error {
    anyhow!(
        "its answer was cut after {MOST_TEXT} characters, which no board's is longer than: is this the board's port?"
    )
}
