//! The core: runs the image's instructions in the emulator, and does by hand what the emulator has not: the passing of
//! time, exception entry and return, sleep, faults, reset.
//!
//! One instruction takes one cycle of the core clock. A hook at the begin of each block of instructions counts them and
//! stops the emulator when something is to happen before the block.

mod exceptions;
mod hooks;
mod machine;
mod probe;

use std::rc::Rc;

use anyhow::{Context, anyhow, bail};
use unicorn_engine::unicorn_const::{Arch, Mode, uc_error};
use unicorn_engine::{ArmCpuModel, RegisterARM, Unicorn};

use crate::chip::{Analog, Chip};
use crate::clock::Cause;
use crate::cpu::exceptions::{INVSTATE, UNALIGNED, UNDEFINSTR};
use crate::cpu::hooks::{EXCEPTION_RETURN, Emulator};
use crate::cpu::machine::{Machine, Stop};
use crate::image::{FLASH, Image};
use crate::nvic::{Exception, USAGE_FAULT};
use crate::time::{NEVER, Ps};

/// RAM of the chip.
pub const RAM: u32 = 0x2000_0000;
/// Its size.
pub const RAM_SIZE: usize = 128 * 1024;
/// The emulator's number of a breakpoint, and the instruction of one that asks the debugger for something.
const BREAKPOINT: u32 = 7;
const SEMIHOSTING: u32 = 0xBEAB;
/// An address that is never reached.
const NOWHERE: u64 = 0xFFFF_FFFE;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The time is up.
    Time,
    /// The watched address is reached; it is the next to be executed.
    Watched(u32),
    /// The supply went in the middle of a flash operation.
    PowerCut,
    /// The core fell asleep; once for each time.
    Asleep,
    /// The chip was reset and is about to start anew.
    Reset(Cause),
    /// The program asks the debugger for something, and waits for [`Cpu::answer`]: a semihosting call, its number and what it is given.
    Call(u32, u32),
}

/// What the core is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Running,
    Sleeping {
        for_event: bool,
    },
    /// Dead until a reset: a fault in the hard fault's handler, or a clock that stands still.
    Dead,
}

/// The core with its memory and the chip.
pub struct Cpu {
    emulator: Emulator<'static>,
    image: Rc<Image>,
    pc: u32,
    state: State,
    watched: Vec<(u32, unicorn_engine::UcHookId)>,
}

/// An error of the emulator, told.
fn told(error: uc_error) -> anyhow::Error {
    anyhow!("the emulator says {error:?}")
}

