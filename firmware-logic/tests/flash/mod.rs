//! A mock of two flash sectors that can lose its power in the middle of any write or erase.

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Smaller than the chip's 128 KiB, so that tests fill it; the word is the chip's.
pub(crate) const SECTOR: usize = 8 * 1024;
const WORD: usize = 4;

/// Both sectors, as bits that a write can only clear.
#[derive(Clone, Debug)]
pub(crate) struct Flash {
    bytes: Vec<u8>,
    /// Sectors erased so far.
    pub(crate) erases: usize,
    /// The power went in the middle of an erase.
    pub(crate) cut_in_erase: bool,
    /// Words written and sectors erased that are still allowed.
    steps_left: Option<usize>,
    noise: u32,
}

/// The power is gone, or the address is wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dead;

impl NorFlashError for Dead {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Flash {
    /// Never written.
    pub(crate) fn new() -> Self {
        Self { bytes: vec![0xFF; 2 * SECTOR], erases: 0, cut_in_erase: false, steps_left: None, noise: 1 }
    }

    /// The power goes in the middle of the step after `steps` more.
    pub(crate) fn cut_at(&mut self, steps: usize) {
        self.steps_left = Some(steps);
        self.noise = steps as u32 + 1;
    }

    /// Whether the power has gone.
    pub(crate) fn was_cut(&self) -> bool {
        self.steps_left == Some(usize::MAX)
    }

    /// The power is back.
    pub(crate) fn power_up(&mut self) {
        self.steps_left = None;
    }

    /// What a flash looks like that something else has used.
    pub(crate) fn fill_with_garbage(&mut self, seed: u32) {
        self.noise = seed;
        for i in 0..self.bytes.len() {
            self.bytes[i] = self.random() as u8;
        }
    }

    /// The first and last words of the sectors, where the storage keeps its page marks: erased, cleared or as they are, by
    /// two bits of `marks` each.
    pub(crate) fn set_page_marks(&mut self, marks: u8) {
        for (i, at) in [0, SECTOR - WORD, SECTOR, 2 * SECTOR - WORD].into_iter().enumerate() {
            match marks >> (2 * i) & 3 {
                0 => self.bytes[at..at + WORD].fill(0xFF),
                1 => self.bytes[at..at + WORD].fill(0),
                _ => {} // what was there
            }
        }
    }

    fn random(&mut self) -> u32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        self.noise
    }

    /// Counts a step; `true` if the power goes in the middle of it.
    fn cut(&mut self) -> Result<bool, Dead> {
        match &mut self.steps_left {
            None => Ok(false),
            Some(usize::MAX) => Err(Dead),
            Some(0) => {
                self.steps_left = Some(usize::MAX);
                Ok(true)
            }
            Some(left) => {
                *left -= 1;
                Ok(false)
            }
        }
    }
}

impl ErrorType for Flash {
    type Error = Dead;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Dead> {
        let from = offset as usize;
        bytes.copy_from_slice(self.bytes.get(from..from + bytes.len()).ok_or(Dead)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Dead> {
        assert!((from as usize).is_multiple_of(SECTOR) && (to as usize).is_multiple_of(SECTOR));
        for sector in (from as usize..to as usize).step_by(SECTOR) {
            let cut = self.cut()?;
            for i in sector..sector + SECTOR {
                // A cut leaves some bits erased and others not yet.
                let erased = if cut { self.random() as u8 } else { 0xFF };
                self.bytes[i] |= erased;
            }
            self.erases += 1;
            self.cut_in_erase |= cut;
            if cut {
                return Err(Dead);
            }
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Dead> {
        assert!((offset as usize).is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        for (i, word) in bytes.chunks(WORD).enumerate() {
            let cut = self.cut()?;
            for (j, byte) in word.iter().enumerate() {
                // A cut leaves some bits cleared and others not yet.
                let kept = if cut { self.random() as u8 } else { 0 };
                self.bytes[offset as usize + i * WORD + j] &= byte | kept;
            }
            if cut {
                return Err(Dead);
            }
        }
        Ok(())
    }
}
