//! One run of a campaign, observed by both diagnoses, as the few numbers that are kept of it.

pub mod heat;

use fdi_core::Instrument;
use fdi_core::likelihood::FaultClass;
use serde::{Deserialize, Serialize};

use super::by::By;
use super::cell::Cell;
use crate::experiment::{Row, as_written, drive, tick_time, with_prbs_phase};
use crate::score::expectation::Expectation;
use crate::score::said::{Said, SaidScorer};
use crate::score::{
    Indication, LikelihoodScore, LikelihoodScorer, Rise, Score, Scorer, TAIL, likelihood_alarm,
    signature_class, signature_indication,
};
use heat::{Heat, HeatMeter};
use pt326_rig::fault::Fault;

/// One run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunRow {
    /// Number of the cell.
    pub cell: usize,
    /// Number of the run in the cell.
    pub run: u64,
    /// Its seed.
    pub seed: u64,
    /// True onset of the fault; null where there is none to be scored.
    pub onset_s: Option<f64>,
    /// What was done with the heat, and whether it was switched off.
    pub heat: Heat,
    /// What the likelihood diagnosis said, against the truth.
    pub said: Said,
    /// By the paper's signatures.
    pub signature: Observation,
    /// By the likelihood diagnosis.
    pub likelihood: Observation,
}

impl RunRow {
    /// By one diagnosis.
    pub fn by(&self, by: By) -> &Observation {
        match by {
            By::Likelihood => &self.likelihood,
            By::Signature => &self.signature,
        }
    }
}

/// What one diagnosis observed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// It watched when the fault began, or at the end of a run without; or the fault was there before arming.
    pub armed: bool,
    /// An alarm stood already when the fault began: then nothing was detected.
    pub early: bool,
    /// Delay of the detection, s; null: missed.
    pub detection_delay_s: Option<f64>,
    /// Delay of the right isolation, s; null: missed.
    pub isolation_delay_s: Option<f64>,
    /// Indicated duration, s.
    pub indicated_duration_s: Option<f64>,
    /// Share of the fault's time that it was rightly isolated.
    pub isolated_share: Option<f64>,
    /// Class named first during the fault.
    pub first: Option<String>,
    /// Class named on most ticks of the fault.
    pub settled: Option<String>,
    /// Estimated magnitude, in the unit of the class settled on.
    pub magnitude: Option<f64>,
    /// Half of its 95 % interval.
    pub half_width: Option<f64>,
    /// Estimated minus true onset, s.
    pub onset_error_s: Option<f64>,
    /// Confidence.
    pub confidence: Option<f64>,
    /// Alarms that rose outside the fault and its tail, or that advice became.
    pub alarms: u32,
    /// Advice that came up there.
    #[serde(default)]
    pub advices: u32,
    /// Ticks outside of it on which it watched and no alarm stood.
    pub watched_ticks: u64,
    /// Ticks outside of it on which an alarm stood.
    pub alarm_ticks: u64,
    /// Those of them on which it was only advice.
    #[serde(default)]
    pub advice_ticks: u64,
    /// Time of the first false alarm, s.
    pub first_alarm_s: Option<f64>,
    /// What it was first named; empty if it was not.
    pub first_alarm_as: Option<String>,
}

/// Counts the false alarms of one diagnosis.
#[derive(Default)]
struct AlarmCounter {
    rise: Rise,
    alarm: Rise,
    advice: Rise,
    observed: Observation,
}

/// What a diagnosis puts out on a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Output {
    /// Whether it raises an alarm; `None` while it does not watch.
    pub alarm: Option<bool>,
    /// Whether that alarm is only advice.
    pub advice: bool,
    /// What it names.
    pub named: Option<FaultClass>,
}

impl Output {
    fn by_signature(row: &Row) -> Self {
        let verdict = row.report.filtered;
        Self {
            alarm: verdict.map(|v| v.fdv != 0),
            advice: false,
            named: verdict.and_then(|v| signature_class(v.fiv)),
        }
    }

    fn by_likelihood(row: &Row) -> Self {
        let likelihood = &row.report.likelihood;
        Self {
            alarm: likelihood_alarm(likelihood),
            advice: likelihood.advice,
            named: likelihood.finding.map(|f| f.class),
        }
    }
}

impl AlarmCounter {
    /// What is there from the start can only be found later: nothing is asked of the time before.
    fn new(fault: Option<&Fault>) -> Self {
        let armed = fault.is_some_and(|f| f.at == 0.0);
        Self { observed: Observation { armed, ..Observation::default() }, ..Self::default() }
    }

