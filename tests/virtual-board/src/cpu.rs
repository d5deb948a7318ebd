//! The core: runs the image's instructions in the emulator, and does by hand what the emulator has not: the passing of
//! time, exception entry and return, sleep, faults, reset.
//!
//! One instruction takes one cycle of the core clock. A hook at the begin of each block of instructions counts them and
//! stops the emulator when something is to happen before the block.

use std::rc::Rc;

use anyhow::{Context, anyhow, bail, ensure};
use unicorn_engine::unicorn_const::{Arch, HookType, Mode, Permission};
use unicorn_engine::{ArmCpuModel, RegisterARM, Unicorn};

use crate::chip::{Analog, Chip, PERIPHERALS};
use crate::clock::Cause;
use crate::image::{FLASH, FLASH_SIZE, Image};
use crate::nvic::{BUS_FAULT, Exception, HARD_FAULT, NMI, USAGE_FAULT};
use crate::time::{NEVER, Ps};

/// RAM of the chip.
pub const RAM: u32 = 0x2000_0000;
/// Its size.
pub const RAM_SIZE: usize = 128 * 1024;
/// Values that return from an exception when they are jumped to.
const EXCEPTION_RETURN: u32 = 0xFFFF_FF00;
/// The page of them, which must exist.
const RETURN_PAGE: u64 = 0xFFFF_F000;
/// An address that is never reached.
const NOWHERE: u64 = 0xFFFF_FFFE;
/// Cycles of entering an exception, and of leaving it.
const ENTRY: Ps = 12;
const EXIT: Ps = 10;

/// Instructions that sleep, and the one that wakes.
const WFE: u16 = 0xBF20;
const WFI: u16 = 0xBF30;
const SEV: u16 = 0xBF40;

/// Bits of CFSR.
const IBUSERR: u32 = 1 << 8;
const PRECISERR_BFARVALID: u32 = 1 << 9 | 1 << 15;
const STKERR: u32 = 1 << 12;
const UNDEFINSTR: u32 = 1 << 16;
const INVSTATE: u32 = 1 << 17;

/// Why the emulator stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    /// Something is to happen before the block at this address.
    Before(u32),
    /// A jump that returns from an exception.
    Return(u32),
    /// WFE or WFI at this address.
    Sleep { at: u32, for_event: bool },
    /// A watched address is reached.
    Watched(u32),
    /// A trap of the processor: supervisor call, breakpoint, undefined.
    Trap(u32),
}

/// What the hooks of the emulator share with the rest.
pub struct Machine {
    /// The chip.
    pub chip: Chip,
    /// The time.
    pub now: Ps,
    cycle: Ps,
    /// When the block hook has to look.
    deadline: Ps,
    /// When the run is to end.
    until: Ps,
    stop: Option<Stop>,
    event: bool,
    /// Where the block before began.
    last: u32,
    /// Size of the block in bytes and its instructions, by the half of the flash at which it begins.
    blocks: Vec<(u16, u16)>,
    code: Rc<Image>,
    /// An access that nothing answers: address, and why it failed.
    refused: Option<String>,
    /// A watched address that has just been reported is passed once.
    passing: Option<u32>,
    /// The access that faulted: address, and whether it was a fetch.
    faulted: Option<(u32, bool)>,
    /// Instructions since the start.
    pub instructions: u64,
}

impl Machine {
    fn new(chip: Chip, code: Rc<Image>) -> Self {
        Self {
            chip,
            now: 0,
            cycle: 62_500,
            deadline: 0,
            until: 0,
            stop: None,
            event: false,
            last: 0,
            blocks: vec![(0, 0); FLASH_SIZE / 2],
            code,
            refused: None,
            passing: None,
            faulted: None,
            instructions: 0,
        }
    }

