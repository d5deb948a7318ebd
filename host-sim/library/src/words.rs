//! Errors as people read them, on a terminal and elsewhere.

/// What the readers of TOML and JSON call things, and what people do.
const WORDS: [(&str, &str); 10] = [
    ("expected f32", "expected a number"),
    ("expected f64", "expected a number"),
    ("expected u8", "expected a whole number"),
    ("expected u16", "expected a whole number"),
    ("expected u32", "expected a whole number"),
    ("expected u64", "expected a whole number"),
    ("expected usize", "expected a whole number"),
    ("expected a sequence", "expected a list in [ ]"),
    ("wanted string or table", "expected a word in quotes"),
    ("unknown variant", "unknown word"),
];

/// An error as people read it, without names of Rust types.
pub fn in_words(error: &anyhow::Error) -> String {
    WORDS.into_iter().fold(format!("{error:#}"), |text, (rust, words)| text.replace(rust, words))
}
