//! What a command shows to the person who typed it: text on standard output, in colour where that is a terminal that
//! wants colour (`NO_COLOR` is heeded), and progress on standard error.
//!
//! Nothing here panics when the reader of a pipe goes away (`pt326 run | head`), as `println!` does: the error travels to
//! `main`, which ends quietly. Only standard output has such a reader: what else breaks, a serial port above all, is an error.

use std::fmt::{self, Display};
use std::io::{self, ErrorKind, Write};

use anstyle::AnsiColor::{Green, Red, Yellow};
use anstyle::Style;
use indicatif::{ProgressBar, ProgressStyle};

pub use pt326_host::words::in_words;

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

/// Whoever reads standard output has had enough.
#[derive(Debug)]
struct Unread;

impl Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("nobody reads the output any more")
    }
}

impl std::error::Error for Unread {}

/// Whether it all ended because nobody reads standard output any more (`pt326 config | head`).
pub fn is_unread(error: &anyhow::Error) -> bool {
    let io = error.chain().find_map(|cause| cause.downcast_ref::<io::Error>());
    io.and_then(io::Error::get_ref).is_some_and(<dyn std::error::Error + Send + Sync>::is::<Unread>)
}

/// Standard output, which tells a reader that has gone from all other pipes that break.
pub struct Output<W>(pub W);

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes).map_err(marked)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush().map_err(marked)
    }
}

fn marked(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::BrokenPipe => io::Error::new(ErrorKind::BrokenPipe, Unread),
        _ => error,
    }
}

/// Prints to standard output.
///
/// # Errors
/// Standard output is closed or full.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = Output(anstream::stdout().lock());
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}

/// A bar of `length` steps on standard error, shown on a terminal only; `counted` says what a step is.
pub fn progress(length: u64, counted: &str) -> ProgressBar {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {counted}, {{eta}} left");
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    /// A pipe whose reader has gone.
    struct Broken;

    impl Write for Broken {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(ErrorKind::BrokenPipe.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn only_a_broken_standard_output_is_one_that_nobody_reads() {
        let output = Output(Broken).write_all(b"x").context("while printing").unwrap_err();
        assert!(is_unread(&output), "{output:#}");
        let other = Broken.write_all(b"x").context("the port").unwrap_err();
        assert!(!is_unread(&other));
    }
}
