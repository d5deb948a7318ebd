//! A mock of two flash sectors that can lose its power in the middle of any write or erase.

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

const WORD: usize = 4;

/// With sectors smaller than the chip's 128 KiB, so that tests fill them; the word is the chip's.
pub(crate) type Flash = Sectors<{ 8 * 1024 }>;

/// Both sectors, as bits that a write can only clear.
#[derive(Clone, Debug)]
pub(crate) struct Sectors<const SECTOR: usize> {
    bytes: Vec<u8>,
    /// Words written and sectors erased so far.
    pub(crate) steps: usize,
    /// Which of these steps were erasures.
    pub(crate) erased_at: Vec<usize>,
    /// Sectors erased so far.
    pub(crate) erases: usize,
    /// The power went in the middle of an erase.
    pub(crate) cut_in_erase: bool,
    /// Sectors whose last erasure was cut: their bits may not stay.
    weak: [bool; 2],
    /// Words written and sectors erased that are still allowed.
    steps_left: Option<usize>,
    /// The power goes between two steps: nothing is left half done.
    between: bool,
    /// The step that is said to be done, and is not.
    lost: Option<usize>,
    /// The step that it refuses; it goes on then.
    refused: Option<usize>,
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

impl<const SECTOR: usize> Sectors<SECTOR> {
    /// Never written.
    pub(crate) fn new() -> Self {
        Self {
            bytes: vec![0xFF; 2 * SECTOR],
            steps: 0,
            erased_at: Vec::new(),
            erases: 0,
            cut_in_erase: false,
            weak: [false; 2],
            steps_left: None,
            between: false,
            lost: None,
            refused: None,
            noise: 1,
        }
    }

    /// The power goes in the middle of the step after `steps` more.
    pub(crate) fn cut_at(&mut self, steps: usize) {
        self.steps_left = Some(steps);
        self.noise = (self.random() ^ (steps as u32 + 1).wrapping_mul(0x9E37_79B9)).max(1);
    }

    /// The power goes between two steps, after `steps` more.
    pub(crate) fn cut_between(&mut self, steps: usize) {
        (self.steps_left, self.between) = (Some(steps), true);
    }

    /// A flash that loses this step.
    pub(crate) fn losing(&self, step: usize) -> Self {
        Self { lost: Some(step), ..self.clone() }
    }

    /// A flash that refuses this step, and no other; the seed says what of it is done all the same.
    pub(crate) fn refusing(&self, step: usize, seed: u32) -> Self {
        Self { refused: Some(step), noise: seed.wrapping_mul(0x9E37_79B9) | 1, ..self.clone() }
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

    /// What a power cut leaves of an erasure, which first clears all bits and then sets them: either may have come to any
    /// place, have happened here and there only, or have just ended.
    fn erase_partly(&mut self, sector: usize) {
        let (kind, bytes) = (self.random() % 6, sector..sector + SECTOR);
        let here = sector + self.random() as usize % SECTOR / WORD * WORD;
        let density = self.random();
        match kind {
            0 => self.bytes[sector..here].fill(0),
            1 => self.bytes[here..bytes.end].fill(0),
            2 => self.bytes[sector..here].fill(0xFF),
            3 => self.bytes[here..bytes.end].fill(0xFF),
            4 => bytes.for_each(|i| self.bytes[i] &= self.sparse(density)),
            _ => {
                let cleared = density & 4 != 0;
                bytes.for_each(|i| {
                    let old = if cleared { 0 } else { self.bytes[i] };
                    self.bytes[i] = old | self.sparse(density);
                });
            }
        }
    }

    /// Bits that are set seldom, by halves or mostly.
    fn sparse(&mut self, density: u32) -> u8 {
        let [a, b, c, d] = self.random().to_le_bytes();
        match density % 4 {
            0 => a & b & c & d,
            1 => a,
            2 => a | b | c | d,
            _ if d == 0 => a,
            _ => 0xFF,
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
        self.steps += 1;
        if self.refused == Some(self.steps - 1) {
            return Ok(true);
        }
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

impl<const SECTOR: usize> ErrorType for Sectors<SECTOR> {
    type Error = Dead;
}

impl<const SECTOR: usize> ReadNorFlash for Sectors<SECTOR> {
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

impl<const SECTOR: usize> NorFlash for Sectors<SECTOR> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Dead> {
        assert!((from as usize).is_multiple_of(SECTOR) && (to as usize).is_multiple_of(SECTOR));
        for sector in (from as usize..to as usize).step_by(SECTOR) {
            self.erased_at.push(self.steps);
            let cut = self.cut()?;
            if cut {
                self.erase_partly(sector);
            } else {
                self.bytes[sector..sector + SECTOR].fill(0xFF);
            }
            self.erases += 1;
            self.cut_in_erase |= cut;
            self.weak[sector / SECTOR] = cut;
            if cut {
                return Err(Dead);
            }
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Dead> {
        assert!((offset as usize).is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        let (sector, within) = (offset as usize / SECTOR, offset as usize % SECTOR);
        let is_mark = within == SECTOR - WORD; // of which nothing is expected that an erasure changes
        assert!(
            is_mark || !self.weak[sector] || self.was_cut(),
            "written to at {within} after an erasure that was cut"
        );
        for (i, word) in bytes.chunks(WORD).enumerate() {
            if self.lost == Some(self.steps) {
                self.steps += 1;
                continue;
            }
            let cut = self.cut()?;
            for (j, byte) in word.iter().enumerate() {
                // A cut leaves some bits cleared and others not yet.
                let kept = match (cut, self.between) {
                    (false, _) => 0,
                    (true, true) => 0xFF,
                    (true, false) => self.random() as u8,
                };
                self.bytes[offset as usize + i * WORD + j] &= byte | kept;
            }
            if cut {
                return Err(Dead);
            }
        }
        Ok(())
    }
}
