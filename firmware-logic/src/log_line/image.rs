//! The line that says which image a board runs.

use core::fmt;

use super::number;

/// Which image a board runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image<'a> {
    /// Its release, such as 0.1.0.
    pub release: &'a str,
    /// The state of its sources.
    pub commit: &'a str,
    /// Name of the board that it is for.
    pub board: &'a str,
    /// See [`VERSION`](super::VERSION).
    pub format: u32,
}

impl fmt::Display for Image<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { release, commit, board, format } = self;
        write!(f, "image {release} ({commit}) on {board}, format {format}")
    }
}

/// As it is printed.
pub(super) fn parse(text: &str) -> Option<Image<'_>> {
    let (release, text) = text.split_once(" (")?;
    let (commit, text) = text.split_once(") on ")?;
    let (board, text) = text.split_once(", format ")?;
    Some(Image { release, commit, board, format: number(text)?.0 })
}