    fn observe(&mut self, t: f64, fault: Option<&Fault>, output: &Output) {
        let alarm = output.alarm == Some(true);
        let rises = self.rise.of(alarm);
        let [alarms, advices] =
            [self.alarm.of(alarm && !output.advice), self.advice.of(alarm && output.advice)].map(u32::from);
        let observed = &mut self.observed;
        if fault.is_none_or(|f| t < f.at) {
            observed.armed = output.alarm.is_some();
            observed.early = alarm && fault.is_some();
        }
        if fault.is_some_and(|f| t >= f.at && t < f.end() + TAIL) {
            return;
        }
        match output.alarm {
            Some(true) => {
                observed.alarm_ticks += 1;
                observed.advice_ticks += u64::from(output.advice);
            }
            Some(false) => observed.watched_ticks += 1,
            None => {}
        }
        observed.alarms += alarms;
        observed.advices += advices;
        if rises {
            observed.first_alarm_s.get_or_insert(t);
        }
        if let (true, Some(class)) = (observed.first_alarm_s.is_some(), output.named) {
            observed.first_alarm_as.get_or_insert_with(|| class.name().into());
        }
    }

    fn finish(self, score: Score) -> Observation {
        let Observation { armed, early, .. } = self.observed;
        let valid = armed && !early;
        Observation {
            detection_delay_s: score.detection_delay_s.filter(|_| valid),
            isolation_delay_s: score.isolation_delay_s.filter(|_| valid),
            indicated_duration_s: score.indicated_duration_s.filter(|_| valid),
            isolated_share: score.isolated_share,
            ..self.observed
        }
    }
}

/// Scores a diagnosis of which nothing is known but what it puts out, over one run of a cell, as ours are scored.
pub struct Observer {
    fault: Option<Fault>,
    right: Vec<FaultClass>,
    sample_time: f64,
    counter: AlarmCounter,
    scorer: Option<Scorer>,
}

impl Observer {
    /// Of the run with a seed, before its first tick.
    pub fn new(cell: &Cell, seed: u64) -> Self {
        let (config, scenario) = cell.draw(seed);
        let fault = cell.fault().and(scenario.faults.into_iter().next());
        Self {
            right: cell.right.clone(),
            sample_time: as_written(config.sample_time.0),
            counter: AlarmCounter::new(fault.as_ref()),
            scorer: fault.as_ref().map(Scorer::new),
            fault,
        }
    }

    /// One tick, at `t`.
    pub fn observe(&mut self, t: f64, output: &Output) {
        self.counter.observe(t, self.fault.as_ref(), output);
        if let Some(scorer) = &mut self.scorer {
            scorer.observe(
                t,
                Indication {
                    monitoring: output.alarm.is_some(),
                    detected: output.alarm == Some(true) && !self.right.is_empty(),
                    isolated: output.named.is_some_and(|class| self.right.contains(&class)),
                    named: output.named,
                },
            );
        }
    }

    /// What it observed.
    pub fn finish(self) -> Observation {
        let Some(scorer) = self.scorer else { return self.counter.observed };
        let score = scorer.score(self.sample_time, !self.right.is_empty());
        with_names(self.counter.finish(score), &scorer)
    }
}

/// Runs one run of a cell.
///
/// # Errors
/// The parameter of the configuration that is out of bounds.
pub fn run(cell: &Cell, number: usize, run: u64) -> anyhow::Result<RunRow> {
    run_before(cell, number, run, |_, _| {})
}

/// The same before somebody who looks at each tick, with its time in s.
///
/// # Errors
/// The parameter of the configuration that is out of bounds.
pub fn run_before(
    cell: &Cell,
    number: usize,
    run: u64,
    mut observe: impl FnMut(f64, &Row),
) -> anyhow::Result<RunRow> {
    let seed = cell.seed(run);
    let (config, scenario) = cell.draw(seed);
    let config = with_prbs_phase(&config, seed);
    let sample_time = as_written(config.sample_time.0);
    let fault = cell.fault().and(scenario.faults.first());
    let mut instrument = Instrument::new(&config)?;
    let mut counters = [AlarmCounter::new(fault), AlarmCounter::new(fault)];
    let mut scorers =
        fault.map(|f| (Scorer::new(f), LikelihoodScorer::new(f, sample_time).right(&cell.right)));
    let mut said = SaidScorer::new(fault, &cell.right, sample_time);
    let mut heat = HeatMeter::new(&config, &scenario, fault);
    drive(&mut instrument, &config, &scenario, seed, |row, rig, _| {
        let t = tick_time(row.tick.index, sample_time);
        heat.observe(t, &row, rig);
        observe(t, &row);
        for (counter, output) in
            counters.iter_mut().zip([Output::by_signature(&row), Output::by_likelihood(&row)])
        {
            counter.observe(t, fault, &output);
        }
        said.observe(t, &row.report.likelihood);
        if let (Some(fault), Some((signature, likelihood))) = (fault, &mut scorers) {
            signature.observe(t, signature_indication(fault, row.report.filtered));
            likelihood.observe(t, &row.report.likelihood);
        }
    });
    let [signature, likelihood] = counters;
    let (signature, likelihood) = match (fault, scorers) {
        (Some(fault), Some((by_signature, by_likelihood))) => {
            let isolable = Expectation::of(fault).fiv.is_some();
            let observed = signature.finish(by_signature.score(sample_time, isolable));
            (with_names(observed, &by_signature), named_by_likelihood(likelihood, by_likelihood.score()))
        }
        _ => (signature.observed, likelihood.observed),
    };
    Ok(RunRow {
        cell: number,
        run,
        seed,
        onset_s: fault.map(|f| f.at),
        said: said.finish(likelihood.detection_delay_s.is_some()),
        heat: heat.finish(),
        signature,
        likelihood,
    })
}

