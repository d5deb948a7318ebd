//! Whether flash and RAM hold what was written to them: all of both at the start, and a part of both each 50 ms for ever after.
//!
//! Hazard: a cell that has failed makes another program, or another number, of one that was tested.
//!
//! The image ends with its checksum (the section `.seal`, which `cargo fw` fills in), so that the checksum of all of it is 0: the chip's own
//! unit computes CRC-32/MPEG-2. An image that was built by anything but `cargo fw` has none, and never heats.

use core::arch::{asm, global_asm};
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::CRC;
use embassy_stm32::{Peri, rcc};

use super::board::Checksum;

/// Words of the image, and of the RAM, that are tested in one go: chosen, some 1200 instructions. Each 50 ms the image takes 23 s, the RAM 62 s.
const IMAGE_WORDS: u32 = 128;
const RAM_WORDS: u32 = 16;

/// Where the checksum is to be, behind all else.
#[used]
#[unsafe(link_section = ".seal")]
static SEAL: u32 = u32::MAX;

unsafe extern "C" {
    static __vector_table: u32;
    static _stack_end: u32;
    static __suninit: u32;
}

/// What failed once is not believed again.
static FAILED: AtomicBool = AtomicBool::new(false);
/// Words that this pass has tested.
static IMAGE_AT: AtomicU32 = AtomicU32::new(0);
static RAM_AT: AtomicU32 = AtomicU32::new(0);

// March X (w0; up: r0, w1; down: r1, w0; r0) over all RAM that is used but what outlives a reset, before any of it is: in registers alone. It
// finds cells that stick or do not change, that answer at another's address, or that are turned by another. A fault ends in a loop: the pins
// of heater and contactor float as after any reset, and the resistors hold them low.
global_asm!(
    ".text",
    ".global __pre_init",
    ".type __pre_init,%function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =_stack_end",
    "ldr r1, =__suninit",
    "ldr r2, =0x55555555",
    "mvn r3, r2",
    "mov r4, r0",
    "0: str r2, [r4], #4",
    "cmp r4, r1",
    "blo 0b",
    "mov r4, r0",
    "1: ldr r5, [r4]",
    "cmp r5, r2",
    "bne 4f",
    "str r3, [r4], #4",
    "cmp r4, r1",
    "blo 1b",
    "2: ldr r5, [r4, #-4]!",
    "cmp r5, r3",
    "bne 4f",
    "str r2, [r4]",
    "cmp r4, r0",
    "bhi 2b",
    "3: ldr r5, [r4], #4",
    "cmp r5, r2",
    "bne 4f",
    "cmp r4, r1",
    "blo 3b",
    "bx lr",
    "4: b 4b",
    ".ltorg",
);

/// Tests the whole image, for the start.
pub(crate) fn start(_unit: Peri<'static, Checksum>) {
    rcc::enable_and_reset::<Checksum>();
    test_image(u32::MAX);
}

/// Tests the next part of both. By one task alone, which all others interrupt: at the port a byte waits for 87 µs.
pub(crate) fn test() {
    test_image(IMAGE_WORDS);
    test_ram(RAM_WORDS);
}

/// Whether all that was tested was well.
pub(crate) fn holds() -> bool {
    !FAILED.load(Ordering::Relaxed)
}

fn test_image(words: u32) {
    let begin = &raw const __vector_table;
    let all = ((&raw const SEAL).addr() - begin.addr()) as u32 / 4 + 1;
    let from = IMAGE_AT.load(Ordering::Relaxed);
    let to = from.saturating_add(words).min(all);
    for i in from..to {
        // SAFETY: from the first word of the image to its last.
        CRC.dr().write_value(unsafe { begin.add(i as usize).read_volatile() });
    }
    if to == all {
        FAILED.fetch_or(CRC.dr().read() != 0, Ordering::Relaxed);
        CRC.cr().write(|w| w.set_reset(true));
    }
    IMAGE_AT.store(if to == all { 0 } else { to }, Ordering::Relaxed);
}

fn test_ram(words: u32) {
    let begin = (&raw const _stack_end).cast_mut();
    let all = ((&raw const __suninit).addr() - begin.addr()) as u32 / 4;
    let from = RAM_AT.load(Ordering::Relaxed);
    for i in from..from + words {
        // SAFETY: `i` is made to be within the RAM that is used.
        let failed = unsafe { is_stuck(begin.add((i % all) as usize)) };
        FAILED.fetch_or(failed, Ordering::Relaxed);
    }
    RAM_AT.store((from + words) % all, Ordering::Relaxed);
}

/// Whether a word does not take its complement, or not itself again. Nothing may come between, and nothing of this lies in RAM meanwhile: it
/// may be the word. No DMA is used here; one that wrote to the word meanwhile would lose what it wrote.
///
/// # Safety
/// It is a word of RAM.
unsafe fn is_stuck(word: *mut u32) -> bool {
    cortex_m::interrupt::free(|_| {
        let wrong: u32;
        // SAFETY: the word holds in the end what it did, and nobody can look at it meanwhile.
        unsafe {
            asm!(
                "ldr {kept}, [{word}]",
                "mvn {other}, {kept}",
                "str {other}, [{word}]",
                "ldr {wrong}, [{word}]",
                "str {kept}, [{word}]",
                "eor {wrong}, {wrong}, {other}",
                "ldr {other}, [{word}]",
                "eor {other}, {other}, {kept}",
                "orr {wrong}, {wrong}, {other}",
                word = in(reg) word,
                kept = out(reg) _,
                other = out(reg) _,
                wrong = out(reg) wrong,
                options(nostack),
            );
        }
        wrong != 0
    })
}
