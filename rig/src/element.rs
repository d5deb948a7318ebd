//! The element of a thermistor: what it makes of the air that it lies in.

use crate::air::{AirStream, HeaterHistory};
use crate::wall::WallEffect;

/// The element of a thermistor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// Its temperature if the tube had no wall, degC.
    direct: f64,
    /// Its temperature, degC.
    value: f64,
}

impl Element {
    pub(crate) fn new(celsius: f64) -> Self {
        Self { direct: celsius, value: celsius }
    }

    /// Temperature without turbulence, degC.
    pub(crate) fn celsius(&self) -> f64 {
        self.value
    }

    /// Lets it follow the air at thermistor `i`, of whose rise it sees `gain` with a `lag`.
    pub(crate) fn follow(
        &mut self,
        (air, heater): (&AirStream, &HeaterHistory),
        i: usize,
        (from, to): (f64, f64),
        seen: (f64, f64),
        wall: Option<&WallEffect>,
    ) {
        let before = self.direct;
        self.direct = air.through(heater, i, (from, to), seen, before);
        self.value = wall.map_or(self.direct, |wall| {
            wall.through(air, seen, to - from, [before, self.direct], self.value)
        });
    }
}
