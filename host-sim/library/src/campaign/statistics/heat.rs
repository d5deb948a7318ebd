//! The heat of many runs, and which of their trips were right.

use serde::Serialize;

use super::Case;
use crate::campaign::run::heat::Heat;

/// The heat of some runs. Worst values are of those that did not trip before the fault, which tried nothing; null where
/// it never came to that in one of them, or none is left.
#[derive(Clone, Debug, Default, Serialize)]
pub struct HeatStatistics {
    /// Runs that tripped, %.
    pub tripped_pct: f64,
    /// Runs that tripped for a reason that the cell does not allow, or before the fault, %.
    pub tripped_otherwise_pct: f64,
    /// Runs that tripped before the fault.
    pub tripped_early: usize,
    /// Why they tripped, and how many of them, most first; but those that tripped before the fault.
    pub reasons: Vec<(String, usize)>,
    /// Highest true temperature of the air over the set-point, degC.
    pub overshoot_max_c: Option<f64>,
    /// Onset to heater off, s.
    pub off_delay_max_s: Option<f64>,
    /// From when it could be seen to heater off, s.
    pub off_after_visible_max_s: Option<f64>,
    /// Longest time at full power, s.
    pub saturated_max_s: Option<f64>,
    /// Longest time at too much power, s.
    pub overpower_max_s: Option<f64>,
}

impl HeatStatistics {
    /// Of some runs.
    pub fn new(cases: &[Case]) -> Self {
        let percent = |is: &dyn Fn(&Case) -> bool| {
            100.0 * cases.iter().filter(|case| is(case)).count() as f64 / cases.len().max(1) as f64
        };
        let worst = |of: &dyn Fn(&Heat) -> Option<f64>| {
            let tried = cases.iter().filter(|case| !tripped_early(case));
            let all = tried.map(|(_, row)| of(&row.heat).unwrap_or(f64::INFINITY));
            all.max_by(f64::total_cmp).filter(|x| x.is_finite())
        };
        Self {
            tripped_pct: percent(&|(_, row)| row.heat.trip.is_some()),
            tripped_otherwise_pct: percent(&tripped_otherwise),
            tripped_early: cases.iter().filter(|case| tripped_early(case)).count(),
            reasons: reasons(cases),
            overshoot_max_c: worst(&|h| Some(h.overshoot_max_c)),
            off_delay_max_s: worst(&|h| h.off_delay_s),
            off_after_visible_max_s: worst(&|h| h.off_after_visible_s),
            saturated_max_s: worst(&|h| Some(h.saturated_s)),
            overpower_max_s: worst(&|h| h.overpower_s),
        }
    }
}

fn tripped_early((_, row): &Case) -> bool {
    row.heat.tripped_s.zip(row.onset_s).is_some_and(|(tripped, onset)| tripped < onset)
}

fn tripped_otherwise(case: &Case) -> bool {
    let (cell, row) = case;
    row.heat.trip.is_some_and(|reason| tripped_early(case) || !cell.may_trip.allows(reason))
}

fn reasons(cases: &[Case]) -> Vec<(String, usize)> {
    let mut counts: Vec<(String, usize)> = Vec::new();
    let tried = cases.iter().filter(|case| !tripped_early(case));
    for reason in tried.filter_map(|(_, row)| row.heat.trip).map(|reason| reason.name()) {
        match counts.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => counts.push((reason.to_owned(), 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

#[cfg(test)]
mod tests {
    use fdi_core::{Config, TripReason};

    use super::*;
    use crate::campaign::cell::Cell;
    use crate::campaign::definition::Campaign;
    use crate::campaign::run::RunRow;

    /// A run whose fault came at 20 s and that tripped at `tripped`, if it did.
    fn heat(tripped: Option<f64>) -> Heat {
        Heat {
            trip: tripped.map(|_| TripReason::T2OverTemperature),
            tripped_s: tripped,
            off_delay_s: tripped.map(|t| t - 20.0).filter(|delay| *delay >= 0.0),
            overshoot_max_c: 5.0,
            ..Heat::default()
        }
    }

    fn statistics(may_trip: &str, heats: &[Heat]) -> HeatStatistics {
        let text = format!(
            "[[cell]]\nname = \"c\"\nruns = 1\nmay_trip = {may_trip}\n\
             fault = [{{ do = \"open\", sensor = \"t1\", at = 20.0, for = 9.0 }}]"
        );
        let campaign: Campaign = toml::from_str(&text).unwrap();
        let cells: Vec<Cell> = campaign.expand(&Config::default()).unwrap();
        let rows =
            heats.iter().map(|heat| RunRow { heat: heat.clone(), onset_s: Some(20.0), ..RunRow::default() });
        let rows: Vec<RunRow> = rows.collect();
        HeatStatistics::new(&rows.iter().map(|row| (&cells[0], row)).collect::<Vec<_>>())
    }

    #[test]
    fn the_worst_counts_and_a_run_that_was_never_off_is_worse() {
        let [soon, late, early, never] = [Some(22.0), Some(26.0), Some(15.0), None].map(heat);
        let of = statistics("true", &[soon.clone(), late, early.clone()]);
        assert_eq!((of.off_delay_max_s, of.tripped_early), (Some(6.0), 1));
        assert_eq!(of.reasons, [("t2_over_temperature".to_owned(), 2)]);
        assert_eq!(statistics("true", &[soon, never]).off_delay_max_s, None);
        assert_eq!(statistics("true", &[early]).overshoot_max_c, None, "nothing was tried");
    }

    #[test]
    fn a_trip_is_right_for_the_reasons_that_the_cell_allows() {
        let (late, early) = (heat(Some(26.0)), heat(Some(15.0)));
        let otherwise =
            |may_trip, heat: &Heat| statistics(may_trip, std::slice::from_ref(heat)).tripped_otherwise_pct;
        assert_eq!(otherwise("[\"t2_over_temperature\"]", &late), 0.0);
        assert_eq!(otherwise("[\"t1_open\"]", &late), 100.0);
        assert_eq!((otherwise("true", &late), otherwise("false", &late)), (0.0, 100.0));
        assert_eq!(otherwise("true", &early), 100.0, "before the fault none is right");
    }
}
