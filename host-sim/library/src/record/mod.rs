//! What is made of a record: a trace, a summary, tables, figures, a report.

pub mod figure;
pub mod files;
pub mod numbers;
pub mod paper;
pub mod report;
pub mod summary;
pub mod table;
pub mod trace;
