//! PID settings for a simulated rig.

use numpy::{IntoPyArray, PyArray1};
use pt326_host::tune::{Moment, tune as tuned};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::config::Config;
use crate::convert::Seed;
use crate::run::experiment;
use crate::wait::wait;

/// The experiment of the console's `tune start` on a simulated rig, and what each rule proposes.
#[pyfunction]
#[pyo3(signature = (scenario: "object" = None, config = None, seed: "int" = Seed(1), preset = None, disturbance = None) -> "dict[str, typing.Any]")]
pub(crate) fn tune<'py>(
    py: Python<'py>,
    scenario: Option<&Bound<'py, PyAny>>,
    config: Option<&Bound<'py, Config>>,
    seed: Seed,
    preset: Option<&str>,
    disturbance: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let (config, scenario) = experiment(scenario, config, preset, disturbance, None)?;
    let settings = Config(config.clone());
    let tuning = wait(py, None, move |_| tuned(&config, &scenario, seed.0))?;
    let rules = PyDict::new(py);
    for (rule, proposal) in &tuning.proposals {
        let Some(proposal) = proposal else { continue };
        let dict = PyDict::new(py);
        for (name, value) in [
            ("kp", proposal.tuned.kp),
            ("ti", proposal.tuned.ti.0),
            ("td", proposal.tuned.td.0),
            ("overshoot_pct", 100.0 * proposal.response.overshoot),
            ("settled_s", proposal.response.settled.0),
            ("gain_margin", proposal.margins.gain),
            ("phase_margin_deg", proposal.margins.phase),
        ] {
            dict.set_item(name, value)?;
        }
        rules.set_item(rule.name(), dict)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("gain", tuning.lag.gain)?;
    dict.set_item("time", tuning.lag.time)?;
    dict.set_item("dead", tuning.lag.dead)?;
    dict.set_item("rules", rules)?;
    dict.set_item("config", settings)?;
    dict.set_item("text", tuning.to_string())?;
    dict.set_item("t", tuning.ticks.iter().map(|tick| tick.t).collect::<Vec<_>>().into_pyarray(py))?;
    let column = |of: fn(&Moment) -> f32| -> Bound<'py, PyArray1<f64>> {
        tuning.ticks.iter().map(|tick| f64::from(of(tick))).collect::<Vec<_>>().into_pyarray(py)
    };
    dict.set_item("t1", column(|tick| tick.t1))?;
    dict.set_item("power", column(|tick| tick.power))?;
    Ok(dict)
}
