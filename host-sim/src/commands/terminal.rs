//! What a command shows to the person who typed it: text on standard output, in colour where that is a terminal that
//! wants colour (`NO_COLOR` is heeded), and progress on standard error.
//!
//! Nothing here panics when the reader of a pipe goes away (`pt326 run | head`), as `println!` does: the error travels to
//! `main`, which ends quietly.

use std::fmt::Display;
use std::io::Write;

use anstyle::AnsiColor::{Green, Red, Yellow};
use anstyle::Style;
use indicatif::{ProgressBar, ProgressStyle};

/// Heads of tables.
pub const HEAD: Style = Style::new().bold();
/// What is as it should be.
pub const GOOD: Style = Green.on_default();
/// What to look at.
pub const WARNING: Style = Yellow.on_default();
/// What is wrong.
pub const BAD: Style = Red.on_default().bold();

/// `text` in `style`; colours are taken out again where nobody sees them.
pub fn styled(style: Style, text: impl Display) -> String {
    format!("{style}{text}{style:#}")
}

/// Words of a table that stand out. They are coloured in the finished text, so that no column is shifted.
const OUTSTANDING: [(&str, Style); 4] =
    [("TRIPPED", BAD), ("No baseline learnt", WARNING), ("Refused", WARNING), (" never ", WARNING)];

/// A table with its outstanding words in colour.
pub fn coloured(table: &str) -> String {
    let colour = |text: String, (word, style): (&str, Style)| text.replace(word, &styled(style, word));
    OUTSTANDING.into_iter().fold(table.to_owned(), colour)
}

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

/// Prints to standard output.
///
/// # Errors
/// Standard output is closed or full.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}

/// A bar of `length` steps on standard error, shown on a terminal only; `counted` says what a step is.
pub fn progress(length: u64, counted: &str) -> ProgressBar {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {counted}, {{eta}} left");
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}
