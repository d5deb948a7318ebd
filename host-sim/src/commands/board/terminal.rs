//! The board's console on a terminal, with history and completion; from a pipe, line by line.

use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context as _, anyhow, bail};
use fdi_core::Config;
use firmware_logic::console::request::COMMANDS;
use firmware_logic::log_line::LogLine;
use firmware_logic::settings::schema::Name;
use rustyline::completion::Completer;
use rustyline::error::ReadlineError;
use rustyline::highlight::Highlighter;
use rustyline::hint::Hinter;
use rustyline::history::DefaultHistory;
use rustyline::validate::Validator;
use rustyline::{Cmd, Context, Editor, ExternalPrinter, Helper, KeyCode, KeyEvent, Modifiers};

use serialport::SerialPort;

use super::attend::Attendant;
use super::keys;
use super::signals::Heed;
use crate::commands::console::play::Play;
use crate::commands::terminal::{in_words, is_unread, print};
use pt326_host::board::simulate::SimulatedRig;
use pt326_host::board::{Heard, Lost, STOP, Session, refusal, take_lines};

/// Lets another thread have the port.
const LET: Duration = Duration::from_millis(2);

/// Talks until the person leaves, or the input ends.
pub(super) fn run(session: Session, name: &str, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    if !std::io::stdin().is_terminal() {
        return scripted(session, rig);
    }
    print(&format!(
        "Board on {name}. Ctrl-C, ESC and ! stop the heater; help lists commands; Ctrl-D leaves.\n"
    ))?;
    interactive(session, rig)
}

/// Each line is a command; `wait SECONDS` shows what the board tells meanwhile. What is refused does not keep the lines behind it from the
/// board, one of which may be `stop`.
fn scripted(mut session: Session, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    let mut script = Script { attendant: Attendant::new(&session)?, news: String::new(), refused: None };
    match script.run(&mut session, rig) {
        Err(error) if session.gate().is_closed() => Err(session.stopped_after(&error)),
        done => done,
    }
}

/// Lines from a pipe, and the first of them that was refused.
struct Script {
    attendant: Attendant,
    news: String,
    refused: Option<String>,
}

impl Script {
    fn run(&mut self, session: &mut Session, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
        while let Some(line) = self.attendant.line().context("the input can't be read")? {
            let line = line.trim();
            print(&format!("> {line}\n"))?;
            let done = match line.strip_prefix("wait ") {
                Some(seconds) => self.wait(session, seconds).map(|()| String::new()),
                None => answer(session, line, rig),
            };
            let error = match done {
                Ok(answer) => {
                    print(&answer)?;
                    refusal(&answer).map(str::to_owned)
                }
                Err(error) if session.gate().is_closed() || error.is::<Lost>() || is_unread(&error) => {
                    return Err(error);
                }
                Err(error) => {
                    print(&format!("error: {error:#}\n"))?;
                    Some(format!("{error:#}"))
                }
            };
            if let Some(error) = error {
                self.refused.get_or_insert(format!("`{line}` was refused: {error}"));
            }
        }
        self.refused.take().map_or(Ok(()), |refused| Err(anyhow!(refused)))
    }

    fn wait(&mut self, session: &mut Session, seconds: &str) -> anyhow::Result<()> {
        let seconds: f64 =
            seconds.trim().parse().with_context(|| format!("wait: \"{seconds}\", expected seconds"))?;
        let begin = Instant::now();
        while begin.elapsed().as_secs_f64() < seconds {
            print(&shown(&session.hear_alive()?, &mut self.news))?;
        }
        Ok(())
    }
}

/// What the board says to a line; or what the rig beside it does.
fn answer(session: &mut Session, line: &str, rig: Option<&SimulatedRig>) -> anyhow::Result<String> {
    let Some(rig) = rig else { return session.ask(line) };
    match Play::parse(line) {
        Ok(Some(Play::Rig(faults))) => {
            rig.touch(|rig| faults.into_iter().for_each(|fault| rig.inject(fault)))
        }
        Ok(Some(Play::Mend)) => rig.touch(|rig| rig.clear()),
        Ok(Some(Play::Power(_) | Play::Wait(_))) => bail!("not on a board: its output stage is the real one"),
        Ok(None) => return session.ask(line),
        Err(error) => return Err(error),
    }
    Ok("ok, to the rig\n".into())
}

/// What of the board's words a person wants to see: whole lines, no prompts, no ticks. A line that is not whole waits in `text`.
fn shown(heard: &[Heard], text: &mut String) -> String {
    heard.iter().fold(String::new(), |mut out, heard| {
        match heard {
            Heard::Text(more) => {
                *text += more;
                take_lines(text).iter().for_each(|line| out += &format!("{line}\n"));
            }
            Heard::Line(line) if matches!(LogLine::find(line), Ok(None)) => out += &format!("{line}\n"),
            Heard::Line(_) | Heard::Broken => {}
        }
        out
    })
}

