//! The log: how the board came up, what each tick has to tell, and a line of status each second.

use defmt::Display2Format;
use fdi_core::Config;
use firmware_logic::log_line::{self, LogLine};
use firmware_logic::notice::{Level, Notice};
use firmware_logic::reset_cause::ResetCause;
use firmware_logic::retained::Retained;
use firmware_logic::settings::store::Origin;
use firmware_logic::status::Status;

use crate::hardware::clock::Source;
use crate::hardware::{board, retained, stack, supply};

/// Who this is, and how it came up.
pub(crate) fn banner(
    clock: Source,
    cause: ResetCause,
    left: Option<&Retained>,
    origin: &Origin,
    config: &Config,
) {
    defmt::info!(
        "PT-326 FDI {=str} ({=str}) on {=str}",
        env!("CARGO_PKG_VERSION"),
        env!("GIT_DESCRIBE"),
        board::NAME
    );
    defmt::info!("clock {}, stack {=usize} bytes", clock, stack::size());
    line(LogLine::Start { version: log_line::VERSION });
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
    log_line::settings(config, line);
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
    let Some((record, report)) = &status.last else { return };
    let (tick, vectors) = (&record.tick, report.filtered.map_or((0, 0), |v| (v.fdv, v.fiv)));
    defmt::info!(
        "{=str} T0 {=f32} T1 {=f32} T2 {=f32} of {=f32} degC, heater {=f32} %, gain {=f32} bandwidth {=f32}, fdv {=u8} fiv {=u8}",
        tick.mode.name(),
        hundredths(tick.sample.t0.celsius.0),
        hundredths(tick.sample.t1.celsius.0),
        hundredths(tick.sample.t2.celsius.0),
        hundredths(tick.setpoint.0),
        hundredths(record.applied.0),
        report.ms1.static_gain.map_or(f32::NAN, |g| (g * 1000.0) as i32 as f32 / 1000.0),
        report.ms1.bandwidth.map_or(f32::NAN, hundredths),
        vectors.0,
        vectors.1,
    );
    let health = &status.health;
    let p = &health.jitter;
    if p.ticks.is_multiple_of(600) || p.missed > 0 || health.records_lost > 0 || health.log_dropped > 0 {
        defmt::info!("health {}", Display2Format(health));
    }
}

/// Two decimals, which is what a person reads.
fn hundredths(x: f32) -> f32 {
    (x * 100.0) as i32 as f32 / 100.0
}
