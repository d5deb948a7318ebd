//! USART2, which the ST-LINK shows as a serial port: bytes take their time on the wire in both directions.

use std::collections::VecDeque;

use crate::registers::{File, Refusal, Register, bit, register};
use crate::time::{NEVER, Ps, SECOND};

const SR: u32 = 0x00;
const DR: u32 = 0x04;
const BRR: u32 = 0x08;
const CR1: u32 = 0x0C;

/// Parity, 9 bits, wake-up, DMA and flow control are not modelled.
static TABLE: [Register; 7] = [
    register(SR, "SR", 0xC0, 0x3FF),
    register(DR, "DR", 0, 0x1FF),
    register(BRR, "BRR", 0, 0xFFFF),
    register(CR1, "CR1", 0, 0x21FC),
    register(0x10, "CR2", 0, 0x3000),
    register(0x14, "CR3", 0, 1),
    register(0x18, "GTPR", 0, 0xFFFF),
];

const FE: u32 = 1 << 1;
const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
/// Flags that a read of SR and then of DR clears.
const CLEARED_BY_READING: u32 = 0x1F;

/// Bits of a frame: start, 8 data, stop.
const FRAME_BITS: u64 = 10;
/// The other end of the wire.
const TERMINAL_BAUD: u64 = 115_200;

/// The port.
pub struct Usart {
    file: File,
    /// Clock of its bus, Hz.
    pub pclk: u64,
    /// Bytes on the wire towards the chip, with the time at which each is complete.
    incoming: VecDeque<(Ps, u8)>,
    idle_at: Ps,
    status_was_read: bool,
    shifting: Option<(u8, Ps)>,
    holding: Option<u8>,
    sent: Vec<u8>,
    /// Bytes that came while the one before had not been read.
    pub overruns: u64,
}

impl Usart {
    /// As after reset.
    pub fn new(pclk: u64) -> Self {
        Self {
            file: File::new(&TABLE),
            pclk,
            incoming: VecDeque::new(),
            idle_at: NEVER,
            status_was_read: false,
            shifting: None,
            holding: None,
            sent: Vec::new(),
            overruns: 0,
        }
    }

    /// As after reset; the terminal goes on.
    pub fn reset(&mut self) {
        let fresh = Self::new(self.pclk);
        *self = Self {
            incoming: std::mem::take(&mut self.incoming),
            sent: std::mem::take(&mut self.sent),
            overruns: self.overruns,
            ..fresh
        };
    }

    /// The terminal sends bytes, back to back, from `now` on.
    pub fn receive(&mut self, bytes: &[u8], now: Ps) {
        let frame = FRAME_BITS * SECOND / TERMINAL_BAUD;
        let mut at = self.incoming.back().map_or(now, |&(at, _)| at.max(now));
        if at <= self.idle_at {
            self.idle_at = NEVER; // a start bit is no idle line
        }
        for &byte in bytes {
            at += frame;
            self.incoming.push_back((at, byte));
        }
    }

