//! The codes of one tick, as a frame towards a board that is simulated: they stand in for those of its converter.

use core::fmt;

use fdi_core::{AdcCode, RawSample};

/// What a tick is to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Codes {
    /// The tick.
    pub tick: u32,
    /// Its codes.
    pub raw: RawSample,
}

impl fmt::Display for Codes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RawSample { t0, t1, t2, supply } = self.raw;
        write!(f, "codes {:x}", self.tick)?;
        [t0, t1, t2, supply].iter().try_for_each(|code| write!(f, " {:x}", code.0.to_bits()))
    }
}

impl Codes {
    /// Reads a line; `None` where it is another.
    pub fn parse(line: &str) -> Option<Self> {
        let mut words =
            line.strip_prefix("codes ")?.split(' ').map(|word| u32::from_str_radix(word, 16).ok());
        let mut next = || words.next().flatten();
        let tick = next()?;
        let mut code = || next().map(|bits| AdcCode(f32::from_bits(bits)));
        let raw = RawSample { t0: code()?, t1: code()?, t2: code()?, supply: code()? };
        words.next().is_none().then_some(Self { tick, raw })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn comes_back(tick: u32, bits: [u32; 4]) {
            let [t0, t1, t2, supply] = bits.map(|bits| AdcCode(f32::from_bits(bits)));
            let codes = Codes { tick, raw: RawSample { t0, t1, t2, supply } };
            let back = Codes::parse(&codes.to_string()).expect("a line of codes");
            prop_assert_eq!(back.tick, tick);
            prop_assert_eq!([back.raw.t0, back.raw.t1, back.raw.t2, back.raw.supply].map(|code| code.0.to_bits()), bits);
        }

        #[test]
        fn no_line_panics(line in "(codes )?[ -~]{0,60}") {
            let _ = Codes::parse(&line);
        }
    }

    #[test]
    fn a_word_too_few_or_too_many_is_another_line() {
        assert_eq!(Codes::parse("codes 1 2 3 4"), None);
        assert_eq!(Codes::parse("codes 1 2 3 4 5 6"), None);
        assert_eq!(Codes::parse("tick 1 2 3 4 5"), None);
    }
}
