//! What identification needs of Rust: the estimator that runs on the board, and the columns of a recording.

use std::path::PathBuf;

use fdi_core::identify::rls::Rls;
use fdi_core::identify::{Adaptation, RlsConfig};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pt326_host::recording::table::Table;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{error, python, refused};

/// One estimator of the largest size serves all: a regressor that is always zero changes no other number.
const PARAMETERS: usize = 17;

/// Recursive least squares in single precision, as on the board: rows of 17 regressors and outputs, both scaled to some 1.
#[pyfunction]
#[pyo3(signature = (phi: "numpy.ndarray", y: "numpy.ndarray", lam: "float" = 1.0) -> "numpy.ndarray")]
pub(crate) fn rls<'py>(
    py: Python<'py>,
    phi: PyReadonlyArray2<'py, f32>,
    y: PyReadonlyArray1<'py, f32>,
    lam: f32,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let (phi, y) = (phi.as_array(), y.as_array());
    if phi.dim() != (y.len(), PARAMETERS) {
        return Err(refused(format!("phi is {:?}, expected ({}, {PARAMETERS})", phi.dim(), y.len())));
    }
    let config = RlsConfig { adaptation: Adaptation::Forgetting { lambda: lam }, d_initial: 1e8, d_max: 1e8 };
    let rls = Rls::<PARAMETERS>::new(&config).map_err(error)?;
    let mut state = rls.start();
    for (row, y) in phi.rows().into_iter().zip(y) {
        rls.step(&mut state, &std::array::from_fn(|i| row[i]), *y);
    }
    Ok(state.theta.to_vec().into_pyarray(py))
}

/// Columns of a file, or of the text of one, by name or number; each cell must be a number.
#[pyfunction]
#[pyo3(signature = (path: "str | os.PathLike[str] | None", text: "str | None", names: "list[str]") -> "dict[str, numpy.ndarray]")]
pub(crate) fn columns<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    text: Option<String>,
    names: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let read = || {
        let table = match path {
            Some(path) => Table::read(&path)?,
            None => Table::parse("data".into(), &text.unwrap_or_default())?,
        };
        let values = |name: &String| table.values(table.column(name)?, 0..table.rows());
        names.iter().map(values).collect::<anyhow::Result<Vec<_>>>()
    };
    let all = PyDict::new(py);
    for (name, values) in names.iter().zip(python(read())?) {
        all.set_item(name, values.into_pyarray(py))?;
    }
    Ok(all)
}
