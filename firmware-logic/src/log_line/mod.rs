//! Lines of the log that a program reads.

pub mod tick;
