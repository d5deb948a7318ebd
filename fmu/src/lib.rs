//! The simulated rig and the instrument as FMUs: parts for simulators, by version 3.0 of the Functional Mock-up Interface, for
//! co-simulation. `docs/fmi.md` tells how they are used; `cargo fmu` makes the files.
//!
//! One library holds both models; which one an instance is of says the instantiation token, which is made from the list of the
//! model's variables. From the same list comes modelDescription.xml.
#![deny(unsafe_code)]

pub mod abi;
pub mod description;
pub mod instance;
pub mod instrument;
pub mod model;
pub mod rig;
pub mod variable;
