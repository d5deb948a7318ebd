//! Settings at random, of all that an instrument takes.

use fdi_core::settings::{Kind, Value};
use fdi_core::{Config, ConfigError, Instrument, Setting};

pub use super::random::Random;

impl Random {
    /// A number within bounds: at one of them in a third of the draws, else evenly, by its logarithm where the range is wide.
    fn within(&mut self, min: f32, max: f32) -> f32 {
        match self.below(6) {
            0 => min,
            1 => max,
            _ if min > 0.0 && max / min > 20.0 => {
                (self.spread(min.into(), max.into()) as f32).clamp(min, max)
            }
            _ => self.between(min.into(), max.into()) as f32,
        }
    }

    fn value(&mut self, kind: Kind, (min, max): (f32, f32)) -> Value {
        match kind {
            Kind::Number { .. } => Value::Number(self.within(min, max)),
            Kind::Whole { .. } => Value::Whole(self.within(min, max) as u16),
            Kind::Switch => Value::Switch(self.below(2) == 0),
            Kind::Choice(forms) => {
                let form = self.below(forms.len());
                let mut numbers = [0.0; 2];
                for (number, bounds) in numbers.iter_mut().zip(forms[form].numbers) {
                    *number = self.within(bounds.min, bounds.max);
                }
                Value::Choice { form, numbers }
            }
        }
    }

    fn draw(&mut self, config: &mut Config, setting: &Setting, bounds: Option<(f32, f32)>) {
        let bounds = bounds.or(setting.kind.bounds()).unwrap_or_default();
        let value = self.value(setting.kind, bounds);
        assert!(config.set(setting, value), "{}", setting.name);
    }

    /// Settings that an instrument takes: from `start` on a share of all, of a part of the groups, is drawn; what is refused is drawn anew within what
    /// is said to be allowed. None where that leads nowhere.
    pub fn settings(&mut self, start: &Config) -> Option<Config> {
        let mut config = start.clone();
        let share = self.one_of(&[0.05, 0.3, 1.0]);
        let left_alone: Vec<bool> = (0..64).map(|_| self.happens(0.5)).collect();
        for setting in Config::settings() {
            let group = setting.name.rsplit_once('.').map_or("", |(group, _)| group);
            let place = group.bytes().fold(0u32, |sum, byte| sum.wrapping_mul(31) + u32::from(byte)) % 64;
            // The thermistors' constants leave few that can be armed.
            let alone = left_alone[place as usize] || group.starts_with("sensors") && self.below(4) > 0;
            if !alone && self.happens(share) {
                self.draw(&mut config, setting, None);
            }
        }
        for _ in 0..400 {
            let Err(error) = Instrument::new(&config) else { return Some(config) };
            let (name, bounds) = refused(error)?;
            let setting = Config::settings().find(|setting| setting.name == name)?;
            let (min, max) = setting.kind.bounds()?;
            let (low, high) = (bounds.0.max(min), bounds.1.min(max));
            if low > high {
                // What it is held against must change.
                let others =
                    ["identification.answer_time", "supervisor.setpoint_max", "supervisor.over_temperature"];
                let other = self.one_of(&others);
                self.draw(&mut config, Config::settings().find(|setting| setting.name == other)?, None);
            } else {
                self.draw(&mut config, setting, Some((low, high)));
            }
        }
        None
    }
}

/// The setting that is refused, and what it may be.
fn refused(error: ConfigError) -> Option<(&'static str, (f32, f32))> {
    match error {
        ConfigError::OutOfRange { name, min, max, .. } => Some((name, (min, max))),
        ConfigError::NotAbove { name, limit, .. } => Some((name, (limit, f32::MAX))),
        ConfigError::BeyondScale { name, max, .. } => Some((name, (f32::MIN, max))),
        ConfigError::NonFinite { .. } | ConfigError::AmbiguousRows { .. } => None,
    }
}
