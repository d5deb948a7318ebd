//! An alarm from its onset to its end: when to name the fault, when to call it unknown, when it is over.

use super::class::FaultClass;
use super::hypothesis::{HYPOTHESES, PROCESS, Signature};
use super::levels::Levels;
use super::noise::NoiseModel;
use super::ranking::Ranking;
use super::verdict::Finding;
use crate::bounds::{larger, smaller};

// Margins are twice log-likelihood ratios. All tuned on seeds 1 to 99999, lively (docs/diagnosis.md, sections 8 and 12).
/// The full margin is asked for at first; a fair one after so long, s; any after so long, s.
const FAIR_AFTER: f32 = 8.0;
const ANY_AFTER: f32 = 15.0;
/// The fair margin: odds of twenty to one.
const FAIR_MARGIN: f32 = 6.0;
/// The process is named only by this margin, odds of 400 to 1: T1 answers first to it, and looks clogged until T2 answers too.
const PROCESS_MARGIN: f32 = 12.0;
/// Between power and air flow the full margin is asked for so long, s: a change of flow looks like one of power until T2
/// has answered. Later less is enough for small changes, which the model of the flow describes well.
const T2_ANSWERS_AFTER: f32 = 4.0;
/// What fits nothing for so long is unknown, s.
const UNKNOWN_AFTER: f32 = 3.0;
/// A residual is quiet again below so many standard deviations, or this share of its peak.
const QUIET_SIGMA: f32 = 3.0;
const QUIET_SHARE: f32 = 0.2;
/// What drives the residual of y1 has ended below this share of its peak.
const ENDED_SHARE: f32 = 0.35;
/// Quiet ticks in a row that end an alarm, and its shortest length.
const QUIET_TICKS: u32 = 3;
const SHORTEST: u32 = 6;

/// What the models say on a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum ModelAlarm {
    /// All is as expected.
    #[default]
    Quiet,
    /// Something is wrong, and it cannot be told what.
    Unnamed,
    /// Something is wrong, and it is this.
    Named(Finding),
}

impl ModelAlarm {
    /// What is wrong, where that is known.
    pub(super) fn finding(self) -> Option<Finding> {
        match self {
            Self::Named(finding) => Some(finding),
            Self::Quiet | Self::Unnamed => None,
        }
    }
}

/// An alarm under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alarm {
    onset: u32,
    ticks: u32,
    quiet: u32,
    named: Option<Signature>,
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
    /// Names the fault, or keeps its name, or does not know yet. `slow_sd` is the standard deviation of slow disturbance, `rise` the rise of
    /// T1, degC.
    pub(super) fn name(&self, alarm: &mut Alarm, ranking: &Ranking, slow_sd: f32, rise: f32) -> ModelAlarm {
        alarm.ticks = alarm.ticks.saturating_add(1);
        let lasted = alarm.ticks as f32 * self.sample_time;
        let margin = match alarm.named {
            None if lasted > ANY_AFTER => 0.0,
            None if lasted > FAIR_AFTER => smaller(FAIR_MARGIN, self.margin),
            _ => self.margin,
        };
        let margin = if ranking.is_process() { larger(PROCESS_MARGIN, margin) } else { margin };
        if ranking.fits() && ranking.margin() > margin {
            let share = if lasted < T2_ANSWERS_AFTER { 1.0 } else { ranking.late_share() };
            alarm.named = Some(ranking.choice(share * self.power_margin));
        }
        let onset = alarm.onset;
        if ranking.is_strange() && lasted > UNKNOWN_AFTER {
            alarm.named = None;
            let class = FaultClass::Unknown;
            return ModelAlarm::Named(Finding { class, confidence: 0.0, magnitude: None, onset });
        }
        let Some(h) = alarm.named else { return ModelAlarm::Unnamed };
        ModelAlarm::Named(Finding {
            class: ranking.class(h),
            confidence: ranking.confidence(h),
            magnitude: ranking.magnitude(h, slow_sd, rise),
            onset,
        })
    }

    /// Whether the fault has gone; `valid` says that this tick shows it.
    pub(super) fn is_over(
        &self,
        alarm: &mut Alarm,
        levels: &Levels,
        noise: &[NoiseModel; 3],
        valid: bool,
    ) -> bool {
        for (peak, level) in alarm.peak.iter_mut().zip(&levels.residual) {
            *peak = larger(*peak, level.abs());
        }
        alarm.peak_drive = larger(alarm.peak_drive, levels.drive.abs());
        let named = alarm.named.map(|h| &HYPOTHESES[h as usize]);
        // y2 from y1 forgets a fault of T1 only as fast as T2 answers; it is asked only where nothing else knows.
        let asked = if named.is_none_or(|h| h.class == FaultClass::Drift) { 0..3 } else { 0..2 };
        let quiet = asked.into_iter().all(|m| {
            levels.residual[m].abs() < larger(QUIET_SIGMA * noise[m].sd, QUIET_SHARE * alarm.peak[m])
        });
        let ended =
            named.is_some_and(|h| h.kind == PROCESS) && levels.drive.abs() < ENDED_SHARE * alarm.peak_drive;
        alarm.quiet = if valid && (quiet || ended) { alarm.quiet + 1 } else { 0 };
        alarm.quiet >= QUIET_TICKS && alarm.ticks >= SHORTEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TS: f32 = 0.11;
    const NOISE: f32 = 0.05;

    /// On which tick an alarm that was named so ends, if the residuals of y1, y2 and y2 from y1 are `residual(tick)` in degC; `None` within
    /// 100 ticks.
    fn ends(named: Option<Signature>, residual: impl Fn(u32) -> [f32; 3]) -> Option<u32> {
        let rules = Rules { margin: 9.0, power_margin: 20.0, sample_time: TS };
        let noise = [NoiseModel { sd: NOISE, ..NoiseModel::default() }; 3];
        let (mut alarm, mut levels) = (Alarm { named, ..Alarm::new(0) }, Levels::default());
        (1..100).find(|&tick| {
            levels.step(&residual(tick).map(Some), &[-0.8, 0.0, 0.0]);
            alarm.ticks += 1;
            rules.is_over(&mut alarm, &levels, &noise, true)
        })
    }

    #[test]
    fn an_alarm_lasts_as_long_as_a_residual_and_ends_soon_after() {
        let offset = |tick| [if tick < 50 { 1.0 } else { 0.0 }, 0.0, 0.0];
        let ended = ends(Some(Signature::T1Offset), offset).unwrap();
        assert!((53..60).contains(&ended), "{ended}");
        assert_eq!(ends(Some(Signature::T1Offset), |_| [1.0, 0.0, 0.0]), None);
    }

    /// y2 from y1 counts only where no name, or that of a drift, says more.
    #[test]
    fn the_third_residual_is_asked_where_nothing_else_knows() {
        let third = |_| [0.0, 0.0, 1.0];
        assert_eq!(ends(None, third), None);
        assert_eq!(ends(Some(Signature::T2Drift), third), None);
        assert_eq!(ends(Some(Signature::T1Clogged), third), Some(SHORTEST));
    }

    /// A change of the process has ended when nothing drives the residual any more, although it has not decayed yet.
    #[test]
    fn a_process_fault_ends_with_what_drives_it() {
        let decaying =
            |tick: u32| [if tick < 30 { 2.0 } else { 2.0 * libm::powf(0.8, (tick - 30) as f32) }, 0.0, 0.0];
        let process = ends(Some(Signature::AirFlow), decaying).unwrap();
        let sensor = ends(Some(Signature::T1Offset), decaying).unwrap();
        assert!(process + 2 < sensor, "{process} {sensor}");
    }
}
