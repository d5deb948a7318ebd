//! What went wrong since the start, the newest few: faults of the rig, trips, holds. What comes again and again takes one entry, and what switched the
//! heater off outlives what did not.

use core::fmt;

use fdi_core::diagnosis::event::{Event, Fault};
use fdi_core::name::Name;
use fdi_core::{AdcCode, Reading, Trip, TripReason};

use crate::alarm::{self, AlarmRecord};
use crate::decimal::{At, Fixed};
use crate::interlock::Lockout;

/// Entries kept.
pub const LENGTH: usize = 8;

/// One thing that went wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Entry {
    /// The diagnosis found a fault; `ended` once it has passed.
    Fault {
        /// Its record.
        fault: Fault,
        /// Whether it has passed.
        ended: bool,
        /// What a user calls it.
        name: Name,
    },
    /// The likelihood diagnosis raised an alarm.
    Alarm {
        /// The last one with its name.
        alarm: AlarmRecord,
        /// How many there were.
        count: u32,
        /// The tick on which the first of them was raised.
        first: u32,
    },
    /// The supervisor tripped.
    Trip(Trip),
    /// Something held the heater off, from this tick on.
    Lockout {
        /// What.
        lockout: Lockout,
        /// Since when.
        tick: u32,
    },
}

/// The newest entries.
#[derive(Clone, Debug, Default)]
pub struct History {
    entries: heapless::Vec<Entry, LENGTH>,
}

impl History {
    /// Adds an entry. Room is made by the oldest that did not switch off, or by the oldest of all.
    pub fn push(&mut self, entry: Entry) {
        if self.entries.is_full() {
            let is_minor = |entry: &Entry| matches!(entry, Entry::Fault { .. } | Entry::Alarm { .. });
            self.entries.remove(self.entries.iter().position(is_minor).unwrap_or(0));
        }
        let _ = self.entries.push(entry);
    }

    /// Adds an event of the diagnosis, with the name that a user has for it; what becomes of a fault replaces its entry.
    pub fn event(&mut self, event: Event, name: Name) {
        let (fault, ended) = match event {
            Event::Detected(fault) => return self.push(Entry::Fault { fault, ended: false, name }),
            Event::Isolated(fault) => (fault, false),
            Event::Ended(fault) => (fault, true),
        };
        let same = |entry: &&mut Entry| matches!(entry, Entry::Fault { fault: known, .. } if known.detected == fault.detected);
        match self.entries.iter_mut().find(same) {
            Some(entry) => *entry = Entry::Fault { fault, ended, name },
            None => self.push(Entry::Fault { fault, ended, name }),
        }
    }

    /// Adds an alarm, or replaces its entry. Once it has ended it takes the place of those before it that had the same name, and counts them; one that
    /// is said to come again and again takes that of the times before as soon as it is.
    pub fn alarm(&mut self, alarm: AlarmRecord) {
        let is_same = |entry: &Entry| matches!(entry, Entry::Alarm { alarm: known, .. } if known.raised == alarm.raised);
        let (mut count, mut first) = (1, alarm.raised);
        if let Some(Entry::Alarm { count: before, first: since, .. }) =
            self.entries.iter().find(|entry| is_same(entry))
        {
            (count, first) = (*before, *since);
        }
        self.entries.retain(|entry| match entry {
            entry if is_same(entry) => false,
            Entry::Alarm { alarm: known, count: before, first: since }
                if alarm.ended.is_some() && known.name() == alarm.name() || alarm.comes_again(known) =>
            {
                (count, first) = (count + before, *since);
                false
            }
            _ => true,
        });
        self.push(Entry::Alarm { alarm, count, first });
    }

    /// An entry, the oldest first.
    pub fn get(&self, index: usize) -> Option<&Entry> {
        self.entries.get(index)
    }
}

/// An entry for people; `sample_time` in s turns ticks into times.
pub struct EntryText<'a> {
    /// The entry.
    pub entry: &'a Entry,
    /// Ts in s.
    pub sample_time: f32,
}

