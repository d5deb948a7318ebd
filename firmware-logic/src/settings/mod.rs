//! What a user changes without rebuilding: names and text, a record of bytes, and its place in flash.

pub(crate) mod bits;
pub mod commissioning;
mod error;
pub mod listing;
mod response;
pub mod schema;
mod sectors;
pub mod store;
pub mod stored;
pub mod table;
pub mod text;

pub use error::{Expected, SetError};
