//! The lines of the log, but for the record of each tick. `pt326 replay` reads those that begin with `order`,
//! `setting` and `lockout`.

use core::fmt::{Arguments, Write};

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::event::Event;
use fdi_core::{Command, Config};
use firmware_logic::alarm::Alarm;
use firmware_logic::control_loop::{Asked, Outcome};
use firmware_logic::history::{Entry, EntryText};
use firmware_logic::reset_cause::ResetCause;
use firmware_logic::retained::Retained;
use firmware_logic::self_test::News;
use firmware_logic::settings::schema::Name;
use firmware_logic::settings::store::Origin;
use firmware_logic::status::Status;

use crate::hardware::clock::Source;
use crate::hardware::{board, stack, supply};

/// Text put together on the board; what does not fit is cut.
fn text(arguments: Arguments<'_>) -> heapless::String<160> {
    let mut text = heapless::String::new();
    let _ = text.write_fmt(arguments);
    text
}

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
    defmt::info!("clock {}, stack {=usize} bytes, record 2", clock, stack::size());
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
        Origin::Flash | Origin::Default => defmt::info!("settings {=str}", text(format_args!("{origin}"))),
        _ => defmt::error!("settings {=str}", text(format_args!("{origin}"))),
    }
    settings(config);
}

/// Each setting that is not at its default.
pub(crate) fn settings(config: &Config) {
    let usual = Config::default();
    for name in Name::all(config) {
        if !name.same(config, &usual) {
            defmt::info!("setting {=str}", text(format_args!("{name} = {}", name.value(config))));
        }
    }
}

/// A baseline that was restored, with its bits, so that a replay can begin with it.
pub(crate) fn baseline(baseline: &Baseline) {
    defmt::info!("baseline samples {=u32}", baseline.samples);
    let rows = [
        ("raw.mean", &baseline.raw.mean),
        ("raw.sigma", &baseline.raw.sigma),
        ("filtered.mean", &baseline.filtered.mean),
        ("filtered.sigma", &baseline.filtered.sigma),
    ];
    for (name, values) in rows {
        let mut words = text(format_args!("{name}"));
        for value in values {
            let _ = write!(words, " {:x}", value.to_bits());
        }
        defmt::info!("baseline {=str}", words);
    }
}

/// What became of an order before a tick.
pub(crate) fn outcome(tick: u32, outcome: &Outcome, checked: bool) {
    if let Err(denial) = outcome.result {
        return defmt::warn!("denied {=u32} {=str}", tick, text(format_args!("{denial}")));
    }
    let command = match outcome.asked {
        Asked::Command(command) => command,
        Asked::Settings => return defmt::info!("order {=u32} settings", tick),
        Asked::Check => return, // its news follow, and it is nothing to the core
    };
    match command {
        Command::Arm => defmt::info!("order {=u32} arm", tick),
        Command::Stop => defmt::info!("order {=u32} stop", tick),
        Command::Acknowledge => defmt::info!("order {=u32} ack", tick),
        Command::Relearn => defmt::info!("order {=u32} relearn", tick),
        Command::SetPoint(wanted) => defmt::info!("order {=u32} setpoint {=f32}", tick, wanted.0),
        Command::Excite(on) => defmt::info!("order {=u32} excite {=bool}", tick, on),
    }
    if command == Command::Arm && !checked {
        defmt::warn!("armed without a check");
    }
}

/// What the self-test says.
pub(crate) fn check(news: News) {
    match news {
        News::Stage(stage) => defmt::info!("check: {=str}", stage.name()),
        News::Found(finding) => defmt::warn!("check: {=str}", text(format_args!("{finding}"))),
        News::Ended(ending) => defmt::info!("{=str}", text(format_args!("{ending}"))),
    }
}

/// A trip or a lockout.
pub(crate) fn went_wrong(entry: &Entry, sample_time: f32) {
    if let Entry::Lockout { tick, .. } = entry {
        defmt::info!("lockout {=u32}", tick);
    }
    defmt::error!("{=str}", text(format_args!("{}", EntryText { entry, sample_time })));
}

/// What the diagnosis says of a fault.
pub(crate) fn event(event: &Event, sample_time: f32) {
    let (what, fault, ended) = match event {
        Event::Detected(fault) => ("detected", fault, false),
        Event::Isolated(fault) => ("isolated", fault, false),
        Event::Ended(fault) => ("ended", fault, true),
    };
    let entry = Entry::Fault { fault: *fault, ended };
    defmt::warn!("{=str}: {=str}", what, text(format_args!("{}", EntryText { entry: &entry, sample_time })));
}

/// News of an alarm of the likelihood diagnosis.
pub(crate) fn alarm(alarm: Alarm, sample_time: f32) {
    let entry = Entry::Alarm(alarm);
    defmt::warn!("likelihood: {=str}", text(format_args!("{}", EntryText { entry: &entry, sample_time })));
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
        defmt::info!("health {=str}", text(format_args!("{health}")));
    }
}

/// Two decimals, which is what a person reads.
fn hundredths(x: f32) -> f32 {
    (x * 100.0) as i32 as f32 / 100.0
}
