//! The seam between the loop and the power output.

use fdi_core::Percent;

use crate::interlock::Lockout;

/// The power output as the loop sees it.
pub trait Heater {
    /// Sets the power; has an effect at the output only while it is enabled.
    fn drive(&mut self, power: Percent);
    /// Closes or opens the contactor in series with the heater; it is closed only while the output is enabled, too.
    fn contactor(&mut self, closed: bool);
    /// Enables the output. Without effect while the break input is open.
    fn enable(&mut self);
    /// Disables the output at once.
    fn disable(&mut self);
    /// Whether the output is enabled; hardware may have disabled it.
    fn is_enabled(&self) -> bool;
    /// Whether the break input is open, which means "stop".
    fn break_is_open(&self) -> bool;
    /// What disabled the output, where the loop did not.
    fn cut_by(&self) -> Lockout;
    /// Enables the output and breaks it by the hardware that the break input acts on; whether that has disabled it. The
    /// caller has set the power to zero and opened the contactor.
    fn test_break(&mut self) -> bool;
}
