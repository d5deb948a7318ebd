//! A text file before it is cut into cells.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, bail};

/// What is no text, by how it begins, and what to do with it.
const NO_TEXT: [(&[u8], &str); 5] = [
    (b"PK\x03\x04", "a workbook or an archive: save its sheet as CSV, and give that"),
    (b"\xd0\xcf\x11\xe0", "an old workbook: save its sheet as CSV, and give that"),
    (b"\x1f\x8b", "packed by gzip: unpack it"),
    (b"PAR1", "a Parquet file: write it as CSV"),
    (b"%PDF", "a PDF: what is asked for is the table that it was made from, as CSV"),
];

/// What to call a file, and its text; `-` is standard input.
///
/// # Errors
/// It cannot be read, or is no text.
pub fn text_of(path: &Path) -> anyhow::Result<(String, String)> {
    let (file, bytes) = match path.to_str() {
        Some("-") => {
            let mut bytes = Vec::new();
            ("standard input".into(), std::io::stdin().read_to_end(&mut bytes).map(|_| bytes))
        }
        _ => (path.display().to_string(), std::fs::read(path)),
    };
    let bytes = bytes.with_context(|| format!("cannot read {file}"))?;
    if let Some((_, what)) = NO_TEXT.iter().find(|(begin, _)| bytes.starts_with(begin)) {
        bail!("{file} is {what}");
    }
    Ok((file, decoded(&bytes)))
}

/// UTF-8, or UTF-16, as PowerShell's `>` and Excel write it, with its mark or known by its zeros. Lossy: a degree sign in an old encoding must not keep anyone from the numbers.
fn decoded(bytes: &[u8]) -> String {
    let units =
        |unit: fn([u8; 2]) -> u16| bytes.as_chunks().0.iter().map(|pair| unit(*pair)).collect::<Vec<_>>();
    match bytes {
        [0xff, 0xfe, ..] | [1..=0xff, 0, 1..=0xff, 0, ..] => {
            String::from_utf16_lossy(&units(u16::from_le_bytes))
        }
        [0xfe, 0xff, ..] | [0, 1..=0xff, 0, 1..=0xff, ..] => {
            String::from_utf16_lossy(&units(u16::from_be_bytes))
        }
        _ => String::from_utf8_lossy(bytes).into_owned(),
    }
}

/// What stands between cells: the first of semicolon, tab, comma, bar that the first line contains; none: blanks.
pub(super) fn separator(text: &str) -> Option<char> {
    let is_row = |l: &&str| !l.trim().is_empty() && !l.trim_start().starts_with('#');
    let first = text.lines().find(is_row).unwrap_or_default();
    [';', '\t', ',', '|'].into_iter().find(|&s| first.contains(s))
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
        let plain = "t,u\n".encode_utf16();
        let [le, be] = [u16::to_le_bytes, u16::to_be_bytes]
            .map(|bytes| plain.clone().flat_map(bytes).collect::<Vec<u8>>());
        assert_eq!([decoded(&le), decoded(&be)], ["t,u\n"; 2]);
    }

    #[test]
    fn what_is_no_text_is_told_with_what_to_do() {
        let path = std::env::temp_dir().join(format!("pt326-workbook-{}.xlsx", std::process::id()));
        std::fs::write(&path, b"PK\x03\x04and so on").unwrap();
        let said = text_of(&path).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(
            said.ends_with("is a workbook or an archive: save its sheet as CSV, and give that"),
            "{said}"
        );
    }
}
