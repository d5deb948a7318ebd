//! Console and exit through QEMU's semihosting: the debugger's calls of an Arm core, answered by the emulator.

use core::arch::asm;
use core::fmt;

const SYS_WRITE0: usize = 0x04;
const SYS_EXIT: usize = 0x18;
/// Reasons for [`SYS_EXIT`]: QEMU ends with status 0 for the first and 1 for the second.
const APPLICATION_EXIT: usize = 0x2_0026;
const RUN_TIME_ERROR: usize = 0x2_0023;

fn semihosting(operation: usize, argument: usize) {
    // SAFETY: under QEMU with semihosting enabled the breakpoint is a call; the two used here only read memory.
    unsafe {
        asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument, options(nostack));
    }
}

/// The emulator's standard error or output, as it was started.
#[derive(Debug, Default)]
pub struct Console;

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for piece in text.as_bytes().chunks(63) {
            let mut ended = [0; 64]; // the call takes a string that ends with a zero
            ended[..piece.len()].copy_from_slice(piece);
            semihosting(SYS_WRITE0, ended.as_ptr() as usize);
        }
        Ok(())
    }
}

/// Ends the emulation.
pub fn exit(well: bool) -> ! {
    loop {
        semihosting(SYS_EXIT, if well { APPLICATION_EXIT } else { RUN_TIME_ERROR });
    }
}
