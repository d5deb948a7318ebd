//! What is counted over a server's life, for Prometheus.

use std::time::SystemTime;

use fdi_core::TripReason;
use fdi_core::schema;

use crate::source::{Numbers, Told};

/// A tick that begins later than this is late, µs: a board that is well begins within a tenth of it.
const LATE: u32 = 1000;

/// Counts; none of them ever goes down.
#[derive(Default)]
pub(crate) struct Counts {
    pub(crate) ticks: u64,
    /// Ticks of a board that were not heard, and how often some were not.
    pub(crate) unheard: u64,
    pub(crate) gaps: u64,
    /// Ticks of a board that began late, and that never began.
    pub(crate) late: u64,
    pub(crate) missed: u64,
    pub(crate) alarms: u64,
    /// By the number of their reasons, from 1.
    pub(crate) trips: [u64; TripReason::NAMES.len()],
    /// Nothing is heard of the board.
    pub(crate) lost: bool,
    /// When the last tick was heard.
    pub(crate) heard: Option<SystemTime>,
    /// Ticks since the mode is as it is, and since the alarm began or ended.
    pub(crate) mode_for: u64,
    pub(crate) alarm_for: u64,
    before: Before,
}

/// What was on the last tick that was heard.
#[derive(Default)]
struct Before {
    mode: Option<f32>,
    alarm: bool,
    trip: Option<usize>,
    gap: bool,
}

/// The number of a field; `None` where it is not defined.
pub(crate) fn number(row: &Numbers, name: &str) -> Option<f32> {
    schema::field(name).map(|i| row[i]).filter(|number| !number.is_nan())
}

impl Counts {
    /// Counts what is told.
    pub(crate) fn take(&mut self, told: &Told) {
        match told {
            Told::Row(row) => self.row(row),
            Told::Late { micros, missed } => {
                self.late += u64::from(*micros > LATE && !missed);
                self.missed += u64::from(*missed);
            }
            Told::Link(up) => self.lost = !up,
            _ => {}
        }
    }

    /// Another scene begins: what is on its first tick began there.
    pub(crate) fn begin(&mut self) {
        self.before = Before::default();
    }

    fn row(&mut self, row: &Numbers) {
        self.ticks += 1;
        self.mode_for += 1;
        self.alarm_for += 1;
        let mode = number(row, "mode");
        // Of a tick that was heard there always is a mode.
        if mode.is_none() {
            self.unheard += 1;
            self.gaps += u64::from(!std::mem::replace(&mut self.before.gap, true));
            return;
        }
        self.heard = Some(SystemTime::now());
        let trip = number(row, "trip").map(|trip| trip as usize);
        let alarm = number(row, "alarm") == Some(1.0);
        self.alarms += u64::from(alarm && !self.before.alarm);
        if mode != self.before.mode {
            self.mode_for = 0;
        }
        if alarm != self.before.alarm {
            self.alarm_for = 0;
        }
        if let Some(trip) = trip
            && self.before.trip != Some(trip)
            && let Some(count) = self.trips.get_mut(trip.wrapping_sub(1))
        {
            *count += 1;
        }
        self.before = Before { mode, alarm, trip, gap: false };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row with some numbers, and nothing defined besides.
    fn row(numbers: &[(&str, f32)]) -> Told {
        let mut row = [f32::NAN; _];
        numbers.iter().for_each(|(name, number)| row[schema::field(name).unwrap()] = *number);
        Told::Row(row)
    }

    #[test]
    fn trips_alarms_and_gaps_are_counted_when_they_begin() {
        let mut counts = Counts::default();
        let well = row(&[("mode", 3.0), ("alarm", 0.0)]);
        let alarmed = row(&[("mode", 3.0), ("alarm", 1.0)]);
        let tripped = |trip| row(&[("mode", 4.0), ("alarm", 1.0), ("trip", trip)]);
        let unheard = row(&[]);
        let all = [
            &well,
            &alarmed,
            &alarmed,
            &tripped(2.0),
            &tripped(2.0),
            &unheard,
            &unheard,
            &tripped(2.0),
            &well,
            &unheard,
            &well,
            &tripped(2.0),
            &tripped(1.0),
        ];
        all.into_iter().for_each(|told| counts.take(told));
        assert_eq!((counts.ticks, counts.alarms, counts.unheard, counts.gaps), (13, 2, 3, 2));
        assert_eq!((counts.trips[0], counts.trips[1], counts.trips.iter().sum::<u64>()), (1, 2, 3));
    }

    /// Ticks that were not heard count: the mode was, as far as anybody knows, the same.
    #[test]
    fn it_is_known_for_how_long_mode_and_alarm_are_as_they_are() {
        let mut counts = Counts::default();
        let mut after = |mode, alarm| {
            counts.take(&row(&[("mode", mode), ("alarm", alarm)]));
            (counts.mode_for, counts.alarm_for)
        };
        assert_eq!(after(3.0, 0.0), (0, 1));
        assert_eq!(after(3.0, 0.0), (1, 2));
        assert_eq!(after(3.0, 1.0), (2, 0));
        assert_eq!(after(f32::NAN, f32::NAN), (3, 1));
        assert_eq!(after(4.0, 1.0), (0, 2));
    }

    #[test]
    fn ticks_that_were_late_are_not_those_that_never_began() {
        let mut counts = Counts::default();
        for (micros, missed) in [(3, false), (LATE, false), (LATE + 1, false), (0, true), (5000, true)] {
            counts.take(&Told::Late { micros, missed });
        }
        counts.take(&Told::Link(false));
        assert_eq!((counts.late, counts.missed, counts.lost), (1, 2, true));
    }
}
