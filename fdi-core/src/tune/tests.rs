extern crate std;

use super::*;

/// Runs the experiment on a lag with dead time in samples.
fn run(gain: f32, time: f32, dead: usize, noise: f32) -> Result<Lag, Unclear> {
    let ts = 0.11;
    let mut tuning = Tuning::new(Powers::for_gain(0.3, Percent(100.0)), Seconds(ts));
    let (mut y, mut waiting, mut random) = (0.0f32, std::vec![0.0f32; dead], 1u32);
    for _ in 0..100_000 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let shaken = 22.0 + y + noise * (random as f32 / u32::MAX as f32 - 0.5);
        let Percent(power) = tuning.step(Some(Celsius(shaken)));
        assert!((0.0..=64.0).contains(&power));
        if let Some(result) = tuning.result() {
            assert_eq!(power, 0.0);
            return result;
        }
        waiting.push(power);
        y += (1.0 - libm::expf(-ts / time)) * (gain * waiting.remove(0) - y);
    }
    panic!("it does not end");
}

#[test]
fn a_lag_with_dead_time_is_found() {
    for (gain, time, dead) in [(0.3, 0.5, 1), (0.15, 1.0, 3), (0.6, 0.4, 2), (0.3, 3.0, 4)] {
        let lag = run(gain, time, dead, 0.1).expect("clear");
        let sampled = dead as f32 * 0.11 + 0.055; // a power that is held lags by half a sample
        assert!((lag.gain / gain - 1.0).abs() < 0.05, "{lag:?} of {gain} {time} {dead}");
        assert!((lag.time / time - 1.0).abs() < 0.25, "{lag:?} of {gain} {time} {dead}");
        assert!((lag.dead - sampled).abs() < 0.06, "{lag:?} of {gain} {time} {dead}");
    }
}

#[test]
fn what_is_unclear_ends_it() {
    assert_eq!(run(0.01, 0.5, 1, 0.1), Err(Unclear::NoAnswer));
    assert_eq!(run(3.0, 0.5, 1, 0.1), Err(Unclear::TooHot));
    assert_eq!(run(0.3, 300.0, 1, 0.0), Err(Unclear::NotStill));
    let mut tuning = Tuning::new(Powers::for_gain(0.3, Percent(100.0)), Seconds(0.11));
    for _ in 0..100 {
        tuning.step(Some(Celsius(22.0)));
    }
    assert!(tuning.step(None).0 > 0.0, "a spike is none");
    for _ in 0..3 {
        tuning.step(None);
    }
    assert_eq!(tuning.result(), Some(Err(Unclear::NoSample)));
    assert_eq!(tuning.step(Some(Celsius(22.0))), Percent(0.0), "for good");
}

#[test]
fn rules_have_the_margins_that_they_are_known_for() {
    let lag = Lag { gain: 0.3, time: 2.0, dead: 0.4 };
    let ts = Seconds(0.01);
    let margins = lag.margins(&lag.by_model(), ts).expect("stable");
    assert!(
        (margins.gain - core::f32::consts::PI).abs() < 0.1 && (margins.phase - 61.4).abs() < 2.0,
        "{margins:?}"
    );
    let tyreus = lag.margins(&lag.by_oscillation(ts).expect("oscillates"), ts).expect("stable");
    assert!((2.5..4.0).contains(&tyreus.gain), "{tyreus:?}");
    let wild = Tuned { kp: 100.0, ..lag.by_model() };
    assert_eq!(lag.margins(&wild, ts), None);
}

#[test]
fn powers_stay_below_what_the_rig_may_be_given() {
    for (gain, most) in [(0.01, 100.0), (0.3, 100.0), (0.3, 20.0), (f32::NAN, 30.0), (10.0, 1.0)] {
        let Powers { mean, swing } = Powers::for_gain(gain, Percent(most));
        assert!(mean.0 > 0.0 && swing.0 < mean.0 && mean.0 + swing.0 <= 1.0001 * most, "{mean:?} {swing:?}");
    }
}

/// Out of the air with the relay high it would stay high.
#[test]
fn a_t1_that_falls_while_the_relay_swings_ends_it_at_once() {
    let mut tuning = Tuning::new(Powers::for_gain(0.3, Percent(100.0)), Seconds(0.11));
    let (mut y, mut ticks) = (0.0, 0);
    while !matches!(tuning.standing(), Standing::Swing) {
        let Percent(power) = tuning.step(Some(Celsius(22.0 + y)));
        y += 0.2 * (0.3 * power - y);
        ticks += 1;
        assert!(ticks < 1000);
    }
    assert!(tuning.step(Some(Celsius(22.0 + y))).0 > 0.0);
    assert_eq!(tuning.step(Some(Celsius(22.5))), Percent(0.0));
    assert_eq!(tuning.result(), Some(Err(Unclear::Fell)));
}

#[test]
fn it_ends_whatever_t1_does() {
    for seed in 0..50u32 {
        let mut tuning = Tuning::new(Powers::for_gain(0.3, Percent(100.0)), Seconds(0.11));
        let (mut y, mut random) = (0.0f32, seed);
        let ended = (0..MOST_TICKS + 2).any(|k| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let wild = random as f32 / u32::MAX as f32 - 0.5;
            y += 0.1 * (10.0 * (seed % 3) as f32 - y) + wild * (seed % 7) as f32;
            let t1 = (k % (seed + 2) != 0).then_some(Celsius(22.0 + y));
            let Percent(power) = tuning.step(t1);
            assert!((0.0..=64.0).contains(&power));
            tuning.result().is_some()
        });
        assert!(ended, "seed {seed}: {:?}", tuning.standing());
    }
}

/// T1 swings around the level at another pace each time, so that no period is ever kept: it ends by the ticks of the whole.
#[test]
fn a_relay_that_never_keeps_its_period_ends_by_time() {
    let mut tuning = Tuning::new(Powers::for_gain(0.3, Percent(100.0)), Seconds(0.11));
    let (mut random, mut left, mut above) = (1u32, 0, false);
    for tick in 0..MOST_TICKS {
        let swings = matches!(tuning.standing(), Standing::Swing | Standing::Measure);
        if swings && left == 0 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (left, above) = (100 + (random >> 16) % 350, !above);
        }
        left = left.saturating_sub(1);
        let t1 = match (tick < REST, swings) {
            (true, _) => 22.0,
            (false, false) => 32.0,
            (false, true) => 32.0 + if above { 1.0 } else { -1.0 },
        };
        tuning.step(Some(Celsius(t1)));
        assert_eq!(tuning.result(), None, "tick {tick}");
    }
    assert_eq!(tuning.standing(), Standing::Measure);
    assert_eq!(tuning.step(Some(Celsius(32.0))), Percent(0.0));
    assert_eq!(tuning.result(), Some(Err(Unclear::NoSwing)));
}