    /// Instructions in the block at `address` of `size` bytes.
    fn count(&mut self, address: u32, size: u32) -> u64 {
        let place = (address.wrapping_sub(FLASH) / 2) as usize;
        let Some(known) = self.blocks.get_mut(place) else { return u64::from(size / 2).max(1) };
        if u32::from(known.0) != size {
            let bytes = self.code.flash.get(2 * place..2 * place + size as usize).unwrap_or_default();
            *known = (size as u16, instructions(bytes));
        }
        known.1.into()
    }

    fn reschedule(&mut self) {
        self.deadline = self.chip.next_event().min(self.until);
        self.cycle = self.chip.cycle().unwrap_or(NEVER);
        if self.must_stop() || self.chip.scs.nvic.any() {
            self.deadline = self.now;
        }
    }

    /// The emulator has to be left for something that is no interrupt.
    fn must_stop(&self) -> bool {
        self.refused.is_some() || self.chip.reset.is_some() || self.chip.power_cut || self.cycle == NEVER
    }

    fn refuse(&mut self, why: String) {
        self.refused.get_or_insert(why);
        self.deadline = self.now;
    }
}

/// Number of Thumb instructions in some code.
fn instructions(code: &[u8]) -> u16 {
    let mut halves = code.chunks_exact(2);
    let mut n = 0;
    while let Some([_, high]) = halves.next() {
        n += 1;
        if high >> 3 >= 0b11101 {
            halves.next(); // the second half of a long one
        }
    }
    n
}

