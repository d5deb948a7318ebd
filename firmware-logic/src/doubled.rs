//! A word that is kept with its complement: bits that flip in either show.

/// The word, and what must be its complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Doubled {
    word: u32,
    complement: u32,
}

impl Doubled {
    pub(crate) const fn new(word: u32) -> Self {
        Self { word, complement: !word }
    }

    /// The word; `None` where bits have flipped.
    pub(crate) fn get(self) -> Option<u32> {
        (self.word == !self.complement).then_some(self.word)
    }
}
