//! How deep the stack has been.

/// What the start-up code fills the stack with.
const PAINT: u32 = 0xCCCC_CCCC;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Size of the stack in bytes, without what is kept for the fault handler.
pub(crate) fn size() -> usize {
    (&raw const _stack_start).addr() - (&raw const _stack_end).addr()
}

/// Most bytes that have ever been used, to a word.
pub(crate) fn high_water() -> usize {
    let bottom = &raw const _stack_end;
    let words = size() / 4;
    let untouched = (0..words)
        // SAFETY: every word from `_stack_end` up to `_stack_start` is RAM; volatile, since it is stack that may be in
        // use by whoever interrupts this, and any value is fine.
        .take_while(|&i| unsafe { bottom.add(i).read_volatile() } == PAINT)
        .count();
    (words - untouched) * 4
}
