//! The board's console on a terminal, with history and completion; from a pipe, line by line.

use std::borrow::Cow;
use std::io::{BufRead, IsTerminal};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
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

use crate::board::simulate::SimulatedRig;
use crate::board::{Heard, Session};
use crate::commands::console::play::Play;
use crate::commands::terminal::print;

/// Talks until the person leaves, or the input ends.
pub(super) fn run(session: Session, name: &str, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    if !std::io::stdin().is_terminal() {
        return scripted(session, std::io::stdin().lock(), rig);
    }
    print(&format!(
        "Board on {name}. Ctrl-C, ESC and ! stop the heater; help lists commands; Ctrl-D leaves.\n"
    ))?;
    interactive(session, rig)
}

/// Each line is a command; `wait SECONDS` shows what the board tells meanwhile.
fn scripted(mut session: Session, input: impl BufRead, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    for line in input.lines() {
        let line = line.context("the input can't be read")?;
        print(&format!("> {line}\n"))?;
        let Some(wait) = line.trim().strip_prefix("wait ") else {
            print(&answer(&mut session, line.trim(), rig)?)?;
            continue;
        };
        let seconds: f64 =
            wait.trim().parse().with_context(|| format!("wait: \"{wait}\", expected seconds"))?;
        let begin = Instant::now();
        while begin.elapsed().as_secs_f64() < seconds {
            for heard in session.hear()? {
                if let Some(text) = shown(&heard) {
                    print(&text)?;
                }
            }
        }
    }
    Ok(())
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

/// What of the board's words a person wants to see: no prompt, no ticks.
fn shown(heard: &Heard) -> Option<String> {
    match heard {
        Heard::Text(text) => Some(text.replace('\r', "").replace("\n> ", "\n")),
        Heard::Line(line) => matches!(LogLine::find(line), Ok(None)).then(|| format!("{line}\n")),
        Heard::Broken => None,
    }
}

/// A person types, and the board may speak at any time.
fn interactive(session: Session, rig: Option<&SimulatedRig>) -> anyhow::Result<()> {
    let config = rustyline::Config::builder().keyseq_timeout(Some(50)).build();
    let mut editor: Editor<Words, DefaultHistory> = Editor::with_config(config)?;
    editor.set_helper(Some(Words::new()));
    for key in [KeyEvent(KeyCode::Esc, Modifiers::NONE), KeyEvent::from('!')] {
        editor.bind_sequence(key, Cmd::Interrupt);
    }
    let session = Arc::new(Mutex::new(session));
    let mut printer = editor.create_external_printer()?;
    let listening = Arc::clone(&session);
    let listener = std::thread::spawn(move || {
        loop {
            // Dropped before printing: whoever stops must not wait for a slow terminal.
            let heard = listening.lock().unwrap_or_else(PoisonError::into_inner).hear();
            let Ok(heard) = heard else {
                let _ = printer.print(
                    "The port has gone. The board goes on by itself, with all its trips; its button stops it.\n".into(),
                );
                return;
            };
            if Arc::strong_count(&listening) == 1 {
                return;
            }
            let text: String = heard.iter().filter_map(shown).collect();
            if !text.is_empty() {
                let _ = printer.print(text);
            }
            // Lets the other thread have the port.
            std::thread::sleep(Duration::from_millis(2));
        }
    });
    while !listener.is_finished() {
        let typed = editor.readline("> ");
        let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
        match typed {
            Ok(line) => {
                let _ = editor.add_history_entry(&line);
                match answer(&mut session, line.trim(), rig) {
                    Ok(answer) => print(&answer)?,
                    Err(error) => print(&format!("error: {error:#}\n"))?,
                }
            }
            Err(ReadlineError::Interrupted) => session.stop()?,
            Err(ReadlineError::Eof) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
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
    fn ticks_are_not_shown_and_sentences_are() {
        let line = |text: &str| shown(&Heard::Line(text.to_owned()));
        assert_eq!(line("order 5 arm"), None);
        assert_eq!(line("mode 5 off -> settle"), Some("mode 5 off -> settle\n".to_owned()));
    }
}
