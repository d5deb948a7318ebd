//! Bounds by comparison. `f32::max` and `f32::min` are calls into a library on this processor, and `clamp` can panic.

/// The larger of two; `a` where `b` is no number.
#[inline]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The smaller of two; `a` where `b` is no number.
#[inline]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// `x` within bounds; the lower one for what is no number.
#[inline]
pub(crate) fn bounded(x: f32, low: f32, high: f32) -> f32 {
    smaller(larger(low, x), high)
}