/// The emulator.
type Emulator<'a> = Unicorn<'a, Machine>;

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
fn told(error: unicorn_engine::unicorn_const::uc_error) -> anyhow::Error {
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
        map_memory(&mut emulator, &image).map_err(told)?;
        map_peripherals(&mut emulator).map_err(told)?;
        add_hooks(&mut emulator, &image).map_err(told)?;
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

    /// Reads a word of memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn word(&self, address: u32) -> anyhow::Result<u32> {
        let mut bytes = [0; 4];
        self.emulator.mem_read(address.into(), &mut bytes).map_err(told)?;
        Ok(u32::from_le_bytes(bytes))
    }

    /// Reads memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn bytes(&self, address: u32, size: usize) -> anyhow::Result<Vec<u8>> {
        self.emulator.mem_read_as_vec(address.into(), size).map_err(told)
    }

    /// Writes a word of memory, as a debug probe does.
    ///
    /// # Errors
    /// There is no memory.
    pub fn set_word(&mut self, address: u32, value: u32) -> anyhow::Result<()> {
        self.emulator.mem_write(address.into(), &value.to_le_bytes()).map_err(told)
    }

    /// The next instruction to be executed.
    pub fn pc(&self) -> u32 {
        self.pc
    }

    /// Has the core go on somewhere else, awake: a program counter gone wild.
    pub fn jump(&mut self, address: u32) {
        self.pc = address & !1;
        self.state = State::Running;
        self.machine().passing = None;
    }

    /// As [`Self::jump`], with the first argument of a function.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn call(&mut self, address: u32, argument: u32) -> anyhow::Result<()> {
        self.jump(address);
        self.set_register(RegisterARM::R0, argument)
    }

    /// Where the function that is about to begin will return to.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn link(&self) -> anyhow::Result<u32> {
        self.register(RegisterARM::LR)
    }

    /// The exception that runs, 0 in thread mode.
    pub fn exception(&self) -> Exception {
        self.chip().scs.nvic.running()
    }

    /// Whether the core hangs until a reset.
    pub fn is_dead(&self) -> bool {
        self.state == State::Dead
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
        let machine = self.machine();
        machine.chip.restart(cause, machine.now);
        machine.event = false;
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

    /// Stops each run just before the instruction at this address, until it is no longer watched.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn watch(&mut self, address: u32) -> anyhow::Result<()> {
        let address = address & !1;
        let at = u64::from(address);
        let hook = self.emulator.add_code_hook(at, at, |emulator, address, _| {
            let machine = emulator.get_data_mut();
            if machine.passing.take() != Some(address as u32) {
                machine.stop.get_or_insert(Stop::Watched(address as u32));
                let _ = emulator.emu_stop();
            }
        });
        self.watched.push((address, hook.map_err(told)?));
        self.forget_translation(address)
    }

    /// Stops watching all addresses.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn unwatch(&mut self) -> anyhow::Result<()> {
        for (address, hook) in std::mem::take(&mut self.watched) {
            self.emulator.remove_hook(hook).map_err(told)?;
            self.forget_translation(address)?;
        }
        self.machine().passing = None;
        Ok(())
    }

    /// Code that has been translated knows only the hooks of that time. Forgetting all of it takes a second, so it is
    /// the block that begins here: where a function begins.
    fn forget_translation(&mut self, address: u32) -> anyhow::Result<()> {
        let address = u64::from(address);
        self.emulator.ctl_remove_cache(address, address + 2).map_err(told)
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
        machine.now = machine.chip.next_event().min(machine.until).max(machine.now);
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
                match number {
                    8 => self.leave(self.pc | 1)?, // the emulator's own "exit of an exception"
                    3 | 17 | 18 => self.fault(USAGE_FAULT, INVSTATE, None)?,
                    1 => self.fault(USAGE_FAULT, UNDEFINSTR, None)?,
                    _ => bail!("trap {number} at {} is not modelled", self.image.describe(self.pc)),
                }
            }
        }
        Ok(None)
    }

    /// What the emulator could not execute.
    fn faulted(&mut self, error: unicorn_engine::unicorn_const::uc_error) -> anyhow::Result<()> {
        use unicorn_engine::unicorn_const::uc_error as E;
        self.pc = self.register(RegisterARM::PC)?;
        let access = self.machine().faulted.take();
        match (error, access) {
            (_, Some((address, true))) => {
                self.pc = address;
                self.fault(BUS_FAULT, IBUSERR, None)
            }
            (_, Some((address, false))) => self.fault(BUS_FAULT, PRECISERR_BFARVALID, Some(address)),
            (E::INSN_INVALID, _) => self.fault(USAGE_FAULT, UNDEFINSTR, None),
            (E::EXCEPTION, _) => self.fault(USAGE_FAULT, INVSTATE, None),
            (error, _) => bail!("the emulator says {error:?} at {}", self.image.describe(self.pc)),
        }
    }

    fn fault(&mut self, exception: Exception, status: u32, address: Option<u32>) -> anyhow::Result<()> {
        match self.machine().chip.scs.fault(exception, status, address) {
            Some(handler) => self.enter(handler),
            None => {
                self.state = State::Dead;
                Ok(())
            }
        }
    }

    /// Enters an exception: frame, link, mode, vector.
    fn enter(&mut self, exception: Exception) -> anyhow::Result<()> {
        let control = self.register(RegisterARM::CONTROL)?;
        ensure!(control & 2 == 0, "the process stack is not modelled");
        let xpsr = self.register(RegisterARM::XPSR)?;
        let with_fpu = control & 4 != 0;
        let sp = self.register(RegisterARM::SP)?;
        let size = if with_fpu { 26 * 4 } else { 8 * 4 };
        let frame = sp.wrapping_sub(size) & !7;
        let words = self.frame(xpsr & !(1 << 9) | (sp & 4) << 7, with_fpu)?;
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        if self.emulator.mem_write(frame.into(), &bytes).is_err() {
            self.machine().chip.scs.raise(crate::scs::CFSR, STKERR);
            if exception != HARD_FAULT && exception != NMI {
                self.set_register(RegisterARM::SP, frame)?;
                return self.fault(BUS_FAULT, STKERR, None);
            }
        }
        let in_handler = self.exception() != 0;
        let link = 0xFFFF_FFE1 | u32::from(!in_handler) << 3 | u32::from(!with_fpu) << 4;
        self.set_register(RegisterARM::SP, frame)?;
        self.set_register(RegisterARM::LR, link)?;
        self.set_register(RegisterARM::CONTROL, control & !4)?;
        self.set_register(RegisterARM::XPSR_NZCVQG, 1 << 24 | u32::from(exception))?;
        let vector = self.chip().scs.vector_table() + 4 * u32::from(exception);
        self.pc = self.word(vector)? & !1;
        let machine = self.machine();
        machine.chip.scs.nvic.enter(exception);
        machine.event = true;
        machine.now += ENTRY * machine.cycle;
        Ok(())
    }

    /// The words that are stacked.
    fn frame(&self, xpsr: u32, with_fpu: bool) -> anyhow::Result<Vec<u32>> {
        use RegisterARM::{LR, R0, R1, R2, R3, R12};
        let mut words = Vec::with_capacity(26);
        for register in [R0, R1, R2, R3, R12, LR] {
            words.push(self.register(register)?);
        }
        words.extend([self.pc, xpsr]);
        if with_fpu {
            for i in 0..16 {
                words.push(self.emulator.reg_read(RegisterARM::S0 as i32 + i).map_err(told)? as u32);
            }
            words.extend([self.register(RegisterARM::FPSCR)?, 0]);
        }
        Ok(words)
    }

    /// Leaves an exception by the value that was jumped to.
    fn leave(&mut self, value: u32) -> anyhow::Result<()> {
        use RegisterARM::{LR, R0, R1, R2, R3, R12};
        let exception = self.exception();
        ensure!(exception != 0, "a return from no exception, {value:#x}");
        let with_fpu = value & 0x10 == 0;
        let sp = self.register(RegisterARM::SP)?;
        let size = if with_fpu { 26 } else { 8 };
        let bytes = self.emulator.mem_read_as_vec(sp.into(), 4 * size).map_err(told)?;
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        for (register, word) in [R0, R1, R2, R3, R12, LR].into_iter().zip(&words) {
            self.set_register(register, *word)?;
        }
        let xpsr = words[7];
        if with_fpu {
            for (i, word) in (0..16).zip(&words[8..]) {
                self.emulator.reg_write(RegisterARM::S0 as i32 + i, u64::from(*word)).map_err(told)?;
            }
            self.set_register(RegisterARM::FPSCR, words[24])?;
        }
        let control = self.register(RegisterARM::CONTROL)?;
        self.set_register(RegisterARM::CONTROL, control & !4 | u32::from(with_fpu) << 2)?;
        self.set_register(RegisterARM::XPSR_NZCVQG, xpsr & !(1 << 9))?;
        self.set_register(RegisterARM::SP, sp + 4 * size as u32 + (xpsr >> 7 & 4))?;
        self.pc = words[6] & !1;
        let machine = self.machine();
        machine.chip.scs.nvic.leave(exception);
        machine.event = true;
        machine.now += EXIT * machine.cycle;
        Ok(())
    }
}

