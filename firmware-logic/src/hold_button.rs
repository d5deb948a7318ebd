//! A button that counts only when held: a touch must not release a safety latch.

/// Reports once when the button has been held for long enough.
#[derive(Clone, Copy, Debug)]
pub struct HoldButton {
    needed: u32,
    held: u32,
}

impl HoldButton {
    /// Needs `needed` looks in a row at a pressed button.
    pub fn new(needed: u32) -> Self {
        // Held since before the start: a jammed button acknowledges nothing.
        Self { needed, held: u32::MAX }
    }

    /// Takes in one look; `true` on the one that completes the time.
    pub fn step(&mut self, pressed: bool) -> bool {
        let before = self.held;
        self.held = if pressed { before.saturating_add(1) } else { 0 };
        before < self.needed && self.held >= self.needed
    }
}

#[cfg(test)]
mod tests {
    use super::HoldButton;

    fn fires(looks: &[(bool, usize)]) -> usize {
        let mut button = HoldButton::new(40);
        let looks = looks.iter().flat_map(|&(pressed, times)| core::iter::repeat_n(pressed, times));
        looks.filter(|&pressed| button.step(pressed)).count()
    }

    #[test]
    fn held_for_two_seconds_counts_once() {
        assert_eq!(fires(&[(false, 1), (true, 39)]), 0);
        assert_eq!(fires(&[(false, 1), (true, 40)]), 1);
        assert_eq!(fires(&[(false, 1), (true, 4000)]), 1);
        assert_eq!(fires(&[(false, 1), (true, 39), (false, 1), (true, 39)]), 0, "chatter is no hold");
    }

    #[test]
    fn a_button_that_is_jammed_at_the_start_acknowledges_nothing() {
        assert_eq!(fires(&[(true, 100_000)]), 0);
        assert_eq!(fires(&[(true, 100), (false, 1), (true, 40)]), 1, "but it can still be used");
    }
}
