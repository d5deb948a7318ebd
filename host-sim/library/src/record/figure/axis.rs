//! Ranges that the bulk of a signal decides and not its worst sample, and round numbers for the ticks.

/// Share of the samples at each end that may fall outside the bulk.
const TAIL: f64 = 0.001;
/// So far beyond the bulk, in widths of it, an extreme is still shown.
const REACH: f64 = 0.25;
/// Margin at each end, in widths of the range.
const MARGIN: f64 = 0.06;

/// Lower and upper end of an axis for `values`; finite, and never empty. All of `always` is within, and the range
/// is `min_span` wide at least, so that a constant stays a line in the middle and quiet noise looks quiet.
pub(crate) fn range(values: Vec<f64>, always: &[f64], min_span: f64) -> (f64, f64) {
    let bulk = bulk(values);
    let ends = || always.iter().copied().filter(|x| x.is_finite()).chain(bulk.into_iter().flatten());
    let low = ends().min_by(f64::total_cmp).unwrap_or(0.0);
    let high = ends().max_by(f64::total_cmp).unwrap_or(0.0);
    let span = (high - low).max(min_span).max(1e-6 * low.abs().max(high.abs()));
    let (middle, half) = (0.5 * (low + high), span * (0.5 + MARGIN));
    (middle - half, middle + half)
}

/// Ends of the bulk, with the extremes that lie near it.
fn bulk(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.retain(|x| x.is_finite());
    values.sort_unstable_by(f64::total_cmp);
    let (&min, &max) = (values.first()?, values.last()?);
    let skip = (TAIL * values.len() as f64) as usize;
    let (low, high) = (values[skip], values[values.len() - 1 - skip]);
    let reach = REACH * (high - low);
    Some([min.max(low - reach), max.min(high + reach)])
}

/// Multiples of 1, 2 or 5 times a power of ten within a range, at most `count` + 1 of them, with their labels.
pub(crate) fn ticks((low, high): (f64, f64), count: u32) -> Vec<(f64, String)> {
    let step = round_up((high - low) / f64::from(count.max(1)));
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    let first = (low / step).ceil();
    let multiples = (0..=count).map(|i| (first + f64::from(i)) * step).take_while(|&x| x <= high);
    multiples.map(|x| (x, label(x, step, decimals))).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not less than `x`.
fn round_up(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= x * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// A number with a real minus sign, and no minus before a zero.
fn label(x: f64, step: f64, decimals: usize) -> String {
    let x = if x.abs() < 0.5 * step { 0.0 } else { x };
    format!("{x:.decimals$}").replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wild_sample_does_not_set_the_range() {
        let mut values: Vec<f64> = (0..5000).map(|i| f64::from(i % 100) / 100.0).collect();
        values[17] = 1e9;
        values.push(f64::NAN);
        let (low, high) = range(values, &[-2.0], 0.1);
        assert!(low < -2.0 && low > -2.5, "{low}");
        assert!((1.0..2.0).contains(&high), "{high}");
    }

    #[test]
    fn a_range_is_never_empty() {
        for values in [vec![], vec![f64::NAN], vec![35.0; 9], vec![1e30]] {
            let (low, high) = range(values, &[], 0.5);
            assert!(low < high && low.is_finite() && high.is_finite(), "{low} {high}");
            assert!(ticks((low, high), 4).len() <= 5);
        }
    }

    #[test]
    fn ticks_are_round_numbers_with_as_many_digits_as_they_need() {
        let labels = |range, count| -> Vec<String> { ticks(range, count).into_iter().map(|t| t.1).collect() };
        assert_eq!(labels((-0.11, 0.12), 4), ["\u{2212}0.1", "0.0", "0.1"]);
        assert_eq!(labels((0.0, 850.0), 9), ["0", "100", "200", "300", "400", "500", "600", "700", "800"]);
        assert_eq!(labels((0.27, 0.35), 5), ["0.28", "0.30", "0.32", "0.34"]);
    }
}