impl fmt::Display for EntryText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |tick: u32| At(tick, self.sample_time);
        match self.entry {
            Entry::Fault { fault, ended, name } => {
                write!(
                    f,
                    "{} s fault: fdv {} fiv {}{}, detected {} s",
                    seconds(fault.onset),
                    u32::from(fault.detection_number),
                    u32::from(fault.isolation_number),
                    Called(*name),
                    seconds(fault.detected)
                )?;
                if let Some(isolated) = fault.isolated {
                    write!(f, ", isolated {} s", seconds(isolated))?;
                }
                match ended {
                    true => write!(f, ", lasted {} s", seconds(fault.duration())),
                    false => f.write_str(", lasting"),
                }
            }
            Entry::Alarm { alarm, count, first } => {
                alarm::AlarmText { alarm, sample_time: self.sample_time }.fmt(f)?;
                if *count == 1 { Ok(()) } else { write!(f, ", {count} times since {} s", seconds(*first)) }
            }
            Entry::Trip(trip) => {
                let (wanted, tick) = (Fixed(trip.setpoint.0, 1), seconds(trip.tick));
                let (Reading { celsius, validity }, code) = seen(trip);
                write!(
                    f,
                    "{tick} s trip: {}; {} degC ({validity:?}, code {}) seen, {wanted} degC wanted at T1",
                    trip.reason.words(),
                    Fixed(celsius.0, 1),
                    Fixed(code.0, 0)
                )?;
                match trip.reason {
                    TripReason::T1OverTemperature | TripReason::T2OverTemperature => {
                        write!(f, ", limit {} degC", Fixed(trip.limit.0, 1))
                    }
                    TripReason::SensorsDisagree | TripReason::T1Contradicted => {
                        write!(f, ", T2 {} degC", Fixed(trip.sample.t2.celsius.0, 1))
                    }
                    TripReason::NoResponse | TripReason::ExcessPower | TripReason::OutOfReach => {
                        power(f, trip)
                    }
                    _ => Ok(()),
                }
            }
            Entry::Lockout { lockout, tick } => write!(f, "{} s lockout: {lockout}", seconds(*tick)),
        }
    }
}

/// A name that a user gave, in brackets; nothing where there is none.
pub struct Called(pub Name);

impl fmt::Display for Called {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " ({})", self.0) }
    }
}

/// The power, and what was needed.
fn power(f: &mut fmt::Formatter<'_>, trip: &Trip) -> fmt::Result {
    write!(f, ", power {} %", Fixed(trip.power.0, 1))?;
    match trip.needed {
        Some(needed) => write!(f, ", {} % needed by what was learnt", Fixed(needed.0, 1)),
        None => Ok(()),
    }
}

