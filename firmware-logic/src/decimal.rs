//! Decimal numbers as people write them, without the 25 KiB of flash that the general conversions of `core` take.

use core::fmt;

/// Powers of ten that an `f32` holds exactly.
const POWERS: [f32; 11] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];
/// Largest run of integers that an `f32` holds exactly: numbers of up to seven digits.
const MAX_MANTISSA: u32 = 1 << 24;

/// What [`parse`] accepts, for error messages.
pub const EXPECTED: &str = "a number of up to 7 digits, such as 35, -0.25 or 1e5";

/// Reads a number of up to seven digits with an exponent within ±10. Both parts are exact in `f32`, so that one
/// multiplication or division gives the nearest `f32`, the same as the general conversion.
pub fn parse(text: &str) -> Option<f32> {
    let (negative, text) = match text.as_bytes().first()? {
        b'-' => (true, text.get(1..)?),
        b'+' => (false, text.get(1..)?),
        _ => (false, text),
    };
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let fraction = fraction.trim_end_matches('0');
    // Zeros are kept back until another digit follows: those at the end may belong to the exponent.
    let (mut mantissa, mut zeros) = (0u32, 0);
    for digit in whole.bytes().chain(fraction.bytes()) {
        let digit = digit.is_ascii_digit().then(|| digit - b'0')?;
        zeros += 1;
        if digit > 0 {
            for _ in 0..zeros {
                mantissa = mantissa.checked_mul(10)?;
            }
            mantissa = mantissa.checked_add(digit.into())?;
            zeros = 0;
        }
    }
    while zeros > 0 && mantissa <= MAX_MANTISSA / 10 {
        mantissa *= 10;
        zeros -= 1;
    }
    let exponent = signed(exponent)?.checked_sub(fraction.len() as i32)?.checked_add(zeros)?;
    let mantissa = (mantissa <= MAX_MANTISSA).then_some(mantissa)?;
    let power = *POWERS.get(exponent.unsigned_abs() as usize)?;
    let size = if exponent < 0 { mantissa as f32 / power } else { mantissa as f32 * power };
    Some(if negative { -size } else { size })
}

/// A number as short as [`parse`] reads it back to the same bits. What has no such form, since it was not typed here,
/// is shown rounded behind a "~", which nothing reads back.
pub struct Short(pub f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if self.0.is_sign_negative() {
            f.write_str("-")?;
        }
        match (-10..=10).rev().find_map(|exponent| Some((mantissa(size, exponent)?, exponent))) {
            Some((0, _)) => f.write_str("0"),
            Some((mantissa, exponent @ 0..=6)) => {
                write!(f, "{mantissa}")?;
                (0..exponent).try_for_each(|_| f.write_str("0"))
            }
            Some((mantissa, exponent @ -7..0)) => {
                let scale = 10u32.pow(exponent.unsigned_abs());
                write!(f, "{}.{:0width$}", mantissa / scale, mantissa % scale, width = -exponent as usize)
            }
            Some((mantissa, exponent)) => write!(f, "{mantissa}e{exponent}"),
            None => write!(f, "~{}", Fixed(size, 4)),
        }
    }
}

/// The whole number of up to seven digits that gives exactly `size` when a power of ten is put to it.
fn mantissa(size: f32, exponent: i32) -> Option<u32> {
    let power = *POWERS.get(exponent.unsigned_abs() as usize)?;
    let near = if exponent < 0 { size * power } else { size / power };
    let near = (near <= MAX_MANTISSA as f32).then_some(near as u32)?;
    // The quotient was rounded and then cut; the mantissa is next to it.
    (near.saturating_sub(1)..=(near + 2).min(MAX_MANTISSA)).find(|&mantissa| {
        let back = if exponent < 0 { mantissa as f32 / power } else { mantissa as f32 * power };
        back == size
    })
}

/// A number with a fixed count of decimals, at most 4.
pub struct Fixed(pub f32, pub u8);

impl fmt::Display for Fixed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(x, decimals) = *self;
        let scale = [1u32, 10, 100, 1000, 10_000][usize::from(decimals.min(4))];
        let scaled = x.abs() * scale as f32 + 0.5;
        if !(scaled < 4e9) {
            return f.write_str(if x.is_nan() { "?" } else { "huge" });
        }
        let scaled = scaled as u32;
        if x < 0.0 && scaled > 0 {
            f.write_str("-")?;
        }
        write!(f, "{}", scaled / scale)?;
        match decimals {
            0 => Ok(()),
            _ => write!(f, ".{:0width$}", scaled % scale, width = usize::from(decimals.min(4))),
        }
    }
}

/// When a tick is, in s from the first, to a tenth: `At(tick, Ts in s)`. A product of two `f32` would move in steps of 0.25 s after 23 days.
pub struct At(pub u32, pub f32);

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// So many ticks of whole microseconds are whole tenths of a second.
        const BLOCK: u32 = 100_000;
        let Self(tick, sample_time) = *self;
        let blocks = (tick / BLOCK).saturating_mul((sample_time * 1e6 + 0.5) as u32);
        let rest = (tick % BLOCK) as f32 * sample_time * 10.0 + 0.5;
        let tenths = blocks.saturating_add(rest as u32);
        write!(f, "{}.{}", tenths / 10, tenths % 10)
    }
}

/// A whole number that fits into `N`.
pub fn whole<N: TryFrom<i32>>(text: &str) -> Option<N> {
    signed(text)?.try_into().ok()
}

/// The only reader of whole numbers: each type has one of its own, which costs flash.
#[inline(never)]
fn signed(text: &str) -> Option<i32> {
    text.parse().ok()
}

