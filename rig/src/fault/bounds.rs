//! Which keys a verb takes, and within which bounds.

use anyhow::{bail, ensure};

use super::{Fault, Sensor, Verb};

impl Fault {
    /// Checks that the verb has what it needs.
    ///
    /// # Errors
    /// The key that is missing, too many or out of bounds; `place` says which fault it is.
    pub fn validate(&self, place: &str) -> anyhow::Result<()> {
        let place = format!("{place} ({})", self.label());
        self.check_sensors(&place)?;
        self.check_size(&place)?;
        self.check_times(&place)
    }

    fn check_sensors(&self, place: &str) -> anyhow::Result<()> {
        let needs_sensor = self.verb.needs_sensor();
        ensure!(
            self.sensor.is_some() == needs_sensor,
            "{place}: key `sensor` {}",
            if needs_sensor { "is missing, expected t0, t1 or t2" } else { "makes no sense with this verb" }
        );
        ensure!(
            self.verb != Verb::Detach || self.sensor != Some(Sensor::T0),
            "{place}: sensor is t0, which lies outside the tube; expected t1 or t2"
        );
        match (self.verb == Verb::Swap, self.with) {
            (true, None) => bail!("{place}: key `with` is missing, expected the other sensor"),
            (true, with) if with == self.sensor => {
                bail!("{place}: `sensor` and `with` are the same, expected two sensors")
            }
            (false, Some(_)) => bail!("{place}: `with` goes with `do = \"swap\"` only"),
            _ => Ok(()),
        }
    }

    fn check_size(&self, place: &str) -> anyhow::Result<()> {
        match (self.verb.size_bounds(), self.size) {
            (Some((min, max, unit)), Some(size)) => {
                ensure!(
                    size >= min && size <= max,
                    "{place}: size is {size}, expected {min} to {max} {unit}"
                );
            }
            (Some((min, max, unit)), None) => {
                bail!("{place}: key `size` is missing, expected {min} to {max} {unit}")
            }
            (None, Some(size)) => bail!("{place}: size = {size} makes no sense with this verb"),
            (None, None) => {}
        }
        Ok(())
    }

    fn check_times(&self, place: &str) -> anyhow::Result<()> {
        if let Some(lag) = self.lag {
            ensure!(
                matches!(self.verb, Verb::Clog | Verb::Detach),
                "{place}: lag = {lag} goes with `do = \"clog\"` and `do = \"detach\"` only"
            );
            ensure!((0.001..=100.0).contains(&lag), "{place}: lag is {lag}, expected 0.001 to 100 s");
        }
        if let Some(over) = self.over {
            ensure!(
                self.verb.grows(),
                "{place}: over = {over} goes with offset, air-flow, heater-power and detach only"
            );
            ensure!((0.0..=1e7).contains(&over), "{place}: over is {over}, expected 0 to 10000000 s");
        }
        ensure!(self.at >= 0.0, "{place}: at is {}, expected 0 s or more", self.at);
        ensure!(self.duration > 0.0, "{place}: for is {}, expected more than 0 s", self.duration);
        Ok(())
    }
}

impl Verb {
    /// Whether it is done to a sensor, and not to the rig as a whole.
    pub(super) fn needs_sensor(self) -> bool {
        !matches!(
            self,
            Self::AirFlow
                | Self::HeaterPower
                | Self::HeaterStuck
                | Self::Ambient
                | Self::AmbientDrift
                | Self::SupplyVoltage
                | Self::Return
        )
    }

    /// Whether it can come little by little, `over` a time.
    fn grows(self) -> bool {
        matches!(self, Self::Offset | Self::AirFlow | Self::HeaterPower | Self::Detach)
    }

    /// Smallest and largest `size` with the unit; `None` for a verb without.
    pub fn size_bounds(self) -> Option<(f64, f64, &'static str)> {
        match self {
            Self::Offset | Self::Loose | Self::Spike | Self::Ambient => Some((-100.0, 100.0, "°C")),
            Self::Drift | Self::AmbientDrift => Some((-600.0, 600.0, "°C a minute")),
            Self::Clog => Some((0.0, 3.0, "times the rise")),
            Self::Missing => Some((0.0, 1.0, "as a probability")),
            Self::AirFlow => Some((0.0, 10.0, "times the nominal flow")),
            Self::HeaterPower => Some((0.0, 3.0, "times the power")),
            Self::SupplyVoltage => Some((0.0, 2.0, "times the nominal voltage")),
            Self::HeaterStuck => Some((0.0, 100.0, "%")),
            Self::Detach => Some((0.0, 1.0, "of the way out")),
            Self::Shunt => Some((10.0, 1e7, "ohm")),
            Self::Return => Some((0.0, 1e6, "ohm")),
            Self::Freeze => Some((0.0, 1000.0, "codes")),
            Self::Open | Self::Short | Self::Stuck | Self::Swap => None,
        }
    }
}
