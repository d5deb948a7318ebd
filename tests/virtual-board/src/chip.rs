//! The chip around the core: which peripheral answers at which address, what one does to another, what is wired to the
//! pins. An access that no peripheral answers fails the run.

use crate::adc::Adc;
use crate::clock::{Cause, Clocks, Frequencies, RESETS};
use crate::flash::{self, Effect, Flash};
use crate::gpio::{Mode, Port};
use crate::nvic::NMI;
use crate::registers::{File, Refusal, Register, register};
use crate::scs::Scs;
use crate::time::{NEVER, Ps, period};
use crate::timer::{Lines, Output, Timer};
use crate::usart::Usart;
use crate::watchdog::Watchdog;

/// What is wired to the converter's inputs, and to the heater's pin.
pub trait Analog {
    /// The code that the converter reads from a channel at a time; `power` is the share of the time that the heater's
    /// pin is high.
    fn code(&mut self, channel: u8, now: Ps, power: f64) -> u16;
}

/// A peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Block {
    Tim1,
    Tim2,
    Tim5,
    Usart2,
    Adc1,
    Gpio(usize),
    Clocks,
    Power,
    Flash,
    FlashMemory,
    Watchdog,
    Exti,
    Syscfg,
    Scs,
    Debug,
}

/// Where a peripheral is, how large, and which bit of which enable register (from RCC_AHB1ENR) gives it its clock.
struct Place {
    base: u32,
    size: u32,
    block: Block,
    clock: Option<(u32, u32)>,
}

const fn place(base: u32, size: u32, block: Block, clock: Option<(u32, u32)>) -> Place {
    Place { base, size, block, clock }
}

const AHB1: u32 = 0x00;
const APB1: u32 = 0x10;
const APB2: u32 = 0x14;

/// The memory map.
static MAP: [Place; 19] = [
    place(0x4000_0000, 0x400, Block::Tim2, Some((APB1, 0))),
    place(0x4000_0C00, 0x400, Block::Tim5, Some((APB1, 3))),
    place(0x4000_3000, 0x400, Block::Watchdog, None),
    place(0x4000_4400, 0x400, Block::Usart2, Some((APB1, 17))),
    place(0x4000_7000, 0x400, Block::Power, Some((APB1, 28))),
    place(0x4001_0000, 0x400, Block::Tim1, Some((APB2, 0))),
    place(0x4001_2000, 0x400, Block::Adc1, Some((APB2, 8))),
    place(0x4001_3800, 0x400, Block::Syscfg, Some((APB2, 14))),
    place(0x4001_3C00, 0x400, Block::Exti, None),
    place(0x4002_0000, 0x400, Block::Gpio(0), Some((AHB1, 0))),
    place(0x4002_0400, 0x400, Block::Gpio(1), Some((AHB1, 1))),
    place(0x4002_0800, 0x400, Block::Gpio(2), Some((AHB1, 2))),
    place(0x4002_0C00, 0x400, Block::Gpio(3), Some((AHB1, 3))),
    place(0x4002_1000, 0x400, Block::Gpio(4), Some((AHB1, 4))),
    place(0x4002_3800, 0x400, Block::Clocks, None),
    place(0x4002_3C00, 0x400, Block::Flash, None),
    place(flash::BASE, 2 * flash::SECTOR as u32, Block::FlashMemory, None),
    place(0xE000_E000, 0x1000, Block::Scs, None),
    place(0xE004_2000, 0x400, Block::Debug, None),
];

/// Regions of peripherals and of nothing known: an access there that the map does not have fails the run, while
/// elsewhere it is a bus fault of the program.
pub const PERIPHERALS: [(u32, u32); 5] = [
    (0x1FFF_0000, 0x8000),
    (0x4000_0000, 0x8_0000),
    (0x5000_0000, 0x4_0000),
    (0xE000_0000, 0x10_0000),
    (flash::BASE, 2 * flash::SECTOR as u32),
];

static DEBUG_TABLE: [Register; 4] = [
    register(0x00, "IDCODE", 0x1000_6431, 0),
    register(0x04, "CR", 0, 0xE7),
    register(0x08, "APB1_FZ", 0, 0x00E0_1C0F),
    register(0x0C, "APB2_FZ", 0, 0x0007_0001),
];

static EXTI_TABLE: [Register; 6] = [
    register(0x00, "IMR", 0, 0),
    register(0x04, "EMR", 0, 0),
    register(0x08, "RTSR", 0, 0),
    register(0x0C, "FTSR", 0, 0),
    register(0x10, "SWIER", 0, 0),
    register(0x14, "PR", 0, 0),
];

