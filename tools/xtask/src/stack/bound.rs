//! The bound. Calls by name are followed; what is called through a pointer cannot be, so it is counted for the worst:
//!
//! * A function whose address is anywhere in the image, or that nobody calls by name, may be called through a pointer.
//! * A path goes through at most [`NESTED`] of these, no one twice: in practice formatting, where a value writes its parts.
//!   The costliest of them are added up, once for what is being formatted and once for a panic on top of it.
//! * Tasks and the start are called by the executor alone, and the task that steps the controller runs on its interrupt.
//! * A panic or a stray interrupt comes once, on top of everything, and never returns.
//! * Interrupts nest as their priorities allow (firmware/src/hardware/mod.rs): one of each level, then the fault.
//!
//! Recursion by name is refused. What is assumed and not checked: that no pointer leads back to its caller, that wakers do
//! not format, and that no address is put together from parts that the disassembler does not show.

use std::collections::{BTreeMap, BTreeSet};

use super::disassembly::Function;

/// Functions called through pointers on one path: `write!`, then six values within values, and the sink.
const NESTED: usize = 8;
/// The same in an interrupt: a waker, and what it pends.
const WAKERS: usize = 2;
/// Eight words, 16 registers of the FPU with their status, and the alignment.
const EXCEPTION_FRAME: u32 = 4 * (8 + 18) + 4;
/// Interrupts by level, the least urgent first; of one level only the deepest counts.
const LEVELS: [&[&str]; 4] = [&["USART2"], &["TIM2"], &["SPI4"], &["TIM5", "PVD"]];
/// Whoever enters one of these never comes back, nor do interrupts come any more.
const ENDS: [&str; 2] = ["DefaultHandler", PANIC];
/// Above all of them. The HardFault's handler has a stack of its own, so that its frame alone lies on this one.
const FAULT: &str = "NonMaskableInt";
const TASK: &str = "TaskStorage<F>::poll";
const START: &str = "firmware::start::start";
const PANIC: &str = "__rustc::rust_begin_unwind";
const CONTROL_STEP: &str = "fdi_core::control::Controller::step";

/// Functions, and how deep each is with all that it calls by name.
pub(super) struct Program {
    functions: BTreeMap<u32, Function>,
    depth: BTreeMap<u32, u32>,
    /// May be called through a pointer.
    taken: BTreeSet<u32>,
}

impl Program {
    /// From functions, and the words of the image's constants.
    pub(super) fn new(mut functions: BTreeMap<u32, Function>, constants: &[u32]) -> Result<Self, String> {
        let starts: Vec<u32> = functions.keys().copied().collect();
        let owner = |address: &u32| starts[starts.partition_point(|start| start <= address).max(1) - 1];
        let entries: BTreeSet<u32> =
            functions.iter().filter(|(_, f)| is_entry(&f.name)).map(|(address, _)| *address).collect();
        for (start, function) in &mut functions {
            let callees = function.calls.iter().map(owner);
            function.calls = callees.filter(|callee| callee != start && !entries.contains(callee)).collect();
        }
        let pointers = functions.values().flat_map(|f| &f.words).chain(constants);
        let mut taken: BTreeSet<u32> = pointers
            .filter(|word| *word & 1 == 1)
            .map(|word| word - 1)
            .filter(|a| functions.contains_key(a))
            .collect();
        let called: BTreeSet<u32> = functions.values().flat_map(|f| f.calls.iter().copied()).collect();
        taken.extend(starts.iter().filter(|start| !called.contains(start)));
        taken.retain(|address| !entries.contains(address));
        let mut program = Self { functions, depth: BTreeMap::new(), taken };
        for start in starts {
            program.measure(start, &mut Vec::new())?;
        }
        Ok(program)
    }

    fn measure(&mut self, address: u32, path: &mut Vec<u32>) -> Result<u32, String> {
        if let Some(depth) = self.depth.get(&address) {
            return Ok(*depth);
        }
        if path.contains(&address) {
            let names: Vec<&str> = path.iter().map(|a| self.functions[a].name.as_str()).collect();
            return Err(format!("recursion by name: {}", names.join(" -> ")));
        }
        path.push(address);
        let callees: Vec<u32> = self.functions[&address].calls.iter().copied().collect();
        let below = callees
            .into_iter()
            .map(|callee| self.measure(callee, path))
            .try_fold(0, |deepest, depth| depth.map(|depth| deepest.max(depth)))?;
        path.pop();
        let depth = below + self.functions[&address].frame;
        self.depth.insert(address, depth);
        Ok(depth)
    }

    /// What lies on the stack at the worst, from its top.
    pub(super) fn bound(&self) -> Result<Vec<(String, u32)>, String> {
        let depth = |address: Option<u32>| address.map_or(0, |address| self.depth[&address]);
        let (control, tasks) = (depth(self.task(true)), depth(self.task(false)));
        let start = depth(self.start());
        let formatting = self.through_pointers(NESTED, |_| true);
        let wakers = self.through_pointers(WAKERS, |name| name.contains("embassy"));
        let mut bound = vec![
            ("reset, main and executor".to_owned(), self.deepest(&["Reset"])?),
            (
                format!("the deeper of the start ({start}) and the tasks of thread mode ({tasks})"),
                start.max(tasks),
            ),
            ("what it formats, through pointers".to_owned(), formatting),
        ];
        for level in LEVELS {
            let task = if level.contains(&"SPI4") { control } else { 0 };
            let depth = self.deepest(level)? + EXCEPTION_FRAME + wakers + task;
            bound.push((format!("interrupt {}, its frame and wakers", level.join(" or ")), depth));
        }
        let end = self.deepest(&ENDS)? + EXCEPTION_FRAME + formatting;
        bound.push(("a panic or a stray interrupt, and what it formats".to_owned(), end));
        bound.push((
            "NMI, and the frame of a fault in it".to_owned(),
            self.deepest(&[FAULT])? + 2 * EXCEPTION_FRAME,
        ));
        Ok(bound)
    }

