//! Samples that follow one another.

use std::ops::Range;

/// A longer run of samples that the file has no row for is a gap.
pub const GAP: usize = 10;

/// Which samples lie between gaps of more than [`GAP`], by whether each is there.
pub fn stretches(is_there: impl IntoIterator<Item = bool>) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for (k, _) in is_there.into_iter().enumerate().filter(|(_, is)| *is) {
        match stretches.last_mut() {
            Some(last) if k - last.end <= GAP => last.end = k + 1,
            _ => stretches.push(k..k + 1),
        }
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_longer_than_ten_samples() {
        let with = |missing: usize| {
            let runs = [(3, true), (missing, false), (2, true), (40, false)];
            stretches(runs.into_iter().flat_map(|(count, is)| std::iter::repeat_n(is, count)))
        };
        assert_eq!((with(10).len(), with(10)[0].clone()), (1, 0..15));
        assert_eq!(with(11), [0..3, 14..16]);
    }
}
