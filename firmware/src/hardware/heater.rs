//! The heater's output: TIM1 channel 1 on PA8, 20 kHz, with the break input on PA6.
//!
//! The break is active high and pulled up: closed to ground means "go", an open wire means "stop". Then hardware
//! clears the main output enable (MOE) and drives the pin low, whatever the program does; only the program can set
//! MOE again, and only while the input is closed.

use core::sync::atomic::{AtomicBool, Ordering};

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::timer::vals::{Bkp, CcmrOutputCcs, Lock, Ocm, Ossi, Ossr};
use embassy_stm32::peripherals::{PA6, PA8, TIM1};
use embassy_stm32::rcc;
use fdi_core::Percent;
use firmware_logic::control_loop::Heater;
use firmware_logic::interlock::Hold;
use firmware_logic::{duty, sampling};

use super::board;

const PWM_HZ: u32 = 1_000_000 / sampling::PWM_PERIOD_US;

/// The dead man's handle has cut the output, not the break input.
static DEAD_MAN: AtomicBool = AtomicBool::new(false);

/// Switches the output off: one register, no state, safe from any interrupt, panic or fault.
pub(crate) fn cut() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
}

/// Ends a break that was made on purpose, with the output off whether it has worked or not.
fn cut_and_forget_break() {
    cut();
    pac::TIM1.sr().modify(|w| w.set_bif(0, false));
}

/// Switches the output off because the control tick was missing for too long.
pub(crate) fn cut_by_dead_man() {
    cut();
    DEAD_MAN.store(true, Ordering::Relaxed);
}

/// Whether the output is enabled.
pub(crate) fn is_enabled() -> bool {
    pac::TIM1.bdtr().read().moe()
}

/// The output stage.
pub(crate) struct HeaterOutput {
    _timer: Peri<'static, TIM1>,
    _pin: Flex<'static>,
    break_input: Flex<'static>,
    period: u16,
}

impl HeaterOutput {
    /// Configures the timer; the output stays disabled.
    pub(crate) fn new(
        timer: Peri<'static, TIM1>,
        pin: Peri<'static, PA8>,
        break_pin: Peri<'static, PA6>,
    ) -> Self {
        rcc::enable_and_reset::<TIM1>();
        let period = (rcc::frequency::<TIM1>().0 / PWM_HZ) as u16;
        let mut break_input = Flex::new(break_pin);
        break_input.set_as_af_unchecked(board::TIM1_AF, AfType::input(Pull::Up));
        let t = pac::TIM1;
        t.psc().write_value(0);
        t.arr().write(|w| w.set_arr(period - 1));
        t.ccr(0).write(|w| w.set_ccr(0));
        t.ccmr_output(0).write(|w| {
            w.set_ccs(0, CcmrOutputCcs::OUTPUT);
            w.set_ocm(0, Ocm::PWM_MODE1);
            w.set_ocpe(0, true); // a new power takes effect between two periods, never within one
        });
        // The idle level of the pin is low by reset; OSSI and OSSR drive it there instead of letting it float. The
        // lock keeps a stray write from undoing any of this until the next reset.
        t.bdtr().write(|w| {
            w.set_bke(0, true);
            w.set_bkp(0, Bkp::ACTIVE_HIGH);
            w.set_ossi(Ossi::IDLE_LEVEL);
            w.set_ossr(Ossr::IDLE_LEVEL);
            w.set_lock(Lock::LEVEL3);
        });
        t.ccer().write(|w| w.set_cce(0, true));
        t.egr().write(|w| w.set_ug(true));
        t.cr1().write(|w| {
            w.set_arpe(true);
            w.set_cen(true);
        });
        // Only now, with the level defined by the timer, is the pin handed over to it.
        let mut pin = Flex::new(pin);
        pin.set_as_af_unchecked(board::TIM1_AF, AfType::output(OutputType::PushPull, Speed::Low));
        Self { _timer: timer, _pin: pin, break_input, period }
    }
}

impl Heater for HeaterOutput {
    fn drive(&mut self, power: Percent) {
        pac::TIM1.ccr(0).write(|w| w.set_ccr(duty::compare(power, self.period)));
    }

    fn contactor(&mut self, _closed: bool) {}

    fn enable(&mut self) {
        DEAD_MAN.store(false, Ordering::Relaxed);
        pac::TIM1.bdtr().modify(|w| w.set_moe(true));
    }

    fn disable(&mut self) {
        cut();
    }

    fn is_enabled(&self) -> bool {
        is_enabled()
    }

    fn break_is_open(&self) -> bool {
        self.break_input.is_high()
    }

    fn test_break(&mut self) -> bool {
        self.enable();
        let enabled = is_enabled();
        pac::TIM1.egr().write(|w| w.set_bg(0, true));
        let cut = !is_enabled();
        cut_and_forget_break();
        enabled && cut
    }

    fn cut_by(&self) -> Hold {
        if DEAD_MAN.load(Ordering::Relaxed) { Hold::MissedDeadline } else { Hold::BreakInput }
    }
}
