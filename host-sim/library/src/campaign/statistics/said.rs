//! What the likelihood diagnosis said in many runs, held against the truth.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Case;
use super::quantiles::{Quantiles, wilson_interval};
use crate::score::said::{BINS, Bin, Said};

/// Fewer verdicts, or intervals, than this prove nothing of a share.
const ENOUGH: u64 = 100;

/// What was said in some runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SaidStatistics {
    /// Of the runs with a fault; null where there is none.
    pub fault: Option<FaultSaid>,
    /// Verdicts by confidence, the lowest first; one without verdicts is left out.
    pub confidence: Vec<Confidence>,
    /// The names on the seconds of the faults, or of runs without: on how many, and on how many above 0.95.
    pub names: BTreeMap<String, [u64; 2]>,
}

/// What was said of a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultSaid {
    /// Onset to the first right name, s.
    pub right_delay_s: Quantiles,
    /// Runs whose name at the end of the fault was right, %.
    pub end_right_pct: f64,
    /// The names at the end, most first, with the number of runs.
    pub end_names: Vec<(String, usize)>,
    /// Runs whose alarm stood from the detection to the end of the fault, %.
    pub lasted_pct: f64,
    /// Share of the time from the detection to the end on which it stood, mean of the runs that detected it, %.
    pub alarm_share_pct: Option<f64>,
    /// How long it outlived the fault, s, of the runs where it stood at its end or rose soon after.
    pub tail_s: Quantiles,
    /// Runs in which a wrong name was said above 0.95 later than 5 s after the onset, %.
    pub sure_wrong_pct: f64,
    /// The intervals at the end under the right name; null: none.
    pub end_coverage: Option<Share>,
    /// The same of every second of the fault.
    pub coverage: Option<Share>,
}

/// A share with its 95 % interval (Wilson).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// How many.
    pub count: u64,
    /// Of how many.
    pub of: u64,
    /// The share, %.
    pub pct: f64,
    /// Its interval, %, if they are independent of each other: verdicts of one run are not, and it is too narrow for them.
    pub pct_95: [f64; 2],
}

/// Verdicts of about one confidence.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// The bin begins here.
    pub from: f64,
    /// Mean confidence, %.
    pub mean_pct: f64,
    /// Those that were right.
    pub right: Share,
}

impl Share {
    fn new(count: u64, of: u64) -> Option<Self> {
        let pct = 100.0 * count as f64 / of as f64;
        (of > 0).then(|| Self { count, of, pct, pct_95: wilson_interval(count, of).map(|x| 100.0 * x) })
    }
}

impl SaidStatistics {
    /// Of some runs.
    pub fn new(cases: &[Case]) -> Self {
        let faulty: Vec<&Said> =
            cases.iter().filter(|(_, row)| row.onset_s.is_some()).map(|(_, row)| &row.said).collect();
        Self {
            fault: (!faulty.is_empty()).then(|| FaultSaid::new(&faulty)),
            confidence: confidence(cases.iter().map(|(_, row)| &row.said)),
            names: sum(cases.iter().map(|(_, row)| &row.said.names)),
        }
    }

    /// How much more often than said the verdicts are right, in points of %, at the confidence where that is least; `None`
    /// without enough verdicts.
    pub fn calibration(&self) -> Option<f64> {
        let proven = self.confidence.iter().filter(|bin| bin.right.of >= ENOUGH);
        proven.map(|bin| bin.right.pct - bin.mean_pct).min_by(f64::total_cmp)
    }

    /// The coverage of every second; `None` without enough intervals.
    pub fn coverage(&self) -> Option<f64> {
        self.fault.as_ref()?.coverage.filter(|share| share.of >= ENOUGH).map(|share| share.pct)
    }
}

impl FaultSaid {
    fn new(all: &[&Said]) -> Self {
        let percent = |is: &dyn Fn(&Said) -> bool| {
            100.0 * all.iter().filter(|said| is(said)).count() as f64 / all.len() as f64
        };
        let quantiles = |value: &dyn Fn(&&&Said) -> Option<f64>| Quantiles::of(all.iter().map(|s| value(&s)));
        let shares: Vec<f64> = all.iter().filter_map(|said| said.alarm_share).collect();
        let tails = all.iter().filter(|said| said.tail_s.is_some());
        let covered: Vec<bool> = all.iter().filter_map(|said| covered(said)).collect();
        let held = covered.iter().filter(|&&held| held).count();
        let sum = |of: &dyn Fn(&Said) -> u64| all.iter().map(|said| of(said)).sum();
        Self {
            right_delay_s: quantiles(&|said| said.right_delay_s),
            end_right_pct: percent(&|said| said.end_right == Some(true)),
            end_names: counts(all.iter().map(|said| said.end_name.as_deref().unwrap_or("none"))),
            lasted_pct: percent(&|said| said.alarm_share == Some(1.0)),
            alarm_share_pct: (!shares.is_empty())
                .then(|| 100.0 * shares.iter().sum::<f64>() / shares.len() as f64),
            tail_s: Quantiles::of(tails.map(|said| said.tail_s.filter(|_| !said.tail_open))),
            sure_wrong_pct: percent(&|said| said.sure_wrong_late_s > 0.0),
            end_coverage: Share::new(held as u64, covered.len() as u64),
            coverage: Share::new(sum(&|said| said.held), sum(&|said| said.intervals)),
        }
    }
}

fn covered(said: &Said) -> Option<bool> {
    Some((said.end_size? - said.end_size_true?).abs() <= said.end_half_width?)
}

