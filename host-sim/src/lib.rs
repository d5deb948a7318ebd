//! The PT-326 instrument on the host: the same [`fdi_core`] that the board runs, against a simulated rig.

pub mod campaign;
pub mod commands;
pub mod experiment;
pub mod record;
pub mod score;
pub mod settings;
