//! Alarms of the likelihood diagnosis, from tick to tick: what is worth a line is that one was raised, is called another
//! name, or has ended.

use core::fmt;

use fdi_core::name::Name;
use fdi_core::{FaultClass, Finding, Report};

use crate::decimal::{At, Fixed};

/// An alarm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AlarmRecord {
    /// The tick on which it was raised.
    pub raised: u32,
    /// The last that was said of it; `None` while nothing could be.
    pub finding: Option<Finding>,
    /// The last fault of the user's own that it was said to be.
    pub taught: Name,
    /// The tick on which it had gone.
    pub ended: Option<u32>,
}

impl AlarmRecord {
    /// What it was called last, by the classes and by the user.
    pub(crate) fn name(&self) -> (Option<FaultClass>, Name) {
        (self.finding.map(|finding| finding.class), self.taught)
    }

    /// It is said to come again and again, and that one was one of the times.
    pub(crate) fn comes_again(&self, one: &Self) -> bool {
        let again = one.finding.and_then(|finding| finding.class.again());
        self.finding.is_some_and(|found| again == Some(found.class) && one.raised >= found.onset)
    }
}

/// Follows what the diagnosis says.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alarms {
    lasting: Option<AlarmRecord>,
}

impl Alarms {
    /// The alarm, if this tick changes what is to be said of it.
    pub fn notice(&mut self, report: &Report) -> Option<AlarmRecord> {
        let (tick, said) = (report.tick, &report.likelihood);
        let taught = said.taught.map_or(Name::NONE, |taught| taught.name);
        let Some(alarm) = &mut self.lasting else {
            let raised = AlarmRecord { raised: tick, finding: said.finding, taught, ended: None };
            self.lasting = said.alarm.then_some(raised);
            return self.lasting;
        };
        if !said.alarm {
            let ended = AlarmRecord { ended: Some(tick), ..*alarm };
            self.lasting = None;
            return Some(ended);
        }
        let named = said.finding.is_some() && said.finding.map(|f| f.class) != alarm.finding.map(|f| f.class);
        let recalled = !taught.is_empty() && taught != alarm.taught;
        alarm.finding = said.finding.or(alarm.finding);
        if recalled {
            alarm.taught = taught;
        }
        (named || recalled).then_some(*alarm)
    }
}

/// An alarm for people; `sample_time` in s turns ticks into times.
pub struct AlarmText<'a> {
    /// The alarm.
    pub alarm: &'a AlarmRecord,
    /// Ts in s.
    pub sample_time: f32,
}

impl fmt::Display for AlarmText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |tick: u32| At(tick, self.sample_time);
        write!(f, "{} s alarm: ", seconds(self.alarm.raised))?;
        match &self.alarm.finding {
            None => f.write_str("not named")?,
            Some(Finding { class, confidence, magnitude, onset }) => {
                f.write_str(class.name())?;
                if let Some(m) = magnitude {
                    write!(f, " {} +- {} {}", Fixed(m.value, 2), Fixed(m.half_width, 2), class.unit())?;
                }
                write!(f, ", confidence {}, since {} s", Fixed(*confidence, 2), seconds(*onset))?;
            }
        }
        if !self.alarm.taught.is_empty() {
            write!(f, ", as taught: {}", self.alarm.taught)?;
        }
        match self.alarm.ended {
            Some(ended) => write!(f, ", ended {} s", seconds(ended)),
            None => f.write_str(", lasting"),
        }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::Report;
    use fdi_core::likelihood::verdict::TaughtFinding;
    use fdi_core::likelihood::{LikelihoodReport, Magnitude};

    use super::*;

    fn report(tick: u32, alarm: bool, finding: Option<(FaultClass, f32)>) -> Report {
        let finding = finding.map(|(class, value)| Finding {
            class,
            confidence: 0.987,
            magnitude: Some(Magnitude { value, half_width: 0.125 }),
            onset: 98,
        });
        let taught = (tick == 105).then(|| TaughtFinding {
            name: "cap".parse().unwrap(),
            place: 0,
            confidence: 0.96,
            magnitude: Magnitude { value: 90.0, half_width: 5.0 },
        });
        Report {
            tick,
            likelihood: LikelihoodReport { alarm, finding, taught, ..Default::default() },
            ..Report::default()
        }
    }

    #[test]
    fn an_alarm_is_told_when_raised_when_renamed_and_when_over() {
        let mut alarms = Alarms::default();
        let (clogged, offset) = (FaultClass::T1Clogged, FaultClass::T1Offset);
        let mut text = |tick, alarm, finding| {
            let alarm = alarms.notice(&report(tick, alarm, finding))?;
            Some(AlarmText { alarm: &alarm, sample_time: 0.11 }.to_string())
        };
        assert_eq!(text(99, false, None), None);
        assert_eq!(text(100, true, None).as_deref(), Some("11.0 s alarm: not named, lasting"));
        assert_eq!(text(101, true, None), None);
        let named =
            "11.0 s alarm: t1_clogged -15.00 +- 0.13 % of gain, confidence 0.99, since 10.8 s, lasting";
        assert_eq!(text(102, true, Some((clogged, -15.0))).as_deref(), Some(named));
        assert_eq!(text(103, true, Some((clogged, -14.0))), None);
        assert!(text(104, true, Some((offset, 1.0))).is_some_and(|text| text.contains("t1_offset 1.00")));
        let taught = text(105, true, Some((offset, 1.5)));
        assert!(taught.is_some_and(|text| text.ends_with(", since 10.8 s, as taught: cap, lasting")));
        assert_eq!(text(106, true, None), None);
        let last = "11.0 s alarm: t1_offset 1.50 +- 0.13 degC, confidence 0.99, since 10.8 s, as taught: cap, ended 12.1 s";
        assert_eq!(text(110, false, None).as_deref(), Some(last));
        assert_eq!(text(111, false, None), None);
    }
}
