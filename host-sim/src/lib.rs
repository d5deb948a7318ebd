//! The PT-326 instrument on the host: the same [`fdi_core`] that the board runs, against a simulated rig.

pub mod campaign;
pub mod cli;
pub mod console;
pub mod cosim;
pub mod expectation;
pub mod experiment;
pub mod fault;
pub mod figure;
pub mod identify;
pub mod repeat;
pub mod replay;
pub mod report;
pub mod rig;
pub mod run;
pub mod scenario;
pub mod score;
pub mod summary;
pub mod table;
pub mod trace;
