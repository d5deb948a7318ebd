//! The button: a touch stops what heats, and only holding it acknowledges, since a touch must not release a safety latch.

/// What the button asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Press {
    /// Heater off, at once.
    Stop,
    /// It has been held for long enough to acknowledge.
    Acknowledge,
}

/// Reports what the button asks for, once a press.
#[derive(Clone, Copy, Debug)]
pub struct HoldButton {
    needed: u32,
    held: u32,
}

/// Held, but for what no longer counts.
const SPENT: u32 = u32::MAX;

impl HoldButton {
    /// Acknowledges after `needed` looks in a row at a pressed button.
    pub fn new(needed: u32) -> Self {
        // Held since before the start: a jammed button acknowledges nothing.
        Self { needed, held: SPENT }
    }

    /// What one look at the button asks for. While something heats, a pressed button stops it, even one that was pressed before: a jammed
    /// button lets nothing heat. The press that stopped acknowledges nothing.
    pub fn step(&mut self, pressed: bool, heating: bool) -> Option<Press> {
        if !pressed {
            self.held = 0;
            return None;
        }
        if heating {
            self.held = SPENT;
            return Some(Press::Stop);
        }
        let before = self.held;
        self.held = before.saturating_add(1);
        (before < self.needed && self.held >= self.needed).then_some(Press::Acknowledge)
    }
}

#[cfg(test)]
mod tests {
    use super::{HoldButton, Press};

    fn acknowledged(looks: &[(bool, usize)]) -> usize {
        let mut button = HoldButton::new(40);
        let looks = looks.iter().flat_map(|&(pressed, times)| core::iter::repeat_n(pressed, times));
        looks.filter(|&pressed| button.step(pressed, false) == Some(Press::Acknowledge)).count()
    }

    #[test]
    fn held_for_two_seconds_counts_once() {
        assert_eq!(acknowledged(&[(false, 1), (true, 39)]), 0);
        assert_eq!(acknowledged(&[(false, 1), (true, 40)]), 1);
        assert_eq!(acknowledged(&[(false, 1), (true, 4000)]), 1);
        assert_eq!(acknowledged(&[(false, 1), (true, 39), (false, 1), (true, 39)]), 0, "chatter is no hold");
    }

    #[test]
    fn a_button_that_is_jammed_at_the_start_acknowledges_nothing() {
        assert_eq!(acknowledged(&[(true, 100_000)]), 0);
        assert_eq!(acknowledged(&[(true, 100), (false, 1), (true, 40)]), 1, "but it can still be used");
    }

    #[test]
    fn a_press_while_heating_stops_at_the_first_look_and_acknowledges_nothing() {
        let mut button = HoldButton::new(40);
        assert_eq!(button.step(false, true), None);
        assert_eq!(button.step(true, true), Some(Press::Stop));
        assert!(
            (0..1000).all(|_| button.step(true, false).is_none()),
            "the press that stopped has done its work"
        );
        button.step(false, false);
        let fired = (0..40).filter_map(|_| button.step(true, false)).collect::<Vec<_>>();
        assert_eq!(fired, [Press::Acknowledge]);
    }

    #[test]
    fn a_jammed_button_lets_nothing_heat() {
        let mut button = HoldButton::new(40);
        (0..100).for_each(|_| assert_eq!(button.step(true, false), None));
        assert_eq!(button.step(true, true), Some(Press::Stop));
    }
}
