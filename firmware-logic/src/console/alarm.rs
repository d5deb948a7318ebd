//! What a user says of an alarm: that it is known, that it may wait, that it is normal.

use core::fmt::Write;

use fdi_core::{Command, Finding, Mode, Seconds};

use super::{Board, done, fail, number, say};

const NOTHING: &str = "error: no alarm and no advice stands, see `status`\n";

/// It monitors, and nothing is told.
fn calm(board: &impl Board) -> bool {
    let last = board.status().last;
    last.is_some_and(|(record, report)| record.tick.mode == Mode::Monitor && !report.likelihood.alarm)
}

/// A trip, a lockout or an alarm is known.
pub(super) async fn acknowledge(board: &mut impl Board, out: &mut dyn Write) {
    if calm(board) {
        return say(out, NOTHING);
    }
    done(out, board.command(Command::Acknowledge).await);
}

/// What is named now is normal: it is learnt.
pub(super) async fn accept(board: &mut impl Board, out: &mut dyn Write) {
    if let Err(why) = named(board, Finding::may_be_accepted) {
        return fail(out, &why);
    }
    match board.command(Command::Relearn).await {
        Ok(()) => say(out, "ok, learning it as normal; `save` keeps it, the commissioning stays\n"),
        Err(denial) => fail(out, &denial),
    }
}

/// What is named now is advice for a while.
pub(super) async fn shelve(minutes: &str, board: &mut impl Board, out: &mut dyn Write) {
    let time = match number("shelve", minutes) {
        Ok(minutes) => Seconds(60.0 * minutes),
        Err(error) => return fail(out, &error),
    };
    if time.0 != 0.0
        && let Err(why) = named(board, Finding::may_be_shelved)
    {
        return fail(out, &format_args!("{why}; `ack` acknowledges an alarm"));
    }
    done(out, board.command(Command::Shelve(time)).await);
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
        Some(_) => Err("what is named may trip, or has no size"),
    }
}