    /// Takes what the chip has sent.
    pub fn take_sent(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.sent)
    }

    /// Duration of a frame at the rate that the program has set.
    fn frame(&self) -> Ps {
        FRAME_BITS * u64::from(self.file.get(BRR)) * SECOND / self.pclk.max(1)
    }

    fn enabled(&self, place: u32) -> bool {
        let cr1 = self.file.get(CR1);
        bit(cr1, 13) && bit(cr1, place)
    }

    fn raise(&mut self, flags: u32) {
        self.file.set(SR, self.file.get(SR) | flags);
    }

    /// Lets happen what happens until `now`.
    pub fn advance(&mut self, now: Ps) {
        while let Some(&(at, byte)) = self.incoming.front().filter(|(at, _)| *at <= now) {
            self.incoming.pop_front();
            self.arrive(byte, at);
        }
        if self.idle_at <= now {
            self.idle_at = NEVER;
            self.raise(IDLE);
        }
        if let Some((byte, _)) = self.shifting.filter(|(_, at)| *at <= now) {
            self.sent.push(byte);
            self.shifting = None;
            match self.holding.take() {
                Some(next) => self.shift(next, now),
                None => self.raise(TC),
            }
        }
    }

    fn arrive(&mut self, byte: u8, at: Ps) {
        if !self.enabled(2) {
            return;
        }
        // The line is idle after a frame without a start bit.
        let silent = self.incoming.front().is_none_or(|(next, _)| *next > at + 2 * self.frame());
        self.idle_at = if silent { at + self.frame() } else { NEVER };
        let ours = self.frame().abs_diff(FRAME_BITS * SECOND / TERMINAL_BAUD);
        if ours > self.frame() / 33 {
            self.raise(FE); // more than 3 % off: the stop bit is missed
        }
        if self.file.get(SR) & RXNE != 0 {
            self.overruns += 1;
            return self.raise(ORE);
        }
        self.file.set(DR, byte.into());
        self.raise(RXNE);
    }

    fn shift(&mut self, byte: u8, now: Ps) {
        self.shifting = Some((byte, now + self.frame()));
        self.raise(TXE);
    }

    /// When something next happens by itself.
    pub fn next_event(&self) -> Ps {
        let arrival = self.incoming.front().map_or(NEVER, |(at, _)| *at);
        arrival.min(self.idle_at).min(self.shifting.map_or(NEVER, |(_, at)| at))
    }

    /// Whether it asks for the processor.
    pub fn level(&self) -> bool {
        let (sr, cr1) = (self.file.get(SR), self.file.get(CR1));
        // The enable of each flag stands at the flag's own place in CR1.
        let enabled = sr & cr1 & (IDLE | RXNE | TC | TXE);
        let overrun = sr & ORE != 0 && cr1 & RXNE != 0;
        let error = sr & (ORE | FE) != 0 && bit(self.file.get(0x14), 0);
        enabled != 0 || overrun || error
    }

    /// Reads a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, offset: u32, now: Ps) -> Result<u32, Refusal> {
        self.advance(now);
        let value = self.file.read(offset)?;
        match offset {
            SR => self.status_was_read = true,
            DR => {
                let mut flags = self.file.get(SR) & !RXNE;
                if std::mem::take(&mut self.status_was_read) {
                    flags &= !CLEARED_BY_READING;
                }
                self.file.set(SR, flags);
            }
            _ => {}
        }
        Ok(value)
    }

    /// Writes a register.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        self.advance(now);
        match offset {
            SR => self.file.set(SR, self.file.get(SR) & (value | !(RXNE | TC))),
            DR => self.send(value as u8, now)?,
            _ => self.file.write(offset, value)?,
        }
        Ok(())
    }

    fn send(&mut self, byte: u8, now: Ps) -> Result<(), Refusal> {
        if !self.enabled(3) {
            return Err("DR: sending while the transmitter is off".into());
        }
        let ready = self.file.get(SR) & TXE != 0;
        if !ready {
            return Err("DR: sending while the byte before has not left".into());
        }
        self.file.set(SR, self.file.get(SR) & !(TC | TXE));
        match self.shifting {
            None => self.shift(byte, now),
            Some(_) => self.holding = Some(byte),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::US;

    fn open() -> Usart {
        let mut port = Usart::new(50_000_000);
        port.write(BRR, 434, 0).unwrap();
        port.write(CR1, 0x202C | IDLE, 0).unwrap();
        port
    }

    #[test]
    fn a_byte_arrives_after_its_time_and_the_line_falls_idle() {
        let mut port = open();
        port.receive(b"a", 0);
        assert!(!port.level());
        port.advance(87 * US);
        assert!(port.level());
        port.read(SR, 87 * US).unwrap();
        assert_eq!(port.read(DR, 87 * US).unwrap(), u32::from(b'a'));
        assert!(!port.level());
        port.advance(180 * US);
        assert!(port.level(), "idle");
    }

    #[test]
    fn what_is_not_read_in_time_is_lost_and_said() {
        let mut port = open();
        port.receive(b"ab", 0);
        port.advance(200 * US);
        assert_eq!(port.overruns, 1);
        assert_ne!(port.read(SR, 200 * US).unwrap() & ORE, 0);
        assert_eq!(port.read(DR, 200 * US).unwrap(), u32::from(b'a'));
    }

    #[test]
    fn two_bytes_fit_and_leave_one_after_the_other() {
        let mut port = open();
        port.write(DR, b'x'.into(), 0).unwrap();
        port.write(DR, b'y'.into(), 0).unwrap();
        assert!(port.write(DR, b'z'.into(), 0).is_err());
        port.advance(87 * US);
        port.advance(174 * US);
        assert_eq!(port.take_sent(), b"xy");
    }
}
