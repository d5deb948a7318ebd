//! Cosine and sine, for the experiment of `tune`. Those of `libm` reduce their argument in double precision, which this
//! processor does in software: they would take 6 KiB of the board's flash.

use core::f32::consts::TAU;

/// Cosine and sine of an angle given in turns; each within 3e-7 of the true value for up to some hundred turns.
///
/// In turns the reduction to an eighth of a turn on either side of zero is exact. There the Taylor series end with
/// the eighth and the ninth power; what they leave out is below 3e-8.
#[inline(never)]
pub(crate) fn cos_sin(turns: f32) -> (f32, f32) {
    let quarters = 4.0 * turns;
    let nearest = (if quarters < 0.0 { quarters - 0.5 } else { quarters + 0.5 }) as i32;
    let x = TAU * (turns - 0.25 * nearest as f32);
    let x2 = x * x;
    let sin = x * (1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0))));
    let cos = 1.0 - x2 / 2.0 * (1.0 - x2 / 12.0 * (1.0 - x2 / 30.0 * (1.0 - x2 / 56.0)));
    match nearest & 3 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

#[cfg(test)]
mod tests {
    use super::cos_sin;
    use core::f64::consts::TAU;

    #[test]
    fn they_agree_with_those_in_f64() {
        for i in -300_000..300_000 {
            let turns = i as f32 * 3.3e-4;
            let angle = TAU * f64::from(turns);
            let (cos, sin) = cos_sin(turns);
            let error =
                (f64::from(cos) - libm::cos(angle)).abs().max((f64::from(sin) - libm::sin(angle)).abs());
            assert!(error < 3e-7, "{turns} turns: {cos} {sin}, wrong by {error}");
        }
    }
}
