//! The core alone: against independent f64 references, over random inputs, over millions of samples, mode by mode.

mod answers;
mod controller;
mod endurance;
mod estimator;
mod experiment;
mod hostile;
mod known;
mod limits;
mod monitor;
mod oracle;
mod properties;
mod reference;
mod settings;
mod supervision;
mod teach;
mod widened;
