//! What the numbers of a recording are in, where nobody says it.

use super::map::Role;
use super::{Heater, names};

/// A T1 that moves by so much is in degC; one that does not is made to move by so much.
const SPANS: (f64, f64) = (5.0, 1000.0);
const TYPICAL_SPAN: f64 = 30.0;

/// The power that is full one, by what there is: a switch or a share, %, the counts of a timer, or the largest.
pub(super) fn full_power(heaters: &[Heater]) -> f64 {
    /// What a power may be a little above the full one when it is measured.
    const ABOVE: f64 = 1.001;
    const USUAL: [f64; 2] = [1.0, 100.0];
    const COUNTS: [f64; 4] = [255.0, 1023.0, 4095.0, 65_535.0];
    let is_watts = |heater: &Heater| {
        let words = heater.map.column(Role::Power).map(names::words).unwrap_or_default();
        words.last().is_some_and(|word| ["w", "watt", "watts"].contains(&word.as_str()))
    };
    let powers = || heaters.iter().flat_map(|heater| &heater.samples).filter_map(|sample| sample.power);
    let (_, most) = span(powers());
    let is_whole = powers().all(|power| power.fract() == 0.0);
    let counts = COUNTS.into_iter().filter(|_| is_whole);
    if heaters.iter().all(is_watts) {
        return most;
    }
    let found = USUAL.into_iter().chain(counts).find(|full| most <= ABOVE * full);
    found.unwrap_or(most)
}

/// How many degC one unit of a temperature should count for: 1, but where T1 moves by so little or so much that its unit is no degC.
pub(super) fn celsius(heaters: &[Heater]) -> f64 {
    let t1 = heaters.iter().flat_map(|heater| &heater.samples).filter_map(|sample| sample.t[1]);
    let (low, high) = span(t1);
    let span = high - low;
    if !(span > 0.0) || (SPANS.0..SPANS.1).contains(&span) {
        return 1.0;
    }
    let exact = TYPICAL_SPAN / span;
    let decade = 10f64.powf(exact.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    steps.into_iter().min_by(|a, b| (a / exact).ln().abs().total_cmp(&(b / exact).ln().abs())).unwrap_or(1.0)
}

/// The lowest and the highest of some values, but for those that are so far from all others that no rig has been there: one odd row must not
/// say what the unit is, or what the gain.
pub fn span(values: impl Iterator<Item = f32>) -> (f64, f64) {
    /// What lies beyond the middle 98 % by so many times their spread.
    const FAR: f32 = 20.0;
    let mut values: Vec<f32> = values.filter(|x| x.is_finite()).collect();
    let mut quantile = |share: f64| {
        let place = (share * values.len().saturating_sub(1) as f64).round() as usize;
        let all = !values.is_empty();
        if all { *values.select_nth_unstable_by(place, f32::total_cmp).1 } else { f32::NAN }
    };
    let [low, high] = [0.01, 0.99].map(&mut quantile);
    let far = FAR * (high - low);
    let near = |x: &f32| !(far > 0.0) || (low - far..=high + far).contains(x);
    let kept = values.into_iter().filter(near).map(f64::from);
    kept.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
}