    fn named<'a>(&'a self, matches: impl Fn(&str) -> bool + 'a) -> impl Iterator<Item = u32> + 'a {
        self.functions.iter().filter(move |(_, f)| matches(&f.name)).map(|(address, _)| *address)
    }

    /// The deepest of these functions, all of which there must be.
    fn deepest(&self, names: &[&str]) -> Result<u32, String> {
        let depth = |name: &&str| {
            self.named(|found| found == *name)
                .map(|a| self.depth[&a])
                .max()
                .ok_or(format!("no function {name}"))
        };
        names.iter().map(depth).try_fold(0, |deepest, depth| depth.map(|depth| deepest.max(depth)))
    }

    /// The deepest ways of the start and of the tasks in thread mode: each function with its own frame.
    pub(super) fn ways(&self) -> Vec<Vec<(&str, u32)>> {
        [self.start(), self.task(false)].into_iter().flatten().map(|address| self.way(address)).collect()
    }

    fn way(&self, from: u32) -> Vec<(&str, u32)> {
        let deepest = |address: &u32| {
            self.functions[address].calls.iter().copied().max_by_key(|callee| self.depth[callee])
        };
        std::iter::successors(Some(from), deepest)
            .map(|address| &self.functions[&address])
            .map(|function| (function.name.as_str(), function.frame))
            .collect()
    }

    /// The deepest task that steps the controller, or that does not.
    fn task(&self, control: bool) -> Option<u32> {
        let steps = |address: &u32| {
            self.functions[address].calls.iter().any(|callee| self.functions[callee].name == CONTROL_STEP)
        };
        let tasks = self.named(|name| name.ends_with(TASK)).filter(|address| steps(address) == control);
        tasks.max_by_key(|address| self.depth[address])
    }

    fn start(&self) -> Option<u32> {
        self.named(|name| name == START).max_by_key(|address| self.depth[address])
    }

    /// The costliest functions that may be called through pointers, added up.
    fn through_pointers(&self, count: usize, matches: impl Fn(&str) -> bool) -> u32 {
        let candidates = self.taken.iter().filter(|address| matches(&self.functions[address].name));
        let mut depths: Vec<u32> = candidates.map(|address| self.depth[address]).collect();
        depths.sort_unstable();
        depths.iter().rev().take(count).sum()
    }
}

/// Entered by the processor, by the executor or by a panic, and counted by itself.
fn is_entry(name: &str) -> bool {
    let others = ["Reset", "HardFault", FAULT].into_iter().chain(ENDS);
    let mut entries = others.chain(LEVELS.into_iter().flatten().copied());
    entries.any(|entry| entry == name) || name.ends_with(TASK) || name == START
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(name: &str, frame: u32, calls: &[u32], words: &[u32]) -> Function {
        Function {
            name: name.to_owned(),
            frame,
            calls: calls.iter().copied().collect(),
            words: words.to_vec(),
        }
    }

    fn program(more: Vec<(u32, Function)>) -> Result<Program, String> {
        let handlers = [
            "Reset",
            "main",
            "USART2",
            "TIM2",
            "SPI4",
            "TIM5",
            "PVD",
            "DefaultHandler",
            "NonMaskableInt",
            PANIC,
        ];
        let functions = (0x100..).step_by(16).zip(handlers.map(|name| function(name, 8, &[], &[])));
        Program::new(functions.chain(more).collect(), &[])
    }

    fn total(program: &Program) -> u32 {
        program.bound().unwrap().iter().map(|(_, bytes)| bytes).sum()
    }

    #[test]
    fn calls_by_name_and_through_pointers_add_up() {
        let empty = total(&program(vec![]).unwrap());
        let task =
            |calls: &[u32], words: &[u32]| (0x1000, function("raw::TaskStorage<F>::poll", 100, calls, words));
        assert_eq!(total(&program(vec![task(&[], &[])]).unwrap()), empty + 100);
        let helper = (0x2000, function("helper", 40, &[], &[]));
        assert_eq!(total(&program(vec![task(&[0x2004], &[]), helper]).unwrap()), empty + 140);
        // Through a pointer: once for the task, once for a panic.
        let display = (0x2000, function("fmt", 40, &[], &[]));
        assert_eq!(total(&program(vec![task(&[], &[0x2001]), display]).unwrap()), empty + 180);
    }

    #[test]
    fn the_task_that_steps_the_controller_is_on_its_interrupt() {
        let step = (0x3000, function(CONTROL_STEP, 10, &[], &[]));
        let control = (0x1000, function("raw::TaskStorage<F>::poll", 100, &[0x3000], &[]));
        let other = (0x2000, function("raw::TaskStorage<F>::poll", 50, &[], &[]));
        let empty = total(&program(vec![]).unwrap());
        assert_eq!(total(&program(vec![step, control, other]).unwrap()), empty + 110 + 50);
    }

    #[test]
    fn recursion_by_name_is_refused() {
        let loops =
            vec![(0x1000, function("a", 8, &[0x2000], &[])), (0x2000, function("b", 8, &[0x1000], &[]))];
        assert!(program(loops).err().unwrap().contains("a -> b"));
    }
}