impl Cpu {
    /// A chip with this image in its flash, that has just been powered up.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn new(image: Rc<Image>, analog: Box<dyn Analog>) -> anyhow::Result<Self> {
        let machine = Machine::new(Chip::new(analog), image.clone());
        let mut emulator =
            Unicorn::new_with_data(Arch::ARM, Mode::MCLASS | Mode::THUMB, machine).map_err(told)?;
        emulator.ctl_set_cpu_model(ArmCpuModel::UC_CPU_ARM_CORTEX_M4 as i32).map_err(told)?;
        hooks::set_up(&mut emulator, &image).map_err(told)?;
        let mut cpu = Self { emulator, image, pc: 0, state: State::Running, watched: Vec::new() };
        cpu.fill_ram()?;
        cpu.start()?;
        Ok(cpu)
    }

    /// The chip.
    pub fn chip(&self) -> &Chip {
        &self.emulator.get_data().chip
    }

    /// The time.
    pub fn now(&self) -> Ps {
        self.emulator.get_data().now
    }

    /// Instructions since the start.
    pub fn instructions(&self) -> u64 {
        self.emulator.get_data().instructions
    }

    /// Does something to the chip from outside, at the present time.
    pub fn touch<T>(&mut self, change: impl FnOnce(&mut Chip, Ps) -> T) -> T {
        let machine = self.emulator.get_data_mut();
        let result = change(&mut machine.chip, machine.now);
        machine.reschedule();
        result
    }

    fn machine(&mut self) -> &mut Machine {
        self.emulator.get_data_mut()
    }

    fn register(&self, register: RegisterARM) -> anyhow::Result<u32> {
        Ok(self.emulator.reg_read(register).map_err(told)? as u32)
    }

    fn set_register(&mut self, register: RegisterARM, value: u32) -> anyhow::Result<()> {
        self.emulator.reg_write(register, value.into()).map_err(told)
    }

    /// The exception that runs, 0 in thread mode.
    pub fn exception(&self) -> Exception {
        self.chip().scs.nvic.running()
    }

    /// RAM holds noise after power-up; the same each time.
    fn fill_ram(&mut self) -> anyhow::Result<()> {
        let mut state = 0x2545_F491_4F6C_DD1Du64;
        let noise = std::iter::repeat_with(|| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state.to_le_bytes()
        });
        let ram: Vec<u8> = noise.take(RAM_SIZE / 8).flatten().collect();
        self.emulator.mem_write(RAM.into(), &ram).map_err(told)
    }

    /// Power goes and comes back.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn power_cycle(&mut self) -> anyhow::Result<()> {
        self.fill_ram()?;
        self.reset(Cause::PowerOn)
    }

    /// The chip is reset.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn reset(&mut self, cause: Cause) -> anyhow::Result<()> {
        if std::mem::take(&mut self.machine().chip.power.ram_lost) {
            self.fill_ram()?;
        }
        let machine = self.machine();
        machine.chip.restart(cause, machine.now);
        machine.event = false;
        self.state = State::Running;
        self.start()
    }

    /// The core begins at its reset vector.
    fn start(&mut self) -> anyhow::Result<()> {
        let vectors = FLASH;
        let (stack, entry) = (self.image.word(vectors), self.image.word(vectors + 4));
        let (stack, entry) = stack.zip(entry).context("the image has no vector table")?;
        for register in
            [RegisterARM::PRIMASK, RegisterARM::BASEPRI, RegisterARM::FAULTMASK, RegisterARM::CONTROL]
        {
            self.set_register(register, 0)?;
        }
        self.set_register(RegisterARM::XPSR_NZCVQG, 1 << 24)?;
        self.set_register(RegisterARM::SP, stack)?;
        self.set_register(RegisterARM::LR, u32::MAX)?;
        self.jump(entry);
        self.machine().reschedule();
        Ok(())
    }

    /// Runs until a time, or until something happens that the caller is told of.
    ///
    /// # Errors
    /// The program did something that is not modelled: what, where.
    pub fn run(&mut self, until: Ps) -> anyhow::Result<Outcome> {
        self.machine().until = until;
        self.machine().reschedule();
        loop {
            if let Some(why) = self.machine().refused.take() {
                let pc = self.register(RegisterARM::PC).unwrap_or(self.pc);
                bail!("{why}, at {} or the block before it", self.image.describe(pc));
            }
            if std::mem::take(&mut self.machine().chip.power_cut) {
                return Ok(Outcome::PowerCut);
            }
            if let Some(cause) = self.machine().chip.reset {
                self.reset(cause)?;
                return Ok(Outcome::Reset(cause));
            }
            if self.now() >= until {
                return Ok(Outcome::Time);
            }
            if self.chip().stands_until() > self.now() {
                self.skip();
                continue;
            }
            if self.machine().cycle == NEVER {
                self.state = State::Dead; // no clock
            }
            match self.state {
                State::Running => {
                    if let Some(outcome) = self.execute()? {
                        return Ok(outcome);
                    }
                }
                State::Sleeping { for_event } => self.sleep(for_event)?,
                State::Dead => self.skip(),
            }
        }
    }

    /// Time passes until something happens on the chip.
    fn skip(&mut self) {
        let machine = self.machine();
        machine.now = machine.chip.next_event(machine.now).min(machine.until).max(machine.now);
        machine.chip.advance(machine.now);
    }

    fn masks(&self) -> anyhow::Result<(bool, u8)> {
        Ok((self.register(RegisterARM::PRIMASK)? & 1 == 1, self.register(RegisterARM::BASEPRI)? as u8))
    }

    fn sleep(&mut self, for_event: bool) -> anyhow::Result<()> {
        let (_, basepri) = self.masks()?;
        let machine = self.machine();
        // PRIMASK keeps an interrupt from being taken, not from waking.
        let woken = machine.chip.scs.nvic.takeable(false, basepri).is_some();
        if woken || (for_event && std::mem::take(&mut machine.event)) {
            self.state = State::Running;
        } else {
            self.skip();
        }
        Ok(())
    }

    /// Executes until the emulator stops, after entering whatever exception is due.
    fn execute(&mut self) -> anyhow::Result<Option<Outcome>> {
        if self.machine().chip.scs.nvic.any() {
            let (primask, basepri) = self.masks()?;
            if let Some(exception) = self.chip().scs.nvic.takeable(primask, basepri) {
                self.enter(exception)?;
            }
        }
        self.machine().reschedule();
        self.machine().stop = None;
        let result = self.emulator.emu_start(u64::from(self.pc) | 1, NOWHERE, 0, 0);
        let stop = self.machine().stop.take();
        match (stop, result) {
            (Some(stop), _) => self.stopped(stop),
            (None, Ok(())) => {
                self.pc = self.register(RegisterARM::PC)?;
                match self.pc >= EXCEPTION_RETURN {
                    true => self.leave(self.pc | 1),
                    false => Ok(()),
                }?;
                Ok(None)
            }
            (None, Err(error)) => self.faulted(error).map(|()| None),
        }
    }

    fn stopped(&mut self, stop: Stop) -> anyhow::Result<Option<Outcome>> {
        match stop {
            Stop::Before(address) => self.pc = address,
            Stop::Return(value) => self.leave(value)?,
            Stop::Sleep { at, for_event } => {
                self.pc = at + 2;
                if !(for_event && std::mem::take(&mut self.machine().event)) {
                    self.state = State::Sleeping { for_event };
                    return Ok(Some(Outcome::Asleep));
                }
            }
            Stop::Watched(address) => {
                self.pc = address;
                self.machine().passing = Some(address);
                return Ok(Some(Outcome::Watched(address)));
            }
            Stop::Trap(number) => {
                self.pc = self.register(RegisterARM::PC)?;
                if number == BREAKPOINT
                    && self.word(self.pc & !3)? >> (8 * (self.pc & 2)) & 0xFFFF == SEMIHOSTING
                {
                    let [call, given] =
                        [RegisterARM::R0, RegisterARM::R1].map(|register| self.register(register));
                    return Ok(Some(Outcome::Call(call?, given?)));
                }
                match number {
                    8 => self.leave(self.pc | 1)?, // the emulator's own "exit of an exception"
                    3 | 17 | 18 => self.fault(USAGE_FAULT, INVSTATE, None)?,
                    1 => self.fault(USAGE_FAULT, UNDEFINSTR, None)?,
                    4 => self.fault(USAGE_FAULT, UNALIGNED, None)?,
                    _ => bail!("trap {number} at {} is not modelled", self.image.describe(self.pc)),
                }
            }
        }
        Ok(None)
    }
}
