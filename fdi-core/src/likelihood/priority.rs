//! Two priorities, as process industry has them (ANSI/ISA-18.2): an alarm for what began lately, advice for what creeps or has stood for long.

use super::arbiter::Evidence;

/// Since when something has been wrong.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Standing {
    since: Option<u32>,
}

impl Standing {
    /// Whether what is wrong on this tick is only advice: it came little by little, or has stood for more ticks than `long`.
    pub(super) fn is_advice(&mut self, evidence: &Evidence, tick: u32, long: u32) -> bool {
        if !evidence.alarm() {
            self.since = None;
            return false;
        }
        if evidence.creeps() {
            // What begins while something creeps is an alarm of its own.
            self.since = None;
            return true;
        }
        tick.wrapping_sub(*self.since.get_or_insert(tick)) > long
    }
}

#[cfg(test)]
mod tests {
    use super::super::alarm::Said;
    use super::*;

    const LONG: u32 = 100;

    fn said(since_onset: bool, since_training: bool) -> Evidence {
        let by = |says: bool| says.then_some(None);
        Evidence {
            said: Said {
                since_onset: by(since_onset),
                since_training: by(since_training),
                ..Said::default()
            },
            ..Evidence::default()
        }
    }

    #[test]
    fn what_begins_is_an_alarm_and_advice_once_it_has_stood() {
        let mut standing = Standing::default();
        for tick in 7..400 {
            assert_eq!(standing.is_advice(&said(true, false), tick, LONG), tick > 7 + LONG, "{tick}");
        }
        assert!(!standing.is_advice(&said(false, false), 400, LONG));
        assert!(!standing.is_advice(&said(true, true), 401, LONG), "another one is young again");
    }

    #[test]
    fn what_creeps_is_advice_and_what_begins_meanwhile_is_an_alarm() {
        let mut standing = Standing::default();
        assert!((0..300).all(|tick| standing.is_advice(&said(false, true), tick, LONG)));
        assert!(!standing.is_advice(&said(true, true), 300, LONG));
        assert!(standing.is_advice(&said(false, true), 301, LONG));
    }
}
