//! A campaign: many runs of many kinds, both diagnoses side by side, in numbers with their uncertainty.
//!
//! A [`definition`] expands to [`cell`]s; the [`runner`] runs what is not finished and keeps each [`run`] in the
//! [`store`]; from there come [`statistics`], [`results`] and the [`output`].

pub mod ablation;
pub mod by;
pub mod cell;
pub mod definition;
mod expand;
pub mod output;
pub mod results;
pub mod run;
pub mod runner;
pub mod statistics;
pub mod store;
