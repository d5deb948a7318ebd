//! The likelihood diagnosis alone, by what it is doing on a tick.

use core::fmt::{self, Write};

use fdi_core::likelihood::taught::{EFFECTS, Response};
use fdi_core::likelihood::{Likelihood, LikelihoodReport, LikelihoodState, Readiness};
use fdi_core::{Config, Report, Tick};

use super::Stopwatch;
use super::tick::{armed, control, diagnose};
use crate::codes::sample;
use crate::recording::Recording;

type Phase = fn(&LikelihoodReport) -> bool;

/// What it may be doing, with how many faults taught; on the other ticks it waits.
const PHASES: [(&str, usize, Phase); 4] = [
    ("likelihood: training", 0, |report| report.readiness == Readiness::Training),
    ("likelihood: watching", 0, |report| report.readiness == Readiness::Armed && !report.alarm),
    ("likelihood: alarm", 0, |report| report.alarm),
    ("likelihood: alarm, ten faults taught", 10, |report| report.alarm),
];

/// Counts each phase over its own ticks of the run.
pub(super) fn count(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    for (name, taught, phase) in PHASES {
        let samples = ticks(recording).filter(|(_, report)| phase(&report.likelihood)).count();
        let mut ticks = ticks(recording);
        let mut c = Config::default();
        for i in 0..taught {
            let response = Response { effects: [50 + 10 * i as i16; EFFECTS], ..Response::default() };
            c.likelihood.taught.push(response).expect("room");
        }
        let likelihood =
            Likelihood::new(&c.likelihood, c.tuning, &c.identification, c.sample_time).expect("valid");
        let mut state = LikelihoodState::default();
        watch.pass(out, [name], samples, |watch, _| {
            for (tick, report) in ticks.by_ref() {
                if phase(&report.likelihood) {
                    watch.time(0, || step(&likelihood, &mut state, &tick, &report));
                    break;
                }
                step(&likelihood, &mut state, &tick, &report);
            }
        })?;
    }
    Ok(())
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
