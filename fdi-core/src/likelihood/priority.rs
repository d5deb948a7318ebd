//! Two priorities, as process industry has them (ANSI/ISA-18.2): an alarm for what began lately, advice for what creeps, has stood for long, is known to
//! the user, or is shelved by him for a while.

use super::arbiter::Evidence;
use super::class::FaultClass;
use super::verdict::Finding;
use crate::observation::{Observation, Shelving};

/// Since when something has been wrong, and what the user has said of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Standing {
    since: Option<u32>,
    /// What was acknowledged, by the name that it had, if it had one.
    acknowledged: Option<Option<FaultClass>>,
    shelf: Option<Shelf>,
}

/// A class that is advice for a while.
#[derive(Clone, Copy, Debug)]
struct Shelf {
    class: FaultClass,
    since: u32,
    ticks: u32,
}

impl Standing {
    /// Whether what is wrong on this tick is only advice: it came little by little, has stood for more ticks than `long`, or the user knows of it.
    pub(super) fn is_advice(
        &mut self,
        evidence: &Evidence,
        finding: Option<Finding>,
        seen: &Observation,
        long: u32,
    ) -> bool {
        if seen.forget {
            // What was said belongs to the rig as it was.
            *self = Self::default();
        }
        let (tick, alarm) = (seen.index, evidence.alarm());
        let named = finding.map(|finding| finding.class);
        self.hear(seen.shelve, alarm, finding, tick);
        self.shelf = self.shelf.filter(|shelf| tick.wrapping_sub(shelf.since) < shelf.ticks);
        if !alarm {
            (self.since, self.acknowledged) = (None, None);
            return false;
        }
        let is_known =
            self.acknowledged == Some(named) || self.shelf.is_some_and(|shelf| Some(shelf.class) == named);
        if evidence.creeps() {
            // What begins while something creeps is an alarm of its own.
            self.since = None;
            return true;
        }
        is_known || tick.wrapping_sub(*self.since.get_or_insert(tick)) > long
    }