fn map_memory(
    emulator: &mut Emulator<'_>,
    image: &Image,
) -> Result<(), unicorn_engine::unicorn_const::uc_error> {
    let code = Permission::READ | Permission::EXEC;
    for base in [0, FLASH] {
        emulator.mem_map(base.into(), FLASH_SIZE, code)?;
        emulator.mem_write(base.into(), &image.flash)?;
    }
    emulator.mem_map(RAM.into(), RAM_SIZE, Permission::ALL)?;
    emulator.mem_map(RETURN_PAGE, 0x1000, code)?;
    emulator.mem_write(RETURN_PAGE, &[0x00, 0xBF].repeat(0x800))
}

fn map_peripherals(emulator: &mut Emulator<'static>) -> Result<(), unicorn_engine::unicorn_const::uc_error> {
    for (base, size) in PERIPHERALS {
        let read = move |emulator: &mut Emulator<'_>, offset: u64, size: usize| -> u64 {
            let machine = emulator.get_data_mut();
            let address = base + offset as u32;
            match machine.chip.read(address, size, machine.now) {
                Ok(value) => {
                    if machine.chip.scs.nvic.any() {
                        machine.deadline = machine.now;
                    }
                    value.into()
                }
                Err(why) => {
                    machine.refuse(format!("read of {address:#010x}: {why}"));
                    0
                }
            }
        };
        let write = move |emulator: &mut Emulator<'_>, offset: u64, size: usize, value: u64| {
            let machine = emulator.get_data_mut();
            let address = base + offset as u32;
            match machine.chip.write(address, size, value as u32, machine.now) {
                Ok(stall) => machine.now += stall,
                Err(why) => machine.refuse(format!("write of {value:#x} to {address:#010x}: {why}")),
            }
            machine.reschedule();
        };
        emulator.mmio_map(base.into(), size as usize, Some(read), Some(write))?;
    }
    Ok(())
}

