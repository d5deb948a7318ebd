//! Time on the board: whole picoseconds since the first power-up, so that a cycle of any clock here is a whole number.

/// Picoseconds; a day is 8.64e16 of them, a `u64` holds 213 days.
pub type Ps = u64;
/// One microsecond.
pub const US: Ps = 1_000_000;
/// One millisecond.
pub const MS: Ps = 1_000 * US;
/// One second.
pub const SECOND: Ps = 1_000 * MS;
/// Later than everything.
pub const NEVER: Ps = Ps::MAX;

/// The period of a frequency in Hz, to the picosecond.
pub const fn period(hz: u64) -> Ps {
    SECOND / hz
}

/// Seconds as picoseconds, to the picosecond.
pub fn seconds(s: f64) -> Ps {
    (s * SECOND as f64).round() as Ps
}
