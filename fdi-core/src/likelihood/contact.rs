//! A thermistor whose error comes and goes: a loose contact. Its alarms are one alarm that chatters (ANSI/ISA-18.2).

use super::alarm::Held;
use super::class::FaultClass;
use super::verdict::Finding;

/// The thermistor whose error came last, and what became of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    /// Its error.
    class: Option<FaultClass>,
    /// The error as it was named last.
    named: Option<Finding>,
    /// Tick of its first alarm, and the last tick on which one stood.
    first: u32,
    last: u32,
    /// How often it has come and gone, too low and too high, each time within the window after the time before. What was followed for long looks
    /// like the opposite error when it goes.
    times: [u32; 2],
    /// The alarm that stands.
    alarm: Standing,
    /// How many faults were taught then.
    taught: usize,
}

/// An alarm: its onset, what it was held for, and on how many ticks more than for all else.
#[derive(Clone, Copy, Debug, Default)]
struct Standing {
    onset: u32,
    most: Option<Error>,
    ticks: u32,
}

/// An error of a thermistor, by its class, and whether it reads too high.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Error {
    class: FaultClass,
    high: bool,
}

/// What makes a contact a loose one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chatter {
    /// It has come and gone this often.
    pub(super) times: u32,
    /// Ticks after which an error that has not come back is over.
    pub(super) window: u32,
    /// How many faults are taught: when one more is, the errors so far were made on purpose, to show it.
    pub(super) taught: usize,
}

impl Contact {
    /// One tick: the alarm since an onset, what it is called, and what it is.
    pub(super) fn step(&mut self, chatter: Chatter, alarm: Option<Held>, tick: u32) -> Option<Finding> {
        if tick.wrapping_sub(self.last) > chatter.window || self.taught != chatter.taught {
            *self = Self { taught: chatter.taught, alarm: self.alarm, ..Self::default() };
        }
        match alarm {
            Some(held) => self.follow(&held, tick),
            None => self.count(),
        }
        let named = self.named.filter(|_| self.times.iter().any(|times| *times >= chatter.times))?;
        Some(Finding { class: named.class.again()?, onset: self.first, ..named })
    }

    fn follow(&mut self, held: &Held, tick: u32) {
        let error = Error::of(held);
        self.alarm.hold(error, held.onset);
        match held.named {
            // One that is too short for a name may be the next of them: it keeps what stands.
            None => self.last = tick,
            Some(named) => {
                let Some(error) = error.filter(|error| error.class == named.class) else { return };
                if self.class != Some(error.class) {
                    self.begin(error.class, held.onset);
                }
                let [same, opposite] = [error.high, !error.high].map(|high| self.times[usize::from(high)]);
                if self.named.is_none() || same >= opposite {
                    self.named = Some(named);
                }
                self.last = tick;
            }
        }
    }

    fn begin(&mut self, class: FaultClass, onset: u32) {
        let Self { last, alarm, taught, .. } = *self;
        *self = Self { class: Some(class), first: onset, last, alarm, taught, ..Self::default() };
    }

    /// An alarm has ended, if there was one.
    fn count(&mut self) {
        let Standing { onset, most, .. } = core::mem::take(&mut self.alarm);
        let Some(error) = most else { return };
        if self.class.is_none() {
            self.begin(error.class, onset);
        }
        if self.class == Some(error.class) {
            let times = &mut self.times[usize::from(error.high)];
            *times = times.saturating_add(1);
        }
    }
}

impl Standing {
    /// One tick: what most ticks hold it for, by a vote in which the others outvote it (R. S. Boyer, J. S. Moore 1981).
    fn hold(&mut self, error: Option<Error>, onset: u32) {
        self.onset = onset;
        (self.most, self.ticks) = match self.ticks {
            0 => (error, 1),
            ticks if self.most == error => (error, ticks.saturating_add(1)),
            ticks => (self.most, ticks - 1),
        };
    }
}

