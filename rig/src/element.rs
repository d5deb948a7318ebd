//! The element of a thermistor: what it makes of the air that it lies in.

use crate::air::{AirStream, HeaterHistory};
use crate::thermistor::{Bead, Thermistors};
use crate::wall::WallEffect;

/// The element of a thermistor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Element {
    /// Its temperature if the tube had no wall, degC.
    direct: f64,
    /// Temperature of its tip, degC.
    tip: f64,
    /// What is behind the tip.
    bead: Bead,
    /// Its temperature, degC.
    celsius: f64,
}

impl Element {
    pub(crate) fn new(celsius: f64) -> Self {
        Self { direct: celsius, tip: celsius, bead: Bead::new(celsius), celsius }
    }

    /// Temperature without turbulence, degC.
    pub(crate) fn celsius(&self) -> f64 {
        self.celsius
    }

    /// Lets it follow the air at thermistor `i`, of whose rise it sees `gain` with a `lag`.
    pub(crate) fn follow(
        &mut self,
        world: &World,
        i: usize,
        (from, to): (f64, f64),
        (gain, lag): (f64, f64),
        wall: Option<&WallEffect>,
    ) {
        let World { air, heater, thermistors } = world;
        let (direct, tip) = (self.direct, self.tip);
        self.direct = air.through(heater, i, (from, to), (gain, lag), direct);
        self.tip =
            wall.map_or(self.direct, |wall| wall.through((gain, lag), to - from, [direct, self.direct], tip));
        self.celsius = self.bead.follow(thermistors, i, to - from, [tip, self.tip], (air.flow, lag));
    }
}

/// What an element lies in and how it is made.
pub(crate) struct World<'a> {
    pub(crate) air: &'a AirStream,
    pub(crate) heater: &'a HeaterHistory,
    pub(crate) thermistors: &'a Thermistors,
}
