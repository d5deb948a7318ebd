//! The heater's outputs: two channels of one timer, a PWM of 20 kHz for the heater and a level that holds the contactor in
//! series with it, and the timer's break input.
//!
//! The break is active high and pulled up: closed to ground means "go", an open wire means "stop". Then hardware
//! clears the main output enable (MOE) and drives both pins low, whatever the program does; only the program can set
//! MOE again, and only while the input is closed. Whatever cuts the heater therefore opens the contactor in the same
//! moment, and a power stage that has failed on is switched off by it.
//!
//! On a board that is simulated neither pin is the timer's: both are driven low, and the port is locked so until the next
//! reset. All else is as ever, so that the whole instrument runs; the break input, which may lead nowhere, is pulled down.

use core::sync::atomic::{AtomicU8, Ordering};

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull, Speed};
use embassy_stm32::pac::timer::vals::{Bkp, CcmrOutputCcs, Lock, Ocm, Ossi, Ossr};
use embassy_stm32::rcc;
use fdi_core::Percent;
use firmware_logic::control_loop::Heater;
use firmware_logic::interlock::Lockout;
use firmware_logic::{duty, sampling};

use super::board::{self, BreakPin, ContactorPin, HeaterPin, PwmTimer};
use super::supply;

const PWM_HZ: u32 = 1_000_000 / sampling::PWM_PERIOD_US;

/// Compare values of the contactor: never high, and above any period, high without an edge.
const OPEN: u16 = 0;
const CLOSED: u16 = u16::MAX;

/// Number of the lockout that the program has cut the outputs for; 0 while only the break input can have.
static CUT_BECAUSE: AtomicU8 = AtomicU8::new(0);

/// Switches both outputs off: one register, no state, safe from any interrupt, panic or fault.
pub(crate) fn cut() {
    board::PWM_TIMER.bdtr().modify(|w| w.set_moe(false));
}

/// Ends a break that was made on purpose, with the output off whether it has worked or not.
fn cut_and_forget_break() {
    cut();
    board::PWM_TIMER.sr().modify(|w| w.set_bif(0, false));
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
    board::PWM_TIMER.bdtr().read().moe()
}

/// The output stage.
pub(crate) struct HeaterOutput {
    _timer: Peri<'static, PwmTimer>,
    _pins: [Flex<'static>; 2],
    break_input: Flex<'static>,
    period: u16,
}

impl HeaterOutput {
    /// Configures the timer; the output stays disabled.
    pub(crate) fn new(
        timer: Peri<'static, PwmTimer>,
        (heater, contactor): (Peri<'static, HeaterPin>, Peri<'static, ContactorPin>),
        break_pin: Peri<'static, BreakPin>,
        simulated: bool,
    ) -> Self {
        rcc::enable_and_reset::<PwmTimer>();
        let period = (rcc::frequency::<PwmTimer>().0 / PWM_HZ) as u16;
        let mut break_input = Flex::new(break_pin);
        let pull = if simulated { Pull::Down } else { Pull::Up };
        break_input.set_as_af_unchecked(board::PWM_AF, AfType::input(pull));
        let t = board::PWM_TIMER;
        set_period(period);
        for channel in [board::HEATER_CHANNEL, board::CONTACTOR_CHANNEL] {
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
            w.set_cce(board::HEATER_CHANNEL, true);
            w.set_cce(board::CONTACTOR_CHANNEL, true);
        });
        t.egr().write(|w| w.set_ug(true));
        run();
        // Only now, with the level defined by the timer, are the pins handed over to it; where it is simulated, never.
        let mut pins = [Flex::new(heater), Flex::new(contactor)];
        for pin in &mut pins {
            if simulated {
                pin.set_low();
                pin.set_as_output(Speed::Low);
            } else {
                pin.set_as_af_unchecked(board::PWM_AF, AfType::output(OutputType::PushPull, Speed::Low));
            }
        }
        lock_pins();
        Self { _timer: timer, _pins: pins, break_input, period }
    }

    /// Whether a pin is high while the output is off: something else holds it there, and nothing that this program does switches it off.
    pub(crate) fn is_stuck_high(&self) -> bool {
        !is_enabled() && board::OUTPUT_PORT.idr().read().0 & board::HEATING_PINS != 0
    }
}

fn set_period(period: u16) {
    board::PWM_TIMER.psc().write_value(0);
    board::PWM_TIMER.arr().write(|w| w.set_arr(period - 1));
}

fn run() {
    board::PWM_TIMER.cr1().write(|w| {
        w.set_arpe(true);
        w.set_cen(true);
    });
}

/// Keeps the pins the timer's until the next reset. Hazard: a stray write to the port's mode register would make a pin an
/// output that no break, no MOE and no deadline watchdog switches off.
fn lock_pins() {
    const KEY: u32 = 1 << 16;
    let lock = board::OUTPUT_PORT.lckr();
    for value in [KEY | board::OUTPUT_PINS, board::OUTPUT_PINS, KEY | board::OUTPUT_PINS] {
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
        board::PWM_TIMER.ccr(board::HEATER_CHANNEL).write(|w| w.set_ccr(duty::compare(power, self.period)));
    }

    fn contactor(&mut self, closed: bool) {
        board::PWM_TIMER
            .ccr(board::CONTACTOR_CHANNEL)
            .write(|w| w.set_ccr(if closed { CLOSED } else { OPEN }));
    }

    fn enable(&mut self) {
        CUT_BECAUSE.store(0, Ordering::Relaxed);
        board::PWM_TIMER.bdtr().modify(|w| w.set_moe(true));
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
        board::PWM_TIMER.egr().write(|w| w.set_bg(0, true));
        let cut = !is_enabled();
        cut_and_forget_break();
        enabled && cut
    }

    fn cut_by(&self) -> Lockout {
        Lockout::from_number(CUT_BECAUSE.load(Ordering::Relaxed).into()).unwrap_or(Lockout::BreakInput)
    }
}