/// Reading and code of the thermistor that tripped.
fn seen(trip: &Trip) -> (Reading, AdcCode) {
    match trip.reason {
        TripReason::T2OverTemperature => (trip.sample.t2, trip.raw.t2),
        _ => (trip.sample.t1, trip.raw.t1),
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::{Celsius, FaultClass, Finding, Percent, RawSample, Sample, Validity};

    use super::*;

    fn fault(detected: u32) -> Fault {
        Fault {
            detection_number: 1,
            isolation_number: 0,
            onset: detected - 4,
            detected,
            isolated: None,
            last_seen: detected,
        }
    }

    #[test]
    fn a_fault_is_one_entry_from_detection_to_end() {
        let mut history = History::default();
        history.event(Event::Detected(fault(100)), Name::NONE);
        let isolated = Fault { isolation_number: 2, isolated: Some(110), last_seen: 300, ..fault(100) };
        history.event(Event::Isolated(isolated), Name::NONE);
        history.event(Event::Ended(isolated), Name::NONE);
        assert_eq!(history.get(0), Some(&Entry::Fault { fault: isolated, ended: true, name: Name::NONE }));
        assert_eq!(history.get(1), None);
        let text = EntryText { entry: history.get(0).expect("one"), sample_time: 0.11 }.to_string();
        assert_eq!(text, "10.6 s fault: fdv 1 fiv 2, detected 11.0 s, isolated 12.1 s, lasted 22.1 s");
        let entry = Entry::Fault { fault: isolated, ended: true, name: "hand".parse().expect("a name") };
        let text = EntryText { entry: &entry, sample_time: 0.11 }.to_string();
        assert!(text.starts_with("10.6 s fault: fdv 1 fiv 2 (hand), detected"), "{text}");
    }

    fn alarm(raised: u32, class: Option<FaultClass>, ended: Option<u32>) -> AlarmRecord {
        let finding = class.map(|class| Finding { class, confidence: 0.9, magnitude: None, onset: raised });
        AlarmRecord { raised, finding, taught: Name::NONE, ended }
    }

    fn texts(history: &History) -> Vec<String> {
        history.entries.iter().map(|entry| EntryText { entry, sample_time: 0.1 }.to_string()).collect()
    }

    #[test]
    fn an_alarm_is_one_entry_from_its_beginning_to_its_end() {
        let mut history = History::default();
        history.alarm(alarm(100, None, None));
        history.alarm(alarm(100, Some(FaultClass::T1Offset), None));
        assert_eq!(texts(&history), ["10.0 s alarm: t1_offset, confidence 0.90, since 10.0 s, lasting"]);
        history.alarm(alarm(100, Some(FaultClass::T1Offset), Some(200)));
        assert_eq!(texts(&history), ["10.0 s alarm: t1_offset, confidence 0.90, since 10.0 s, ended 20.0 s"]);
    }

    /// One that comes again and again is one that chatters: it has a count, and pushes nothing out.
    #[test]
    fn alarms_of_one_name_are_one_entry_with_a_count() {
        let mut history = History::default();
        for raised in [100, 300, 500] {
            history.alarm(alarm(raised, None, None));
            history.alarm(alarm(raised, Some(FaultClass::T1Offset), None));
            history.alarm(alarm(raised, Some(FaultClass::T1Offset), Some(raised + 50)));
            history.alarm(alarm(raised + 60, Some(FaultClass::AirFlow), Some(raised + 70)));
        }
        assert_eq!(
            texts(&history),
            [
                "50.0 s alarm: t1_offset, confidence 0.90, since 50.0 s, ended 55.0 s, 3 times since 10.0 s",
                "56.0 s alarm: air_flow, confidence 0.90, since 56.0 s, ended 57.0 s, 3 times since 16.0 s"
            ]
        );
    }

    /// A loose contact is told once, and how often it has come; an error of before it began is another one.
    #[test]
    fn a_loose_contact_takes_the_place_of_the_errors_by_which_it_was_seen() {
        let mut history = History::default();
        for (raised, class) in [(50, FaultClass::T1Offset), (70, FaultClass::T2Offset)] {
            history.alarm(alarm(raised, Some(class), Some(raised + 10)));
        }
        history.alarm(alarm(200, Some(FaultClass::T2Offset), Some(250)));
        history.alarm(alarm(300, Some(FaultClass::T2Offset), None));
        let loose = |raised, ended| {
            let mut alarm = alarm(raised, Some(FaultClass::T2Loose), ended);
            alarm.finding.as_mut().expect("it has one").onset = 65;
            alarm
        };
        history.alarm(loose(300, None));
        let told = "30.0 s alarm: t2_loose, confidence 0.90, since 6.5 s, lasting, 3 times since 7.0 s";
        assert_eq!(texts(&history)[1..], [told]);
        history.alarm(loose(300, Some(900)));
        assert_eq!(texts(&history)[1..], [told.replace("lasting", "ended 90.0 s")]);
        history.alarm(alarm(1000, Some(FaultClass::T2Offset), Some(1010)));
        assert_eq!(texts(&history).len(), 3, "what comes later is another one");
    }

    #[test]
    fn a_trip_by_heat_says_which_limit_was_exceeded() {
        let reading = |celsius| Reading { celsius: Celsius(celsius), validity: Validity::Good };
        let trip = Trip {
            reason: TripReason::T2OverTemperature,
            tick: 100,
            raw: RawSample { t2: AdcCode(500.0), ..RawSample::default() },
            sample: Sample { t0: reading(22.0), t1: reading(35.0), t2: reading(87.25) },
            setpoint: Celsius(35.0),
            limit: Celsius(75.0),
            power: Percent(99.5),
            needed: Some(Percent(41.7)),
        };
        let text = |trip| EntryText { entry: &Entry::Trip(trip), sample_time: 0.11 }.to_string();
        let seen = "87.3 degC (Good, code 500) seen, 35.0 degC wanted at T1";
        assert_eq!(text(trip), format!("11.0 s trip: T2 is above the limit; {seen}, limit 75.0 degC"));
        let excess = text(Trip { reason: TripReason::ExcessPower, ..trip });
        assert!(excess.ends_with("power 99.5 %, 41.7 % needed by what was learnt"), "{excess}");
        let open = text(Trip { reason: TripReason::T1Open, ..trip });
        assert!(open.ends_with("35.0 degC wanted at T1"), "{open}");
    }

    #[test]
    fn what_switched_off_outlives_what_did_not() {
        let mut history = History::default();
        let lockout = |tick| Entry::Lockout { lockout: Lockout::BreakInput, tick };
        history.push(lockout(0));
        for detected in 100..100 + 2 * LENGTH as u32 {
            history.event(Event::Detected(fault(detected)), Name::NONE);
        }
        assert_eq!((history.get(0), history.entries.len()), (Some(&lockout(0)), LENGTH));
        for tick in 1..=LENGTH as u32 {
            history.push(lockout(tick));
        }
        assert_eq!((history.get(0), history.entries.len()), (Some(&lockout(1)), LENGTH));
    }
}
