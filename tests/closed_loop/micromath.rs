//! What docs/decisions/11-libm-not-micromath.md says of micromath's errors and of libm's.

use micromath::F32Ext;

/// The largest error over a range, as `off` measures it.
fn worst(from: f32, to: f32, of: fn(f32) -> f32, truth: fn(f64) -> f64, off: fn(f64, f64) -> f64) -> f64 {
    const STEPS: u16 = 20_000;
    let at = |k: u16| from + (to - from) * f32::from(k) / f32::from(STEPS);
    (0..=STEPS).map(at).map(|x| off(f64::from(of(x)), truth(f64::from(x)))).fold(0.0, f64::max)
}

fn absolute(is: f64, should: f64) -> f64 {
    (is - should).abs()
}

fn relative(is: f64, should: f64) -> f64 {
    absolute(is, should) / should
}

/// degC of a thermistor of 10 kOhm behind as much, by its share of the converter's scale.
fn celsius(share: f64, ln: impl Fn(f64) -> f64) -> f64 {
    1.0 / (1.0 / 298.15 + ln(share / (1.0 - share)) / 3950.0) - 273.15
}

#[test]
fn micromath_is_as_wrong_as_the_decision_says_and_libm_is_not() {
    let ln = [F32Ext::ln, libm::logf].map(|of| worst(0.01, 100.0, of, libm::log, absolute));
    assert!((0.11..0.125).contains(&ln[0]) && ln[1] < 3e-7, "{ln:?}");
    let exp = [F32Ext::exp, libm::expf].map(|of| worst(-10.0, 0.0, of, libm::exp, absolute));
    assert!((0.001..0.00125).contains(&exp[0]) && exp[1] < 5e-8, "{exp:?}");
    let sqrt = [F32Ext::sqrt, libm::sqrtf].map(|of| worst(1e-3, 1e3, of, libm::sqrt, relative));
    assert!((0.055..0.065).contains(&sqrt[0]) && sqrt[1] < 6e-8, "{sqrt:?}");
    let read = [F32Ext::ln as fn(f32) -> f32, libm::logf].map(|of| {
        let codes = (200..=3900).map(|code| f64::from(code) / 4095.0);
        let single = |x: f64| f64::from(of(x as f32));
        codes.map(|share| (celsius(share, single) - celsius(share, libm::log)).abs()).fold(0.0, f64::max)
    });
    assert!((4.0..4.2).contains(&read[0]) && read[1] < 1e-5, "{read:?}");
}
