//! What a user says of an alarm: that it is known, that it may wait, that it is normal.

use core::fmt::Write;

use fdi_core::{Command, Finding, Mode, Seconds};

use super::{Asked, Board, OK, fail, number, say};

const NOTHING: &str = "error: no alarm and no advice stands, see `status`\n";

/// It monitors, and nothing is told.
fn calm(board: &impl Board) -> bool {
    let last = board.status().last;
    last.is_some_and(|(record, report)| record.tick.mode == Mode::Monitor && !report.likelihood.alarm)
}

/// A trip, a lockout or an alarm is known.
pub(super) fn acknowledge(board: &impl Board, out: &mut dyn Write) -> Option<Asked> {
    if calm(board) {
        say(out, NOTHING);
        return None;
    }
    Some((Command::Acknowledge, OK))
}

/// What is named now is normal: it is learnt.
pub(super) fn accept(board: &impl Board, out: &mut dyn Write) -> Option<Asked> {
    if let Err(why) = named(board, Finding::may_be_accepted) {
        fail(out, &why);
        return None;
    }
    Some((Command::Relearn, "ok, learning it as normal; `save` keeps it, the commissioning stays\n"))
}

/// What is named now is advice for a while.
pub(super) fn shelve(minutes: &str, board: &impl Board, out: &mut dyn Write) -> Option<Asked> {
    let time = match number("shelve", minutes) {
        Ok(minutes) => Seconds(60.0 * minutes),
        Err(error) => {
            fail(out, &error);
            return None;
        }
    };
    if time.0 != 0.0
        && let Err(why) = named(board, Finding::may_be_shelved)
    {
        fail(out, &format_args!("{why}; `ack` acknowledges an alarm"));
        return None;
    }
    Some((Command::Shelve(time), OK))
}

/// It monitors, and names something of which `may` holds.
///
/// # Errors
/// Why it does not.
fn named(board: &impl Board, may: fn(&Finding) -> bool) -> Result<(), &'static str> {
    let monitored = board.status().last.filter(|(record, _)| record.tick.mode == Mode::Monitor);
    match monitored.and_then(|(_, report)| report.likelihood.finding) {
        None => Err("nothing is named, see `status`"),
        Some(found) if may(&found) => Ok(()),
        Some(_) => Err("what is named may trip, is not sure, or has no size"),
    }
}
