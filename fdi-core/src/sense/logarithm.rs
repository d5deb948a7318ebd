//! Natural logarithm for the thermistor: a polynomial of degree 6, a third cheaper than `libm::logf`.
//!
//! `x = 2^k m` with m from sqrt(1/2) to sqrt(2); `ln x = k ln 2 + ln m`. The polynomial is the minimax fit of ln(1 + t) on
//! that interval that is zero at t = 0 (Remez exchange in f64, then rounded). Its largest error, 1.5e-6, is 5e-5 degC at
//! 100 degC, a hundredth of one count of the converter.

/// ln(1 + t) = t (C[0] + t (C[1] + ...)).
const C: [f32; 6] = [1.000_012_8, -0.499_850_5, 0.332_258_73, -0.254_724_62, 0.223_300_7, -0.143_198_53];

/// Bits of sqrt(1/2), where the mantissa wraps.
const LOWEST_MANTISSA: u32 = 0x3F35_04F3;
const MANTISSA_BITS: u32 = 23;

/// ln of a positive normal number; anything else gives some finite number.
#[inline]
pub(super) fn ln(x: f32) -> f32 {
    let bits = x.to_bits();
    let k = (bits.wrapping_sub(LOWEST_MANTISSA) as i32) >> MANTISSA_BITS;
    let m = f32::from_bits(bits.wrapping_sub((k as u32) << MANTISSA_BITS));
    let t = m - 1.0;
    let p = C[0] + t * (C[1] + t * (C[2] + t * (C[3] + t * (C[4] + t * C[5]))));
    k as f32 * core::f32::consts::LN_2 + t * p
}

#[cfg(test)]
mod tests {
    use super::ln;

    /// Every seventh number between the largest and the smallest ratio that a 12-bit converter can give.
    #[test]
    fn agrees_with_a_logarithm_in_f64() {
        let (low, high) = (1.0f32 / 4094.0, 4094.0f32);
        for bits in (low.to_bits()..=high.to_bits()).step_by(7) {
            let x = f32::from_bits(bits);
            let error = f64::from(ln(x)) - libm::log(f64::from(x));
            assert!(error.abs() < 2.6e-6, "ln({x}) errs by {error}");
        }
        assert_eq!(ln(1.0), 0.0);
    }
}
