//! A thermistor whose error comes and goes: a loose contact. Its alarms are one alarm that chatters (ANSI/ISA-18.2).

use super::class::FaultClass;
use super::verdict::Finding;

/// The thermistor whose error came last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    /// The error as it was named last.
    named: Option<Finding>,
    /// Tick of its first alarm, and the last tick on which it stood.
    first: u32,
    last: u32,
    /// How many alarms it has had, each within the window after the one before.
    alarms: u32,
    /// It has been counted in the alarm that stands.
    counted: bool,
    /// How many faults were taught then.
    taught: usize,
}

/// What makes a contact a loose one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chatter {
    /// Alarms from which on it is.
    pub(super) alarms: u32,
    /// Ticks after which an error that has not come back is over.
    pub(super) window: u32,
    /// How many faults are taught: when one more is, the errors so far were made on purpose, to show it.
    pub(super) taught: usize,
}

impl Contact {
    /// One tick: the alarm since an onset, and what it is called.
    pub(super) fn step(
        &mut self,
        chatter: Chatter,
        alarm: Option<Option<Finding>>,
        tick: u32,
    ) -> Option<Finding> {
        self.counted &= alarm.is_some();
        if tick.wrapping_sub(self.last) > chatter.window || self.taught != chatter.taught {
            *self = Self { taught: chatter.taught, ..Self::default() };
        }
        match alarm {
            Some(Some(named)) if loose(named.class).is_some() => self.follow(named, tick),
            // One that is too short for a name may be the next of them: it keeps what stands, and does not count.
            Some(None) => self.last = tick,
            _ => {}
        }
        let named = self.named.filter(|_| self.alarms >= chatter.alarms)?;
        Some(Finding { class: loose(named.class)?, onset: self.first, ..named })
    }

    fn follow(&mut self, named: Finding, tick: u32) {
        if self.named.is_none_or(|was| was.class != named.class) {
            *self = Self { first: named.onset, taught: self.taught, ..Self::default() };
        }
        if !self.counted {
            self.alarms += 1;
            self.counted = true;
        }
        self.named = Some(named);
        self.last = tick;
    }
}

/// What an error of this class is called that comes again and again. T0 has none: what moves T1 and T2 alike is given its name as well.
fn loose(class: FaultClass) -> Option<FaultClass> {
    match class {
        FaultClass::T1Offset => Some(FaultClass::T1Loose),
        FaultClass::T2Offset => Some(FaultClass::T2Loose),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use FaultClass::{AirFlow, T1Loose, T1Offset, T2Offset};

    const CHATTER: Chatter = Chatter { alarms: 3, window: 600, taught: 0 };

    /// Alarms of these classes, 100 ticks each and 100 ticks apart from tick 50 on; what is said on the last tick of each, and of the pause after it.
    fn said(classes: &[FaultClass]) -> Vec<[Option<Finding>; 2]> {
        let mut contact = Contact::default();
        let mut tick = 50;
        let mut last_of = |class: Option<FaultClass>| {
            let mut said = None;
            for _ in 0..100 {
                let named =
                    class.map(|class| Finding { class, confidence: 0.9, magnitude: None, onset: tick });
                said = contact.step(CHATTER, named.map(Some), tick);
                tick += 1;
            }
            said
        };
        classes.iter().map(|class| [last_of(Some(*class)), last_of(None)]).collect()
    }

    fn is_loose(said: &[Option<Finding>; 2]) -> [bool; 2] {
        said.map(|finding| finding.is_some_and(|finding| finding.class == T1Loose))
    }

    #[test]
    fn an_error_that_comes_a_third_time_is_a_loose_contact_and_stays_one_between() {
        let said = said(&[T1Offset; 4]);
        assert_eq!(
            said.iter().map(is_loose).collect::<Vec<_>>(),
            [[false; 2], [false; 2], [true; 2], [true; 2]]
        );
        let first = said[3][1].map(|finding| finding.onset);
        assert!(first.is_some_and(|onset| onset < 150), "since the first of them: {first:?}");
    }

    #[test]
    fn another_thermistor_begins_a_count_of_its_own_and_another_fault_counts_for_none() {
        assert!(
            said(&[T1Offset, T2Offset, T1Offset, T1Offset]).iter().all(|said| is_loose(said) == [false; 2])
        );
        assert!(said(&[AirFlow; 5]).iter().flatten().all(Option::is_none));
    }

    /// The repetitions by which a fault is taught come as a loose contact's errors do; it is none when the fault comes then.
    #[test]
    fn what_was_shown_to_teach_a_fault_counts_for_none() {
        let mut contact = Contact::default();
        let named = |tick| Some(Finding { class: T1Offset, confidence: 0.9, magnitude: None, onset: tick });
        let mut alarm = |tick, taught| {
            let chatter = Chatter { taught, ..CHATTER };
            contact.step(chatter, None, tick - 1);
            contact.step(chatter, Some(named(tick)), tick).is_some()
        };
        assert_eq!([(100, 0), (200, 0)].map(|(tick, taught)| alarm(tick, taught)), [false; 2]);
        assert_eq!([(300, 1), (400, 1), (500, 1)].map(|(t, taught)| alarm(t, taught)), [false, false, true]);
    }

    /// Too short for a name, it counts for none and keeps what stands.
    #[test]
    fn an_alarm_without_a_name_keeps_a_loose_contact() {
        let mut contact = Contact::default();
        let named = |tick| Some(Finding { class: T1Offset, confidence: 0.9, magnitude: None, onset: tick });
        for tick in [100, 200, 300] {
            assert!(contact.step(CHATTER, Some(None), tick).is_none());
            contact.step(CHATTER, Some(named(tick + 1)), tick + 1);
            contact.step(CHATTER, None, tick + 2);
        }
        assert!(
            contact.step(CHATTER, Some(None), 800).is_some() && contact.step(CHATTER, None, 1300).is_some()
        );
        assert!(contact.step(CHATTER, None, 1401).is_none());
    }

    /// An alarm that changes its name and back is still one.
    #[test]
    fn an_alarm_counts_once() {
        let mut contact = Contact::default();
        for tick in 0..60 {
            let class = if tick % 2 == 0 { T1Offset } else { AirFlow };
            let named = Finding { class, confidence: 0.9, magnitude: None, onset: 0 };
            assert_eq!(contact.step(CHATTER, Some(Some(named)), tick), None, "{tick}");
        }
    }

    #[test]
    fn an_error_that_has_not_come_back_within_the_window_is_over() {
        let mut contact = Contact::default();
        let mut step = |named: bool, tick| {
            let named =
                named.then_some(Finding { class: T1Offset, confidence: 0.9, magnitude: None, onset: tick });
            contact.step(CHATTER, named.map(Some), tick).is_some()
        };
        for tick in [100, 200, 300] {
            step(true, tick);
            step(false, tick + 1);
        }
        assert!(step(false, 900) && !step(false, 901));
        assert!(!step(true, 902), "it begins to count anew");
    }
}
