//! `teach`: repetitions of a fault that somebody makes, and the row that comes of them.

use core::fmt::{self, Display, Write};

use fdi_core::diagnosis::teach::Steady;
use fdi_core::name::Name;
use fdi_core::{Config, Mode};

use super::{Board, fail, say};
use crate::settings::store::SaveError;
use crate::teaching::{Lesson, TeachError, Teaching};

/// What `teach` is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The repetitions, and the row that they give.
    Show,
    /// A repetition of this fault begins.
    Begin(Name),
    /// It ends.
    End,
    /// Put the row in force, and keep it.
    Save,
    /// Forget the repetitions.
    Drop,
}

/// What follows `teach`.
pub const EXPECTED: &str =
    "NAME (a letter, then letters, digits, - or _, 12 in all), end, show, save or drop";

impl Wanted {
    /// Reads it; `None` where it is none.
    pub(super) fn parse(text: &str) -> Option<Self> {
        match text {
            "" | "show" => Some(Self::Show),
            "end" => Some(Self::End),
            "save" => Some(Self::Save),
            "drop" => Some(Self::Drop),
            name => name.parse().ok().map(Self::Begin),
        }
    }
}

/// Carries it out.
pub(super) async fn carry_out(wanted: Wanted, board: &mut impl Board, out: &mut dyn Write) {
    let result = match wanted {
        Wanted::Begin(name) => begin(name, board, out),
        Wanted::End => end(board, out),
        Wanted::Show => show(board, out),
        Wanted::Save => return save(board, out).await,
        Wanted::Drop => {
            board.teach(|teaching| *teaching = Teaching::default());
            say(out, "ok\n");
            Ok(())
        }
    };
    if let Err(error) = result {
        fail(out, &error);
    }
}

fn begin(name: Name, board: &mut impl Board, out: &mut dyn Write) -> Result<(), TeachError> {
    let status = board.status();
    let last = status.last.filter(|(record, _)| record.tick.mode == Mode::Monitor);
    let tick = last.map(|(record, _)| record.tick.index).ok_or(TeachError::NotMonitoring)?;
    let number = board.teach(|teaching| teaching.begin(name, tick))?;
    let _ = writeln!(out, "{name}, repetition {number}: make it now, hold it for 20 s, then `teach end`");
    Ok(())
}

fn end(board: &mut impl Board, out: &mut dyn Write) -> Result<(), TeachError> {
    let (steady, seen) = board.teach(Teaching::end)?;
    let number = board.teach(|teaching| teaching.repetitions().len());
    let unseen = if seen { "" } else { ", no alarm of the likelihood diagnosis for 3 s" };
    let _ = writeln!(out, "repetition {number}: {}{unseen}", SteadyText(&steady));
    Ok(())
}

fn show(board: &mut impl Board, out: &mut dyn Write) -> Result<(), TeachError> {
    board.teach(|teaching| {
        for (number, steady) in (1..).zip(teaching.repetitions()) {
            let _ = writeln!(out, "{} {number}: {}", teaching.name(), SteadyText(steady));
        }
        if teaching.repetitions().len() == 1 {
            let _ = writeln!(out, "{}", TeachError::Once);
        }
    });
    let (_, lesson) = proposed(board)?;
    let _ = write!(out, "{}", LessonText(&lesson));
    Ok(())
}

/// Apart from what waits, whose memory is static.
fn proposed(board: &mut impl Board) -> Result<(Config, Lesson), TeachError> {
    let config = board.config();
    board.teach(|teaching| teaching.proposed(&config))
}

async fn save(board: &mut impl Board, out: &mut dyn Write) {
    if board.teach(|teaching| teaching.repetitions().len()) == 1 {
        return fail(out, &TeachError::Once);
    }
    let (config, lesson) = match proposed(board) {
        Ok(proposed) => proposed,
        Err(error) => return fail(out, &error),
    };
    if let (Some(error), Err(_)) = (lesson.refused, lesson.response) {
        return fail(out, &error);
    }
    if let Err(error) = board.apply(&config).await {
        return fail(out, &error);
    }
    board.teach(|teaching| *teaching = Teaching::default());
    let _ = write!(out, "in force\n{}", LessonText(&lesson));
    match board.save().await {
        Ok(()) => say(out, "saved\n"),
        Err(SaveError::Heating) => say(out, "it heats: `save` keeps it once the heater is off\n"),
        Err(error) => fail(out, &error),
    }
}

/// The row and the response, and why one of them cannot stand.
struct LessonText<'a>(&'a Lesson);

impl Display for LessonText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Lesson { row, refused, response } = self.0;
        write!(f, "row: {} {} {}", u32::from(row.number), row.pattern, row.name)?;
        if let Some(error) = refused {
            write!(f, ", NOT taught: {error}")?;
        }
        match response {
            Ok(response) => {
                f.write_str("\nlikelihood:")?;
                response.effects.iter().try_for_each(|effect| write!(f, " {}", i32::from(*effect)))?;
                f.write_str("\n")
            }
            Err(error) => writeln!(f, "\nlikelihood: NOT taught: {error}"),
        }
    }
}

/// The five symptoms; `~` where one came and went.
struct SteadyText<'a>(&'a Steady);

impl Display for SteadyText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, symptom) in self.0.iter().enumerate() {
            let gap = if i > 0 { " " } else { "" };
            match symptom.map(|symptom| symptom.sign()) {
                Some(0) => write!(f, "{gap}0")?,
                Some(sign) => write!(f, "{gap}{:+}", i32::from(sign))?,
                None => write!(f, "{gap}~")?,
            }
        }
        Ok(())
    }
}
