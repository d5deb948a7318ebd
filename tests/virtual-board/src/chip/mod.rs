//! The chip around the core: which peripheral answers at which address, what one does to another, what is wired to the
//! pins. An access that no peripheral answers fails the run.

mod bus;
mod map;

use crate::adc::Adc;
use crate::chip::map::{DEBUG_TABLE, EXTI_TABLE, SYSCFG_TABLE};
use crate::clock::{Cause, Clocks, Frequencies};
use crate::flash::Flash;
use crate::gpio::{Mode, Port};
use crate::nvic::NMI;
use crate::registers::{File, Refusal};
use crate::scs::Scs;
use crate::time::{NEVER, Ps, period};
use crate::timer::{Lines, Output, Timer};
use crate::usart::Usart;
use crate::watchdog::Watchdog;

pub use map::PERIPHERALS;

/// What is wired to the converter's inputs, and to the heater's pin.
pub trait Analog {
    /// The code that the converter reads from a channel at a time; `power` is the share of the time that the heater's
    /// pin is high.
    fn code(&mut self, channel: u8, now: Ps, power: f64) -> u16;
}

/// Interrupt numbers.
const TIM1_BREAK: u16 = 24;
const TIM1_UPDATE: u16 = 25;
const TIM1_COMPARE: u16 = 27;
const TIM2: u16 = 28;
const USART2: u16 = 38;
const TIM5: u16 = 50;

/// Pins of port A.
const BREAK_PIN: usize = 6;
const HEATER_PIN: usize = 8;

/// The chip.
pub struct Chip {
    /// System control space.
    pub scs: Scs,
    /// Clocks.
    pub clocks: Clocks,
    /// Flash controller and the sectors of the settings.
    pub flash: Flash,
    /// Heater PWM.
    pub tim1: Timer,
    /// Clock of the thread-mode tasks.
    pub tim2: Timer,
    /// Clock of the control tick.
    pub tim5: Timer,
    /// Serial port.
    pub usart: Usart,
    /// Converter.
    pub adc: Adc,
    /// Ports A to E.
    pub ports: [Port; 5],
    /// Watchdog.
    pub watchdog: Watchdog,
    debug: File,
    exti: File,
    syscfg: File,
    /// What is wired to the converter.
    pub analog: Box<dyn Analog>,
    /// Why the chip must be reset.
    pub reset: Option<Cause>,
    /// The supply is gone.
    pub power_cut: bool,
    frequencies: Option<Frequencies>,
    /// Every change of the heater's pin: when, and the share of the time that it is high from then on.
    pub heater_log: Vec<(Ps, f64)>,
}

impl Chip {
    /// A chip whose supply has just come up.
    pub fn new(analog: Box<dyn Analog>) -> Self {
        let mut chip = Self {
            scs: Scs::default(),
            clocks: Clocks::new(Some(8_000_000)),
            flash: Flash::default(),
            tim1: Timer::advanced(Lines { update: TIM1_UPDATE, compare: TIM1_COMPARE, brk: TIM1_BREAK }),
            tim2: Timer::general(TIM2),
            tim5: Timer::general(TIM5),
            usart: Usart::new(16_000_000),
            adc: Adc::default(),
            ports: ['A', 'B', 'C', 'D', 'E'].map(Port::new),
            watchdog: Watchdog::new(32_000),
            debug: File::new(&DEBUG_TABLE),
            exti: File::new(&EXTI_TABLE),
            syscfg: File::new(&SYSCFG_TABLE),
            analog,
            reset: None,
            power_cut: false,
            frequencies: None,
            heater_log: vec![(0, 0.0)],
        };
        chip.clocks.reset(Cause::PowerOn);
        chip.clocks_changed(0);
        chip
    }

    /// Resets everything that a reset resets.
    pub fn restart(&mut self, cause: Cause, now: Ps) {
        self.scs = Scs::default();
        self.clocks.reset(cause);
        self.flash.reset();
        for timer in [&mut self.tim1, &mut self.tim2, &mut self.tim5] {
            timer.reset(now);
        }
        self.usart.reset();
        self.adc = Adc::default();
        self.ports.iter_mut().for_each(Port::reset);
        self.watchdog = Watchdog::new(self.watchdog.oscillator);
        // The debug unit keeps its settings but over a power-up.
        if cause == Cause::PowerOn {
            self.debug.reset();
        }
        (self.reset, self.power_cut) = (None, false);
        self.clocks_changed(now);
        self.settle(now);
    }

