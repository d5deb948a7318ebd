//! An alarm from its onset to its end: when to name the fault, when to call it unknown, when it is over.

use super::class::FaultClass;
use super::hypothesis::{Weighed, class};
use super::noise::Normal;
use super::verdict::Finding;
use super::watch::Levels;
use crate::bounds::{larger, smaller};

/// A fault is named on a clear lead; after so long on a fair one; after so long again on any.
const FAIR_AFTER: f32 = 8.0;
const ANY_AFTER: f32 = 15.0;
/// The fair lead: odds of twenty to one.
const FAIR_LEAD: f32 = 6.0;
/// The process is named only on this lead: T1 answers first to it, and looks clogged until T2 answers too.
const PROCESS_LEAD: f32 = 12.0;
/// Between power and air flow the full margin is asked for so long, s: a change of flow looks like one of power until T2
/// has answered. Later less is enough for small changes, which the model of the flow describes well.
const EARLY: f32 = 4.0;
/// What fits nothing for so long is unknown, s.
const STRANGE_AFTER: f32 = 3.0;
/// A residual is quiet again below so many standard deviations, or this share of its peak.
const QUIET_SIGMA: f32 = 3.0;
const QUIET_SHARE: f32 = 0.2;
/// What drives the residual of y1 has ended below this share of its peak.
const ENDED_SHARE: f32 = 0.35;
/// Quiet ticks in a row that end an alarm, and its shortest length.
const QUIET_TICKS: u32 = 3;
const SHORTEST: u32 = 6;

/// An alarm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alarm {
    onset: u32,
    ticks: u32,
    quiet: u32,
    named: Option<usize>,
    peak: [f32; 3],
    peak_drive: f32,
}

impl Alarm {
    /// A fault thought to have begun on tick `onset`.
    pub(super) fn new(onset: u32) -> Self {
        Self { onset, ticks: 0, quiet: 0, named: None, peak: [0.0; 3], peak_drive: 0.0 }
    }
}

/// When to name and when to clear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub(super) margin: f32,
    pub(super) power_margin: f32,
    pub(super) sample_time: f32,
}

impl Rules {
    /// Names the fault, or keeps its name, or does not know yet.
    pub(super) fn name(&self, alarm: &mut Alarm, weighed: &Weighed, slow: f32, rise: f32) -> Option<Finding> {
        alarm.ticks = alarm.ticks.saturating_add(1);
        let lasted = alarm.ticks as f32 * self.sample_time;
        let lead = match alarm.named {
            None if lasted > ANY_AFTER => 0.0,
            None if lasted > FAIR_AFTER => smaller(FAIR_LEAD, self.margin),
            _ => self.margin,
        };
        let lead = if weighed.is_process() { larger(PROCESS_LEAD, lead) } else { lead };
        if weighed.fits() && weighed.lead() > lead {
            let share = if lasted < EARLY { 1.0 } else { weighed.late_share() };
            alarm.named = Some(weighed.choice(share * self.power_margin));
        }
        if weighed.is_strange() && lasted > STRANGE_AFTER {
            alarm.named = None;
            let class = FaultClass::Unknown;
            return Some(Finding { class, confidence: 0.0, magnitude: None, onset: alarm.onset });
        }
        let h = alarm.named?;
        Some(Finding {
            class: weighed.named(h),
            confidence: weighed.confidence(h),
            magnitude: weighed.magnitude(h, slow, rise),
            onset: alarm.onset,
        })
    }

    /// Whether the fault has gone.
    pub(super) fn is_over(
        &self,
        alarm: &mut Alarm,
        levels: &Levels,
        normal: &[Normal; 3],
        valid: bool,
    ) -> bool {
        for (peak, level) in alarm.peak.iter_mut().zip(&levels.residual) {
            *peak = larger(*peak, level.abs());
        }
        alarm.peak_drive = larger(alarm.peak_drive, levels.drive.abs());
        // y2 from y1 forgets a fault of T1 only as fast as T2 answers; it is asked only where nothing else knows.
        let class = alarm.named.map(class);
        let asked = if matches!(class, None | Some(FaultClass::Drift)) { 0..3 } else { 0..2 };
        let quiet = asked.into_iter().all(|m| {
            levels.residual[m].abs() < larger(QUIET_SIGMA * normal[m].sd, QUIET_SHARE * alarm.peak[m])
        });
        let process = matches!(class, Some(FaultClass::AirFlow | FaultClass::HeaterPower));
        let ended = process && levels.drive.abs() < ENDED_SHARE * alarm.peak_drive;
        alarm.quiet = if valid && (quiet || ended) { alarm.quiet + 1 } else { 0 };
        alarm.quiet >= QUIET_TICKS && alarm.ticks >= SHORTEST
    }
}
