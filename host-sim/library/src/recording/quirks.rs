//! What logs hold that no rig had: noughts before the first conversion, error codes of sensors, readings that come alone, and what was said last, repeated
//! after a shutdown.

use std::ops::Range;

use fdi_core::Observed;

/// A temperature that begins with 0.0 and is so far from it next was not 0.
const FAR: f32 = 5.0;
/// A controller whose power and T1 both stand still for so many samples has ended.
const ENDED: usize = 30;

/// A reading is far beyond its neighbours where it is so many times their spread from their median, and at least so many degC. (Measured on 43 sessions of
/// printers: of those without an error code it takes 0.02 % of the rows.)
const SPREADS: f32 = 6.0;
const LEAST: f32 = 1.0;
/// The neighbours: so many rows before it, and behind it.
const BESIDE: usize = 3;
/// From the median of the distances to the median to a standard deviation.
const TO_SD: f32 = 1.4826;
/// What sensors read that have no reading, in their own unit: of DS18B20 (lost, not yet converted), of MAX6675, MAX31855 and MAX31865, of DHT22, and what
/// programs put in their place.
const CODES: [f32; 14] = [
    -127.0, 85.0, -999.0, -9999.0, 999.0, 9999.0, 0.0, 127.0, -196.6, 2047.75, 1023.75, 1024.0, 1300.0,
    -242.02,
];
/// A code that stays is one where T leaps to it by so many degC.
const LEAP: f32 = 10.0;

/// Takes out what is none, and says so; `celsius`: how many degC one unit of temperature counts for.
pub(super) fn take_out(
    samples: &mut [Observed],
    sessions: &[Range<usize>],
    full_power: f32,
    celsius: f32,
) -> Vec<String> {
    let (mut noughts, mut repeated, mut alone) = (0, 0, [0; 3]);
    let is_controlled = is_controlled(samples, sessions);
    for session in sessions {
        let samples = &mut samples[session.clone()];
        noughts += (0..3).map(|which| start_values(samples, which)).sum::<usize>();
        for (which, count) in alone.iter_mut().enumerate() {
            *count += codes(samples, which, celsius) + lone(samples, which, celsius);
        }
        repeated += if is_controlled { after_the_end(samples, full_power) } else { 0 };
    }
    let mut remarks = Vec::new();
    if noughts > 0 {
        remarks.push(format!(
            "{noughts} temperatures at the beginning are 0 before any was measured: taken as not known."
        ));
    }
    for (which, count) in alone.into_iter().enumerate().filter(|(_, count)| *count > 0) {
        remarks.push(format!(
            "Readings of T{which} that are far from those before and behind them, as error codes of a sensor are: {count}, taken as missing."
        ));
    }
    if repeated > 0 {
        remarks.push(format!(
            "{repeated} samples at the end of a session repeat power and T1 to the last digit, as a log does after a shutdown: not judged."
        ));
    }
    remarks
}

/// A fan that never moves is the usual one, whatever its level is called.
pub(super) fn constant_fan(samples: &mut [Observed]) -> Option<String> {
    let level = samples.iter().find_map(|sample| sample.fan)?;
    let is_constant = samples.iter().all(|sample| sample.fan.is_none_or(|fan| fan == level));
    if !is_constant || level == 100.0 {
        return None;
    }
    samples.iter_mut().for_each(|sample| sample.fan = None);
    Some(format!("The fan stands at {level} all the time: taken for its usual level."))
}

/// Noughts until the first temperature; how many there were.
fn start_values(samples: &mut [Observed], which: usize) -> usize {
    let begun = samples.iter().position(|sample| sample.t[which].is_some_and(|t| t != 0.0)).unwrap_or(0);
    let is_far = samples.get(begun).and_then(|sample| sample.t[which]).is_some_and(|t| t.abs() > FAR);
    let noughts = samples[..begun].iter_mut().filter(|sample| is_far && sample.t[which].is_some());
    // What the power is before anything is measured is no more known.
    noughts.map(|sample| *sample = Observed::default()).count()
}

/// Codes to which a temperature leaps, however long they stay; how many there were.
fn codes(samples: &mut [Observed], which: usize, celsius: f32) -> usize {
    let is_code = |t: f32| CODES.iter().any(|code| (t - code).abs() < 0.005);
    let (mut count, mut last) = (0, None::<f32>);
    // What a rig read before its first code is not known: what follows shows how far that is.
    let first = samples.iter().filter_map(|sample| sample.t[which]).find(|t| !is_code(*t));
    for sample in samples {
        let Some(t) = sample.t[which] else { continue };
        let far = |from: f32| (t - from).abs() * celsius > LEAP;
        if is_code(t) && last.or(first).is_some_and(far) {
            (sample.t[which], count) = (None, count + 1);
        } else {
            last = Some(t);
        }
    }
    count
}

