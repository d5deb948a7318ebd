//! What was learnt, as a table.

use super::super::Recording;
use super::super::map::Role;
use super::Told;

/// A number that was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    /// What it is.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Half of its 95 % interval, where it is known.
    pub half_width: Option<f64>,
    /// Its unit.
    pub unit: String,
}

impl Told<'_> {
    /// What was learnt of the heater, in the recording's units.
    pub fn learnt(&self) -> Vec<Learnt> {
        let model = &self.done.trained.model;
        let unit = self.unit();
        let per_power = format!("{unit} a unit of power");
        let gain = |gain: f32| f64::from(gain) / per_unit(self.recording);
        let learnt =
            |name, value: f64, unit: &str| Learnt { name, value, half_width: None, unit: unit.to_owned() };
        let mut all = vec![
            learnt("Gain: what T1 rises by in the end", gain(model.gain), &per_power),
            learnt("Heat store of the heater", model.heater.into(), "s"),
            learnt("Dead time", model.dead_time.into(), "s"),
            learnt("Lag of T1", model.lag.into(), "s"),
            learnt("Share of the rise that comes slowly", 100.0 * f64::from(model.wall_share), "%"),
            learnt("Time of that share", model.wall.into(), "s"),
        ];
        if self.heater.map.column(Role::Known).is_some() {
            all.push(learnt("Gain of the heater beside", gain(model.gain_beside), &per_power));
            all.push(learnt("Its further lag", model.lag_beside.into(), "s"));
        }
        if self.heater.inputs.t2 {
            all.push(learnt("Way from T1 to T2", model.transport.into(), "s"));
            all.push(learnt("Share of the rise that reaches T2", 100.0 * f64::from(model.reaches), "%"));
        }
        let noise = f64::from(model.noise[0]) / f64::from(self.recording.units.celsius);
        all.push(learnt("What is left of T1, made white", noise, unit));
        all
    }
}

/// degC a % of the diagnosis for each unit of temperature a unit of power.
fn per_unit(recording: &Recording) -> f64 {
    f64::from(recording.units.celsius) * f64::from(recording.units.full_power) / 100.0
}
