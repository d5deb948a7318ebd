//! When the processor gives up: heater off, crash record, reset.

use core::arch::global_asm;
use core::fmt::Write;

use embassy_stm32::pac::RCC;
use firmware_logic::reset_cause::Death;
use firmware_logic::retained::{CrashMessage, Retained};

use super::{heater, reset, retained};

// The fault may be that the stack has run out of RAM. So nothing is pushed here: the stack pointer moves to the memory
// kept for this (memory.x), and the Rust part learns where the old one pointed.
global_asm!(
    ".global HardFault",
    ".type HardFault,%function",
    ".thumb_func",
    "HardFault:",
    "mrs r0, msp",
    "ldr r1, =_fault_stack",
    "msr msp, r1",
    "b {handler}",
    handler = sym hard_fault,
);

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Configurable fault status, and the address of a bus fault, of the system control block.
const CFSR: *const u32 = 0xE000_ED28 as *const u32;
const BFAR: *const u32 = 0xE000_ED38 as *const u32;

extern "C" fn hard_fault(stack: *const u32) -> ! {
    heater::cut();
    let mut words = CrashMessage::EMPTY;
    let (bottom, top) = (&raw const _stack_end, &raw const _stack_start);
    // SAFETY: both are registers of the processor that can always be read.
    let (cfsr, bfar) = unsafe { (CFSR.read_volatile(), BFAR.read_volatile()) };
    if stack < bottom {
        let _ = write!(words, "stack overflow, sp {:#010x}", stack.addr());
    } else if stack.wrapping_add(8) <= top {
        // SAFETY: the exception frame of 8 words lies within the stack.
        let (lr, pc) = unsafe { (stack.add(5).read(), stack.add(6).read()) };
        let _ = write!(words, "pc {pc:#010x} lr {lr:#010x}");
    }
    let _ = write!(words, " cfsr {cfsr:#010x} bfar {bfar:#010x}");
    die(Death::HardFault, words)
}

/// The external clock died: hardware has already cut the heater by the break of the PWM's timer, and the core runs on at 16 MHz.
#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    heater::cut();
    RCC.cir().modify(|w| w.set_cssc(true));
    die(Death::ClockFailure, CrashMessage::EMPTY)
}

/// An interrupt that nothing handles.
#[cortex_m_rt::exception]
unsafe fn DefaultHandler(irq: i16) -> ! {
    heater::cut();
    let mut words = CrashMessage::EMPTY;
    let _ = write!(words, "interrupt {}", i32::from(irq));
    die(Death::StrayInterrupt, words)
}

/// Keeps the crash record and starts all over. The heater must be off already. What held it off is not repeated: the
/// death is a reason of its own.
pub(crate) fn die(death: Death, words: CrashMessage) -> ! {
    retained::store(&Retained { death: Some(death), words, ..Retained::EMPTY });
    reset::reset()
}
