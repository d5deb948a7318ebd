//! An ARX model of a recording.

use std::path::PathBuf;

use pt326_host::identify::detrend::Detrend;
use pt326_host::identify::{Asked, identify as identified};
use pt326_host::recording::table::Table;
use pyo3::prelude::*;

use crate::convert::{from_table, python, refused, to_python};

/// Identifies an ARX model from a file, or from the text of one: `pt326 identify --json`, and what it prints.
#[pyfunction]
#[pyo3(signature = (path: "str | os.PathLike[str] | None", text, u, y, order, ts = None, lam = 1.0, detrend = "auto", rows = None, validate = None) -> "tuple[dict[str, typing.Any], str]")]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    text: Option<String>,
    u: String,
    y: String,
    order: (usize, usize, usize),
    ts: Option<f64>,
    lam: f64,
    detrend: &str,
    rows: Option<(usize, usize)>,
    validate: Option<(usize, usize)>,
) -> PyResult<(Bound<'py, PyAny>, String)> {
    let (na, nb, nk) = order;
    let order = format!("{na},{nb},{nk}").parse().map_err(|why| refused(format!("order: {why}")))?;
    let detrend: Detrend =
        from_table::<Named>(toml::Table::from_iter([("detrend".into(), detrend.into())]))?.detrend;
    if !(0.5..=1.0).contains(&lam) {
        return Err(refused(format!("lam is {lam}, expected a number from 0.5 to 1")));
    }
    if ts.is_some_and(|ts| !(ts > 0.0 && ts.is_finite())) {
        return Err(refused("ts: expected a number of seconds above 0".into()));
    }
    let asked = Asked {
        u,
        y,
        order,
        ts,
        lambda: lam,
        detrend,
        from: rows.map_or(0, |(from, _)| from),
        to: rows.map(|(_, to)| to),
        validate: validate.map(|(from, to)| from..to),
    };
    let report = py.detach(|| {
        let table = match (path, text) {
            (Some(path), None) => Table::read(&path)?,
            (None, Some(text)) => Table::parse("data".into(), &text)?,
            _ => anyhow::bail!("expected a path or a text"),
        };
        identified(&asked, &table)
    });
    let report = python(report)?;
    Ok((to_python(py, &report)?, report.to_string()))
}

#[derive(serde::Deserialize)]
struct Named {
    detrend: Detrend,
}
