//! The native half of the Python package `pt326`: the rig, the instrument and the experiments of `host-sim` as Python objects. What needs no
//! Rust (plots, data frames, the TCLab interface) is Python, in `pt326/`.

mod board;
mod campaign;
mod config;
mod convert;
mod identify;
mod instrument;
mod monitor;
mod rig;
mod run;
mod tune;
mod wait;

use pyo3::prelude::*;

/// The native half of pt326: use `import pt326`.
#[pymodule(name = "_core")]
mod core {
    #[pymodule_export]
    use crate::board::Board;
    #[pymodule_export]
    use crate::campaign::{Cells, Observer, repeat};
    #[pymodule_export]
    use crate::config::{Config, Setting};
    #[pymodule_export]
    use crate::identify::{columns, rls};
    #[pymodule_export]
    use crate::instrument::{Finding, Instrument, Report};
    #[pymodule_export]
    use crate::monitor::{Monitor, Recording};
    #[pymodule_export]
    use crate::rig::{Codes, Rig};
    #[pymodule_export]
    use crate::run::{Record, isolability, run, scenario};
    #[pymodule_export]
    use crate::tune::tune;

    /// The version of this package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
