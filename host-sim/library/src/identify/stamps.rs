//! The times at which the rows were recorded, where a column tells them: are they even, and do they agree with --ts?

use std::ops::Range;

use super::warning::Warning;
use crate::recording::table::Table;

/// A step between rows that differs from the usual one by more than this share of it is no jitter: a row is missing, is
/// there twice, or was late.
const UNEVEN: f64 = 0.2;
/// --ts may differ from the steps by this share.
const CONTRADICTION: f64 = 0.02;

/// A column of times.
#[derive(Clone, Debug)]
pub struct Stamps {
    /// Its name.
    column: String,
    /// First row that was looked at.
    from: usize,
    /// From each row to the next, s.
    steps: Vec<f64>,
    /// The median step, s.
    pub usual: f64,
}

impl Stamps {
    /// The first column whose name is that of a time; without a header the first column, if it rises throughout and does
    /// not merely count the rows. `None` if there is none, or it holds dates.
    pub fn find(table: &Table, (u, y): (usize, usize), rows: &Range<usize>) -> Option<Self> {
        let column = match table.has_header() {
            true => (0..table.width()).find(|&column| is_time(&table.name(column)))?,
            false => 0,
        };
        let times = table.values(column, rows.clone()).ok()?;
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut sorted = steps.clone();
        sorted.sort_by(f64::total_cmp);
        // To the nanosecond: 0.11, and not the 0.11000000000001364 of 187.11 - 187.
        let usual = (sorted.get(sorted.len() / 2)? * 1e9).round() / 1e9;
        let rises = sorted[0] > 0.0 && sorted.iter().any(|step| *step != 1.0);
        let found = column != u && column != y && usual > 0.0 && (table.has_header() || rises);
        found.then(|| Self { column: table.name(column), from: rows.start, steps, usual })
    }

    /// What the times say against the model.
    pub fn warnings(&self, ts: f64) -> Vec<Warning> {
        [self.uneven(), self.contradiction(ts)].into_iter().flatten().collect()
    }

    fn uneven(&self) -> Option<Warning> {
        let is_uneven = |step: &&f64| (*step - self.usual).abs() > UNEVEN * self.usual;
        let places = self.steps.iter().filter(is_uneven).count();
        let first = self.steps.iter().position(|step| is_uneven(&step))?;
        Some(Warning::TimesUneven {
            column: self.column.clone(),
            row: self.from + first + 1,
            step_s: self.steps[first],
            usual_s: self.usual,
            places,
        })
    }

    fn contradiction(&self, ts: f64) -> Option<Warning> {
        // Times that are rounded to a tenth of a second have steps of 0.1 and 0.2 s for 0.11 s, with the right mean.
        let mean = self.steps.iter().sum::<f64>() / self.steps.len() as f64;
        let differs = |step: f64| (step - ts).abs() > CONTRADICTION * ts;
        (differs(mean) && differs(self.usual)).then(|| Warning::TimesContradictTs {
            column: self.column.clone(),
            usual_s: self.usual,
            ts_s: ts,
        })
    }
}

/// `t`, `t_s`, `Time (s)`, `time/s`, `seconds` .. but not `T1` or `throttle`.
fn is_time(name: &str) -> bool {
    let first = name.split(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
    first == "t" || ["time", "timestamp", "seconds"].contains(&first.to_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns t, u, y with these times.
    fn stamps(header: &str, times: &[f64]) -> Option<Stamps> {
        let rows: String = times.iter().map(|t| format!("{t},1,2\n")).collect();
        let table = Table::parse("f".into(), &format!("{header}{rows}")).unwrap();
        Stamps::find(&table, (1, 2), &(0..times.len()))
    }

    fn even(step: f64) -> Vec<f64> {
        (0..100).map(|k| f64::from(k) * step).collect()
    }

    #[test]
    fn a_column_of_times_is_known_by_its_name_or_because_it_rises() {
        for header in ["t,u,y\n", "t_s,u,y\n", "Time (s),u,y\n", "\"t, s\",u,y\n", "TIME,u,y\n", ""] {
            assert_eq!(stamps(header, &even(0.5)).unwrap().usual, 0.5, "{header}");
        }
        for header in ["T,u,y\n", "T1,u,y\n", "throttle,u,y\n"] {
            assert!(stamps(header, &even(0.5)).is_none(), "{header}");
        }
        assert!(stamps("", &even(1.0)).is_none(), "this may as well count the rows");
        assert!(stamps("", &[3.0, 1.0, 2.0]).is_none() && stamps("t,u,y\n", &[1.0]).is_none());
    }

    #[test]
    fn gaps_are_told_with_the_row_behind_them_and_jitter_is_not() {
        let mut times = even(0.5);
        times[50..].iter_mut().for_each(|t| *t += 1.0);
        times[80..].iter_mut().for_each(|t| *t += 0.03);
        let warnings = stamps("t,u,y\n", &times).unwrap().warnings(0.5);
        let [Warning::TimesUneven { row: 50, places: 1, step_s, .. }] = warnings[..] else {
            panic!("{warnings:?}")
        };
        assert!((step_s - 1.5).abs() < 1e-9);
    }

    #[test]
    fn another_ts_than_the_times_have_is_told() {
        let found = stamps("t,u,y\n", &even(1.0)).unwrap();
        assert_eq!(found.warnings(1.0), []);
        assert!(matches!(found.warnings(0.11)[..], [Warning::TimesContradictTs { ts_s: 0.11, .. }]));
        let rounded: Vec<f64> = even(0.11).into_iter().map(|t| (t * 10.0).round() / 10.0).collect();
        let warnings = stamps("t,u,y\n", &rounded).unwrap().warnings(0.11);
        assert!(!warnings.iter().any(|w| matches!(w, Warning::TimesContradictTs { .. })), "{warnings:?}");
    }
}
