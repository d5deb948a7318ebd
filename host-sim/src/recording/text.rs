//! A text file before it is cut into cells.

use std::io::Read;
use std::path::Path;

use anyhow::Context;

/// What to call a file, and its text; `-` is standard input.
///
/// # Errors
/// It cannot be read.
pub fn text_of(path: &Path) -> anyhow::Result<(String, String)> {
    let (file, bytes) = match path.to_str() {
        Some("-") => {
            let mut bytes = Vec::new();
            ("standard input".into(), std::io::stdin().read_to_end(&mut bytes).map(|_| bytes))
        }
        _ => (path.display().to_string(), std::fs::read(path)),
    };
    let bytes = bytes.with_context(|| format!("cannot read {file}"))?;
    // Lossy: a degree sign in an old encoding must not keep anyone from the numbers.
    Ok((file, String::from_utf8_lossy(&bytes).into_owned()))
}

/// What stands between cells: the first of semicolon, tab, comma that the first line contains; none: blanks.
pub(super) fn separator(text: &str) -> Option<char> {
    let is_row = |l: &&str| !l.trim().is_empty() && !l.trim_start().starts_with('#');
    let first = text.lines().find(is_row).unwrap_or_default();
    [';', '\t', ','].into_iter().find(|&s| first.contains(s))
}

/// A row of noughts below a header, to try the header with.
pub fn as_numbers(header: &str) -> String {
    let separator = separator(header);
    let cells = match separator {
        Some(separator) => header.split(separator).count(),
        None => header.split_whitespace().count(),
    };
    vec!["0"; cells].join(&separator.unwrap_or(' ').to_string())
}

/// The same lines with each run of blanks made one.
pub(super) fn single_blanks(text: &str) -> String {
    text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ") + "\n").collect()
}
