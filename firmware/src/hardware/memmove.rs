//! Moves within a list, which are rare, byte by byte: the compiler's own is a kilobyte and a half, unrolled for a speed that nothing here needs.

/// Copies `count` bytes, where both places may overlap.
///
/// # Safety
/// `from` can be read and `to` written for `count` bytes.
#[unsafe(export_name = "__aeabi_memmove")]
unsafe extern "C" fn memmove(to: *mut u8, from: *const u8, count: usize) {
    // Volatile, or the compiler would see what this loop does, and call for it the function that it is in.
    // SAFETY: the caller's; `i` is below `count`.
    let one = |i| unsafe { to.add(i).write_volatile(from.add(i).read_volatile()) };
    if to.cast_const() <= from { (0..count).for_each(one) } else { (0..count).rev().for_each(one) }
}

/// The same, where both are known to be aligned to 4 bytes.
///
/// # Safety
/// That of [`memmove`].
#[unsafe(export_name = "__aeabi_memmove4")]
unsafe extern "C" fn memmove_words(to: *mut u8, from: *const u8, count: usize) {
    // SAFETY: the caller's.
    unsafe { memmove(to, from, count) }
}

/// The same, where both are known to be aligned to 8 bytes.
///
/// # Safety
/// That of [`memmove`].
#[unsafe(export_name = "__aeabi_memmove8")]
unsafe extern "C" fn memmove_double_words(to: *mut u8, from: *const u8, count: usize) {
    // SAFETY: the caller's.
    unsafe { memmove(to, from, count) }
}
