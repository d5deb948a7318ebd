//! Keeps the control tick on its grid and accounts for every microsecond that it is late.
//!
//! Time is a free-running 32-bit counter of microseconds that wraps every 71.6 minutes; only differences are used.

use core::num::NonZeroU32;

use fdi_core::Seconds;

/// Ts that a board can keep, s: the log of a shorter one would not get through, and a rig that is slower still needs none.
pub const SAMPLE_TIMES: [f32; 2] = [0.05, 5.0];
/// The rig is looked at at least so often, in µs, whatever Ts is.
const LONGEST_WAIT: u32 = 110_000;
/// The heater is cut when nothing has been completed for so many waits after the last was due: three are missed then and the
/// fourth has not come either.
const DEADLINE_WAITS: u32 = 4;
/// Missed ticks that the core sees one by one. The heater is off before there can be more.
const MAX_MISSED: u32 = 4;

/// Bins of the jitter histogram: bin i counts ticks that began less than `2^i` µs late (and not less than half of that).
pub const BINS: usize = 16;

/// The jitter of the control tick since boot; counters saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Jitter {
    /// Ticks that began.
    pub ticks: u32,
    /// Ticks that never began: their time passed while an earlier one was still held up.
    pub missed: u32,
    /// Most microseconds that a tick began after it was due.
    pub worst_us: u32,
    /// Ticks by lateness.
    pub histogram: [u32; BINS],
}

impl Jitter {
    /// Counts a tick by when it began.
    pub fn count(&mut self, arrival: &Arrival) {
        self.ticks = self.ticks.saturating_add(1);
        self.missed = self.missed.saturating_add(arrival.missed);
        self.worst_us = self.worst_us.max(arrival.late_us);
        let bin = (u32::BITS - arrival.late_us.leading_zeros()) as usize;
        if let Some(count) = self.histogram.get_mut(bin.min(BINS - 1)) {
            *count = count.saturating_add(1);
        }
    }
}

/// What is known when a tick begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Arrival {
    /// When this tick was due, in µs.
    pub due: u32,
    /// Microseconds after `due`.
    pub late_us: u32,
    /// Ticks missed just before this one.
    pub missed: u32,
}

impl Arrival {
    /// How many missed ticks the core has to see before this one.
    pub fn missed_ticks(&self) -> u32 {
        self.missed.min(MAX_MISSED)
    }
}

/// Ts in whole µs.
pub fn period(sample_time: Seconds) -> NonZeroU32 {
    NonZeroU32::new((sample_time.0 * 1e6 + 0.5) as u32).unwrap_or(NonZeroU32::MIN)
}

/// The grid of due times, and the looks between two of them where they are far apart: what is dangerous by itself must not
/// wait for a tick.
#[derive(Clone, Debug)]
pub struct Cadence {
    period: NonZeroU32,
    due: u32,
}

impl Cadence {
    /// A grid whose first tick is due at `first`; `period` in µs.
    pub fn new(period: NonZeroU32, first: u32) -> Self {
        Self { period, due: first }
    }

    /// When the next tick is due.
    pub fn due(&self) -> u32 {
        self.due
    }

    /// When to look before the next tick, if it is further from `now` than may be waited: looks part the time evenly.
    pub fn look(&self, now: u32) -> Option<u32> {
        let ahead = self.due.wrapping_sub(now);
        let far = ahead > LONGEST_WAIT && ahead <= u32::MAX / 2;
        far.then(|| now.wrapping_add(ahead / ahead.div_ceil(LONGEST_WAIT).max(1)))
    }

    /// When the heater is to be cut, in µs, unless something else has been completed by then than what was due at `due`.
    pub fn deadline(&self, due: u32) -> u32 {
        due.wrapping_add(DEADLINE_WAITS * self.period.get().min(LONGEST_WAIT))
    }

