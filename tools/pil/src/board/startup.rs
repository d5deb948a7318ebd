//! From reset to `main`, and from a fault or a panic to the end of the emulation.

use core::arch::global_asm;
use core::fmt::Write;
use core::panic::PanicInfo;

use super::console::{Console, exit};

// The vector table, and a reset that switches the FPU on: the rest of memory is ready, see netduinoplus2.x.
global_asm!(
    ".section .vectors, \"a\"",
    ".word _stack_top",
    ".word reset",
    ".rept 14",
    ".word fault",
    ".endr",
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".type reset, %function",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xE000ED88", // CPACR
    "ldr r1, [r0]",
    "orr r1, r1, #(0xF << 20)", // full access to CP10 and CP11
    "str r1, [r0]",
    "dsb",
    "isb",
    "bl main",
    "udf #0",
    ".pool",
    options(raw)
);

#[unsafe(no_mangle)]
extern "C" fn fault() -> ! {
    let _ = writeln!(Console, "fault: the core raised an exception");
    exit(false)
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    let _ = writeln!(Console, "{info}");
    exit(false)
}
