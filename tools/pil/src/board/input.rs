//! The recording, which QEMU's loader device has put into flash: the number of rows, then the rows, little-endian.

use crate::recording::{ROW, Recording};

unsafe extern "C" {
    /// Where it begins (linker script).
    static _input: u32;
}

/// The recorded run.
///
/// # Panics
/// Where the emulator was started without one.
pub fn recording() -> Recording<'static> {
    // SAFETY: the host writes the count, then as many arrays of f32, which any bit pattern is; flash is never
    // written, and the address is aligned.
    let rows: &[[f32; ROW]] = unsafe {
        let count = &raw const _input;
        core::slice::from_raw_parts(count.add(1).cast(), count.read_volatile() as usize)
    };
    Recording::new(rows).expect("a recording")
}
