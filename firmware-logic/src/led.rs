//! What the one LED says. Every pattern moves: a LED that stands still, dark or lit, is a board that is dead.

/// How things are, as far as the LED tells them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Heater off: a short flash.
    Off,
    /// Heating, or about to, a check included: lit, with a short gap.
    Heating,
    /// Heating, and something is wrong: two flashes and a pause.
    Alarm,
    /// Tripped or locked out until acknowledged: fast blinking.
    Latched,
}

/// Looks at the LED in one round of a pattern: 2 s of 50 ms each.
pub const ROUND: u32 = 40;

impl Sign {
    /// One bit a look, the first lowest: 1 is lit.
    pub const fn pattern(self) -> u64 {
        match self {
            Self::Off => 0b1,
            Self::Heating => (1 << ROUND) - 1 - 0b11,
            Self::Alarm => 0b11111_00000_11111,
            Self::Latched => 0b00000_11111_00000_11111_00000_11111_00000_11111,
        }
    }

    /// Whether the LED is lit at a look.
    pub const fn is_lit(self, look: u32) -> bool {
        self.pattern() >> (look % ROUND) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Sign; 4] = [Sign::Off, Sign::Heating, Sign::Alarm, Sign::Latched];

    /// Changes in a round, and how long it is lit: what an eye sees, whenever it begins to look.
    fn seen(sign: Sign) -> (usize, usize) {
        let lit = |look| sign.is_lit(look);
        let changes = (0..ROUND).filter(|look| lit(*look) != lit(look + 1)).count();
        (changes, (0..ROUND).filter(|look| lit(*look)).count())
    }

    #[test]
    fn every_sign_moves_within_a_round() {
        for sign in ALL {
            assert!(seen(sign).0 >= 2, "{sign:?} looks like a dead board");
        }
    }

    #[test]
    fn no_two_signs_look_alike() {
        for (i, a) in ALL.into_iter().enumerate() {
            for b in ALL.into_iter().skip(i + 1) {
                let ((changes_a, lit_a), (changes_b, lit_b)) = (seen(a), seen(b));
                let apart = changes_a != changes_b || lit_a.abs_diff(lit_b) > ROUND as usize / 2;
                assert!(apart, "{a:?} and {b:?}");
            }
        }
    }
}