    /// The arrival of a tick that begins at `now`. Whole periods that have passed are missed ticks; the grid itself
    /// never moves, so lateness cannot add up to drift.
    pub fn arrive(&mut self, now: u32) -> Arrival {
        let behind = now.wrapping_sub(self.due);
        let behind = if behind > u32::MAX / 2 { 0 } else { behind }; // woken early: on time
        let (missed, late_us) = (behind / self.period, behind % self.period);
        let due = self.due.wrapping_add(missed.wrapping_mul(self.period.get()));
        self.due = due.wrapping_add(self.period.get());
        Arrival { due, late_us, missed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TS: u32 = 110_000;
    const PERIOD: NonZeroU32 = NonZeroU32::new(TS).expect("not zero");

    #[test]
    fn a_day_of_jitter_moves_the_grid_by_nothing() {
        let first = u32::MAX - 5 * TS; // begins just before the counter wraps
        let mut cadence = Cadence::new(PERIOD, first);
        let mut p = Jitter::default();
        let ticks = 24 * 3600 * 1000 / 110;
        for k in 0..ticks {
            let due = cadence.due();
            assert_eq!(due, first.wrapping_add(TS.wrapping_mul(k)), "tick {k}");
            let arrival = cadence.arrive(due.wrapping_add(k % 37));
            assert_eq!(arrival, Arrival { due, late_us: k % 37, missed: 0 });
            p.count(&arrival);
        }
        assert_eq!((p.ticks, p.missed, p.worst_us), (ticks, 0, 36));
        assert_eq!(p.histogram.iter().sum::<u32>(), ticks);
    }

    #[test]
    fn whole_periods_are_missed_ticks_and_the_rest_is_lateness() {
        let mut cadence = Cadence::new(PERIOD, 0);
        assert_eq!(
            cadence.arrive(3 * TS + 70),
            Arrival { due: 3 * TS, late_us: 70, missed: 3 },
            "the tick that begins is the one of the present period"
        );
        assert_eq!(cadence.due(), 4 * TS);
        assert_eq!(cadence.arrive(4 * TS).missed, 0);
    }

    #[test]
    fn the_deadline_is_440_ms_after_the_tick_was_due_and_no_more_missed_ticks_are_seen_than_fit() {
        let arrival = Arrival { due: u32::MAX - 10_000, late_us: 70, missed: 2 };
        let deadline = |sample_time| Cadence::new(period(Seconds(sample_time)), 0).deadline(arrival.due);
        assert_eq!((deadline(0.11), arrival.missed_ticks()), (429_999, 2));
        assert_eq!((deadline(0.05), deadline(5.0)), (189_999, 429_999));
        assert_eq!(Arrival { missed: 39_000, ..arrival }.missed_ticks(), 4, "a halt of an hour");
    }

    #[test]
    fn the_rig_is_looked_at_every_110_ms_however_long_the_period_is() {
        for (sample_time, looks) in [(0.05, 0), (0.11, 0), (0.25, 2), (0.5, 4), (5.0, 45)] {
            let period = period(Seconds(sample_time));
            assert_eq!(period.get(), (f64::from(sample_time) * 1e6).round() as u32);
            let first = u32::MAX - period.get() / 2; // the counter wraps before the second tick
            let mut cadence = Cadence::new(period, first);
            assert_eq!(cadence.arrive(first), Arrival { due: first, late_us: 0, missed: 0 });
            let mut now = first.wrapping_add(1400); // a tick takes as long
            let mut count = 0;
            while let Some(at) = cadence.look(now) {
                assert!(at.wrapping_sub(now) <= LONGEST_WAIT && at != now, "{sample_time} s");
                now = at.wrapping_add(1400);
                count += 1;
            }
            assert!(cadence.due().wrapping_sub(now) <= LONGEST_WAIT, "{sample_time} s");
            assert!((looks..=looks + 1).contains(&count), "{sample_time} s: {count} looks");
            assert_eq!(cadence.arrive(cadence.due()).missed, 0);
        }
    }

    #[test]
    fn a_look_that_comes_too_late_moves_no_tick() {
        let mut cadence = Cadence::new(period(Seconds(1.0)), 0);
        cadence.arrive(0);
        assert_eq!(cadence.look(1_000_500), None, "past the tick: it begins at once");
        assert_eq!(cadence.arrive(2_000_300), Arrival { due: 2_000_000, late_us: 300, missed: 1 });
    }

    #[test]
    fn early_is_on_time_and_bins_are_powers_of_two() {
        let mut cadence = Cadence::new(PERIOD, 1000);
        assert_eq!(cadence.arrive(998).late_us, 0);
        for (late, bin) in [(0, 0), (1, 1), (2, 2), (3, 2), (4, 3), (65_000, BINS - 1)] {
            let mut p = Jitter::default();
            p.count(&cadence.arrive(cadence.due() + late));
            assert_eq!((p.histogram[bin], p.worst_us, p.ticks), (1, late, 1), "{late} us");
        }
        let mut p = Jitter::default();
        p.count(&Arrival { due: 0, late_us: 7, missed: 3 });
        assert_eq!((p.missed, p.worst_us), (3, 7));
    }
}
