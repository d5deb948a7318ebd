//! How well what was learnt is known.
//!
//! The covariance of the batch fit is that of Gauss and Newton with the priors in it, and with how each stretch began taken out. What is left is
//! correlated: it counts as if one residual of kappa were independent, where kappa is how much larger the variance of its means over a fiftieth of all is
//! than that of white noise (batch means). An interval is sqrt(kappa) times as wide as white residuals would make it.

use fdi_core::likelihood::Parameter::{
    self, Curvature, Delay1, Delay2, Gain, Heater, Lag1, Lag2, Reaches2, Wall1, WallTime,
};
use fdi_core::likelihood::model::Model;
use pt326_fit::Found;

/// Standard deviations on either side of a value within which it is in 95 of 100 cases.
const SDS: f64 = 1.96;
/// A parameter is not known where the samples alone leave it more than this share of the standard deviation that it had before them.
pub(super) const UNKNOWN: f64 = 0.5;

/// How well a number is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// Its 95 % interval, in its own unit.
    Within(f64, f64),
    /// The samples do not tell it: it is what is usual.
    No,
}

/// A number of a model by its name, and how well it is known.
pub type Interval = (&'static str, Known);

/// What the standard deviation of a parameter is one of.
#[derive(Clone, Copy)]
enum Scale {
    /// Of its logarithm.
    Log,
    /// Of it in ticks.
    Ticks,
    /// Of itself.
    Plain,
}

/// Each number of a model by its name: gain in degC a %, times in s, shares of 1.
pub fn numbers(model: &Model) -> [(&'static str, f32); 13] {
    [
        ("gain", model.gain),
        ("curvature", model.curvature),
        ("offset", model.offset),
        ("heater", model.heater),
        ("lag", model.lag),
        ("wall", model.wall),
        ("dead_time", model.dead_time),
        ("wall_share", model.wall_share),
        ("reaches", model.reaches),
        ("lag2", model.lag2),
        ("transport", model.transport),
        ("gain_beside", model.gain_beside),
        ("lag_beside", model.lag_beside),
    ]
}

/// Which parameter stands behind a number: without T2 those of T2 are the heater's beside.
fn behind(has_t2: bool) -> Vec<(&'static str, Parameter, Scale)> {
    let mut all = vec![
        ("gain", Gain, Scale::Log),
        ("curvature", Curvature, Scale::Plain),
        ("heater", Heater, Scale::Log),
        ("lag", Lag1, Scale::Log),
        ("wall", WallTime, Scale::Log),
        ("dead_time", Delay1, Scale::Ticks),
        ("wall_share", Wall1, Scale::Plain),
    ];
    if has_t2 {
        all.push(("reaches", Reaches2, Scale::Plain));
        all.push(("lag2", Lag2, Scale::Log));
        all.push(("transport", Delay2, Scale::Ticks));
    } else {
        all.push(("lag_beside", Lag2, Scale::Log));
    }
    all
}

/// How well each number of a model is known that was looked for in a fit with ticks of so many s.
pub(super) fn intervals(model: &Model, found: &Found, has_t2: bool, tick: f64) -> Vec<Interval> {
    let values = numbers(model);
    let value =
        |name: &str| values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, x)| f64::from(*x));
    let log = |value: f64, sd: f64| Known::Within(value * (-SDS * sd).exp(), value * (SDS * sd).exp());
    let known = |(name, which, scale): (&'static str, Parameter, Scale)| {
        let (value, sd, share) = (value(name), found.sd[which as usize], found.known[which as usize]);
        let half = SDS * sd * if matches!(scale, Scale::Ticks) { tick } else { 1.0 };
        let known = match scale {
            _ if share > UNKNOWN => Known::No,
            Scale::Log => log(value, sd),
            Scale::Ticks => Known::Within((value - half).max(0.0), value + half),
            Scale::Plain => Known::Within(value - half, value + half),
        };
        (share > 0.0).then_some((name, known))
    };
    let mut all: Vec<Interval> = behind(has_t2).into_iter().filter_map(known).collect();
    let share = found.known[Reaches2 as usize];
    if !has_t2 && share > 0.0 {
        let of = if share > UNKNOWN { Known::No } else { log(value("gain_beside"), found.sd_beside) };
        all.push(("gain_beside", of));
    }
    // Of a standard deviation of so many white residuals.
    let noise = f64::from(model.noise[0]);
    let half = SDS * noise / (2.0 * found.left.len().max(1) as f64).sqrt();
    all.push(("noise", Known::Within(noise - half, noise + half)));
    all
}