fn add_hooks(
    emulator: &mut Emulator<'static>,
    image: &Image,
) -> Result<(), unicorn_engine::unicorn_const::uc_error> {
    emulator.add_block_hook(0, u64::from(u32::MAX), block)?;
    emulator.add_intr_hook(|emulator, number| {
        emulator.get_data_mut().stop.get_or_insert(Stop::Trap(number));
        let _ = emulator.emu_stop();
    })?;
    let absent = HookType::MEM_UNMAPPED | HookType::MEM_PROT;
    emulator.add_mem_hook(absent, 0, u64::from(u32::MAX), |emulator, kind, address, _, _| {
        use unicorn_engine::unicorn_const::MemType;
        let fetch = matches!(kind, MemType::FETCH_UNMAPPED | MemType::FETCH_PROT);
        emulator.get_data_mut().faulted.get_or_insert((address as u32, fetch));
        false
    })?;
    for (i, half) in image.flash.chunks_exact(2).enumerate() {
        let at = u64::from(FLASH) + 2 * i as u64;
        match u16::from_le_bytes([half[0], half[1]]) {
            SEV => {
                drop(emulator.add_code_hook(at, at, |emulator, _, _| emulator.get_data_mut().event = true)?)
            }
            code @ (WFE | WFI) => {
                let for_event = code == WFE;
                emulator.add_code_hook(at, at, move |emulator, address, _| {
                    let stop = Stop::Sleep { at: address as u32, for_event };
                    emulator.get_data_mut().stop.get_or_insert(stop);
                    let _ = emulator.emu_stop();
                })?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Before each block of instructions.
fn block(emulator: &mut Emulator<'_>, address: u64, size: u32) {
    let address = address as u32;
    let machine = emulator.get_data_mut();
    if address >= EXCEPTION_RETURN {
        machine.stop.get_or_insert(Stop::Return(address | 1));
        let _ = emulator.emu_stop();
        return;
    }
    if machine.now >= machine.deadline {
        machine.chip.advance(machine.now);
        let until = machine.until;
        machine.deadline = machine.chip.next_event().min(until);
        let leave = machine.must_stop() || machine.now >= until;
        if leave || interrupted(emulator) {
            emulator.get_data_mut().stop.get_or_insert(Stop::Before(address));
            let _ = emulator.emu_stop();
            return;
        }
    }
    let machine = emulator.get_data_mut();
    if size == 2 && machine.last == address {
        // One instruction that jumps to itself: nothing but the chip can change anything.
        machine.now = machine.chip.next_event().min(machine.until).max(machine.now);
    }
    machine.last = address;
    let count = machine.count(address, size);
    machine.instructions += count;
    machine.now += count * machine.cycle;
}

/// Whether an exception is to be taken now. One that is masked is looked for again at each block.
fn interrupted(emulator: &mut Emulator<'_>) -> bool {
    if !emulator.get_data().chip.scs.nvic.any() {
        return false;
    }
    let primask = emulator.reg_read(RegisterARM::PRIMASK).unwrap_or(0) & 1 == 1;
    let basepri = emulator.reg_read(RegisterARM::BASEPRI).unwrap_or(0) as u8;
    let machine = emulator.get_data_mut();
    let due = machine.chip.scs.nvic.takeable(primask, basepri).is_some();
    if !due {
        machine.deadline = machine.now;
    }
    due
}
