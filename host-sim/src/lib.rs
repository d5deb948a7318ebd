//! The PT-326 instrument on the host: the same [`fdi_core`] that the board runs, against a simulated rig.

pub mod experiment;
pub mod fault;
pub mod rig;
pub mod scenario;
pub mod summary;
pub mod trace;
