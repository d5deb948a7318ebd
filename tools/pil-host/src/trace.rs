//! What an image executed, block by block, from the emulator's log of translations and executions.

use std::collections::HashMap;
use std::io::BufRead;

use anyhow::{Context, ensure};

use crate::cycles;

/// The function that begins and ends an interval, by its name in the log.
const STOPWATCH: &str = "stopwatch_read";

/// What an interval took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cost {
    pub(crate) instructions: u32,
    pub(crate) cycles: u32,
}

impl std::ops::AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.instructions += other.instructions;
        self.cycles += other.cycles;
    }
}

/// A stretch of code that is executed from its first instruction to its last.
struct Block {
    cost: Cost,
    /// Where it goes on if it does not branch.
    end: u32,
    is_stopwatch: bool,
}

/// Reads the log of a run and returns the cost of each interval between two calls of the stopwatch: of the first and
/// second call, of the third and fourth, and so on.
///
/// # Errors
/// A log that can't be read, or not understood.
pub(crate) fn intervals(log: impl BufRead) -> anyhow::Result<Vec<Cost>> {
    let mut reader = Reader::default();
    let mut translation = Translation::default();
    for line in log.split(b'\n') {
        let line = line.context("the emulator's log")?;
        if let Some(trace) = line.strip_prefix(b"Trace ") {
            if let Some((start, block)) = std::mem::take(&mut translation).finish()? {
                reader.blocks.insert(start, block);
            }
            reader.execute(program_counter(trace).context("a trace line of another form")?)?;
        } else if line.starts_with(b"Stopped execution of TB chain before") {
            reader.take_back();
        } else {
            translation.read(&String::from_utf8_lossy(&line));
        }
    }
    ensure!(!reader.intervals.is_empty(), "the trace holds no interval");
    Ok(reader.intervals)
}

/// The second of four numbers in brackets, `[00800400/0800c75e/00000010/ff000200]`.
fn program_counter(line: &[u8]) -> Option<u32> {
    let bracket = line.iter().position(|&b| b == b'[')?;
    let text = std::str::from_utf8(line.get(bracket + 1..)?).ok()?;
    u32::from_str_radix(text.split('/').nth(1)?, 16).ok()
}

/// A block as the log lists it when it is translated.
#[derive(Default)]
struct Translation {
    is_stopwatch: bool,
    /// Address, bytes, mnemonic, operands.
    instructions: Vec<(u32, u32, String, String)>,
}

impl Translation {
    /// Reads `IN: name` or `0x0800bc5c:  4805       ldr      r0, [pc, #0x14]`.
    fn read(&mut self, line: &str) {
        if let Some(name) = line.strip_prefix("IN: ") {
            *self = Self { is_stopwatch: name.trim() == STOPWATCH, instructions: Vec::new() };
        } else if let Some((address, rest)) = line.split_once(":  ")
            && let Ok(address) = u32::from_str_radix(address.trim_start_matches("0x"), 16)
        {
            let mut words = rest.split_whitespace().peekable();
            let mut size = 0;
            while words.next_if(|w| w.len() == 4 && w.bytes().all(|b| b.is_ascii_hexdigit())).is_some() {
                size += 2;
            }
            let mnemonic = words.next().unwrap_or_default().to_owned();
            let operands = words.collect::<Vec<_>>().join(" ");
            self.instructions.push((address, size, mnemonic, operands));
        }
    }

    fn finish(self) -> anyhow::Result<Option<(u32, Block)>> {
        let (Some(&(start, ..)), Some(&(last, size, ..))) =
            (self.instructions.first(), self.instructions.last())
        else {
            return Ok(None);
        };
        let listed = |i: &(u32, u32, String, String)| i.1 > 0 && !i.2.is_empty();
        ensure!(
            self.instructions.iter().all(listed),
            "this emulator lists no disassembly (it was built without capstone)"
        );
        let code = self.instructions.iter().map(|(_, _, m, o)| (m.as_str(), o.as_str()));
        let cost = Cost { instructions: self.instructions.len() as u32, cycles: cycles::of_block(code) };
        Ok(Some((start, Block { cost, end: last + size, is_stopwatch: self.is_stopwatch })))
    }
}

#[derive(Default)]
struct Reader {
    blocks: HashMap<u32, Block>,
    intervals: Vec<Cost>,
    /// The interval that is open.
    current: Option<Cost>,
    /// The block before: where it began, and where it goes on without a branch. It is counted when its successor is known.
    pending: Option<u32>,
}

impl Reader {
    fn execute(&mut self, start: u32) -> anyhow::Result<()> {
        if let Some(before) = self.pending.replace(start) {
            self.count(before, start)?;
        }
        Ok(())
    }

    fn take_back(&mut self) {
        self.pending = None;
    }

    fn count(&mut self, start: u32, next: u32) -> anyhow::Result<()> {
        let block = self.blocks.get(&start).with_context(|| format!("no translation of {start:#x}"))?;
        if block.is_stopwatch {
            match self.current.take() {
                None => self.current = Some(Cost::default()),
                Some(cost) => self.intervals.push(cost),
            }
        } else if let Some(cost) = &mut self.current {
            *cost += block.cost;
            cost.cycles += if next == block.end { 0 } else { cycles::REFILL };
        }
        Ok(())
    }
}
