//! Square root without the FPU's instruction, which stable Rust does not reach without `std`, and cheaper than software.

/// Square root of a number that is zero or positive and normal; zero for anything below.
///
/// By way of 1/sqrt(x), which takes no division: half the exponent, negated, is a guess within 4 %; each of three Newton
/// steps squares the relative error.
#[inline(never)]
pub(crate) fn sqrt(x: f32) -> f32 {
    const BIAS: u32 = 0x5F37_5A86;
    if !(x >= f32::MIN_POSITIVE) {
        return 0.0;
    }
    let half = 0.5 * x;
    let mut inverse = f32::from_bits(BIAS - (x.to_bits() >> 1));
    for _ in 0..3 {
        inverse *= 1.5 - half * inverse * inverse;
    }
    x * inverse
}

#[cfg(test)]
mod tests {
    use super::sqrt;

    #[test]
    fn agrees_with_a_square_root_in_f64() {
        for bits in (f32::MIN_POSITIVE.to_bits()..f32::MAX.to_bits()).step_by(9973) {
            let x = f32::from_bits(bits);
            let wanted = libm::sqrt(f64::from(x));
            let error = (f64::from(sqrt(x)) / wanted - 1.0).abs();
            assert!(error < 2e-7, "sqrt({x}) is {}, not {wanted}", sqrt(x));
        }
        for x in [0.0, -0.0, -1.0, 1e-40, f32::NAN] {
            assert_eq!(sqrt(x), 0.0);
        }
    }
}