    /// Period of the core clock; `None` while it stands still.
    pub fn cycle(&self) -> Option<Ps> {
        self.frequencies.map(|f| period(f.core))
    }

    fn clocks_changed(&mut self, now: Ps) {
        let frequencies = self.clocks.frequencies();
        if frequencies == self.frequencies {
            return;
        }
        self.frequencies = frequencies;
        let Some(f) = frequencies else { return };
        self.scs.cycle = period(f.core);
        self.tim1.set_clock(period(f.timers2()), now);
        self.tim2.set_clock(period(f.timers1()), now);
        self.tim5.set_clock(period(f.timers1()), now);
        self.usart.pclk = f.pclk1;
    }

    /// The core may run as fast as it does.
    fn check_speed(&self) -> Result<(), Refusal> {
        let Some(f) = self.frequencies else { return Ok(()) };
        let limits = [(self.flash.max_hz(), "flash wait states"), (self.clocks.max_hz(), "voltage scale")];
        match limits.iter().find(|(limit, _)| f.core > *limit) {
            Some((limit, what)) => Err(format!("core at {} Hz, its {what} allow for {limit} Hz", f.core)),
            None => Ok(()),
        }
    }

    /// When something next happens by itself.
    pub fn next_event(&self) -> Ps {
        let timers = [&self.tim1, &self.tim2, &self.tim5].map(Timer::next_event);
        let others = [self.usart.next_event(), self.watchdog.next_event(), self.scs.next_event()];
        timers.into_iter().chain(others).min().unwrap_or(NEVER)
    }

    /// Lets happen what happens until `now`.
    pub fn advance(&mut self, now: Ps) {
        for timer in [&mut self.tim1, &mut self.tim2, &mut self.tim5] {
            timer.advance(now);
        }
        self.usart.advance(now);
        self.scs.advance(now);
        if self.watchdog.next_event() <= now {
            self.reset = Some(Cause::Watchdog);
        }
        self.settle(now);
    }

    /// Carries what one peripheral does over to the others: break input, interrupt lines, the heater's pin.
    pub fn settle(&mut self, now: Ps) {
        let connected = self.ports[0].mode(BREAK_PIN) == Mode::Alternate(1);
        self.tim1.set_break_level(connected && self.ports[0].level(BREAK_PIN));
        if std::mem::take(&mut self.clocks.guard) {
            self.tim1.break_now();
            self.clocks_changed(now);
        }
        if self.clocks.guard_flag() && self.scs.nvic.running() != NMI {
            self.scs.nvic.pend(NMI);
        }
        for timer in [&self.tim1, &self.tim2, &self.tim5] {
            // One number may carry several sources.
            let levels = timer.levels();
            for (number, _) in levels {
                let level = levels.iter().any(|&(other, level)| other == number && level);
                self.scs.nvic.line(number, level);
            }
        }
        self.scs.nvic.line(USART2, self.usart.level());
        if self.scs.reset_request {
            self.reset = Some(Cause::Software);
        }
        let power = self.heater();
        if self.heater_log.last().is_none_or(|(_, before)| *before != power) {
            self.heater_log.push((now, power));
        }
    }

    /// Share of the time that the heater's pin is high; an open pin is low, for the power stage pulls it down.
    pub fn heater(&self) -> f64 {
        let port = &self.ports[0];
        match (port.mode(HEATER_PIN), self.tim1.output()) {
            (Mode::Output, _) => f64::from(u8::from(port.driven(HEATER_PIN))),
            (Mode::Alternate(1), Output::Driven(high)) => high,
            _ => 0.0,
        }
    }

    /// Wires a pin of a port (0 is A) to a level, or leaves it open.
    pub fn wire(&mut self, port: usize, pin: usize, level: Option<bool>, now: Ps) {
        self.ports[port].wire(pin, level);
        self.settle(now);
    }

    /// The external clock stops.
    pub fn fail_external_clock(&mut self, now: Ps) {
        self.clocks.fail_external();
        self.clocks_changed(now);
        self.settle(now);
    }
}
