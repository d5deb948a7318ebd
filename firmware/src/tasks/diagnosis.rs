//! The second half of each tick: identify, diagnose, log. It has almost the whole period for it.

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::{Diagnosis, DiagnosisState};
use fdi_core::likelihood::Readiness;
use fdi_core::{Mode, Report};
use firmware_logic::alarm::Alarms;
use firmware_logic::control_loop::{Asked, TickRecord};
use firmware_logic::history::Entry;
use firmware_logic::interlock::Lockout;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::retained::Retained;
use firmware_logic::status::readiness;
use firmware_logic::task_watchdog::Task;

use crate::hardware::retained;
use crate::instrument::Instrument;
use crate::link::{self, Records};
use crate::log;

/// The diagnosis half of the instrument.
#[embassy_executor::task]
pub(crate) async fn diagnosis(
    mut diagnosis: Diagnosis,
    restored: Option<Baseline>,
    mut records: Records,
    instrument: &'static Instrument,
) {
    let mut state = diagnosis.start();
    if let Some(baseline) = &restored {
        diagnosis.restore(&mut state, baseline);
    }
    let mut changes = Changes {
        mode: Mode::Off,
        lockout: None,
        readiness: Readiness::Untrained,
        alarms: Alarms::default(),
    };
    loop {
        let record = records.next().await;
        link::check_in(Task::Diagnosis);
        if let Some(outcome) = record.outcome {
            // Settings that control has refused are not for this half either.
            if outcome.asked == Asked::Settings
                && let Some(retuned) = instrument.take_retuned()
                && outcome.result.is_ok()
            {
                diagnosis = retuned;
            }
            log::outcome(record.tick.index, &outcome, record.checked);
            instrument.answered(outcome);
        }
        if let Some(news) = record.news {
            log::check(news);
        }
        let report = diagnosis.step(&mut state, &record.tick, record.applied);
        link::feed_back(report.feedback());
        defmt::debug!("{}", TickLine::new(&record, &report));
        changes.notice(&record, &report, instrument, &diagnosis, &state);
        instrument.ticked(record, report);
    }
}

/// What was the case on the tick before, so that a change can be told.
struct Changes {
    mode: Mode,
    lockout: Option<Lockout>,
    readiness: Readiness,
    alarms: Alarms,
}

impl Changes {
    fn notice(
        &mut self,
        record: &TickRecord,
        report: &Report,
        instrument: &Instrument,
        diagnosis: &Diagnosis,
        state: &DiagnosisState,
    ) {
        let tick = &record.tick;
        let sample_time = instrument.sample_time();
        let before = core::mem::replace(&mut self.mode, tick.mode);
        if core::mem::discriminant(&before) != core::mem::discriminant(&tick.mode) {
            defmt::info!("mode {=u32} {=str} -> {=str}", tick.index, before.name(), tick.mode.name());
            if let Mode::Tripped(trip) = tick.mode {
                log::went_wrong(&Entry::Trip(trip), sample_time);
                instrument.note(|history| history.push(Entry::Trip(trip)));
            }
            if tick.mode == Mode::Monitor {
                instrument.learnt(diagnosis.baseline(state));
            }
        }
        if record.lockout != self.lockout {
            self.lockout = record.lockout;
            retained::store(&Retained { lockout: record.lockout, ..Retained::EMPTY });
            if let Some(lockout) = record.lockout {
                let entry = Entry::Lockout { lockout, tick: tick.index };
                log::went_wrong(&entry, sample_time);
                instrument.note(|history| history.push(entry));
            }
        }
        for event in &report.events {
            log::event(event, sample_time);
            instrument.note(|history| history.event(*event));
        }
        if report.likelihood.readiness != self.readiness {
            self.readiness = report.likelihood.readiness;
            defmt::info!("likelihood {=u32} {=str}", tick.index, readiness(self.readiness));
        }
        if let Some(alarm) = self.alarms.notice(report) {
            log::alarm(alarm, sample_time);
            instrument.note(|history| history.alarm(alarm));
        }
        if record.arrival.missed > 0 && !record.missed {
            defmt::warn!("tick {=u32} came after {=u32} missed", tick.index, record.arrival.missed);
        }
    }
}