/// Each name with how often it comes, most first.
fn counts<'a>(names: impl Iterator<Item = &'a str>) -> Vec<(String, usize)> {
    let mut counts = BTreeMap::new();
    names.for_each(|name| *counts.entry(name).or_insert(0) += 1);
    let mut counts: Vec<_> = counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

/// Names with their seconds, of all together.
pub fn sum<'a>(all: impl Iterator<Item = &'a BTreeMap<String, [u64; 2]>>) -> BTreeMap<String, [u64; 2]> {
    let mut sums = BTreeMap::new();
    for (name, [seconds, sure]) in all.flatten() {
        let sum: &mut [u64; 2] = sums.entry(name.clone()).or_default();
        *sum = [sum[0] + seconds, sum[1] + sure];
    }
    sums
}

fn confidence<'a>(all: impl Iterator<Item = &'a Said>) -> Vec<Confidence> {
    let mut sums = [Bin::default(); BINS.len() + 1];
    for said in all {
        for (sum, bin) in sums.iter_mut().zip(&said.bins) {
            sum.said += bin.said;
            sum.right += bin.right;
            sum.confidence += bin.confidence;
        }
    }
    let bins = sums.iter().zip(std::iter::once(0.0).chain(BINS));
    let of_bin = |(bin, from): (&Bin, f64)| {
        let right = Share::new(bin.right, bin.said)?;
        Some(Confidence { from, mean_pct: 100.0 * bin.confidence / bin.said as f64, right })
    };
    bins.filter_map(of_bin).collect()
}

/// The confidence of all runs together, and of those on each plant.
pub fn by_plant(cases: &[Case]) -> Vec<(String, Vec<Confidence>)> {
    let mut plants: Vec<&str> = Vec::new();
    for (cell, _) in cases {
        if !plants.contains(&cell.plant.as_str()) {
            plants.push(&cell.plant);
        }
    }
    let of = |plant: &str| {
        confidence(cases.iter().filter(|(cell, _)| cell.plant == plant).map(|(_, row)| &row.said))
    };
    let all = ("all".to_owned(), confidence(cases.iter().map(|(_, row)| &row.said)));
    let each = plants
        .iter()
        .map(|&plant| (if plant.is_empty() { "reference rig".into() } else { plant.to_owned() }, of(plant)));
    std::iter::once(all).chain(each).filter(|(_, confidence)| !confidence.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use crate::campaign::cell::Cell;
    use crate::campaign::definition::Campaign;
    use crate::campaign::run::RunRow;

    fn statistics(all: Vec<Said>) -> SaidStatistics {
        let text = "[[cell]]\nname = \"c\"\nruns = 1\nfault = [{ do = \"air-flow\", size = 0.8, at = 9.0, for = 9.0 }]";
        let campaign: Campaign = toml::from_str(text).unwrap();
        let cells: Vec<Cell> = campaign.expand(&Config::default()).unwrap();
        let row = |said| RunRow { said, onset_s: Some(9.0), ..RunRow::default() };
        let rows: Vec<RunRow> = all.into_iter().map(row).collect();
        SaidStatistics::new(&rows.iter().map(|row| (&cells[0], row)).collect::<Vec<_>>())
    }

    fn right(size: f64) -> Said {
        Said {
            right_delay_s: Some(0.5),
            end_name: Some("air_flow".into()),
            end_right: Some(true),
            end_size: Some(size),
            end_half_width: Some(1.0),
            end_size_true: Some(-20.0),
            alarm_share: Some(1.0),
            tail_s: Some(0.75),
            ..Said::default()
        }
    }

    #[test]
    fn each_run_counts_and_what_did_not_end_is_infinitely_long() {
        let wrong = Said { end_name: Some("drift".into()), end_right: Some(false), ..Said::default() };
        let open = Said { tail_open: true, sure_wrong_late_s: 1.0, alarm_share: Some(0.5), ..right(-25.0) };
        let fault = statistics(vec![right(-20.5), wrong, open, right(-19.5)]).fault.unwrap();
        assert_eq!((fault.end_right_pct, fault.lasted_pct, fault.sure_wrong_pct), (75.0, 50.0, 25.0));
        assert_eq!((fault.right_delay_s.median, fault.right_delay_s.p95), (Some(0.5), None));
        assert_eq!(
            (fault.tail_s.median, fault.tail_s.p99),
            (Some(0.75), None),
            "of three that stood one did not fall"
        );
        assert_eq!(fault.end_names, [("air_flow".to_owned(), 3), ("drift".to_owned(), 1)]);
        let coverage = fault.end_coverage.unwrap();
        assert_eq!((coverage.count, coverage.of), (2, 3));
        assert!((fault.alarm_share_pct.unwrap() - 250.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn calibration_is_that_of_the_worst_bin_with_enough_verdicts() {
        let bins = |said: [u64; 2], right: [u64; 2]| {
            let mut bins = [Bin::default(); BINS.len() + 1];
            bins[1] = Bin { said: said[0], right: right[0], confidence: 0.6 * said[0] as f64 };
            bins[5] = Bin { said: said[1], right: right[1], confidence: said[1] as f64 };
            Said { bins, ..Said::default() }
        };
        let all = statistics(vec![bins([30, 100], [0, 95]), bins([30, 100], [0, 95])]);
        assert!((all.calibration().unwrap() + 5.0).abs() < 1e-9, "the other one has 60 verdicts");
        let more = statistics(vec![bins([60, 100], [0, 95]), bins([60, 100], [0, 95])]);
        assert!((more.calibration().unwrap() + 60.0).abs() < 1e-9);
        assert_eq!((all.confidence[1].from, all.confidence.len()), (0.99, 2));
        assert_eq!(statistics(vec![bins([9, 9], [9, 9])]).calibration(), None);
    }
}
