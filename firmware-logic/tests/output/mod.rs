//! The output stage of a board, for tests of what drives it.
#![allow(dead_code, reason = "each test looks at a part of it")]

use fdi_core::Percent;
use firmware_logic::control_loop::Heater;
use firmware_logic::interlock::Lockout;

/// The output stage as the chip has it: the break input clears the enable and keeps it from being set, and the enable
/// carries heater and contactor both.
#[derive(Debug, Default)]
pub(crate) struct Output {
    pub(crate) power: f32,
    pub(crate) contactor: bool,
    pub(crate) enabled: bool,
    pub(crate) open: bool,
    pub(crate) missed_deadline: bool,
}

impl Output {
    /// What reaches the heater, %.
    pub(crate) fn given(&self) -> f32 {
        if self.enabled && self.contactor { self.power } else { 0.0 }
    }

    /// Nothing is left of the power anywhere.
    pub(crate) fn is_off(&self) -> bool {
        !self.enabled && !self.contactor && self.power == 0.0
    }
}

impl Heater for Output {
    fn drive(&mut self, power: Percent) {
        self.power = power.0;
    }
    fn contactor(&mut self, closed: bool) {
        self.contactor = closed;
    }
    fn enable(&mut self) {
        self.enabled = !self.open;
    }
    fn disable(&mut self) {
        self.enabled = false;
    }
    fn is_enabled(&self) -> bool {
        self.enabled
    }
    fn break_is_open(&self) -> bool {
        self.open
    }
    fn cut_by(&self) -> Lockout {
        if self.missed_deadline { Lockout::MissedDeadline } else { Lockout::BreakInput }
    }
    fn test_break(&mut self) -> bool {
        assert!(self.power == 0.0 && !self.contactor, "the proof heats");
        std::mem::take(&mut self.enabled);
        !self.open
    }
}
