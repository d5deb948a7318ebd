//! The chip around the core: which peripheral answers at which address, what one does to another, what is wired to the
//! pins. An access that no peripheral answers fails the run.

mod bus;
mod map;
mod pins;

use crate::adc::Adc;
use crate::checksum::Checksum;
use crate::chip::map::DEBUG_TABLE;
use crate::clock::{Cause, Clocks, Frequencies};
use crate::exti::{self, Exti};
use crate::flash::Flash;
use crate::gpio::{Mode, Port};
use crate::nvic::NMI;
use crate::power::{Event, Power};
use crate::registers::{File, Refusal, bit};
use crate::scs::Scs;
use crate::time::{NEVER, Ps, period};
use crate::timer::{Lines, Timer};
use crate::usart::Usart;
use crate::watchdog::Watchdog;
use crate::wiring::Wiring;

pub use map::PERIPHERALS;

/// What is wired to the converter's inputs, and to the heater's pin.
pub trait Analog {
    /// The code of the voltage at a channel's input at a time; `power` is the share of the time that the heater is on.
    fn code(&mut self, channel: u8, now: Ps, power: f64) -> u16;
}

/// Interrupt numbers.
const TIM1_BREAK: u16 = 24;
const TIM1_UPDATE: u16 = 25;
const TIM1_COMPARE: u16 = 27;
const TIM2: u16 = 28;
const USART2: u16 = 38;
const TIM5: u16 = 50;

/// Pin of port A.
const BREAK_PIN: usize = 6;

/// Highest clock of the slow bus, Hz.
const MAX_PCLK1: u64 = 50_000_000;

