//! The recorded codes, which QEMU's loader device has put into flash: a count, then the codes, all little-endian.

use crate::codes::Codes;

unsafe extern "C" {
    /// Where they begin (linker script).
    static _input: u32;
}

/// The codes, one entry a tick.
pub fn recorded() -> &'static [Codes] {
    // SAFETY: the host writes the count, then as many arrays of three f32, which any bit pattern is; flash is never
    // written, and the address is aligned.
    unsafe {
        let count = &raw const _input;
        core::slice::from_raw_parts(count.add(1).cast(), count.read_volatile() as usize)
    }
}
