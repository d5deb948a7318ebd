//! What a board streams, as a file that `pt326 replay` reads: its lines as they came, and a remark where some are missing.

use std::io::Write;

use firmware_logic::log_line::LogLine;

/// Counts what it writes.
pub struct Recorder<W> {
    out: W,
    /// Records of ticks.
    pub ticks: u64,
    /// The tick that is due next, where one is.
    due: Option<u32>,
    /// Ticks that are missing.
    pub missing: u64,
    /// Lines that did not come whole.
    pub broken: u64,
    /// Lines that the board had no room for.
    pub dropped: u64,
    /// The first record was that of tick 0: a replay can run the core again.
    pub from_start: bool,
}

impl<W: Write> Recorder<W> {
    /// Writes into `out`.
    pub fn new(out: W) -> Self {
        Self { out, ticks: 0, due: None, missing: 0, broken: 0, dropped: 0, from_start: false }
    }

    /// Where it writes.
    pub fn out(&mut self) -> &mut W {
        &mut self.out
    }

    /// A line has come.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn line(&mut self, line: &str) -> std::io::Result<()> {
        match LogLine::find(line) {
            Ok(Some(LogLine::Tick(tick))) => self.tick(tick.tick())?,
            Ok(Some(LogLine::Start { .. })) => self.due = Some(0),
            Ok(Some(LogLine::Dropped { count })) => self.dropped += u64::from(count),
            _ => {}
        }
        writeln!(self.out, "{line}")
    }

    /// A line has come that is not whole.
    pub fn broken(&mut self) {
        self.broken += 1;
    }

    /// A remark for people; a replay passes over it.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn remark(&mut self, text: &str) -> std::io::Result<()> {
        writeln!(self.out, "# {text}")?;
        self.out.flush()
    }

    fn tick(&mut self, tick: u32) -> std::io::Result<()> {
        if self.ticks == 0 {
            self.from_start = tick == 0;
        }
        if let Some(due) = self.due.filter(|due| *due < tick) {
            self.missing += u64::from(tick - due);
            self.remark(&format!("ticks {due} to {} are missing", tick - 1))?;
        }
        self.ticks += 1;
        self.due = Some(tick.wrapping_add(1));
        Ok(())
    }

    /// How it goes, in one line.
    pub fn progress(&self) -> String {
        let told =
            [(self.missing, "missing"), (self.broken, "broken"), (self.dropped, "dropped by the board")];
        let lost: String =
            told.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}")).collect();
        format!("{} ticks{lost}", self.ticks)
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::schema::WORDS;
    use firmware_logic::log_line::tick::TickLine;

    use super::*;

    fn tick(n: u32) -> String {
        let mut words = [0; WORDS];
        words[0] = n;
        TickLine(words).to_string()
    }

    #[test]
    fn gaps_are_told_where_they_are() {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file);
        for line in ["log format 5".to_owned(), tick(0), tick(1), "dropped 3".to_owned(), tick(5)] {
            recorder.line(&line).unwrap();
        }
        recorder.broken();
        assert_eq!(recorder.progress(), "3 ticks, 3 missing, 1 broken, 3 dropped by the board");
        assert!(recorder.from_start);
        let text = String::from_utf8(file).unwrap();
        let remark = text.lines().position(|line| line == "# ticks 2 to 4 are missing").unwrap();
        assert_eq!(text.lines().nth(remark + 1), Some(&*tick(5)));
    }

    #[test]
    fn a_record_that_begins_late_says_so_and_a_new_start_is_no_gap() {
        let mut recorder = Recorder::new(Vec::new());
        for line in [tick(77), tick(78), "log format 5".to_owned(), tick(0)] {
            recorder.line(&line).unwrap();
        }
        assert_eq!((recorder.from_start, recorder.missing), (false, 0));
    }
}
