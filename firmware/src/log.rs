//! The log: how the board came up, what each tick has to tell, and a line of status each second.

use defmt::Display2Format;
use firmware_logic::log_line::LogLine;
use firmware_logic::notice::{Level, Notice};
use firmware_logic::reset_cause::ResetCause;
use firmware_logic::retained::Retained;
use firmware_logic::settings::store::Origin;
use firmware_logic::status::{Status, StatusLine};

use crate::hardware::clock::Source;
use crate::hardware::{board, retained, stack, supply};

/// Who this is, and how it came up.
pub(crate) fn banner(clock: Source, cause: ResetCause, left: Option<&Retained>, origin: &Origin) {
    defmt::info!(
        "PT-326 FDI {=str} ({=str}) on {=str}",
        env!("CARGO_PKG_VERSION"),
        env!("GIT_DESCRIBE"),
        board::NAME
    );
    defmt::info!("clock {}, stack {=usize} bytes", clock, stack::size());
    if clock == Source::InternalForWrongClock {
        defmt::warn!("the external clock is not 8 MHz, and not used");
    }
    match cause.is_fault() {
        true => defmt::error!("reset cause: {=str}", cause.name()),
        false => defmt::info!("reset cause: {=str}", cause.name()),
    }
    if let Some(left) = left.filter(|left| left.death.is_some()) {
        defmt::error!("crash record: {=str}", left.words.as_str());
    }
    if let Some(level) = supply::low_brown_out_level() {
        defmt::warn!("brown-out level {=str}, expected 3 (2.7 V): `brownout set`", level);
    }
    match origin {
        Origin::Flash | Origin::Default => defmt::info!("settings {}", Display2Format(origin)),
        _ => defmt::error!("settings {}", Display2Format(origin)),
    }
}

/// A line that a program reads.
pub(crate) fn line(line: LogLine<'_>) {
    defmt::info!("{}", Display2Format(&line));
}

/// What a tick has to tell.
pub(crate) fn notice(notice: &Notice, sample_time: f32) {
    if let Notice::Lockout { lockout, .. } = *notice {
        retained::store(&Retained { lockout, ..Retained::EMPTY });
    }
    let text = &notice.text(sample_time);
    match (notice, notice.level()) {
        (Notice::Tick(tick), _) => defmt::debug!("{}", tick), // put together where the log is decoded
        (_, Level::Debug) => defmt::debug!("{}", Display2Format(text)),
        (_, Level::Info) => defmt::info!("{}", Display2Format(text)),
        (_, Level::Warn) => defmt::warn!("{}", Display2Format(text)),
        (_, Level::Error) => defmt::error!("{}", Display2Format(text)),
    }
}

/// The line of each second.
pub(crate) fn status(status: &Status) {
    if status.last.is_none() {
        return;
    }
    defmt::info!("{}", Display2Format(&StatusLine(status)));
    if status.health.is_worth_a_line() {
        defmt::info!("health {}", Display2Format(&status.health));
    }
}
