//! The output stage: interlock, timer, MOSFET and contactor, with what can be wrong with each.

use fdi_core::Percent;
use firmware_logic::control_loop::Heater;
use firmware_logic::interlock::Lockout;

/// What can be wrong with the way from the timer to the heater.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defect {
    /// The MOSFET conducts whatever its gate says.
    MosfetShorted,
    /// The contactor never opens; none fitted is the same.
    ContactorWelded,
    /// The contact on the break input is open.
    InterlockOpen,
    /// The timer does not listen to its break input.
    BreakIgnored,
    /// The heater is broken, or its fuse.
    NoHeater,
}

/// MOSFET and contactor in series with the heater; the timer's enable holds both off.
#[derive(Debug, Default)]
pub struct OutputStage {
    power: Percent,
    contactor: bool,
    enabled: bool,
    defects: Vec<Defect>,
}

impl OutputStage {
    /// What reaches the heater.
    pub fn given(&self) -> Percent {
        let closed = self.has(Defect::ContactorWelded) || (self.enabled && self.contactor);
        if !closed || self.has(Defect::NoHeater) {
            Percent(0.0)
        } else if self.has(Defect::MosfetShorted) {
            Percent(100.0)
        } else if self.enabled {
            self.power
        } else {
            Percent(0.0)
        }
    }

    /// Whether nothing is driven: the output disabled, the contactor not held.
    pub fn is_off(&self) -> bool {
        !self.enabled && !self.contactor
    }

    /// What the MOSFET is asked for.
    pub fn asked(&self) -> Percent {
        if self.enabled { self.power } else { Percent(0.0) }
    }

    /// Lets something be wrong from now on.
    pub(super) fn break_with(&mut self, defect: Defect) {
        self.defects.push(defect);
        self.obey_break();
    }

    /// Everything as it should be.
    pub(super) fn mend(&mut self) {
        self.defects.clear();
    }

    fn has(&self, defect: Defect) -> bool {
        self.defects.contains(&defect)
    }

    fn obey_break(&mut self) {
        self.enabled &= !self.has(Defect::InterlockOpen) || self.has(Defect::BreakIgnored);
    }
}

impl Heater for OutputStage {
    fn drive(&mut self, power: Percent) {
        self.power = power;
    }

    fn contactor(&mut self, closed: bool) {
        self.contactor = closed;
    }

    fn enable(&mut self) {
        self.enabled = true;
        self.obey_break();
    }

    fn disable(&mut self) {
        self.enabled = false;
    }

    fn is_enabled(&self) -> bool {
        self.enabled
    }

    fn break_is_open(&self) -> bool {
        self.has(Defect::InterlockOpen)
    }

    fn cut_by(&self) -> Lockout {
        Lockout::BreakInput
    }

    fn test_break(&mut self) -> bool {
        self.enable();
        let enabled = self.enabled;
        self.enabled = self.has(Defect::BreakIgnored);
        let cut = !self.enabled;
        self.enabled = false;
        enabled && cut
    }
}
