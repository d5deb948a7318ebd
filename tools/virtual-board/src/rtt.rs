//! The debug probe's view of the log: a ring buffer in RAM that is emptied while the firmware sleeps.

use std::rc::Rc;

use anyhow::{Context, ensure};
use defmt_decoder::{DecodeError, StreamDecoder};
use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;

use crate::cpu::Cpu;
use crate::image::Image;

/// Offsets in the control block of SEGGER's RTT, one channel up.
const BUFFER: u32 = 28;
const SIZE: u32 = 32;
const WRITE: u32 = 36;
const READ: u32 = 40;

/// One line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Microseconds since the start, as the firmware says.
    pub timestamp: String,
    /// "INFO", "WARN" ..
    pub level: &'static str,
    /// The text.
    pub text: String,
}

impl Line {
    /// The record of a tick, if it is one.
    pub fn tick(&self) -> Option<TickLine> {
        match LogLine::find(&self.text) {
            Ok(Some(LogLine::Tick(tick))) => Some(tick),
            _ => None,
        }
    }
}

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:>10} {:<5} {}", self.timestamp, self.level, self.text)
    }
}

/// The probe.
pub struct Probe {
    control_block: u32,
    image: Rc<Image>,
    /// Bytes of the frames that are not complete.
    bytes: Vec<u8>,
    /// Whether it reads.
    pub attached: bool,
}

impl Probe {
    /// A probe that reads the log of this image.
    ///
    /// # Errors
    /// The image has no RTT.
    pub fn new(image: Rc<Image>) -> anyhow::Result<Self> {
        let control_block = image.address("_SEGGER_RTT")?;
        Ok(Self { control_block, image, bytes: Vec::new(), attached: true })
    }

    /// The program has started anew; half a frame will never be completed.
    pub fn restart(&mut self) {
        self.bytes.clear();
    }

    /// Empties the buffer into `lines`.
    ///
    /// # Errors
    /// What is there is no log.
    pub fn read(&mut self, cpu: &mut Cpu, lines: &mut Vec<Line>) -> anyhow::Result<()> {
        let field = |cpu: &Cpu, offset| cpu.word(self.control_block + offset);
        let (from, to) = (field(cpu, READ)?, field(cpu, WRITE)?);
        if !self.attached || from == to || field(cpu, 0)? != u32::from_le_bytes(*b"SEGG") {
            return Ok(());
        }
        let (buffer, size) = (field(cpu, BUFFER)?, field(cpu, SIZE)?);
        ensure!(from < size && to < size, "RTT: offsets {from} and {to} in a buffer of {size}");
        let end = if from < to { to } else { size };
        self.bytes.extend(cpu.bytes(buffer + from, (end - from) as usize)?);
        if to < from {
            self.bytes.extend(cpu.bytes(buffer, to as usize)?);
        }
        cpu.set_word(self.control_block + READ, to)?;
        self.decode(lines)
    }

    fn decode(&mut self, lines: &mut Vec<Line>) -> anyhow::Result<()> {
        // A zero ends each frame, so what comes before the last one is complete.
        let Some(last) = self.bytes.iter().rposition(|byte| *byte == 0) else { return Ok(()) };
        let mut decoder: Box<dyn StreamDecoder + Send + Sync + '_> =
            self.image.log_table.new_stream_decoder();
        decoder.received(&self.bytes[..=last]);
        loop {
            match decoder.decode() {
                Ok(frame) => lines.push(Line {
                    timestamp: frame.display_timestamp().map(|t| t.to_string()).unwrap_or_default(),
                    level: frame.level().map_or("", |level| level.as_str()),
                    text: frame.display_message().to_string(),
                }),
                Err(DecodeError::UnexpectedEof) => break,
                Err(DecodeError::Malformed) => {
                    return Err(DecodeError::Malformed).context("RTT: a frame of the log is damaged");
                }
            }
        }
        drop(decoder);
        self.bytes.drain(..=last);
        Ok(())
    }
}
