//! Leaps of T1 that stay: an error of a thermistor begins with one, and no heat makes one.

/// Rows over which a leap may be spread.
const WIDTHS: [usize; 3] = [1, 3, 6];
/// A leap is beyond so many times the spread of such differences, and so many degC.
const SPREADS: f64 = 8.0;
const LEAST: f64 = 1.5;
/// So much of it is still there behind it.
const STAYS: f64 = 0.7;
/// From the median of absolute values to a standard deviation.
const TO_SD: f64 = 1.4826;

/// A leap of T1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leap {
    /// The sample from which on T1 is further.
    pub at: usize,
    /// By how much, degC.
    pub by: f64,
}

/// A row: its sample, T1, and what a model leaves of it, degC.
pub(super) type Left = (usize, f64, f64);

/// The leaps of rows that follow one another, in order: in T1, and in what a model leaves of it.
pub(super) fn leaps(rows: &[Left]) -> Vec<Leap> {
    let (t, left): (Vec<f64>, Vec<f64>) = rows.iter().map(|(_, t, left)| (*t, *left)).unzip();
    let mut found: Vec<(usize, usize, Leap)> = Vec::new();
    for width in WIDTHS {
        let differences: Vec<f64> = (width..left.len()).map(|k| (left[k] - left[k - width]).abs()).collect();
        let least = (SPREADS * TO_SD * median(differences)).max(LEAST);
        let beyond = |k: usize| {
            let (own, theirs) = (alone(&t, k, width), alone(&left, k, width));
            (own * theirs > 0.0 && own.abs() > 0.5 * least)
                .then_some(theirs.abs())
                .filter(|size| *size > least)
        };
        let mut places: Vec<(usize, f64)> =
            (4 * width..t.len().saturating_sub(4 * width)).filter_map(|k| Some((k, beyond(k)?))).collect();
        places.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (k, size) in places {
            let near = |(other, wide, _): &(usize, usize, Leap)| k.abs_diff(*other) <= 3 * width.max(*wide);
            if found.iter().any(near) {
                continue;
            }
            let by = median(left[k + 1..k + 3 * width + 1].to_vec())
                - median(left[k - 3 * width - 1..k - width].to_vec());
            if by.abs() > STAYS * size && by * (left[k] - left[k - width]) > 0.0 {
                found.push((k, width, Leap { at: rows[k + 1 - width].0, by }));
            }
        }
    }
    found.sort_by_key(|(k, ..)| *k);
    found.into_iter().map(|(.., leap)| leap).collect()
}

/// How many rows at the end a model leaves more of than a leap would have to be.
pub(super) fn far_off_at_the_end(left: &[f64]) -> usize {
    let least = (SPREADS * TO_SD * median(left.iter().map(|e| e.abs()).collect())).max(LEAST);
    left.iter().rev().take_while(|e| e.abs() > least).count()
}

/// By how much a difference over so many rows is beyond each of the three before and behind it, with its sign.
fn alone(x: &[f64], k: usize, width: usize) -> f64 {
    let difference = |k: usize| x[k] - x[k - width];
    let beside = [1, 2, 3].map(|j| j * width);
    let others = beside.into_iter().flat_map(|j| [k.checked_sub(j), Some(k + j)]).flatten();
    let others = others.filter(|k| (width..x.len()).contains(k)).map(|k| difference(k).abs());
    let own = difference(k);
    own.signum() * (own.abs() - others.fold(0.0, f64::max)).max(0.0)
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sawtooth with noise, and what a model leaves of it.
    fn rows(more: impl Fn(usize) -> f64) -> Vec<Left> {
        let noise = |k: usize| 0.1 * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
        let at = |k: usize| (k, 40.0 + 0.5 * (k % 60) as f64 + noise(k) + more(k), noise(k) + more(k));
        (0..400).map(at).collect()
    }

    #[test]
    fn a_leap_is_found_at_once_or_over_some_rows() {
        for (over, near) in [(1, 0), (4, 3)] {
            let found = leaps(&rows(|k| 4.0 * ((k as f64 - 199.0) / f64::from(over)).clamp(0.0, 1.0)));
            let [leap] = found[..] else { panic!("{over}: {found:?}") };
            assert!(leap.at.abs_diff(200) <= near && (leap.by - 4.0).abs() < 0.3, "{over}: {leap:?}");
        }
    }

    #[test]
    fn what_is_far_off_at_the_end_is_counted_from_where_it_begins() {
        let of =
            |last: usize| (0..400).map(|k| if k < 400 - last { 0.1 } else { -9.0 }).collect::<Vec<f64>>();
        assert_eq!([0, 1, 6].map(|last| far_off_at_the_end(&of(last))), [0, 1, 6]);
    }

    #[test]
    fn what_is_back_or_grows_slowly_is_none() {
        assert_eq!(leaps(&rows(|_| 0.0)), []);
        assert_eq!(leaps(&rows(|k| if (200..202).contains(&k) { 4.0 } else { 0.0 })), []);
        assert_eq!(leaps(&rows(|k| 0.05 * k.saturating_sub(200) as f64)), []);
    }
}