    /// What the user has said on this tick.
    fn hear(&mut self, said: Option<Shelving>, alarm: bool, finding: Option<Finding>, tick: u32) {
        match said {
            Some(Shelving::UntilItEnds) if alarm => {
                self.acknowledged = Some(finding.map(|finding| finding.class));
            }
            Some(Shelving::For(0)) => self.shelf = None,
            Some(Shelving::For(ticks)) => {
                let found = finding.filter(Finding::may_be_shelved);
                self.shelf =
                    found.map(|found| Shelf { class: found.class, since: tick, ticks }).or(self.shelf);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::alarm::Said;
    use super::super::verdict::Magnitude;
    use super::*;

    const LONG: u32 = 100;

    /// What stands, since an onset and since training, by the name of the first.
    #[derive(Clone, Copy)]
    struct Stands(bool, bool, Option<FaultClass>);

    const SIZE: Option<Magnitude> = Some(Magnitude { value: 1.5, half_width: 0.2 });

    const NOTHING: Stands = Stands(false, false, None);
    const SUDDEN: Stands = Stands(true, false, None);
    const CREEPS: Stands = Stands(false, true, None);
    const BOTH: Stands = Stands(true, true, None);

    fn offset(class: FaultClass) -> Stands {
        Stands(true, false, Some(class))
    }

    impl Standing {
        fn on(&mut self, tick: u32, Stands(since_onset, since_training, class): Stands) -> bool {
            self.told(tick, Stands(since_onset, since_training, class), None)
        }

        fn told(&mut self, tick: u32, stands: Stands, shelve: Option<Shelving>) -> bool {
            self.seen(&Observation { index: tick, shelve, ..Observation::default() }, stands)
        }

        fn seen(&mut self, seen: &Observation, stands: Stands) -> bool {
            let Stands(.., class) = stands;
            let found = class.map(|class| Finding { class, confidence: 0.9, magnitude: SIZE, onset: 0 });
            self.finds(seen, stands, found)
        }

        fn finds(&mut self, seen: &Observation, stands: Stands, found: Option<Finding>) -> bool {
            let Stands(since_onset, since_training, _) = stands;
            let by = |says: bool| says.then_some(found);
            let said =
                Said { since_onset: by(since_onset), since_training: by(since_training), ..Said::default() };
            let evidence = Evidence { said: &said, ..Evidence::default() };
            self.is_advice(&evidence, found, seen, LONG)
        }
    }

    #[test]
    fn what_begins_is_an_alarm_and_advice_once_it_has_stood() {
        let mut standing = Standing::default();
        for tick in 7..400 {
            assert_eq!(standing.on(tick, SUDDEN), tick > 7 + LONG, "{tick}");
        }
        assert!(!standing.on(400, NOTHING));
        assert!(!standing.on(401, BOTH), "another one is young again");
    }

    #[test]
    fn what_creeps_is_advice_and_what_begins_meanwhile_is_an_alarm() {
        let mut standing = Standing::default();
        assert!((0..300).all(|tick| standing.on(tick, CREEPS)));
        assert!(!standing.on(300, BOTH));
        assert!(standing.on(301, CREEPS));
    }

    #[test]
    fn what_is_acknowledged_is_advice_until_it_ends_or_has_another_name() {
        let mut standing = Standing::default();
        let (t1, t2) = (offset(FaultClass::T1Offset), offset(FaultClass::T2Offset));
        assert!(!standing.told(0, NOTHING, Some(Shelving::UntilItEnds)));
        assert!(!standing.on(1, t1), "there was nothing to acknowledge");
        assert!(standing.told(2, t1, Some(Shelving::UntilItEnds)));
        assert!(standing.on(3, t1));
        assert!(!standing.on(4, t2), "news");
        assert!(standing.on(5, t1));
        assert!(!standing.on(6, NOTHING));
        assert!(!standing.on(7, t1), "it came again");
    }

    #[test]
    fn what_is_shelved_is_advice_for_so_long_however_often_it_comes() {
        let mut standing = Standing::default();
        let (t1, t2) = (offset(FaultClass::T1Offset), offset(FaultClass::T2Offset));
        assert!(standing.told(10, t2, Some(Shelving::For(50))));
        for tick in 11..100 {
            let stands = if tick % 7 < 3 { NOTHING } else { t2 };
            let expected = tick < 60 && tick % 7 >= 3;
            assert_eq!(standing.on(tick, stands), expected, "{tick}");
        }
        assert!(
            standing.told(100, t2, Some(Shelving::For(50))) && !standing.on(101, t1),
            "another thermistor"
        );
        assert!(!standing.told(102, t2, Some(Shelving::For(0))), "taken off the shelf");
    }

    #[test]
    fn what_is_learnt_anew_is_on_no_shelf() {
        let mut standing = Standing::default();
        let t2 = offset(FaultClass::T2Offset);
        assert!(standing.told(0, t2, Some(Shelving::For(50))));
        assert!(standing.on(1, t2));
        standing.seen(&Observation { index: 2, forget: true, ..Observation::default() }, NOTHING);
        assert!(!standing.on(3, t2), "a new fault of the class");
    }

    /// What may trip, and what has no name or none that is sure, stays an alarm.
    #[test]
    fn what_may_trip_is_not_shelved() {
        let blind = FaultClass::ALL.into_iter().filter(|class| class.leaves_t1_blind());
        for class in blind.chain([FaultClass::Open(super::super::Channel::T1), FaultClass::Unknown]) {
            let mut standing = Standing::default();
            assert!(!standing.told(0, offset(class), Some(Shelving::For(50))), "{class:?}");
        }
        assert!(!Standing::default().told(0, SUDDEN, Some(Shelving::For(50))));
        // A heater that gives always the same has no size.
        let found = Finding { class: FaultClass::HeaterPower, confidence: 0.9, magnitude: None, onset: 0 };
        for (magnitude, confidence, shelved) in [(None, 0.9, false), (SIZE, 0.6, false), (SIZE, 0.9, true)] {
            let seen = Observation { shelve: Some(Shelving::For(50)), ..Observation::default() };
            let found = Some(Finding { magnitude, confidence, ..found });
            assert_eq!(Standing::default().finds(&seen, SUDDEN, found), shelved);
        }
    }
}