/// A person types, and the board may speak at any time.
fn interactive(session: Session, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    let config = rustyline::Config::builder().keyseq_timeout(Some(50)).build();
    let mut editor: Editor<Words, DefaultHistory> = Editor::with_config(config)?;
    editor.set_helper(Some(Words::new()));
    for key in [KeyEvent(KeyCode::Esc, Modifiers::NONE), KeyEvent::from('!')] {
        editor.bind_sequence(key, Cmd::Interrupt);
    }
    keys::remember();
    let (hand, mut stopping) = (session.other_hand()?, session.other_hand()?);
    let session = Arc::new(Mutex::new(session));
    let _heed = heed(hand, Arc::clone(&session))?;
    listen(editor.create_external_printer()?, Arc::clone(&session));
    loop {
        let typed = editor.readline("> ");
        match typed {
            Ok(line) => {
                let _ = editor.add_history_entry(&line);
                let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
                match answer(&mut session, line.trim(), rig) {
                    Ok(answer) => print(&answer)?,
                    Err(error) if error.is::<Lost>() => return Err(error),
                    Err(error) => print(&format!("error: {error:#}\n"))?,
                }
            }
            Err(ReadlineError::Interrupted) => stopping.write_all(&[STOP]).map_err(Lost::Gone)?,
            Err(ReadlineError::Eof) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

/// A terminal that is closed, or a program that is ended, stops the board, which nobody watches any more.
fn heed(hand: Box<dyn SerialPort>, session: Arc<Mutex<Session>>) -> anyhow::Result<Heed> {
    let hand = Mutex::new(hand);
    Heed::new(move || {
        let sent = hand.lock().unwrap_or_else(PoisonError::into_inner).write_all(&[STOP]);
        // Whoever waits for an answer has the port.
        let session = (0..50).find_map(|_| {
            std::thread::sleep(LET);
            session.try_lock().ok()
        });
        let ended = anyhow!("the console was ended");
        leave(&match session {
            Some(mut session) => session.stopped_after(&ended),
            None => ended.context(format!("a stop was {}sent", if sent.is_ok() { "" } else { "NOT " })),
        });
    })
}

/// Shows what the board says by itself. Without a port there is nothing to type a line for: the console ends.
fn listen(mut printer: impl ExternalPrinter + Send + 'static, session: Arc<Mutex<Session>>) {
    let mut news = String::new();
    std::thread::spawn(move || {
        loop {
            // Dropped before printing: whoever stops must not wait for a slow terminal.
            let heard = session.lock().unwrap_or_else(PoisonError::into_inner).hear();
            let text = heard.map_or_else(|error| leave(&error), |heard| shown(&heard, &mut news));
            if Arc::strong_count(&session) == 2 {
                return; // whoever typed has left
            }
            if !text.is_empty() {
                let _ = printer.print(text);
            }
            std::thread::sleep(LET);
        }
    });
}

/// Ends the program although somebody may be typing.
fn leave(error: &anyhow::Error) -> ! {
    keys::restore();
    let _ = writeln!(std::io::stderr(), "\nerror: {}", in_words(error));
    std::process::exit(2)
}

/// Words that can be completed.
struct Words {
    settings: Vec<String>,
}

impl Words {
    fn new() -> Self {
        let config = Config::default();
        Self { settings: Name::all(&config).map(|name| name.to_string()).collect() }
    }

    /// Where the word begins that ends at `end`, and what it may become.
    fn complete(&self, line: &str, end: usize) -> (usize, Vec<String>) {
        let typed = line.get(..end).unwrap_or_default();
        let begin = typed.rfind(' ').map_or(0, |at| at + 1);
        let word = typed.get(begin..).unwrap_or_default();
        let fits = |candidate: &&str| candidate.starts_with(word);
        let command = typed.split_ascii_whitespace().next().unwrap_or_default();
        let words = match (begin, command) {
            (0, _) => COMMANDS.iter().map(|(name, ..)| *name).filter(fits).map(str::to_owned).collect(),
            (4, "get" | "set") => {
                self.settings.iter().map(String::as_str).filter(fits).map(str::to_owned).collect()
            }
            _ => arguments(command).filter(|word| fits(&word.as_str())).collect(),
        };
        (begin, words)
    }
}

/// The words that a command takes, from its row of the help: those that are not in capitals.
fn arguments(command: &str) -> impl Iterator<Item = String> {
    let row = COMMANDS.iter().find(|(name, ..)| *name == command).map_or("", |(_, arguments, _)| arguments);
    let words =
        row.split(['|', ' ', '[', ']']).filter(|word| word.starts_with(|c: char| c.is_ascii_lowercase()));
    words.map(str::to_owned)
}

impl Completer for Words {
    type Candidate = String;

    fn complete(&self, line: &str, end: usize, _: &Context<'_>) -> rustyline::Result<(usize, Vec<String>)> {
        Ok(self.complete(line, end))
    }
}

impl Hinter for Words {
    type Hint = String;
}

impl Highlighter for Words {
    fn highlight_prompt<'b, 's: 'b, 'p: 'b>(&'s self, prompt: &'p str, _: bool) -> Cow<'b, str> {
        Cow::Borrowed(prompt)
    }
}

impl Validator for Words {}

impl Helper for Words {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_settings_and_their_words_are_completed() {
        let words = Words::new();
        assert_eq!(words.complete("sta", 3), (0, vec!["status".to_owned()]));
        assert_eq!(words.complete("set pid.k", 9), (4, vec!["pid.kp".to_owned()]));
        assert_eq!(words.complete("stream o", 8).1, ["on", "off"]);
        assert_eq!(words.complete("baseline l", 10).1, ["learn"]);
        assert!(words.complete("set pid.kp 2", 12).1.is_empty());
    }

    #[test]
    fn ticks_and_prompts_are_not_shown_and_sentences_are() {
        let mut text = String::new();
        let mut line = |heard: &str| shown(&[Heard::Line(heard.to_owned())], &mut text);
        assert_eq!(line("order 5 arm"), "");
        assert_eq!(line("mode 5 off -> settle"), "mode 5 off -> settle\n");
        // A piece ends where it likes, between a line feed and the prompt, too.
        let pieces = ["\nstop", "ped\n", "> ", "\n> "].map(|piece| Heard::Text(piece.to_owned()));
        assert_eq!(shown(&pieces, &mut text), "stopped\n");
    }
}
