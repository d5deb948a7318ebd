//! The heater's outputs: TIM1 channel 1 on PA8, 20 kHz, and channel 3 on PA10, which holds the contactor in series with
//! the heater; the break input is on PA6.
//!
//! The break is active high and pulled up: closed to ground means "go", an open wire means "stop". Then hardware
//! clears the main output enable (MOE) and drives both pins low, whatever the program does; only the program can set
//! MOE again, and only while the input is closed. Whatever cuts the heater therefore opens the contactor in the same
//! moment, and a power stage that has failed on is switched off by it.

use core::sync::atomic::{AtomicU8, Ordering};

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::timer::vals::{Bkp, CcmrOutputCcs, Lock, Ocm, Ossi, Ossr};
use embassy_stm32::peripherals::{PA6, PA8, PA10, TIM1};
use embassy_stm32::rcc;
use fdi_core::Percent;
use firmware_logic::control_loop::Heater;
use firmware_logic::interlock::Lockout;
use firmware_logic::{duty, sampling};

use super::{board, supply};

const PWM_HZ: u32 = 1_000_000 / sampling::PWM_PERIOD_US;

/// Channels of the timer, counted from 0 as the register access does.
const HEATER: usize = 0;
const CONTACTOR: usize = 2;
/// Compare values of the contactor: never high, and above any period, high without an edge.
const OPEN: u16 = 0;
const CLOSED: u16 = u16::MAX;

/// Number of the lockout that the program has cut the outputs for; 0 while only the break input can have.
static CUT_BECAUSE: AtomicU8 = AtomicU8::new(0);

/// Switches both outputs off: one register, no state, safe from any interrupt, panic or fault.
pub(crate) fn cut() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
}

/// Ends a break that was made on purpose, with the output off whether it has worked or not.
fn cut_and_forget_break() {
    cut();
    pac::TIM1.sr().modify(|w| w.set_bif(0, false));
}

/// Switches both outputs off for a reason that the control task will latch on its next tick. `false` if they were off.
pub(crate) fn cut_because(reason: Lockout) -> bool {
    let was_enabled = is_enabled();
    cut();
    if was_enabled {
        CUT_BECAUSE.store(reason.number(), Ordering::Relaxed);
    }
    was_enabled
}

/// Whether the output is enabled.
pub(crate) fn is_enabled() -> bool {
    pac::TIM1.bdtr().read().moe()
}

/// The output stage.
pub(crate) struct HeaterOutput {
    _timer: Peri<'static, TIM1>,
    _pins: [Flex<'static>; 2],
    break_input: Flex<'static>,
    period: u16,
}

impl HeaterOutput {
    /// Configures the timer; the output stays disabled.
    pub(crate) fn new(
        timer: Peri<'static, TIM1>,
        (heater, contactor): (Peri<'static, PA8>, Peri<'static, PA10>),
        break_pin: Peri<'static, PA6>,
    ) -> Self {
        rcc::enable_and_reset::<TIM1>();
        let period = (rcc::frequency::<TIM1>().0 / PWM_HZ) as u16;
        let mut break_input = Flex::new(break_pin);
        break_input.set_as_af_unchecked(board::TIM1_AF, AfType::input(Pull::Up));
        let t = pac::TIM1;
        set_period(period);
        for channel in [HEATER, CONTACTOR] {
            t.ccr(channel).write(|w| w.set_ccr(0));
            t.ccmr_output(channel / 2).write(|w| {
                w.set_ccs(channel % 2, CcmrOutputCcs::OUTPUT);
                w.set_ocm(channel % 2, Ocm::PWM_MODE1);
                w.set_ocpe(channel % 2, true); // takes effect between two periods, never within one
            });
        }
        // The idle level of the pins is low by reset; OSSI and OSSR drive them there instead of letting them float. The
        // lock keeps a stray write from undoing any of this until the next reset.
        t.bdtr().write(|w| {
            w.set_bke(0, true);
            w.set_bkp(0, Bkp::ACTIVE_HIGH);
            w.set_ossi(Ossi::IDLE_LEVEL);
            w.set_ossr(Ossr::IDLE_LEVEL);
            w.set_lock(Lock::LEVEL3);
        });
        t.ccer().write(|w| {
            w.set_cce(HEATER, true);
            w.set_cce(CONTACTOR, true);
        });
        t.egr().write(|w| w.set_ug(true));
        run();
        // Only now, with the level defined by the timer, are the pins handed over to it.
        let mut pins = [Flex::new(heater), Flex::new(contactor)];
        for pin in &mut pins {
            pin.set_as_af_unchecked(board::TIM1_AF, AfType::output(OutputType::PushPull, Speed::Low));
        }
        lock_pins();
        Self { _timer: timer, _pins: pins, break_input, period }
    }
}

fn set_period(period: u16) {
    pac::TIM1.psc().write_value(0);
    pac::TIM1.arr().write(|w| w.set_arr(period - 1));
}

fn run() {
    pac::TIM1.cr1().write(|w| {
        w.set_arpe(true);
        w.set_cen(true);
    });
}

/// Keeps the pins the timer's until the next reset. Hazard: a stray write to the port's mode register would make a pin an
/// output that no break, no MOE and no deadline watchdog switches off.
fn lock_pins() {
    const PA6_PA8_PA10: u32 = 1 << 6 | 1 << 8 | 1 << 10;
    const KEY: u32 = 1 << 16;
    let lock = pac::GPIOA.lckr();
    for value in [KEY | PA6_PA8_PA10, PA6_PA8_PA10, KEY | PA6_PA8_PA10] {
        lock.write(|w| w.0 = value);
    }
    let _ = lock.read(); // closes it
}

impl Heater for HeaterOutput {
    /// Period and counter are written anew with each power, for nothing locks them: a counter that a stray write has
    /// stopped while the pin is high would heat at full power for good.
    fn drive(&mut self, power: Percent) {
        set_period(self.period);
        run();
        pac::TIM1.ccr(HEATER).write(|w| w.set_ccr(duty::compare(power, self.period)));
    }

    fn contactor(&mut self, closed: bool) {
        pac::TIM1.ccr(CONTACTOR).write(|w| w.set_ccr(if closed { CLOSED } else { OPEN }));
    }

    fn enable(&mut self) {
        CUT_BECAUSE.store(0, Ordering::Relaxed);
        pac::TIM1.bdtr().modify(|w| w.set_moe(true));
        // A supply that was low before gives no edge for the interrupt to see.
        if supply::is_low() {
            cut_because(Lockout::Undervoltage);
        }
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

    fn cut_by(&self) -> Lockout {
        Lockout::from_number(CUT_BECAUSE.load(Ordering::Relaxed)).unwrap_or(Lockout::BreakInput)
    }
}
