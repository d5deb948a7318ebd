//! What the diagnosis says of a made record, held against what was wrong.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::AddAssign;

use fdi_core::{Config, FaultClass};
use indicatif::ProgressBar;
use pt326_host::recording::run::{Diagnosed, Training, diagnose};
use pt326_host::recording::{Reading, Recording};

use crate::rig::{COUNT, Fault, LEARNT, Made};

/// The name that an alarm has on each sample; none without an alarm.
pub(crate) type Names = Vec<Option<String>>;

/// The same as `pt326 diagnose --train` with the first samples does.
pub(crate) fn diagnosed(made: &Made, config: &Config) -> anyhow::Result<Diagnosed> {
    let how = Reading {
        map: ["time=time", "t1=temp", "power=power"].map(String::from).to_vec(),
        full_power: Some(100.0),
        fan: Some(false),
        ..Reading::default()
    };
    let recording = Recording::parse("made".into(), &made.csv, &how)?;
    let training = Training::Own(0..LEARNT, String::new());
    diagnose(&recording, 0, &training, &[], config, &ProgressBar::hidden())
}

/// What it says.
pub(crate) fn names(done: &Diagnosed) -> Names {
    let mut names = vec![None; COUNT];
    for row in &done.record.rows {
        let said = &row.report.likelihood;
        if let Some(name) = names.get_mut(row.tick.index as usize).filter(|_| said.alarm) {
            let of = said.finding.map(|finding| match (finding.class, finding.magnitude) {
                (FaultClass::HeaterPower, None) => "heater gives the same".to_owned(),
                (FaultClass::HeaterPower, Some(size)) if size.value < 0.0 => "less power".to_owned(),
                (FaultClass::HeaterPower, Some(_)) => "more power".to_owned(),
                (class, _) => class.name().to_owned(),
            });
            *name = Some(of.unwrap_or_else(|| "no name".to_owned()));
        }
    }
    names
}

impl Fault {
    /// What it should be called; a lid has no name of its own.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::None | Self::Lid => "",
            Self::Weak => "less power",
            Self::Strong => "more power",
            Self::Offset => "t1_offset",
            Self::On | Self::Stuck => "heater gives the same",
        }
    }
}

/// Counts over records.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    records: usize,
    refused: usize,
    /// Faults, those with an alarm, and those that had their name at their end.
    faults: usize,
    seen: usize,
    named: usize,
    /// Samples with and without a fault, and those of them in alarm.
    within: [usize; 2],
    outside: [usize; 2],
    /// Alarms that began without a fault, and samples by which alarms outlived faults.
    raised: usize,
    outlived: usize,
    /// What alarms without a fault are called, in samples.
    names: BTreeMap<String, usize>,
}

impl Score {
    /// Of one record; `None`: nothing could be learnt from it.
    pub(crate) fn of(made: &Made, fault: Fault, names: Option<&Names>) -> Self {
        let mut score = Self { records: 1, ..Self::default() };
        let Some(names) = names else { return Self { refused: 1, ..score } };
        for span in &made.faults {
            let last = names[span.clone()].iter().rev().flatten().next();
            score.faults += 1;
            score.seen += usize::from(last.is_some());
            score.named += usize::from(last.is_some_and(|last| last == fault.name()));
            score.outlived += names[span.end..].iter().take_while(|name| name.is_some()).count();
        }
        for k in LEARNT..COUNT {
            let wrong = made.faults.iter().any(|span| span.contains(&k));
            let [all, in_alarm] = if wrong { &mut score.within } else { &mut score.outside };
            *all += 1;
            if let Some(name) = &names[k] {
                *in_alarm += 1;
                if !wrong {
                    *score.names.entry(name.clone()).or_default() += 1;
                    score.raised += usize::from(names[k - 1].is_none());
                }
            }
        }
        score
    }

    /// The names of alarms without a fault, with the samples that they stood.
    pub(crate) fn names(&self) -> String {
        let mut names: Vec<_> = self.names.iter().collect();
        names.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        names.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
    }
}

impl AddAssign for Score {
    fn add_assign(&mut self, other: Self) {
        for (sum, of) in [
            (&mut self.records, other.records),
            (&mut self.refused, other.refused),
            (&mut self.faults, other.faults),
            (&mut self.seen, other.seen),
            (&mut self.named, other.named),
            (&mut self.raised, other.raised),
            (&mut self.outlived, other.outlived),
        ] {
            *sum += of;
        }
        for i in 0..2 {
            self.within[i] += other.within[i];
            self.outside[i] += other.outside[i];
        }
        for (name, count) in other.names {
            *self.names.entry(name).or_default() += count;
        }
    }
}

/// Cells of a table.
impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percent = |[all, in_alarm]: [usize; 2]| 100.0 * in_alarm as f64 / all.max(1) as f64;
        let tail = self.outlived as f64 / self.faults.max(1) as f64;
        write!(f, "{} | {} of {} | {} | ", self.records - self.refused, self.seen, self.faults, self.named)?;
        write!(f, "{:.1} % | {:.2} % | ", percent(self.within), percent(self.outside))?;
        write!(f, "{} | {tail:.0}", self.raised)
    }
}

/// Spans of a record in which the same is said while the same is wrong.
pub(crate) fn spans(made: &Made, names: &Names) -> Vec<String> {
    let said = |k: usize| (made.faults.iter().any(|span| span.contains(&k)), &names[k]);
    let mut spans = Vec::new();
    let mut from = LEARNT;
    while from < COUNT {
        let to = (from..COUNT).find(|k| said(*k) != said(from)).unwrap_or(COUNT);
        let (wrong, name) = said(from);
        if wrong || name.is_some() {
            let name = name.as_deref().unwrap_or("no alarm");
            spans.push(format!(
                "{from}..{to} ({}) {}: {name}",
                to - from,
                if wrong { "fault" } else { "none" }
            ));
        }
        from = to;
    }
    spans
}