impl Error {
    /// What an alarm is held for, if that is an error that a loose contact makes.
    fn of(held: &Held) -> Option<Self> {
        held.class.again().map(|_| Self { class: held.class, high: held.value > 0.0 })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use FaultClass::{AirFlow, Drift, T1Loose, T1Offset, T2Offset};

    const CHATTER: Chatter = Chatter { times: 2, window: 600, taught: 0 };
    /// An alarm lasts so long in these tests, and the pause after it, ticks.
    const SPELL: u32 = 100;

    /// What an alarm is held for, and whether it has that name.
    #[derive(Clone, Copy)]
    struct Is(FaultClass, f32, bool);

    const T1_HIGH: Is = Is(T1Offset, 1.5, true);
    const T1_LOW: Is = Is(T1Offset, -1.5, true);
    const T2_HIGH: Is = Is(T2Offset, 1.5, true);

    fn held(Is(class, value, is_named): Is, onset: u32) -> Held {
        let named = Finding { class, confidence: 0.9, magnitude: None, onset };
        Held { class, value, onset, named: is_named.then_some(named) }
    }

    /// Alarms one after another, from tick 1000 on, each with a pause; what is said on the last tick of each, and on that of the pause after it.
    fn said(alarms: &[Is]) -> Vec<[bool; 2]> {
        let mut contact = Contact::default();
        let mut tick = 1000;
        let mut last_of = |alarm: Option<Is>| {
            let (onset, mut said) = (tick, None);
            for _ in 0..SPELL {
                said = contact.step(CHATTER, alarm.map(|is| held(is, onset)), tick);
                tick += 1;
            }
            said.is_some_and(|finding| finding.class == T1Loose && finding.onset < 1000 + SPELL)
        };
        alarms.iter().map(|alarm| [last_of(Some(*alarm)), last_of(None)]).collect()
    }

    const NOT: [bool; 2] = [false; 2];

    #[test]
    fn an_error_that_has_come_and_gone_twice_is_a_loose_contact_and_stays_one_between() {
        assert_eq!(said(&[T1_HIGH; 3]), [NOT, [false, true], [true; 2]]);
        assert_eq!(said(&[T1_HIGH]), [NOT], "once it may have been mended");
    }

    #[test]
    fn another_thermistor_begins_a_count_of_its_own_and_another_fault_counts_for_none() {
        assert_eq!(said(&[T1_HIGH, T2_HIGH, T1_HIGH]), [NOT; 3]);
        assert_eq!(said(&[Is(AirFlow, 0.2, true); 4]), [NOT; 4]);
        assert_eq!(said(&[T1_HIGH, Is(AirFlow, 0.2, true), T1_HIGH])[2], [false, true]);
    }

    /// An error that was followed for long looks like the opposite one when it goes: the two are one error that came once.
    #[test]
    fn an_error_and_its_opposite_count_each_for_itself() {
        assert_eq!(said(&[T1_HIGH, T1_LOW]), [NOT; 2]);
        assert_eq!(said(&[T1_HIGH, T1_LOW, T1_HIGH, T1_LOW]), [NOT, NOT, [false, true], [true; 2]]);
    }

    /// Who is never quite sure that it is T1 has seen it all the same.
    #[test]
    fn an_alarm_that_is_never_sure_counts_for_what_it_was_held_for_most() {
        let unsure = Is(T1Offset, 1.5, false);
        assert_eq!(said(&[unsure, T1_HIGH]), [NOT, [false, true]]);
        assert_eq!(said(&[T1_HIGH, unsure]), [NOT, [false, true]]);
        assert_eq!(said(&[T1_HIGH, Is(Drift, 1.0, false), T1_HIGH])[1..], [NOT, [false, true]]);
        assert_eq!(said(&[unsure; 3]), [NOT; 3], "something has to be sure");
    }

    /// Its last moments fit nothing, and its first may fit anything.
    #[test]
    fn an_alarm_counts_once_and_for_most_of_its_time() {
        let of = |classes: [FaultClass; 5]| {
            let mut contact = Contact::default();
            let mut alarm = |from: u32| {
                for (i, class) in classes.into_iter().enumerate() {
                    let tick = from + i as u32;
                    contact.step(CHATTER, Some(held(Is(class, 1.5, true), from)), tick);
                }
                contact.step(CHATTER, None, from + 5).is_some()
            };
            [alarm(1000), alarm(1100)]
        };
        assert_eq!(of([AirFlow, T1Offset, T1Offset, T1Offset, Drift]), [false, true]);
        assert_eq!(of([T1Offset, AirFlow, AirFlow, AirFlow, AirFlow]), [false, false]);
        assert_eq!(of([T1Offset, AirFlow, T1Offset, AirFlow, T1Offset]), [false, true], "once an alarm");
    }

    /// The repetitions by which a fault is taught come as a loose contact's errors do; it is none when the fault comes then.
    #[test]
    fn what_was_shown_to_teach_a_fault_counts_for_none() {
        let mut contact = Contact::default();
        let mut alarm = |tick, taught| {
            let chatter = Chatter { taught, ..CHATTER };
            contact.step(chatter, Some(held(T1_HIGH, tick)), tick);
            contact.step(chatter, None, tick + 1).is_some()
        };
        assert!(!alarm(1000, 0));
        assert_eq!([(1100, 1), (1200, 1)].map(|(tick, taught)| alarm(tick, taught)), [false, true]);
    }

    #[test]
    fn an_error_that_has_not_come_back_within_the_window_is_over() {
        let mut contact = Contact::default();
        let mut step =
            |alarm: Option<Is>, tick| contact.step(CHATTER, alarm.map(|is| held(is, tick)), tick).is_some();
        for tick in [1000, 1200] {
            step(Some(T1_HIGH), tick);
            step(None, tick + 1);
        }
        // Too short for a name, it keeps what stands.
        assert!(step(Some(Is(AirFlow, 0.2, false)), 1700) && step(None, 2300) && !step(None, 2301));
        assert!(!step(Some(T1_HIGH), 2302) && !step(None, 2303), "it begins to count anew");
        assert!(!step(Some(T1_HIGH), 2904) && !step(None, 2905), "and this came too late after it");
    }
}
