//! A cell of a table with its kind: from one list of columns come runs.csv and runs.parquet.

use std::fmt;

/// A cell with the name of its column.
pub type Field = (String, Value);

/// What stands in a cell. `None`: nothing does.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A word or a name.
    Text(Option<String>),
    /// A number with a fraction, in the unit of its column.
    Real(Option<f64>),
    /// How many.
    Count(Option<u64>),
    /// Whether it is so.
    Flag(Option<bool>),
}

pub(super) fn field(name: impl Into<String>, value: impl Into<Value>) -> Field {
    (name.into(), value.into())
}

/// As in a CSV: empty where there is nothing, 0 or 1 of a flag.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(Some(text)) => f.write_str(text),
            Self::Real(Some(x)) => write!(f, "{x}"),
            Self::Count(Some(n)) => write!(f, "{n}"),
            Self::Flag(Some(is_so)) => write!(f, "{}", u8::from(*is_so)),
            Self::Text(None) | Self::Real(None) | Self::Count(None) | Self::Flag(None) => Ok(()),
        }
    }
}

/// Each type, and its `Option`, as the kind that it is.
macro_rules! kinds {
    ($($kind:ident($x:ident: $type:ty) $value:expr;)*) => {$(
        impl From<$type> for Value {
            fn from($x: $type) -> Self {
                Self::$kind(Some($value))
            }
        }
        impl From<Option<$type>> for Value {
            fn from($x: Option<$type>) -> Self {
                Self::$kind($x.map(|$x| $value))
            }
        }
    )*};
}

kinds! {
    Text(text: &str) text.to_owned();
    Text(text: &String) text.clone();
    Text(text: String) text;
    Real(x: f64) x;
    Count(n: u32) n.into();
    Count(n: u64) n;
    Count(n: usize) n as u64;
    Flag(is_so: bool) is_so;
}
