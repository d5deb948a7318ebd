//! What goes wrong inside: tasks that hang, fall silent, panic, or run off into nowhere. The image stays as it is; only
//! the program counter and registers are touched, at the moment that a task is about to be polled.

use anyhow::{Context, ensure};

use crate::board::Board;
use crate::cpu::RAM;
use crate::time::{MS, Ps};

/// The tasks of the firmware, by the name of their module.
pub const TASKS: [&str; 6] = ["control", "diagnosis", "status", "panel", "console", "watchdog"];

/// RAM that no section of the image reaches, for a few words of our own.
const SCRATCH: u32 = RAM + 0x1_F000;

/// Where the executor enters a task: the function whose address lies in the task's storage.
///
/// # Errors
/// The image has no such task, or it was not spawned yet.
pub fn poll_function(board: &Board, task: &str) -> anyhow::Result<u32> {
    let storage = board.image.address(&format!("firmware::tasks::{task}::{task}::POOL"))?;
    let is_poll = |address: u32| {
        let mut symbols = board.image.symbols.iter();
        symbols.any(|s| s.address == address & !1 && s.name.ends_with("TaskStorage<F>::poll"))
    };
    let words = (0..16).map(|i| board.cpu.word(storage + 4 * i)).collect::<anyhow::Result<Vec<_>>>()?;
    words.into_iter().find(|word| is_poll(*word)).with_context(|| format!("task {task} was not spawned"))
}

/// Runs until a task is about to be polled.
///
/// # Errors
/// It is not, within two seconds.
pub fn until_polled(board: &mut Board, task: &str) -> anyhow::Result<()> {
    let poll = poll_function(board, task)?;
    board.cpu.watch(poll)?;
    let hit = board.run_to(board.now() + 2000 * MS)?;
    board.cpu.unwatch()?;
    ensure!(hit.is_some(), "task {task} is not polled within 2 s");
    Ok(())
}

/// From its next poll on, a task spins for ever.
///
/// # Errors
/// There is no such task.
pub fn hang(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    run_code(board, &[0xE7FE]) // b .
}

/// From its next poll on, a task spins for ever with all interrupts off.
///
/// # Errors
/// There is no such task.
pub fn hang_masked(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    spin(board)
}

/// From now on, the core spins for ever with all interrupts off, whatever it was doing.
///
/// # Errors
/// The emulator refuses.
pub fn spin(board: &mut Board) -> anyhow::Result<()> {
    run_code(board, &[0xB672, 0xE7FE]) // cpsid i; b .
}

/// From its next poll on, a task calls itself for ever, and the stack grows.
///
/// # Errors
/// There is no such task.
pub fn overflow_stack(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    run_code(board, &[0xB57F, 0xE7FD]) // push {r0-r6, lr}; b .-2
}

/// At its next poll, a task jumps to where no memory is.
///
/// # Errors
/// There is no such task.
pub fn run_wild(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    board.cpu.jump(0x6000_0000);
    Ok(())
}

/// At its next poll, a task executes what is no instruction.
///
/// # Errors
/// There is no such task.
pub fn undefined(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    run_code(board, &[0xDE00, 0xE7FE])
}

/// At its next poll, a task panics: at line 7 of a file called "injected".
///
/// # Errors
/// There is no such task.
pub fn panic(board: &mut Board, task: &str) -> anyhow::Result<()> {
    until_polled(board, task)?;
    let (location, name) = (SCRATCH, SCRATCH + 0x40);
    for (i, word) in [name, 8, 7, 1].into_iter().enumerate() {
        board.cpu.set_word(location + 4 * i as u32, word)?;
    }
    for (i, bytes) in b"injected".chunks_exact(4).enumerate() {
        board
            .cpu
            .set_word(name + 4 * i as u32, u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))?;
    }
    let function = board.image.address("core::panicking::panic_const::panic_const_div_by_zero")?;
    board.cpu.call(function, location)
}

/// For a time, a task is never polled, though it is woken: it waits for what never comes.
///
/// # Errors
/// There is no such task.
pub fn silence(board: &mut Board, task: &str, time: Ps) -> anyhow::Result<()> {
    let poll = poll_function(board, task)?;
    board.cpu.watch(poll)?;
    let (until, resets) = (board.now() + time, board.resets.len());
    while board.run_to(until)?.is_some() && board.resets.len() == resets {
        let back = board.cpu.link()?;
        board.cpu.jump(back);
    }
    board.cpu.unwatch()
}

/// Has the core go on with some code of our own.
fn run_code(board: &mut Board, code: &[u16]) -> anyhow::Result<()> {
    let place = SCRATCH + 0x100;
    for (i, halves) in code.chunks(2).enumerate() {
        let word = u32::from(halves[0]) | u32::from(halves.get(1).copied().unwrap_or(0xBF00)) << 16;
        board.cpu.set_word(place + 4 * i as u32, word)?;
    }
    board.cpu.jump(place);
    Ok(())
}
