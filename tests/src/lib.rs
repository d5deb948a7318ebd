//! What the tests share: independent f64 oracles, and the estimator's endurance runs.

pub mod endurance;
pub mod oracle;