/// Which bits of DBGMCU's registers at these offsets freeze what while the core is halted.
const APB1_FZ: u32 = 0x08;
const APB2_FZ: u32 = 0x0C;
const TIM2_STOP: u32 = 0;
const TIM5_STOP: u32 = 3;
const IWDG_STOP: u32 = 12;
const TIM1_STOP: u32 = 0;

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
    checksum: Checksum,
    /// Ports A to E.
    pub ports: [Port; 5],
    /// Watchdog.
    pub watchdog: Watchdog,
    /// Power controller and supply.
    pub power: Power,
    /// External interrupts.
    pub exti: Exti,
    debug: File,
    /// What is soldered to the pins.
    pub wiring: Wiring,
    /// State of the noise at the converter.
    noise: u64,
    /// A debugger has halted the core.
    halted: bool,
    /// What is wired to the converter.
    pub analog: Box<dyn Analog>,
    /// Why the chip must be reset.
    pub reset: Option<Cause>,
    /// The supply is gone.
    pub power_cut: bool,
    frequencies: Option<Frequencies>,
    /// Every change of the heater's pin: when, and the share of the time that it is high from then on.
    pub heater_log: Vec<(Ps, f64)>,
    /// The same of the contactor's pin.
    pub contactor_log: Vec<(Ps, f64)>,
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
            checksum: Checksum::default(),
            ports: ['A', 'B', 'C', 'D', 'E'].map(Port::new),
            watchdog: Watchdog::new(32_000),
            debug: File::new(&DEBUG_TABLE),
            power: Power::default(),
            exti: Exti::default(),
            wiring: Wiring::default(),
            noise: 0x2545_F491_4F6C_DD1D,
            halted: false,
            analog,
            reset: None,
            power_cut: false,
            frequencies: None,
            heater_log: vec![(0, 0.0)],
            contactor_log: vec![(0, 0.0)],
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
        self.checksum = Checksum::default();
        self.ports.iter_mut().for_each(Port::reset);
        self.watchdog = Watchdog::new(self.watchdog.oscillator);
        self.power.reset(cause, self.flash.options.brown_out());
        self.exti = Exti::default();
        // The debug unit keeps its settings but over a power-up.
        if cause == Cause::PowerOn {
            self.debug.reset();
        }
        (self.reset, self.power_cut, self.halted) = (None, false, false);
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
        let limits = [
            (f.core, self.flash.max_hz(), "core, by its wait states"),
            (f.core, self.power.max_hz(), "core, by its voltage scale"),
            (f.pclk1, MAX_PCLK1, "slow bus"),
        ];
        match limits.iter().find(|(hz, limit, _)| hz > limit) {
            Some((hz, limit, what)) => Err(format!("{what}: {hz} Hz, at most {limit} Hz allowed")),
            None => Ok(()),
        }
    }

    /// When something next happens by itself, after `now`.
    pub fn next_event(&self, now: Ps) -> Ps {
        let timers = [&self.tim1, &self.tim2, &self.tim5].map(Timer::next_event);
        let busy = self.flash.busy_until();
        let others = [
            self.usart.next_event(),
            self.watchdog.next_event(),
            self.scs.next_event(),
            self.power.supply.next_event(now),
            if busy > now { busy } else { NEVER },
        ];
        timers.into_iter().chain(others).min().unwrap_or(NEVER)
    }

    /// Lets happen what happens until `now`.
    pub fn advance(&mut self, now: Ps) {
        self.follow_pwm(now);
        self.tim5.set_slow_oscillator(self.watchdog.slow_period(), now);
        for timer in [&mut self.tim1, &mut self.tim2, &mut self.tim5] {
            timer.advance(now);
        }
        self.usart.advance(now);
        self.scs.advance(now);
        if self.watchdog.advance(now) && !self.power.holds() {
            self.reset = Some(Cause::Watchdog);
        }
        self.follow_supply(now);
        self.flash.advance(now);
        self.settle(now);
    }

    /// What the timer of the PWM does by itself until `now` reaches the pins when it does it, and not when the core is next looked at.
    fn follow_pwm(&mut self, now: Ps) {
        while self.tim1.next_event() <= now {
            let at = self.tim1.next_event();
            self.tim1.advance(at);
            self.settle(at);
        }
    }

    fn follow_supply(&mut self, now: Ps) {
        self.flash.volts = self.power.supply.volts(now);
        match self.power.advance(now, self.flash.options.brown_out()) {
            // From here on everything is as after a reset, and stays so until the supply is back.
            Some(Event::Down) => self.restart(Cause::BrownOut, now),
            Some(Event::Up(cause)) => self.reset = Some(cause),
            None => {}
        }
    }

    /// Until when the core cannot run: it is halted or held in reset, or waits for the flash.
    pub fn stands_until(&self) -> Ps {
        if self.halted || self.power.holds() { NEVER } else { self.flash.busy_until() }
    }

    /// A debugger halts the core, or lets it go on: what it has been told to freeze stops meanwhile.
    pub fn halt(&mut self, halted: bool, now: Ps) {
        self.halted = halted;
        let frozen = |register, place| halted && bit(self.debug.get(register), place);
        let stops = [(APB2_FZ, TIM1_STOP), (APB1_FZ, TIM2_STOP), (APB1_FZ, TIM5_STOP), (APB1_FZ, IWDG_STOP)];
        let [tim1, tim2, tim5, watchdog] = stops.map(|(register, place)| frozen(register, place));
        self.tim1.freeze(tim1, now);
        self.tim2.freeze(tim2, now);
        self.tim5.freeze(tim5, now);
        self.watchdog.freeze(watchdog, now);
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
        self.follow_lines();
        if self.scs.reset_request {
            self.reset = Some(Cause::Software);
        }
        let (heater, contactor) = (self.heater(), self.contactor());
        for (log, level) in [(&mut self.heater_log, heater), (&mut self.contactor_log, contactor)] {
            if log.last().is_none_or(|(_, before)| *before != level) {
                log.push((now, level));
            }
        }
    }

    /// Levels of pins and voltage detector, and the interrupts that their edges ask for.
    fn follow_lines(&mut self) {
        let used = self.exti.used();
        if used == 0 {
            return;
        }
        let pins = (0..16).filter(|&line| bit(used, line as u32));
        let high = pins.filter(|&line| self.ports.get(self.exti.port(line)).is_some_and(|p| p.level(line)));
        let levels = high.fold(0, |levels, line| levels | 1 << line);
        self.exti.follow(levels | u32::from(self.power.is_low()) << exti::DETECTOR);
        for (number, lines) in exti::INTERRUPTS {
            self.scs.nvic.line(number, self.exti.level(lines));
        }
    }

    /// Wires a pin of a port (0 is A) to a level, or leaves it open.
    pub fn wire(&mut self, port: usize, pin: usize, level: Option<bool>, now: Ps) {
        self.ports[port].wire(pin, level);
        self.settle(now);
    }

    /// The external clock runs at another frequency, in Hz.
    pub fn set_external_clock(&mut self, hz: u64, now: Ps) {
        self.clocks.external = Some(hz);
        self.clocks_changed(now);
    }

    /// The external clock stops.
    pub fn fail_external_clock(&mut self, now: Ps) {
        self.clocks.fail_external();
        self.clocks_changed(now);
        self.settle(now);
    }
}
