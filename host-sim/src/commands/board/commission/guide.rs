//! What all steps need: a board, a person, and a place to write down what both said.

use std::io::{Read, Write};

use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;

use super::report::{Outcome, Section};
use pt326_host::board::{Heard, Session, refusal, take_lines};

/// Who is led.
pub trait Person {
    /// Shows a line.
    ///
    /// # Errors
    /// Nobody can see it.
    fn tell(&mut self, line: &str) -> anyhow::Result<()>;

    /// Asks; `None` where nobody answers any more.
    ///
    /// # Errors
    /// Nobody can be asked.
    fn ask(&mut self, question: &str) -> anyhow::Result<Option<String>>;
}

/// Board, person, and what was written down.
pub(super) struct Guide<'a, P> {
    pub(super) session: &'a mut Session<P>,
    person: &'a mut dyn Person,
    pub(super) sections: Vec<Section>,
    /// The board's stream.
    pub(super) log: String,
    /// Text of the console, up to a line that is not whole.
    text: String,
}

impl<'a, P: Read + Write> Guide<'a, P> {
    pub(super) fn new(session: &'a mut Session<P>, person: &'a mut dyn Person) -> Self {
        Self { session, person, sections: Vec::new(), log: String::new(), text: String::new() }
    }

    /// Begins a step, which counts as left out until it has ended.
    pub(super) fn section(&mut self, title: &'static str, explanation: &str) -> anyhow::Result<()> {
        self.sections.push(Section { title, outcome: Outcome::LeftOut, lines: Vec::new() });
        self.person.tell(&format!("\n{title}"))?;
        if explanation.is_empty() { Ok(()) } else { self.person.tell(explanation) }
    }

    pub(super) fn end(&mut self, outcome: Outcome) {
        if let Some(section) = self.sections.last_mut() {
            section.outcome = outcome;
        }
    }

    /// Shows lines, and writes them down.
    pub(super) fn say(&mut self, text: &str) -> anyhow::Result<()> {
        for line in text.lines() {
            self.person.tell(&format!("  {line}"))?;
            if let Some(section) = self.sections.last_mut() {
                section.lines.push(line.to_owned());
            }
        }
        Ok(())
    }

    /// An answer that is not empty.
    pub(super) fn ask(&mut self, question: &str) -> anyhow::Result<Option<String>> {
        self.session.gate().check()?;
        let answer = self.person.ask(question)?;
        Ok(answer.map(|answer| answer.trim().to_owned()).filter(|answer| !answer.is_empty()))
    }

    /// Anything but a yes is a no.
    pub(super) fn yes(&mut self, question: &str) -> anyhow::Result<bool> {
        let answer = self.ask(&format!("{question} [y/N] "))?;
        Ok(answer.is_some_and(|answer| ["y", "yes"].contains(&answer.to_lowercase().as_str())))
    }

    /// Types a line, which must not be refused.
    pub(super) fn order(&mut self, line: &str) -> anyhow::Result<String> {
        Ok(self.session.order(line)?.trim_end().to_owned())
    }

    /// Types a line, and shows its answer; `None` where it is refused, by which the step has failed.
    pub(super) fn try_order(&mut self, line: &str) -> anyhow::Result<Option<String>> {
        let answer = self.session.ask(line)?.trim_end().to_owned();
        self.say(&answer)?;
        let taken = refusal(&answer).is_none();
        if !taken {
            self.end(Outcome::Failed);
        }
        Ok(taken.then_some(answer))
    }

    /// Writes down what ended it all, though nobody may see it any more.
    pub(super) fn note(&mut self, text: &str) {
        self.end(Outcome::Failed);
        if let Some(section) = self.sections.last_mut() {
            section.lines.push(text.to_owned());
        }
        let _ = self.person.tell(text);
    }

    /// Shows what the board tells, until a line ends it.
    pub(super) fn follow(&mut self, over: impl Fn(&str) -> Option<bool>) -> anyhow::Result<bool> {
        self.text.clear();
        let mut result = None;
        loop {
            for line in take_lines(&mut self.text) {
                self.say(&line)?;
                result = result.or(over(&line));
            }
            // Up to its prompt: what is asked next must not take it for its own.
            match result {
                Some(result) if self.text.ends_with("> ") => return Ok(result),
                _ => drop(self.ticks()?),
            }
        }
    }

    /// Shows what its console has told by itself.
    pub(super) fn news(&mut self) -> anyhow::Result<()> {
        take_lines(&mut self.text).iter().try_for_each(|line| self.say(line))
    }

    /// Lets so many ticks pass.
    pub(super) fn pass(&mut self, mut count: usize) -> anyhow::Result<()> {
        while count > 0 {
            count = count.saturating_sub(self.ticks()?.len());
        }
        Ok(())
    }

    /// The ticks that the board has streamed since; waits for something to come.
    pub(super) fn ticks(&mut self) -> anyhow::Result<Vec<TickLine>> {
        let mut ticks = Vec::new();
        loop {
            let heard = self.session.hear_alive()?;
            let any = !heard.is_empty();
            for heard in heard {
                match heard {
                    Heard::Text(text) => self.text += &text,
                    Heard::Broken => self.log += "# a line came broken\n",
                    Heard::Line(line) => {
                        if let Ok(Some(LogLine::Tick(tick))) = LogLine::find(&line) {
                            ticks.push(tick);
                        }
                        self.log += &line;
                        self.log.push('\n');
                    }
                }
            }
            if any {
                return Ok(ticks);
            }
        }
    }
}