/// Readings that come alone, or two or three of them, are far beyond their neighbours, and are back on the next row; how many there were. It is Hampel's
/// identifier beside the slope that the neighbours have.
fn lone(samples: &mut [Observed], which: usize, celsius: f32) -> usize {
    let there: Vec<(usize, f32)> =
        samples.iter().enumerate().filter_map(|(k, sample)| Some((k, sample.t[which]?))).collect();
    let t: Vec<f32> = there.iter().map(|(_, t)| *t).collect();
    let far: Vec<Option<f32>> = (0..t.len()).map(|i| far(&t, i, LEAST / celsius.min(1.0))).collect();
    let mut count = 0;
    let mut i = 0;
    while i < t.len() {
        let run = far[i..].iter().take_while(|far| far.is_some()).count();
        // A kink is far beyond the slope on one side of it, and on the way from one side to the other.
        let (before, behind) = (i.checked_sub(1).map(|b| t[b]), t.get(i + run).copied());
        for j in i..i + run {
            let share = (j + 1 - i) as f32 / (run + 1) as f32;
            let on_the_way = before.zip(behind).map(|(a, b)| a + share * (b - a));
            if on_the_way.is_none_or(|x| far[j].is_some_and(|least| (t[j] - x).abs() > least)) {
                (samples[there[j].0].t[which], count) = (None, count + 1);
            }
        }
        i += run.max(1);
    }
    count
}

/// By how much a reading would have to be off its neighbours, where it is by more.
fn far(t: &[f32], i: usize, least: f32) -> Option<f32> {
    const WIDTH: usize = 2 * BESIDE + 1;
    let begin = i.saturating_sub(BESIDE).min(t.len().saturating_sub(WIDTH));
    let window = t.get(begin..begin + WIDTH)?;
    let mut steps: [f32; WIDTH - 1] = std::array::from_fn(|j| window[j + 1] - window[j]);
    let slope = *steps.select_nth_unstable_by(BESIDE, f32::total_cmp).1;
    let level: [f32; WIDTH] = std::array::from_fn(|j| window[j] - slope * j as f32);
    let median = |mut of: [f32; WIDTH]| *of.select_nth_unstable_by(BESIDE, f32::total_cmp).1;
    let middle = median(level);
    let least = (SPREADS * TO_SD * median(level.map(|x| (x - middle).abs()))).max(least);
    ((level[i - begin] - middle).abs() > least).then_some(least)
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
        assert_eq!(take_out(&mut log, &[0..100, 100..200], 1.0, 1.0).len(), 1);
        assert_eq!(log.iter().filter(|sample| sample.t[1].is_none()).count(), 6);
        let mut frost = samples(|k| (0.1 * (k / 20) as f32, k as f32 / 400.0));
        assert!(take_out(&mut frost, &whole(), 1.0, 1.0).is_empty());
    }

    /// A code that comes alone, one that stays, and one that is first; a step that stays and a slow way through 85 degC are none.
    #[test]
    fn error_codes_and_lone_readings_are_missing() {
        let ramp = |k: usize| 40.0 + 0.3 * k as f32 + 0.05 * (k % 3) as f32;
        let odd = |k: usize| match k {
            0 | 50 => 85.0,
            70 => -127.0,
            100..130 => 2047.75,
            140 => ramp(k) + 3.0,
            160.. => ramp(k) + 4.0,
            _ => ramp(k),
        };
        let mut log = samples(|k| (odd(k), k as f32 / 400.0));
        let said = take_out(&mut log, &whole(), 1.0, 1.0);
        assert!(said[0].ends_with(": 34, taken as missing."), "{said:?}");
        let missing: Vec<usize> = (0..200).filter(|k| log[*k].t[1].is_none()).collect();
        let expected: Vec<usize> = [0, 50, 70].into_iter().chain(100..130).chain([140]).collect();
        assert_eq!(missing, expected);
    }

    #[test]
    fn what_is_repeated_after_a_shutdown_is_not_judged() {
        let frozen =
            |k: usize| if k < 150 { (200.0 + 0.1 * (k % 7) as f32, k as f32 / 400.0) } else { (187.3, 0.7) };
        let mut log = samples(frozen);
        let said = take_out(&mut log, &whole(), 1.0, 1.0);
        assert!(said[0].starts_with("49 samples"), "{said:?}");
        assert_eq!(log.iter().filter(|sample| sample.power.is_none()).count(), 49);
        // Full power, no power, or somebody who sets it by hand: T1 may well stand still.
        for power in [0.0, 1.0] {
            let mut log = samples(|k| if k < 150 { frozen(k) } else { (187.3, power) });
            assert!(take_out(&mut log, &whole(), 1.0, 1.0).is_empty(), "{power}");
        }
        let mut by_hand = samples(|k| if k < 150 { (frozen(k).0, 0.3) } else { (187.3, 0.7) });
        assert!(take_out(&mut by_hand, &whole(), 1.0, 1.0).is_empty());
    }
}
