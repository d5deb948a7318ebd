//! The likelihood diagnosis alone, by what it is doing on a tick.

use core::fmt::{self, Write};

use fdi_core::likelihood::taught::{EFFECTS, Response};
use fdi_core::likelihood::{Likelihood, LikelihoodReport, LikelihoodState, Readiness};
use fdi_core::{Config, Report, Tick};

use super::Stopwatch;
use super::tick::{armed, control, diagnose};
use crate::codes::sample;
use crate::recording::Recording;

/// What is counted on a tick, by what the diagnosis does: as it is delivered, and with ten faults taught. While it waits, nothing.
fn counted(report: &LikelihoodReport) -> &'static [&'static str] {
    match report.readiness {
        _ if report.alarm => &["likelihood: alarm", "likelihood: alarm, ten faults taught"],
        Readiness::Training => &["likelihood: training"],
        Readiness::Armed => &["likelihood: watching"],
        _ => &[],
    }
}

/// Counts each phase over its own ticks, in one pass of the run.
pub(super) fn count(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let diagnoses = [0, 10].map(diagnosis);
    let mut states = [(); 2].map(|()| LikelihoodState::default());
    let mut ticks = ticks(recording).peekable();
    while let Some((_, report)) = ticks.peek() {
        let names = counted(&report.likelihood);
        watch.stretch(out, names, |watch| {
            let mut samples = 0;
            while let Some((tick, report)) = ticks.next_if(|(_, report)| counted(&report.likelihood) == names)
            {
                for (i, (diagnosis, state)) in diagnoses.iter().zip(&mut states).enumerate() {
                    // What it says is dropped here: to hand it on would be a copy that is counted.
                    let mut work = || {
                        step(diagnosis, state, &tick, &report);
                    };
                    if i < names.len() { watch.time(i, work) } else { work() }
                }
                samples += 1;
            }
            samples
        })?;
    }
    Ok(())
}

/// A diagnosis with so many faults taught.
fn diagnosis(taught: usize) -> Likelihood {
    let mut c = Config::default();
    for i in 0..taught {
        let response = Response { effects: [50 + 10 * i as i16; EFFECTS], ..Response::default() };
        c.likelihood.taught.push(response).expect("room");
    }
    Likelihood::new(&c.likelihood, c.tuning, &c.identification, c.sample_time).expect("valid")
}

/// The ticks of the run, and what an instrument says on them.
fn ticks(recording: &Recording) -> impl Iterator<Item = (Tick, Report)> {
    let mut instrument = armed();
    recording.rows().map(move |row| {
        let tick = control(&mut instrument, sample(row.codes));
        let report = diagnose(&mut instrument, &tick, tick.drive);
        (tick, report)
    })
}

#[inline(never)]
fn step(
    likelihood: &Likelihood,
    state: &mut LikelihoodState,
    tick: &Tick,
    report: &Report,
) -> LikelihoodReport {
    let undisturbed = report.filtered.is_none_or(|verdict| verdict.fdv == 0);
    likelihood.step(state, &tick.observation(tick.drive), undisturbed)
}
