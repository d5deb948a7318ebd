//! The flash controller, its option bytes, and sectors 6 and 7, which the program may erase and program. The core stands
//! still meanwhile, as it does on silicon when it runs from the flash that is busy. After RM0383, chapter 3; times are
//! those of the data sheet.

mod cache;
mod options;

use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::{MS, Ps, US};

pub use cache::Cache;
pub use options::Options;

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const OPTKEYR: u32 = 0x08;
const SR: u32 = 0x0C;
const CR: u32 = 0x10;
const OPTCR: u32 = 0x14;

static TABLE: [Register; 4] = [
    register(ACR, "ACR", 0, 0x1F07),
    register(KEYR, "KEYR", 0, u32::MAX),
    register(SR, "SR", 0, 0xF3),
    register(CR, "CR", 1 << 31, 1 << 31 | 1 << 25 | 1 << 24 | 1 << 16 | 0x37B),
];

const DCEN: u32 = 1 << 10;
const ICEN: u32 = 1 << 9;
const DCRST: u32 = 1 << 12;
const ICRST: u32 = 1 << 11;
const LOCK: u32 = 1 << 31;
const STRT: u32 = 1 << 16;
const SER: u32 = 1 << 1;
const PG: u32 = 1;
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
const BSY: u32 = 1 << 16;
const EOP: u32 = 1;
const WRPERR: u32 = 1 << 4;

/// Where sector 6 begins.
pub const BASE: u32 = 0x0804_0000;
/// Size of a sector.
pub const SECTOR: usize = 128 * 1024;
/// Typical times to erase 128 KiB, and 16 KiB as the option bytes are taken to be, by PSIZE; at most twice as long.
const ERASE: [Ps; 3] = [2000 * MS, 1300 * MS, 1000 * MS];
const ERASE_OPTIONS: [Ps; 3] = [400 * MS, 300 * MS, 250 * MS];
/// To program a word, typical and at most.
const PROGRAM: Ps = 16 * US;
const PROGRAM_SLOW: Ps = 100 * US;
/// Least supply that each PSIZE needs, V. What is done below it goes wrong, and no flag says so.
const LEAST_VOLTS: [f64; 3] = [1.7, 2.1, 2.7];
/// Highest core clock in Hz that each wait state allows for, 2.7 to 3.6 V.
const HZ_A_WAIT_STATE: u64 = 30_000_000;

/// What an operation leaves when the supply goes in the middle of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remains {
    /// Nothing has happened yet.
    Before,
    /// Some of the bits have changed.
    Half,
    /// All is done, but nobody was told.
    After,
}

/// An operation that runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    /// The sector that begins here.
    Erase(usize),
    /// The word here.
    Program(usize, u32),
    /// The option bytes.
    Options(u32),
}

/// Controller and content.
pub struct Flash {
    file: File,
    keys: usize,
    /// Sectors 6 and 7.
    pub content: Vec<u8>,
    /// The cache of the data bus.
    pub cache: Cache,
    /// The option bytes.
    pub options: Options,
    /// The supply goes during the operation after so many.
    pub cut: Option<(u32, Remains)>,
    /// It takes as long as the data sheet allows, not as long as is typical.
    pub slow: bool,
    /// The supply, V.
    pub volts: f64,
    /// Words programmed and sectors erased since power came up.
    pub operations: u32,
    /// Which of them were erasures, counted from 0.
    pub erased: Vec<u32>,
    /// What runs, and until when.
    running: Option<(Operation, Ps)>,
}

/// What a write did beyond the register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// The core stands still until then.
    Busy(Ps),
    /// The supply is gone.
    PowerCut,
}

impl Default for Flash {
    fn default() -> Self {
        Self {
            file: File::new(&TABLE),
            keys: 0,
            content: vec![0xFF; 2 * SECTOR],
            cache: Cache::default(),
            options: Options::default(),
            cut: None,
            slow: false,
            volts: 3.3,
            operations: 0,
            erased: Vec::new(),
            running: None,
        }
    }
}

impl Flash {
    /// As after reset; the content stays, but what runs is left half done.
    pub fn reset(&mut self) {
        self.file.reset();
        self.keys = 0;
        self.cache.flush();
        self.options.reset();
        if let Some((operation, _)) = self.running.take() {
            self.carry_out(operation, Remains::Half);
        }
    }

    /// Highest core clock for which the wait states suffice, Hz.
    pub fn max_hz(&self) -> u64 {
        u64::from(field(self.file.get(ACR), 0, 4) + 1) * HZ_A_WAIT_STATE
    }

    /// When what runs is done; 0 if nothing runs.
    pub fn busy_until(&self) -> Ps {
        self.running.map_or(0, |(_, until)| until)
    }

    /// Lets happen what happens until `now`.
    pub fn advance(&mut self, now: Ps) {
        if let Some((operation, until)) = self.running
            && until <= now
        {
            self.running = None;
            self.carry_out(operation, Remains::After);
            if bit(self.file.get(CR), 24) {
                self.file.set(SR, self.file.get(SR) | EOP);
            }
        }
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        let busy = if self.running.is_some() { BSY } else { 0 };
        match offset {
            SR => Ok(self.file.get(SR) | busy),
            OPTKEYR => Ok(0),
            OPTCR => Ok(self.options.read()),
            _ => self.file.read(offset),
        }
    }