/// A thousandth, rounded down, by divisions of 32 bits: that of 64 bits is a function of a kilobyte. It wraps.
pub fn thousandth(x: u64) -> u32 {
    let rest = (x >> 32) as u32 % 1000;
    let high = (rest << 16) | ((x >> 16) as u32 & 0xffff);
    let low = ((high % 1000) << 16) | (x as u32 & 0xffff);
    ((high / 1000) << 16) | (low / 1000)
}

/// Rounded to a part of 1: what the console shows of it is then all of it.
pub(crate) fn rounded(x: f32, part: f32) -> f32 {
    let whole = x * part + if x < 0.0 { -0.5 } else { 0.5 };
    whole as i32 as f32 / part
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn reads_what_people_write() {
        for (text, value) in [
            ("35", 35.0),
            ("-0.25", -0.25),
            ("+.5", 0.5),
            ("0.110", 0.11),
            ("1e5", 1e5),
            ("1E-9", 1e-9),
            ("10000000", 1e7),
            ("0", 0.0),
            ("0.000000", 0.0),
        ] {
            assert_eq!(parse(text), Some(value), "{text}");
        }
    }

    #[test]
    fn zeros_at_the_end_count_as_an_exponent_where_a_mantissa_does_not_hold_them() {
        for (text, value) in
            [("16777216", 16_777_216.0), ("12000000000000000", 1.2e16), ("100200.00", 100_200.0)]
        {
            assert_eq!(parse(text), Some(value), "{text}");
        }
        assert_eq!(parse("16777217"), None);
        assert_eq!(parse("167772170000"), None);
    }

    proptest! {
        #[test]
        fn a_thousandth_is_what_a_division_says(x: u64) {
            prop_assert_eq!(thousandth(x), (x / 1000) as u32);
        }
    }

    #[test]
    fn a_time_is_told_to_a_tenth_however_long_it_runs() {
        let cases = [
            (0, 0.11, "0.0"),
            (7727, 0.11, "850.0"),
            (100_000, 0.11, "11000.0"),
            (20_000_001, 0.11, "2200000.1"),
        ];
        for (tick, ts, said) in cases {
            assert_eq!(At(tick, ts).to_string(), said);
        }
        for tick in (0..1 << 25).step_by(9973) {
            let exact = (f64::from(tick) * 0.11 * 10.0 + 0.5).floor() / 10.0;
            let told: f64 = At(tick, 0.11).to_string().parse().expect("a number");
            assert!((told - exact).abs() < 0.11, "{tick}: {told}, {exact}");
        }
    }

    #[test]
    fn refuses_all_else() {
        let nonsense = [
            "",
            "-",
            ".",
            "e5",
            "1e",
            "1e99",
            "1e11",
            "nan",
            "inf",
            "0x10",
            "1,5",
            "1 2",
            "16777.217",
            "1.2.3",
            "--1",
            "\u{0661}",
        ];
        for text in nonsense {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn agrees_with_the_general_conversion_to_the_bit(mantissa in 0u32..=MAX_MANTISSA, exponent in -10i32..=10) {
            let text = format!("{mantissa}e{exponent}");
            let general: f32 = text.parse().expect("a number");
            prop_assert_eq!(parse(&text).map(f32::to_bits), Some(general.to_bits()), "{}", text);
        }

        #[test]
        fn short_comes_back_to_the_bit_and_is_no_longer_than_typed(mantissa in 0u32..=MAX_MANTISSA, exponent in -10i32..=10) {
            let value = parse(&format!("{mantissa}e{exponent}")).expect("in range");
            let short = Short(value).to_string();
            prop_assert_eq!(parse(&short), Some(value), "{}", &short);
            let general: f32 = short.parse().expect("a number");
            prop_assert_eq!(general.to_bits(), value.to_bits(), "{}", &short);
        }

        #[test]
        fn short_of_any_bits_is_exact_or_marked(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            let short = Short(value).to_string();
            if !short.contains('~') {
                prop_assert_eq!(parse(&short).map(f32::to_bits), Some(bits), "{}", short);
            }
        }

        #[test]
        fn fixed_is_the_rounding_of_display(x in -1e4f32..1e4, decimals in 0u8..=4) {
            let shown: f64 = Fixed(x, decimals).to_string().parse().expect("a number");
            let step = 10f64.powi(-i32::from(decimals));
            prop_assert!((shown - f64::from(x)).abs() <= 0.5 * step + 1e-3 * f64::from(x.abs()).max(1.0) * 1e-2);
        }

        #[test]
        fn never_panics(text in ".{0,20}") {
            let _ = parse(&text);
        }
    }

    #[test]
    fn short_is_what_people_write() {
        for text in [
            "0",
            "0.11",
            "35",
            "-20",
            "3950",
            "10000",
            "100000",
            "0.95",
            "5.1",
            "41.7",
            "1e10",
            "0.0000001",
            "-0.5",
        ] {
            assert_eq!(Short(parse(text).expect(text)).to_string(), text);
        }
        assert_eq!(Short(core::f32::consts::PI).to_string(), "~3.1416");
        assert_eq!(Short(1e-20).to_string(), "~0.0000");
        assert_eq!(Short(f32::NAN).to_string(), "~?");
    }

    #[test]
    fn fixed_shows_what_is_no_number() {
        assert_eq!(Fixed(f32::NAN, 2).to_string(), "?");
        assert_eq!(Fixed(f32::INFINITY, 2).to_string(), "huge");
        assert_eq!(Fixed(-0.001, 2).to_string(), "0.00");
        assert_eq!(Fixed(-1.25, 1).to_string(), "-1.3");
        assert_eq!(Fixed(34.999, 0).to_string(), "35");
    }
}