fn with_names(observed: Observation, scorer: &Scorer) -> Observation {
    let name = |class: FaultClass| class.name().to_owned();
    Observation { first: scorer.first_named().map(name), settled: scorer.settled().map(name), ..observed }
}

fn named_by_likelihood(counter: AlarmCounter, score: LikelihoodScore) -> Observation {
    Observation {
        first: score.first_verdict.map(str::to_owned),
        settled: score.verdict.map(str::to_owned),
        magnitude: score.magnitude,
        half_width: score.magnitude_half_width,
        onset_error_s: score.onset_error_s,
        confidence: score.confidence,
        ..counter.finish(score.score)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pt326_rig::fault::{Sensor, Verb};

    /// What is kept of a fault from 10 s to 20 s, one tick a second, if the alarm stands when `alarm` says so.
    fn observed(alarm: impl Fn(u32) -> Option<bool>) -> Observation {
        let fault = Fault::new(Verb::Offset, Some(Sensor::T2), Some(1.0), 10.0, 10.0);
        let mut counter = AlarmCounter::new(Some(&fault));
        for t in 0..60 {
            let named = (t == 40).then_some(FaultClass::Drift);
            let advice = (40..=50).contains(&t) && alarm(t) == Some(true);
            counter.observe(f64::from(t), Some(&fault), &Output { alarm: alarm(t), advice, named });
        }
        counter.finish(Score { detection_delay_s: Some(0.0), ..Score::default() })
    }

    #[test]
    fn only_alarms_outside_the_fault_and_its_tail_are_false_and_each_counts_once() {
        let observed = observed(|t| (t >= 2).then_some(matches!(t, 12..34 | 38..42 | 50)));
        assert_eq!((observed.alarms, observed.alarm_ticks), (1, 5));
        assert_eq!((observed.advices, observed.advice_ticks), (2, 3), "from 40 s on it is advice");
        assert_eq!(observed.watched_ticks, 8 + 25 - 5, "2 to 9 s, and 35 to 59 s without the alarms");
        assert_eq!((observed.first_alarm_s, observed.first_alarm_as.as_deref()), (Some(38.0), Some("drift")));
        assert_eq!((observed.armed, observed.early, observed.detection_delay_s), (true, false, Some(0.0)));
    }

    #[test]
    fn an_alarm_that_stood_before_the_fault_has_not_detected_it() {
        let observed = observed(|t| Some((8..20).contains(&t)));
        assert_eq!((observed.early, observed.detection_delay_s, observed.alarms), (true, None, 1));
    }

    #[test]
    fn what_is_there_before_arming_can_still_be_found() {
        let fault = Fault { at: 0.0, ..Fault::new(Verb::Detach, Some(Sensor::T1), Some(1.0), 0.0, 10.0) };
        let mut counter = AlarmCounter::new(Some(&fault));
        counter.observe(0.0, Some(&fault), &Output { alarm: None, advice: false, named: None });
        counter.observe(5.0, Some(&fault), &Output { alarm: Some(true), advice: false, named: None });
        let observed = counter.finish(Score { detection_delay_s: Some(5.0), ..Score::default() });
        assert_eq!((observed.armed, observed.detection_delay_s, observed.alarms), (true, Some(5.0), 0));
    }

    /// Whoever says what ours says is scored as ours is.
    #[test]
    fn a_diagnosis_from_outside_is_scored_as_ours_is() {
        let text = "[[cell]]\nname = \"c\"\nruns = 1\nphase = 60.0\n\
                    fault = [{ do = \"offset\", sensor = \"t2\", size = 1.5, at = 400.0, for = 20.0 }]";
        let campaign: crate::campaign::definition::Campaign = toml::from_str(text).unwrap();
        let cell = campaign.expand(&fdi_core::Config::default()).unwrap().remove(0);
        let mut observer = Observer::new(&cell, cell.seed(0));
        let ours =
            run_before(&cell, 0, 0, |t, row| observer.observe(t, &Output::by_likelihood(row))).unwrap();
        let theirs = observer.finish();
        assert!(theirs.isolation_delay_s.is_some_and(|delay| delay < 5.0), "{theirs:?}");
        let (magnitude, half_width) = (theirs.magnitude, theirs.half_width);
        let (onset_error_s, confidence) = (theirs.onset_error_s, theirs.confidence);
        assert_eq!(
            theirs,
            Observation { magnitude, half_width, onset_error_s, confidence, ..ours.likelihood }
        );
    }

    #[test]
    fn what_did_not_watch_at_the_onset_is_not_armed() {
        let observed = observed(|t| (t >= 15).then_some(false));
        assert_eq!((observed.armed, observed.detection_delay_s), (false, None));
    }
}
