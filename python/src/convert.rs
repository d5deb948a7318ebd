//! Values and errors on their way between Python and Rust.

use pt326_host::words::in_words;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::{Table, Value as Toml};

pyo3::import_exception!(pt326._error, Error);

/// An error of the library on its way to Python.
pub(crate) fn error(why: impl Into<anyhow::Error>) -> PyErr {
    Error::new_err(in_python(&in_words(&why.into())))
}

/// What the command line says of its options, said of Python's arguments: `--map t1=COLUMN` is `t1=COLUMN`, `--full-power 255` is
/// `full_power=255`.
pub(crate) fn in_python(text: &str) -> String {
    const SPECIAL: [(&str, &str); 6] = [
        ("--map ", ""),
        ("--map", "t1=, power= and so on"),
        ("--train FROM:TO", "train=(FROM, TO)"),
        ("--train-on RECORD", "train_on=RECORD"),
        ("--fan yes", "has_fan=True"),
        ("--fan no", "has_fan=False"),
    ];
    let text =
        SPECIAL.into_iter().fold(text.to_owned(), |text, (option, argument)| text.replace(option, argument));
    let mut parts = text.split("--");
    let mut said = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        let (option, rest) = part.split_at(end);
        match option {
            "" => said += "--",
            _ => said += &format!("{}=", option.replace('-', "_")),
        }
        let value = rest.strip_prefix(' ').filter(|value| value.starts_with(|c: char| c.is_ascii_digit()));
        said += value.unwrap_or(rest);
    }
    said
}

/// What came out well, or the error on its way to Python.
pub(crate) fn python<T>(result: anyhow::Result<T>) -> PyResult<T> {
    result.map_err(error)
}

/// What a Python caller has given that cannot be.
pub(crate) fn refused(why: String) -> PyErr {
    Error::new_err(why)
}

/// A seed that a Python caller has given: a whole number from 0.
#[derive(Clone, Copy)]
pub(crate) struct Seed(pub(crate) u64);

impl<'a, 'py> FromPyObject<'a, 'py> for Seed {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match given.extract() {
            Ok(seed) => Ok(Self(seed)),
            Err(_) => Err(refused(format!(
                "a seed is {}, expected a whole number from 0 to 2^64 - 1",
                given.repr()?
            ))),
        }
    }
}

/// Python's dict, list, word or number as TOML has it; a `None` in a dict is a key that is left out.
pub(crate) fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<Toml> {
    if let Ok(dict) = value.cast::<PyDict>() {
        let entries = dict.iter().filter(|(_, value)| !value.is_none());
        let entries = entries.map(|(key, value)| Ok((key.extract()?, to_toml(&value)?)));
        return Ok(Toml::Table(entries.collect::<PyResult<_>>()?));
    }
    if let Ok(word) = value.extract() {
        return Ok(Toml::String(word));
    }
    if let Ok(on) = value.extract() {
        return Ok(Toml::Boolean(on));
    }
    if let Ok(number) = value.extract() {
        return Ok(Toml::Integer(number));
    }
    if let Ok(number) = value.extract() {
        return Ok(Toml::Float(number));
    }
    let items = value.try_iter()?.map(|item| to_toml(&item?));
    Ok(Toml::Array(items.collect::<PyResult<_>>()?))
}

/// The same of a dict.
pub(crate) fn to_table(value: &Bound<'_, PyAny>) -> PyResult<Table> {
    match to_toml(value)? {
        Toml::Table(table) => Ok(table),
        other => Err(Error::new_err(format!("expected a dict, not {other}"))),
    }
}

/// A dict as what it describes.
///
/// # Errors
/// The key that is wrong, in the words of the command line.
pub(crate) fn from_table<T: DeserializeOwned>(table: Table) -> PyResult<T> {
    table.try_into().map_err(error)
}

/// What serde can write, as Python's dicts, lists and numbers.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(error)?;
    py.import("json")?.call_method1("loads", (text,))
}
