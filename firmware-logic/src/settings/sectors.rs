//! Two sectors of flash that say of each other which one counts. sequential-storage tells the states of a sector from its first
//! and its last byte, and takes a sector whose erasure the power has cut for full, for begun or for empty, as it happens; what
//! it then repairs or reads is lost or old. So the end of an erasure is made sure of here, before the storage looks.
//!
//! The last word of a sector has three bytes that the storage does not use, in which bits are only ever cleared. Two say nothing
//! (ff ff), that the other sector is void (3c a5), or that this one is retired (00 00). In the third a bit is cleared when an
//! erasure of the other begins, and the next when it has ended:
//!
//! ```text
//! ff ff ff ─▶ 3c a5 fe ─erased─▶ 3c a5 fc ─▶ 3c a5 f8 ─erased again─▶ 3c a5 f0 ... ─▶ 00 00 xx
//! ```
//!
//! Before a sector is erased it is retired, then the other one says that it is void. Whatever an erasure has come to that was cut,
//! at the next start it is done again: also one that looks done, whose bits may not stay.

use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// What a sector says when the other one is void.
const VOID: [u8; 2] = [0x3C, 0xA5];
const RETIRED: [u8; 3] = [0, 0, 0xFF];
/// The storage takes a byte with as many cleared bits as marked.
const MARKED: u32 = 4;

/// The flash below the storage.
pub(super) struct Sectors<F>(F);

impl<F: NorFlash> Sectors<F> {
    const SECTOR: u32 = F::ERASE_SIZE as u32;
    const WORD: u32 = F::WRITE_SIZE as u32;

    /// Of a flash with words of four bytes and two sectors.
    pub(super) fn new(flash: F) -> Self {
        const { assert!(F::WRITE_SIZE == 4 && F::READ_SIZE == 1) };
        Self(flash)
    }

    pub(super) fn into_flash(self) -> F {
        self.0
    }

    /// Ends an erasure that was cut.
    pub(super) async fn mend(&mut self) -> Result<(), F::Error> {
        for sector in [0, Self::SECTOR] {
            let other = Self::other(sector);
            if !self.is_begun(sector).await? {
                continue; // never erase for the sake of one that holds nothing
            }
            let [[a, b, erasures], others] = [self.said(sector).await?, self.said(other).await?];
            let void = match [a, b] {
                VOID => is_under_way(erasures) || !self.is_blank(other).await?,
                _ => is_retired(others) && !is_retired([a, b, erasures]),
            };
            if void {
                return self.void(sector, other).await;
            }
        }
        Ok(())
    }

    /// Erases the other sector of one that counts.
    async fn void(&mut self, sector: u32, other: u32) -> Result<(), F::Error> {
        let [.., before] = self.said(sector).await?;
        let begun = if is_under_way(before) { before } else { before << 1 };
        let say = |erasures| [VOID[0], VOID[1], erasures];
        self.say(sector, say(begun)).await?;
        self.0.erase(other, other + Self::SECTOR).await?;
        self.say(sector, say(begun << 1)).await
    }

    fn other(sector: u32) -> u32 {
        Self::SECTOR - sector
    }

    /// Where the last word of a sector is.
    fn last_word(sector: u32) -> u32 {
        sector + Self::SECTOR - Self::WORD
    }

    async fn said(&mut self, sector: u32) -> Result<[u8; 3], F::Error> {
        let mut said = [0; 3];
        self.0.read(Self::last_word(sector), &mut said).await?;
        Ok(said)
    }

    async fn say(&mut self, sector: u32, [a, b, c]: [u8; 3]) -> Result<(), F::Error> {
        self.0.write(Self::last_word(sector), &[a, b, c, 0xFF]).await
    }

    /// Whether the storage has begun to use it.
    async fn is_begun(&mut self, sector: u32) -> Result<bool, F::Error> {
        let mut first = [0];
        self.0.read(sector, &mut first).await?;
        Ok(first[0].count_zeros() >= MARKED)
    }

    async fn is_blank(&mut self, sector: u32) -> Result<bool, F::Error> {
        let mut bytes = [0; 64];
        for at in (sector..sector + Self::SECTOR).step_by(bytes.len()) {
            self.0.read(at, &mut bytes).await?;
            if bytes.iter().any(|byte| *byte != 0xFF) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Whether bits are cleared that [`VOID`] leaves alone: also if the power went while they were.
fn is_retired([a, b, _]: [u8; 3]) -> bool {
    !a & VOID[0] != 0 || !b & VOID[1] != 0
}

/// Whether an erasure has begun that has not ended.
fn is_under_way(erasures: u8) -> bool {
    erasures.trailing_zeros() % 2 == 1
}

impl<F: ErrorType> ErrorType for Sectors<F> {
    type Error = F::Error;
}

impl<F: NorFlash> ReadNorFlash for Sectors<F> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), F::Error> {
        self.0.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl<F: NorFlash> NorFlash for Sectors<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), F::Error> {
        let other = Self::other(from);
        if to - from == Self::SECTOR && self.is_begun(other).await? {
            self.say(from, RETIRED).await?;
            return self.void(other, from).await;
        }
        self.0.erase(from, to).await
    }

    /// Of the mark of a full sector only the byte that the storage reads.
    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), F::Error> {
        if offset % Self::SECTOR == Self::last_word(0) {
            return self.0.write(offset, &[0xFF, 0xFF, 0xFF, bytes[3]]).await;
        }
        self.0.write(offset, bytes).await
    }
}
