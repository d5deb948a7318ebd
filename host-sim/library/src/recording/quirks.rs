//! What logs hold that no rig had: noughts before the first conversion, and what was said last, repeated after a shutdown.

use std::ops::Range;

use fdi_core::Observed;

/// A temperature that begins with 0.0 and is so far from it next was not 0.
const FAR: f32 = 5.0;
/// A controller whose power and T1 both stand still for so many samples has ended.
const ENDED: usize = 30;

/// Takes out what is none, and says so.
pub(super) fn take_out(samples: &mut [Observed], sessions: &[Range<usize>], full_power: f32) -> Vec<String> {
    let (mut noughts, mut repeated) = (0, 0);
    let is_controlled = is_controlled(samples, sessions);
    for session in sessions {
        let samples = &mut samples[session.clone()];
        noughts += (0..3).map(|which| start_values(samples, which)).sum::<usize>();
        repeated += if is_controlled { after_the_end(samples, full_power) } else { 0 };
    }
    let mut remarks = Vec::new();
    if noughts > 0 {
        remarks.push(format!(
            "{noughts} temperatures at the beginning are 0 before any was measured: taken as not known."
        ));
    }
    if repeated > 0 {
        remarks.push(format!(
            "{repeated} samples at the end of a session repeat power and T1 to the last digit, as a log does after a shutdown: not judged."
        ));
    }
    remarks
}

/// Noughts until the first temperature; how many there were.
fn start_values(samples: &mut [Observed], which: usize) -> usize {
    let begun = samples.iter().position(|sample| sample.t[which].is_some_and(|t| t != 0.0)).unwrap_or(0);
    let is_far = samples.get(begun).and_then(|sample| sample.t[which]).is_some_and(|t| t.abs() > FAR);
    let noughts = samples[..begun].iter_mut().filter(|sample| is_far && sample.t[which].is_some());
    // What the power is before anything is measured is no more known.
    noughts.map(|sample| *sample = Observed::default()).count()
}

/// Whether the power moves at most samples.
fn is_controlled(samples: &[Observed], sessions: &[Range<usize>]) -> bool {
    let pairs = || sessions.iter().flat_map(|session| samples[session.clone()].windows(2));
    let moves = pairs().filter(|pair| pair[0].power != pair[1].power).count();
    2 * moves > pairs().count()
}

/// All that the end of a session repeats, where the power is neither off nor full: a controller that was at work would move it.
fn after_the_end(samples: &mut [Observed], full_power: f32) -> usize {
    let Some(last) = samples.last().copied() else { return 0 };
    let works = last.power.is_some_and(|power| power > 0.0 && power < full_power) && last.t[1].is_some();
    let same = |sample: &Observed| sample.power == last.power && sample.t[1] == last.t[1];
    let first = samples.iter().rposition(|sample| !same(sample)).map_or(0, |k| k + 1);
    // The first of them was measured.
    let repeated = samples.get_mut(first + 1..).filter(|repeated| works && repeated.len() >= ENDED);
    repeated.map_or(0, |repeated| {
        repeated.fill(Observed::default());
        repeated.len()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole() -> Vec<Range<usize>> {
        std::iter::once(0..200).collect()
    }

    fn samples(of: impl Fn(usize) -> (f32, f32)) -> Vec<Observed> {
        let sample = |k| {
            let (t1, power) = of(k);
            Observed { t: [None, Some(t1), None], power: Some(power), ..Observed::default() }
        };
        (0..200).map(sample).collect()
    }

    #[test]
    fn noughts_before_the_first_temperature_are_none_and_a_frost_is_one() {
        let mut log = samples(|k| (if k % 100 < 3 { 0.0 } else { 24.0 }, k as f32 / 400.0));
        assert_eq!(take_out(&mut log, &[0..100, 100..200], 1.0).len(), 1);
        assert_eq!(log.iter().filter(|sample| sample.t[1].is_none()).count(), 6);
        let mut frost = samples(|k| (0.1 * (k / 20) as f32, k as f32 / 400.0));
        assert!(take_out(&mut frost, &whole(), 1.0).is_empty());
    }

    #[test]
    fn what_is_repeated_after_a_shutdown_is_not_judged() {
        let frozen =
            |k: usize| if k < 150 { (200.0 + 0.1 * (k % 7) as f32, k as f32 / 400.0) } else { (187.3, 0.7) };
        let mut log = samples(frozen);
        let said = take_out(&mut log, &whole(), 1.0);
        assert!(said[0].starts_with("49 samples"), "{said:?}");
        assert_eq!(log.iter().filter(|sample| sample.power.is_none()).count(), 49);
        // Full power, no power, or somebody who sets it by hand: T1 may well stand still.
        for power in [0.0, 1.0] {
            let mut log = samples(|k| if k < 150 { frozen(k) } else { (187.3, power) });
            assert!(take_out(&mut log, &whole(), 1.0).is_empty(), "{power}");
        }
        let mut by_hand = samples(|k| if k < 150 { (frozen(k).0, 0.3) } else { (187.3, 0.7) });
        assert!(take_out(&mut by_hand, &whole(), 1.0).is_empty());
    }
}
