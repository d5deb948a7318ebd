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
    Ok((file, decoded(&bytes)))
}

/// UTF-8, or UTF-16 with its mark, as PowerShell's `>` and Excel write it. Lossy: a degree sign in an old encoding must not keep anyone from the numbers.
fn decoded(bytes: &[u8]) -> String {
    let units =
        |unit: fn([u8; 2]) -> u16| bytes.as_chunks().0.iter().map(|pair| unit(*pair)).collect::<Vec<_>>();
    match bytes {
        [0xff, 0xfe, ..] => String::from_utf16_lossy(&units(u16::from_le_bytes)),
        [0xfe, 0xff, ..] => String::from_utf16_lossy(&units(u16::from_be_bytes)),
        _ => String::from_utf8_lossy(bytes).into_owned(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_orders_of_utf_16_are_read() {
        let text = "\u{feff}t,°C\n";
        let le: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!([decoded(&le), decoded(&be), decoded(text.as_bytes())], [text; 3]);
    }
}
