//! What the other half hears of a check, piece by piece, and what it makes of it.

use fdi_core::Config;
use heapless::Vec;

use super::finding::{CheckFinding, Ending};
use super::{MAX_FINDINGS, Stage};

/// One piece of news; a tick brings at most one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum News {
    /// A check, or the next stage of it, has begun.
    Stage(Stage),
    /// Something was found.
    Found(CheckFinding),
    /// The check has ended.
    Ended(Ending),
}

/// What is known of the last check.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// The stage that it is in; `None` before the first check and after it has ended.
    pub stage: Option<Stage>,
    /// What it has found so far.
    pub findings: Vec<CheckFinding, MAX_FINDINGS>,
    /// How it ended.
    pub ending: Option<Ending>,
}

impl Progress {
    /// Notes a piece of news.
    pub fn note(&mut self, news: News) {
        match news {
            News::Stage(stage) => {
                if self.stage.is_none() {
                    *self = Self::default();
                }
                self.stage = Some(stage);
            }
            News::Found(finding) => drop(self.findings.push(finding)),
            News::Ended(ending) => (self.stage, self.ending) = (None, Some(ending)),
        }
    }
}

/// What to type so that a thermistor agrees with the others: name and value of the setting.
pub fn offset_setting(finding: &CheckFinding, config: &Config) -> Option<(&'static str, f32)> {
    use fdi_core::likelihood::Channel::{T0, T1, T2};
    let CheckFinding::Offset(channel, by) = *finding else { return None };
    let (name, offset) = match channel {
        T0 => ("sensors.t0.offset", config.sensors.t0.offset),
        T1 => ("sensors.t1.offset", config.sensors.t1.offset),
        T2 => ("sensors.t2.offset", config.sensors.t2.offset),
    };
    Some((name, offset.0 - by))
}

#[cfg(test)]
mod tests {
    use fdi_core::Celsius;
    use fdi_core::likelihood::Channel;

    use super::*;

    #[test]
    fn the_offset_that_mends_a_reading_is_added_to_the_one_in_force() {
        let mut config = Config::default();
        (config.sensors.t0.offset, config.sensors.t1.offset, config.sensors.t2.offset) =
            (Celsius(0.25), Celsius(-1.0), Celsius(2.0));
        let setting = |channel| offset_setting(&CheckFinding::Offset(channel, 0.5), &config);
        assert_eq!(setting(Channel::T0), Some(("sensors.t0.offset", -0.25)));
        assert_eq!(setting(Channel::T1), Some(("sensors.t1.offset", -1.5)));
        assert_eq!(setting(Channel::T2), Some(("sensors.t2.offset", 1.5)));
        assert_eq!(offset_setting(&CheckFinding::FarOff(Channel::T0, 5.0), &config), None);
    }
}
