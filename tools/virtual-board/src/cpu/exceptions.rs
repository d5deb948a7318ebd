//! Faults, and entry to and return from exceptions, which the emulator leaves to us.

use anyhow::{bail, ensure};
use unicorn_engine::RegisterARM;
use unicorn_engine::unicorn_const::uc_error;

use super::{Cpu, State, told};
use crate::nvic::{BUS_FAULT, Exception, HARD_FAULT, NMI, USAGE_FAULT};
use crate::scs::CFSR;
use crate::time::Ps;

/// Cycles of entering an exception, and of leaving it.
const ENTRY: Ps = 12;
const EXIT: Ps = 10;

/// Bits of CFSR.
const IBUSERR: u32 = 1 << 8;
const PRECISERR_BFARVALID: u32 = 1 << 9 | 1 << 15;
const STKERR: u32 = 1 << 12;
pub(super) const UNDEFINSTR: u32 = 1 << 16;
pub(super) const INVSTATE: u32 = 1 << 17;
pub(super) const UNALIGNED: u32 = 1 << 24;

impl Cpu {
    /// What the emulator could not execute.
    pub(super) fn faulted(&mut self, error: uc_error) -> anyhow::Result<()> {
        self.pc = self.register(RegisterARM::PC)?;
        let access = self.machine().faulted.take();
        match (error, access) {
            (_, Some((address, true))) => {
                self.pc = address;
                self.fault(BUS_FAULT, IBUSERR, None)
            }
            (_, Some((address, false))) => self.fault(BUS_FAULT, PRECISERR_BFARVALID, Some(address)),
            (uc_error::INSN_INVALID, _) => self.fault(USAGE_FAULT, UNDEFINSTR, None),
            (uc_error::EXCEPTION, _) => self.fault(USAGE_FAULT, INVSTATE, None),
            (error, _) => bail!("the emulator says {error:?} at {}", self.image.describe(self.pc)),
        }
    }

    pub(super) fn fault(
        &mut self,
        exception: Exception,
        status: u32,
        address: Option<u32>,
    ) -> anyhow::Result<()> {
        match self.machine().chip.scs.fault(exception, status, address) {
            Some(handler) => self.enter(handler),
            None => {
                self.state = State::Dead;
                Ok(())
            }
        }
    }

    /// Enters an exception: frame, link, mode, vector.
    pub(super) fn enter(&mut self, exception: Exception) -> anyhow::Result<()> {
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
            self.machine().chip.scs.raise(CFSR, STKERR);
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
    pub(super) fn leave(&mut self, value: u32) -> anyhow::Result<()> {
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
