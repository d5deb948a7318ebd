//! The flash controller, and sectors 6 and 7, which the program may erase and program. The core stalls meanwhile, as it
//! does on silicon when it runs from the flash that is busy.

use crate::registers::{File, Refusal, Register, bit, field, register};
use crate::time::{MS, Ps, US};

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const SR: u32 = 0x0C;
const CR: u32 = 0x10;

static TABLE: [Register; 4] = [
    register(ACR, "ACR", 0, 0x1F07),
    register(KEYR, "KEYR", 0, u32::MAX),
    register(SR, "SR", 0, 0xF3),
    register(CR, "CR", 1 << 31, 1 << 31 | 1 << 25 | 1 << 24 | 1 << 16 | 0x37B),
];

const LOCK: u32 = 1 << 31;
const STRT: u32 = 1 << 16;
const SER: u32 = 1 << 1;
const PG: u32 = 1;
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
const PGSERR: u32 = 1 << 7;
const PGPERR: u32 = 1 << 6;
const EOP: u32 = 1;

/// Where sector 6 begins.
pub const BASE: u32 = 0x0804_0000;
/// Size of a sector.
pub const SECTOR: usize = 128 * 1024;
/// Typical times of the data sheet, at the parallelism of 32 bits.
const ERASE_TIME: Ps = 1000 * MS;
const PROGRAM: Ps = 16 * US;
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

/// Controller and content.
pub struct Flash {
    file: File,
    keys: usize,
    /// Sectors 6 and 7.
    pub content: Vec<u8>,
    /// The supply goes during the operation after so many.
    pub cut: Option<(u32, Remains)>,
    /// How long a sector takes: 1 s typical, 4 s at most.
    pub erase_time: Ps,
    /// Words programmed and sectors erased since power came up.
    pub operations: u32,
    /// Which of them were erasures, counted from 0.
    pub erased: Vec<u32>,
}

/// What a write did beyond the register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// The core stands still for so long.
    Stall(Ps),
    /// The supply is gone.
    PowerCut,
}

impl Default for Flash {
    fn default() -> Self {
        Self {
            file: File::new(&TABLE),
            keys: 0,
            content: vec![0xFF; 2 * SECTOR],
            cut: None,
            erase_time: ERASE_TIME,
            operations: 0,
            erased: Vec::new(),
        }
    }
}

impl Flash {
    /// As after reset; the content stays.
    pub fn reset(&mut self) {
        self.file.reset();
        self.keys = 0;
    }

    /// Highest core clock for which the wait states suffice, Hz.
    pub fn max_hz(&self) -> u64 {
        u64::from(field(self.file.get(ACR), 0, 4) + 1) * HZ_A_WAIT_STATE
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&self, offset: u32) -> Result<u32, Refusal> {
        self.file.read(offset)
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<Effect, Refusal> {
        match offset {
            KEYR => self.key(value),
            SR => self.file.set(SR, self.file.get(SR) & !value),
            CR if self.file.get(CR) & LOCK != 0 => {
                return Err("CR: written while locked".into());
            }
            CR => {
                self.file.write(CR, value & !STRT)?;
                if value & STRT != 0 {
                    return self.erase(value);
                }
            }
            _ => self.file.write(offset, value)?,
        }
        Ok(Effect::None)
    }

    fn key(&mut self, value: u32) {
        self.keys = if KEYS.get(self.keys) == Some(&value) { self.keys + 1 } else { 0 };
        if self.keys == KEYS.len() {
            self.file.set(CR, self.file.get(CR) & !LOCK);
            self.keys = 0;
        }
    }

    /// Counts an operation; what remains of it if the supply goes now.
    fn operate(&mut self) -> Option<Remains> {
        self.operations += 1;
        let (after, remains) = self.cut?;
        (self.operations > after).then_some(remains)
    }

    fn erase(&mut self, cr: u32) -> Result<Effect, Refusal> {
        let sector = field(cr, 3, 4) as usize;
        if cr & SER == 0 || !(6..8).contains(&sector) {
            return Err(format!("CR {cr:#x}: only erasing sectors 6 and 7 is modelled"));
        }
        self.erased.push(self.operations);
        let from = (sector - 6) * SECTOR;
        let until = match self.operate() {
            Some(Remains::Before) => return Ok(Effect::PowerCut),
            Some(Remains::Half) => from + SECTOR / 2,
            Some(Remains::After) | None => from + SECTOR,
        };
        self.content[from..until].fill(0xFF);
        self.end(self.cut.is_some_and(|(after, _)| self.operations > after), self.erase_time)
    }

    /// The program writes to the memory itself. `offset` is from [`BASE`].
    ///
    /// # Errors
    /// The controller is not set up for it, which on silicon is an error flag or a bus fault.
    pub fn program(&mut self, offset: u32, size: usize, value: u32) -> Result<Effect, Refusal> {
        let cr = self.file.get(CR);
        if cr & LOCK != 0 || cr & PG == 0 {
            self.file.set(SR, self.file.get(SR) | PGSERR);
            return Err("programmed while PG is not set or the controller is locked".into());
        }
        if 1 << field(cr, 8, 2) != size || !bit(cr, 9) {
            self.file.set(SR, self.file.get(SR) | PGPERR);
            return Err(format!("programmed {size} bytes at a parallelism of {}", 1 << field(cr, 8, 2)));
        }
        let remains = self.operate();
        let value = match remains {
            Some(Remains::Before) => return Ok(Effect::PowerCut),
            Some(Remains::Half) => value | 0x5A5A_5A5A,
            Some(Remains::After) | None => value,
        };
        let place = offset as usize;
        for (byte, new) in self.content[place..].iter_mut().zip(value.to_le_bytes()) {
            *byte &= new; // programming only clears bits
        }
        self.end(remains.is_some(), PROGRAM)
    }

    fn end(&mut self, cut: bool, time: Ps) -> Result<Effect, Refusal> {
        if cut {
            return Ok(Effect::PowerCut);
        }
        if bit(self.file.get(CR), 24) {
            self.file.set(SR, self.file.get(SR) | EOP);
        }
        Ok(Effect::Stall(time))
    }
}
