//! Both halves of the tick, whole.

use core::fmt::{self, Write};

use fdi_core::{Command, Config, Instrument, Percent, RawSample, Report, Tick};

use super::Stopwatch;
use crate::codes::sample;
use crate::recording::Recording;

/// Counts both halves over the whole run.
pub(super) fn count(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let mut instrument = armed();
    watch.pass(out, ["control()", "diagnose()"], recording.len(), |watch, k| {
        let raw = sample(recording.row(k).codes);
        let tick = watch.time(0, || control(&mut instrument, raw));
        watch.time(1, || diagnose(&mut instrument, &tick, tick.drive));
    })
}

/// An instrument at the first tick of the recording.
pub(super) fn armed() -> Instrument {
    let mut instrument = Instrument::new(&Config::default()).expect("valid");
    instrument.command(Command::Arm).expect("a new instrument is off");
    instrument
}

#[inline(never)]
pub(super) fn control(instrument: &mut Instrument, raw: RawSample) -> Tick {
    instrument.control(raw)
}

#[inline(never)]
pub(super) fn diagnose(instrument: &mut Instrument, tick: &Tick, applied: Percent) -> Report {
    instrument.diagnose(tick, applied)
}