    /// Reads a word of the memory, by way of the cache where that is on. `offset` is from [`BASE`].
    pub fn word(&mut self, offset: u32) -> u32 {
        let at = offset as usize;
        if self.file.get(ACR) & DCEN != 0 {
            return self.cache.read(at, &self.content);
        }
        let bytes = self.content.get(at..at + 4).and_then(|b| b.try_into().ok());
        u32::from_le_bytes(bytes.unwrap_or_default())
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<Effect, Refusal> {
        match offset {
            ACR => self.write_acr(value)?,
            KEYR => self.key(value)?,
            OPTKEYR => self.options.key(value)?,
            SR => self.file.set(SR, self.file.get(SR) & !value),
            CR | OPTCR if self.running.is_some() => return Err("CR or OPTCR: written while busy".into()),
            CR if self.file.get(CR) & LOCK != 0 => return Err("CR: written while locked".into()),
            CR => {
                self.file.write(CR, value & !STRT)?;
                if value & STRT != 0 {
                    return self.erase(value, now);
                }
            }
            OPTCR => {
                if let Some(bytes) = self.options.write(value)? {
                    return Ok(self.start(
                        Operation::Options(bytes),
                        ERASE_OPTIONS[self.parallelism()?],
                        now,
                    ));
                }
            }
            _ => self.file.write(offset, value)?,
        }
        Ok(Effect::None)
    }

    fn write_acr(&mut self, value: u32) -> Result<(), Refusal> {
        for (enable, flush) in [(DCEN, DCRST), (ICEN, ICRST)] {
            if value & flush != 0 && (value | self.file.get(ACR)) & enable != 0 {
                return Err(format!("ACR: {value:#x} flushes a cache that is on"));
            }
        }
        if value & DCRST != 0 {
            self.cache.flush();
        }
        self.file.write(ACR, value)
    }

    /// A wrong key locks the controller until a reset, and is a fault of the bus.
    fn key(&mut self, value: u32) -> Result<(), Refusal> {
        if KEYS.get(self.keys) != Some(&value) || self.file.get(CR) & LOCK == 0 {
            return Err(format!("KEYR: {value:#x} is not the key expected"));
        }
        self.keys = (self.keys + 1) % KEYS.len();
        if self.keys == 0 {
            self.file.set(CR, self.file.get(CR) & !LOCK);
        }
        Ok(())
    }

    /// PSIZE.
    fn parallelism(&self) -> Result<usize, Refusal> {
        match field(self.file.get(CR), 8, 2) {
            3 => Err("CR: a parallelism of 64 bits needs a second supply".into()),
            psize => Ok(psize as usize),
        }
    }

    fn erase(&mut self, cr: u32, now: Ps) -> Result<Effect, Refusal> {
        let sector = field(cr, 3, 4) as usize;
        if cr & (SER | PG) != SER || !(6..8).contains(&sector) {
            return Err(format!("CR {cr:#x}: only erasing sectors 6 and 7 is modelled"));
        }
        self.erased.push(self.operations);
        let time = ERASE[self.parallelism()?] * if self.slow { 2 } else { 1 };
        Ok(self.start(Operation::Erase((sector - 6) * SECTOR), time, now))
    }

    /// The program writes to the memory itself. `offset` is from [`BASE`].
    ///
    /// # Errors
    /// The controller is not set up for it, which on silicon is an error flag or a bus fault.
    pub fn program(&mut self, offset: u32, size: usize, value: u32, now: Ps) -> Result<Effect, Refusal> {
        let cr = self.file.get(CR);
        if cr & LOCK != 0 || cr & (PG | SER) != PG {
            return Err("programmed while PG is not set alone or the controller is locked".into());
        }
        let wanted = 1 << self.parallelism()?;
        if wanted != size {
            return Err(format!("programmed {size} bytes at a parallelism of {wanted}"));
        }
        let time = if self.slow { PROGRAM_SLOW } else { PROGRAM };
        Ok(self.start(Operation::Program(offset as usize, value), time, now))
    }

    fn start(&mut self, operation: Operation, time: Ps, now: Ps) -> Effect {
        self.operations += 1;
        if let Some((after, remains)) = self.cut
            && self.operations > after
        {
            self.carry_out(operation, remains);
            return Effect::PowerCut;
        }
        self.running = Some((operation, now + time));
        Effect::Busy(now + time)
    }

    fn carry_out(&mut self, operation: Operation, remains: Remains) {
        let psize = field(self.file.get(CR), 8, 2) as usize;
        let enough = LEAST_VOLTS.get(psize).is_some_and(|least| self.volts >= *least);
        let half = match (remains, enough) {
            (Remains::Before, _) => return,
            (Remains::After, true) => false,
            _ => true,
        };
        match operation {
            Operation::Erase(from) => {
                let size = if half { SECTOR / 2 } else { SECTOR };
                self.content[from..from + size].fill(0xFF);
            }
            Operation::Program(place, value) => {
                let value = if half { value | 0x5A5A_5A5A } else { value };
                let bytes = value.to_le_bytes();
                for (byte, new) in self.content[place..].iter_mut().zip(bytes) {
                    *byte &= new; // programming only clears bits
                }
                self.cache.program(place, &bytes);
            }
            Operation::Options(_) if self.options.protected => self.file.set(SR, self.file.get(SR) | WRPERR),
            Operation::Options(bytes) => self.options.program(bytes, half),
        }
    }
}
