//! Times of ticks, as people write them.

/// Time of a tick in s, free of the rounding of a long product: to the microsecond.
pub fn tick_time(tick: u32, sample_time: f64) -> f64 {
    (f64::from(tick) * sample_time * 1e6).round() / 1e6
}

/// The number that the user wrote: 0.11 and not the 0.10999999940 that an `f32` holds.
pub fn as_written(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}
