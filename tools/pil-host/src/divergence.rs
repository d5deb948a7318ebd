//! How long each estimator stays sane: a fast update is worth nothing once its numbers are not.

use std::fmt::Write as _;

use pil::peers::{self, FullMatrix, Regressor, Textbook};
use pil::recording::Row;
use pt326_host::experiment::scenario::{Action, Scenario};

use crate::recording::simulate;

/// A one-step prediction that errs by so much, in units of the typical rise, is no prediction: 125 degC.
const ABSURD: f32 = 10.0;
/// Length of the long runs in s, and when the excitation is switched off in one of them.
const LONG: f64 = 20_000.0;
const EXCITED: f64 = 60.0;

/// Says for each run and estimator when its prediction first was absurd or no number.
///
/// # Errors
/// A simulation that fails.
pub(crate) fn table() -> anyhow::Result<String> {
    let steady = Scenario { duration: LONG, faults: Vec::new(), ..Scenario::default() };
    let unexcited = Action { at: EXCITED, excite: Some(false), ..Action::default() };
    let runs = [
        ("the paper's run", Scenario::default()),
        ("a long run without a fault", steady.clone()),
        ("the same without excitation", Scenario { actions: vec![unexcited], ..steady }),
    ];
    let mut text = String::new();
    for (name, scenario) in runs {
        let (_, rows) = simulate(&scenario)?;
        let _ = writeln!(text, "Sane predictions on {name}, {} samples:", rows.len());
        for (estimator, sane) in estimators(&rows) {
            match sane {
                Some(samples) => _ = writeln!(text, "  {estimator:<38} diverges after {samples}"),
                None => _ = writeln!(text, "  {estimator:<38} all"),
            }
        }
    }
    Ok(text)
}

/// For each estimator, after how many samples it gave its first absurd prediction.
fn estimators(rows: &[Row]) -> [(&'static str, Option<usize>); 4] {
    let rls = peers::ours::<6>();
    let mut ours = rls.start();
    let mut full = FullMatrix::<6>::default();
    let mut single = Textbook::<f32, 6>::default();
    let mut double = Textbook::<f64, 6>::default();
    let in_double = |phi: &[f32; 6], y: f32| double.step(&phi.map(f64::from), f64::from(y)) as f32;
    [
        ("RLS update", sane(rows, |phi, y| rls.step(&mut ours, phi, y).prediction)),
        ("peer: full matrix, arrays, f32", sane(rows, |phi, y| full.step(phi, y))),
        ("peer: nalgebra, textbook, f32", sane(rows, |phi, y| single.step(phi, y))),
        ("peer: nalgebra, textbook, f64", sane(rows, in_double)),
    ]
}

fn sane(rows: &[Row], mut predict: impl FnMut(&[f32; 6], f32) -> f32) -> Option<usize> {
    let mut regressor = Regressor::<6>::default();
    rows.iter().position(|row| {
        let y = regressor.output(row);
        let error = y - predict(&regressor.phi, y);
        regressor.shift(row);
        !(error.abs() < ABSURD)
    })
}
