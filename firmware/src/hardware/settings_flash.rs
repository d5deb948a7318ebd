//! The two flash sectors for the settings as the store of the settings sees them.

use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, Flash, WRITE_SIZE};
use embassy_stm32::pac::FLASH as FLASH_REGISTERS;
use embassy_stm32::pac::flash::vals::Psize;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use super::{board, watchdog};

/// Size of a sector.
const SECTOR: usize = board::SETTINGS_SECTOR;

/// Both sectors.
pub(crate) struct SettingsFlash(Flash<'static, Blocking>);

/// What the flash controller reported.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlashError(Error);

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self.0 {
            Error::Size => NorFlashErrorKind::OutOfBounds,
            Error::Unaligned => NorFlashErrorKind::NotAligned,
            _ => NorFlashErrorKind::Other,
        }
    }
}

impl SettingsFlash {
    /// Takes the flash controller.
    pub(crate) fn new(flash: Peri<'static, board::Flash>) -> Self {
        Self(Flash::new_blocking(flash))
    }
}

impl ErrorType for SettingsFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.0.blocking_read(board::SETTINGS_START + offset, bytes).map_err(FlashError)
    }

    fn capacity(&self) -> usize {
        2 * SECTOR
    }
}

impl NorFlash for SettingsFlash {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = SECTOR;

    /// Hazard: the core stalls for 1 to 2 s a sector, for it runs from the flash that is being erased. The caller has
    /// made sure that the heater is off; the watchdog, which does not stall, gets its long deadline.
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        (from..to).step_by(SECTOR).try_for_each(|sector| {
            let sector = board::SETTINGS_START + sector;
            watchdog::with_long_deadline(|| {
                without_caches(|| {
                    unlock_by_words();
                    self.0.blocking_erase(sector, sector + SECTOR as u32)
                })
            })
            .map_err(FlashError)
        })
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        self.0.blocking_write(board::SETTINGS_START + offset, bytes).map_err(FlashError)
    }
}

/// Hazard: the caches know nothing of an erase, and go on giving what was there before.
fn without_caches<T>(erase: impl FnOnce() -> T) -> T {
    let enable = |on| {
        FLASH_REGISTERS.acr().modify(|w| {
            w.set_icen(on);
            w.set_dcen(on);
        });
    };
    let forget = |on| {
        FLASH_REGISTERS.acr().modify(|w| {
            w.set_icrst(on);
            w.set_dcrst(on);
        });
    };
    enable(false);
    let result = erase();
    forget(true); // possible only while they are off
    forget(false);
    enable(true);
    result
}

/// Unlocks the controller, which the HAL does not do again, and has it erase with the parallelism of 3.3 V: 32 bits. The HAL
/// leaves 8 bits, with which a sector takes twice as long. It locks the controller afterwards.
fn unlock_by_words() {
    if FLASH_REGISTERS.cr().read().lock() {
        FLASH_REGISTERS.keyr().write_value(0x4567_0123);
        FLASH_REGISTERS.keyr().write_value(0xCDEF_89AB);
    }
    FLASH_REGISTERS.cr().modify(|w| w.set_psize(Psize::PSIZE32));
}
