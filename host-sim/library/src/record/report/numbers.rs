//! Numbers and text as a page shows them.

/// What stands where there is no number.
pub(super) const NOTHING: &str = "\u{2014}";

/// A number rounded to so many significant digits, with a real minus sign; a power of ten where it is very large or small.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return NOTHING.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let rounded = format!("{x:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    let text = if (-4..=6).contains(&power) {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        let whole = rounded.parse().unwrap_or(x);
        format!("{whole:.decimals$}")
    } else {
        format!("{mantissa}&middot;10<sup>{power}</sup>")
    };
    text.replace('-', "\u{2212}")
}

/// The same of a number that may not be there.
pub(super) fn maybe(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| NOTHING.into(), |x| significant(x, digits))
}

/// How often, where it could happen.
pub(super) fn count(n: Option<u32>) -> String {
    n.map_or_else(|| NOTHING.into(), |n| n.to_string())
}

/// A number as the user wrote it.
pub(crate) fn written(x: f64) -> String {
    x.to_string().replace('-', "\u{2212}")
}

/// Text as HTML.
pub fn escape(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_asked_for() {
        let cases = [
            (0.0, "0"),
            (4.2871, "4.29"),
            (9.999, "10.0"),
            (850.0, "850"),
            (1234.5, "1230"),
            (-0.000_123_4, "\u{2212}0.000123"),
            (1.23e9, "1.23&middot;10<sup>9</sup>"),
            (f64::NAN, NOTHING),
        ];
        for (x, expected) in cases {
            assert_eq!(significant(x, 3), expected, "{x}");
        }
    }

    #[test]
    fn no_text_can_become_markup() {
        assert_eq!(escape("<b a='1' c=\"2\">&"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;");
    }
}