static SYSCFG_TABLE: [Register; 1] = [register(0x20, "CMPCR", 0, 0)];

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

    fn find(&mut self, address: u32, now: Ps) -> Result<(Block, u32), Refusal> {
        let place = MAP.iter().find(|p| (p.base..p.base + p.size).contains(&address));
        let place = place.ok_or("no such peripheral in the model")?;
        if let Some((register, bit)) = place.clock
            && !self.clocks.is_enabled(register, bit)
        {
            return Err(format!("{:?} has no clock", place.block));
        }
        let _ = now;
        Ok((place.block, address - place.base))
    }

    /// Reads `size` bytes.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, address: u32, size: usize, now: Ps) -> Result<u32, Refusal> {
        let (block, offset) = self.find(address & !3, now)?;
        let word = match block {
            Block::Tim1 => self.tim1.read(offset, now),
            Block::Tim2 => self.tim2.read(offset, now),
            Block::Tim5 => self.tim5.read(offset, now),
            Block::Usart2 => self.usart.read(offset, now),
            Block::Adc1 => self.adc.read(offset, now),
            Block::Gpio(port) => self.ports[port].read(offset),
            Block::Clocks => self.clocks.read(offset, now),
            Block::Power => self.clocks.read_power(offset),
            Block::Flash => self.flash.read(offset),
            Block::FlashMemory => Ok(self.flash_word(offset)),
            Block::Watchdog => self.watchdog.read(offset, now),
            Block::Exti => self.exti.read(offset),
            Block::Syscfg => self.syscfg.read(offset),
            Block::Scs => self.scs.read(offset, now),
            Block::Debug => self.debug.read(offset),
        }
        .map_err(|why| format!("{block:?}: {why}"))?;
        if block == Block::Usart2 {
            self.settle(now);
        }
        let (shift, mask) = (8 * (address & 3), u32::MAX >> (32 - 8 * size.min(4)));
        Ok(word >> shift & mask)
    }

    fn flash_word(&self, offset: u32) -> u32 {
        let at = offset as usize;
        let bytes = self.flash.content.get(at..at + 4).and_then(|b| b.try_into().ok());
        u32::from_le_bytes(bytes.unwrap_or_default())
    }

    /// Writes `size` bytes. The core may have to stand still for it, for the time that is returned.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, address: u32, size: usize, value: u32, now: Ps) -> Result<Ps, Refusal> {
        let (block, offset) = self.find(address, now)?;
        let mut stall = 0;
        if size != 4 {
            self.write_part(block, offset, size, value, now)
        } else {
            self.write_word(block, offset, value, now, &mut stall)
        }
        .map_err(|why| format!("{block:?}: {why}"))?;
        self.settle(now);
        Ok(stall)
    }

    /// The few registers that the program writes a byte or a half of.
    fn write_part(
        &mut self,
        block: Block,
        offset: u32,
        size: usize,
        value: u32,
        now: Ps,
    ) -> Result<(), Refusal> {
        match (block, offset, size) {
            (Block::Scs, _, 1) => self.scs.write_byte(offset, value as u8),
            (Block::Usart2, 4, 1) => self.usart.write(offset, value, now),
            // Registers of 16 bits.
            (Block::Tim2, 0..0x24 | 0x28, 2) => self.tim2.write(offset, value, now),
            (Block::Tim5, 0..0x24 | 0x28, 2) => self.tim5.write(offset, value, now),
            (Block::Tim1, _, 2) => self.tim1.write(offset, value, now),
            _ => Err(format!("writing {size} bytes here is not modelled")),
        }
    }

    fn write_word(
        &mut self,
        block: Block,
        offset: u32,
        value: u32,
        now: Ps,
        stall: &mut Ps,
    ) -> Result<(), Refusal> {
        match block {
            Block::Tim1 => self.tim1.write(offset, value, now),
            Block::Tim2 => self.tim2.write(offset, value, now),
            Block::Tim5 => self.tim5.write(offset, value, now),
            Block::Usart2 => self.usart.write(offset, value, now),
            Block::Adc1 => self.write_adc(offset, value, now),
            Block::Gpio(port) => self.ports[port].write(offset, value),
            Block::Clocks => {
                self.clocks.write(offset, value, now)?;
                self.reset_blocks(offset, value, now);
                self.clocks_changed(now);
                self.check_speed()
            }
            Block::Power => self.clocks.write_power(offset, value),
            Block::Flash => {
                let effect = self.flash.write(offset, value)?;
                self.flash_effect(effect, stall);
                self.check_speed()
            }
            Block::FlashMemory => {
                let effect = self.flash.program(offset, 4, value)?;
                self.flash_effect(effect, stall);
                Ok(())
            }
            Block::Watchdog => self.watchdog.write(offset, value, now),
            Block::Exti => self.exti.write(offset, value),
            Block::Syscfg => self.syscfg.write(offset, value),
            Block::Scs => self.scs.write(offset, value, now),
            Block::Debug => self.debug.write(offset, value),
        }
    }

    fn flash_effect(&mut self, effect: Effect, stall: &mut Ps) {
        match effect {
            Effect::None => {}
            Effect::Stall(time) => *stall = time,
            Effect::PowerCut => self.power_cut = true,
        }
    }

    /// A one in a reset register resets the peripheral whose enable stands at the same place.
    fn reset_blocks(&mut self, offset: u32, value: u32, now: Ps) {
        let Some(register) = offset.checked_sub(RESETS).filter(|r| *r <= APB2) else { return };
        let hit = |p: &&Place| p.clock.is_some_and(|(r, place)| r == register && value >> place & 1 == 1);
        for place in MAP.iter().filter(hit) {
            match place.block {
                Block::Tim1 => self.tim1.reset(now),
                Block::Tim2 => self.tim2.reset(now),
                Block::Tim5 => self.tim5.reset(now),
                Block::Usart2 => self.usart.reset(),
                Block::Adc1 => self.adc = Adc::default(),
                Block::Gpio(port) => self.ports[port].reset(),
                _ => {}
            }
        }
    }

    fn write_adc(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        let Some(channel) = self.adc.write(offset, value, now)? else { return Ok(()) };
        let (port, pin) = match channel {
            0..8 => (0, channel),
            8..10 => (1, channel - 8),
            10..16 => (2, channel - 10),
            _ => return Err(format!("channel {channel} is not modelled")),
        };
        if self.ports[port].mode(pin.into()) != Mode::Analog {
            return Err(format!("channel {channel} is converted, but its pin is not analogue"));
        }
        let code = self.analog.code(channel, now, self.heater());
        let pclk2 = self.frequencies.map_or(0, |f| f.pclk2);
        self.adc.convert(channel, code, pclk2, now)
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
