//! The record in flash: two sectors that sequential-storage writes in turn, so that a cut at any point leaves either
//! the old record or the new one, with the help of `sectors` where an erasure is cut.

use core::fmt;

use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use super::commissioning::Commissioning;
use super::sectors::Sectors;
use super::stored::{MAX_BYTES, Stored, StoredError};

/// The key of the record, of the mark that says since when power must not be lost unnoticed, and of the commissioning.
const RECORD: u8 = 1;
const MARK: u8 = 2;
const COMMISSIONING: u8 = 3;
/// Room for the record and for what the storage puts around it.
const BUFFER: usize = MAX_BYTES + 64;

/// How the settings came to be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Origin {
    /// Read from flash.
    Flash,
    /// Nothing was ever saved.
    Default,
    /// What was saved is unusable, so these are the defaults.
    Fallback(StoredError),
    /// The storage itself is unusable, so these are the defaults.
    Unreadable,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flash => f.write_str("read from flash"),
            Self::Default => f.write_str("defaults, nothing saved"),
            Self::Fallback(error) => write!(f, "DEFAULTS, since the saved {error}"),
            Self::Unreadable => f.write_str("DEFAULTS, since the flash cannot be read"),
        }
    }
}

/// Why settings were not saved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SaveError {
    /// The heater is on: writing stalls the processor.
    Heating,
    /// The board is simulated: what it has learnt is of no rig.
    Simulated,
    /// The record is too long.
    Record(StoredError),
    /// The flash refused.
    Flash,
}

impl fmt::Display for SaveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Heating => f.write_str("not while heating, expected `stop` first"),
            Self::Simulated => f.write_str("not while simulated, expected a reset first"),
            Self::Record(error) => error.fmt(f),
            Self::Flash => f.write_str("the flash could not be written"),
        }
    }
}

/// Remembers where the newest of each key is. Without it, changing sectors searches the whole of the full one once for each
/// of the thousands of items in it, which takes many seconds and starves the watchdog.
type Newest = Cache<Uncached, Uncached, ArrayKeyPointers<u8, 3>, u8>;

/// What is known when the board starts.
fn nothing_known() -> Newest {
    Newest::new(Uncached, Uncached, ArrayKeyPointers::new())
}

/// The storage.
pub struct Store<F: NorFlash> {
    sectors: Sectors<F>,
    newest: Newest,
    /// No erasure is cut: looked at before the first use, and again after an error.
    mended: bool,
}

impl<F: NorFlash> Store<F> {
    /// A store that covers the whole of `flash`, which has two sectors.
    pub fn new(flash: F) -> Self {
        Self { sectors: Sectors::new(flash), newest: nothing_known(), mended: false }
    }

    /// Both sectors with what is known of them, which is given back afterwards.
    fn map(&mut self) -> MapStorage<u8, &mut Sectors<F>, Newest> {
        let both = MapConfig::new(0..2 * F::ERASE_SIZE as u32);
        let newest = core::mem::replace(&mut self.newest, nothing_known());
        MapStorage::new(&mut self.sectors, both, newest)
    }

    /// Reads what was saved; the defaults where there is nothing usable, and why.
    pub async fn load(&mut self) -> (Stored, Origin) {
        let mut buffer = [0; BUFFER];
        match self.read(RECORD, &mut buffer).await {
            Ok(Some(bytes)) => match Stored::decode(bytes) {
                Ok(stored) => (stored, Origin::Flash),
                Err(error) => (Stored::default(), Origin::Fallback(error)),
            },
            Ok(None) => (Stored::default(), Origin::Default),
            Err(_) => (Stored::default(), Origin::Unreadable),
        }
    }

    /// Saves. The heater must be off: on this chip a write stalls the processor, an erase for seconds.
    ///
    /// # Errors
    /// Why it was not saved; what was saved before is still there then.
    pub async fn save(&mut self, stored: &Stored) -> Result<(), SaveError> {
        let mut record = [0; MAX_BYTES];
        let bytes = stored.encode(&mut record).map_err(SaveError::Record)?;
        for _ in 0..2 {
            match self.write(RECORD, bytes).await {
                Ok(()) => return Ok(()),
                Err(Error::Storage { .. }) => break,
                // What the storage can neither use nor mend, it could not read either: a new one is worth more.
                Err(_) => self.map().erase_all().await.map_err(|_| SaveError::Flash)?,
            }
        }
        Err(SaveError::Flash)
    }

    /// Whether the mark stands; not where it cannot be read, which [`Store::load`] has told.
    pub async fn is_marked(&mut self) -> bool {
        let mut buffer = [0; BUFFER];
        matches!(self.read(MARK, &mut buffer).await, Ok(Some([1])))
    }

    /// Sets the mark or takes it away. The heater must be off, as for [`Store::save`], which mends what this cannot use: the
    /// settings are not erased for a mark.
    ///
    /// # Errors
    /// The flash refused, or holds something else.
    pub async fn mark(&mut self, stands: bool) -> Result<(), SaveError> {
        self.write(MARK, &[u8::from(stands)]).await.map_err(|_| SaveError::Flash)
    }

    /// The commissioning that is kept, if there is one that can be read.
    pub async fn commissioning(&mut self) -> Option<Commissioning> {
        let mut buffer = [0; BUFFER];
        let record = self.read(COMMISSIONING, &mut buffer).await;
        record.ok().flatten().and_then(Commissioning::decode)
    }

    /// Keeps a commissioning, or that there is none. The heater must be off, as for [`Store::save`], which mends what this cannot
    /// use.
    ///
    /// # Errors
    /// The flash refused, or holds something else.
    pub async fn keep(&mut self, commissioning: Option<&Commissioning>) -> Result<(), SaveError> {
        let record = commissioning.map(Commissioning::encode);
        let bytes: &[u8] = record.as_ref().map_or(&[], |record| record);
        self.write(COMMISSIONING, bytes).await.map_err(|_| SaveError::Flash)
    }

    async fn read<'a>(
        &mut self,
        key: u8,
        buffer: &'a mut [u8; BUFFER],
    ) -> Result<Option<&'a [u8]>, Error<F::Error>> {
        self.mend().await;
        let mut map = self.map();
        let found = map.fetch_item(buffer, &key).await;
        self.newest = map.destroy().1;
        found
    }

    /// Writes, and reads back as the next start will, which knows nothing: one write in 65,536 behind half a header makes it one that seems
    /// whole and hides all that follows.
    async fn write(&mut self, key: u8, bytes: &[u8]) -> Result<(), Error<F::Error>> {
        self.mend().await;
        let mut buffer = [0; BUFFER];
        let mut map = self.map();
        let result = map.store_item(&mut buffer, &key, &bytes).await;
        self.newest = map.destroy().1;
        self.mended = result.is_ok();
        result?;
        let newest = core::mem::replace(&mut self.newest, nothing_known());
        let is_there = matches!(self.read(key, &mut buffer).await, Ok(Some(found)) if found == bytes);
        self.newest = newest;
        if is_there { Ok(()) } else { Err(Error::Corrupted {}) }
    }

    /// What cannot be mended the storage finds anew, and tells.
    async fn mend(&mut self) {
        if !self.mended {
            self.mended = self.sectors.mend().await.is_ok();
        }
    }

    /// Gives the flash back.
    pub fn into_flash(self) -> F {
        self.sectors.into_flash()
    }
}
