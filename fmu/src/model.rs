//! A model: its variables, and how it begins and steps.

use anyhow::Context;
use crc::{CRC_64_XZ, Crc};

use crate::variable::{Values, Variable};
use crate::{instrument, rig};

/// What can be made an instance of.
pub struct Model {
    /// Its name as part of a file name.
    pub identifier: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its variables, in the order of their value references.
    pub variables: Vec<Variable>,
    /// Begins by the parameters, and tells what is known before the first step.
    pub begin: fn(&mut Values) -> anyhow::Result<Box<dyn Running>>,
}

/// Variables that are connected together: those of one model with the terminal of the same name of the other.
pub struct Terminal {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// The variables.
    pub members: &'static [&'static str],
}

/// What both models are connected by: codes from the rig to the instrument, power back.
pub static TERMINALS: [Terminal; 2] = [
    Terminal {
        name: "codes",
        about: "What the converter reads",
        members: &["code_t0", "code_t1", "code_t2", "code_supply"],
    },
    Terminal { name: "heater", about: "What drives the heater", members: &["power"] },
];

/// A model that has begun.
pub trait Running: Send {
    /// Length of each of its steps, s.
    fn sample_time(&self) -> f64;
    /// Takes a step by the inputs, tells the outputs, and gives what it has refused to do.
    fn step(&mut self, values: &mut Values) -> Vec<String>;
}

/// Every model.
pub fn models() -> [&'static Model; 2] {
    [&rig::MODEL, &instrument::MODEL]
}

impl Model {
    /// By what an importer shows that its description is that of this library: it changes with any variable.
    pub fn token(&self) -> String {
        let text = format!("{} {} {:?}", self.identifier, env!("CARGO_PKG_VERSION"), self.variables);
        format!("{}-{:016x}", self.identifier, Crc::<u64>::new(&CRC_64_XZ).checksum(text.as_bytes()))
    }

    /// The model of a token.
    ///
    /// # Errors
    /// There is none.
    pub fn of_token(token: &str) -> anyhow::Result<&'static Self> {
        let known = || models().map(Self::token).join(" or ");
        let model = models().into_iter().find(|model| model.token() == token);
        model.with_context(|| format!("the instantiation token is {token:?}, expected {}", known()))
    }
}

/// TOML that a parameter holds, or the file of a path that ends in `.toml`.
///
/// # Errors
/// The file cannot be read.
pub(crate) fn text_or_file(given: &str) -> anyhow::Result<String> {
    if given.ends_with(".toml") && !given.contains('\n') {
        return std::fs::read_to_string(given).with_context(|| format!("can't read {given}"));
    }
    Ok(given.to_owned())
}
