//! The firmware's ELF: bytes for the flash, names for addresses, the table of its log.

use std::path::Path;

use anyhow::{Context, ensure};
use defmt_decoder::Table;
use object::{Object, ObjectSymbol, SymbolKind};

/// Where the flash begins.
pub const FLASH: u32 = 0x0800_0000;
/// Size of the part that holds the program: sectors 0 to 5.
pub const FLASH_SIZE: usize = 0x4_0000;

/// One function or variable.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// Readable name, without the hash.
    pub name: String,
    /// Address, without the Thumb bit.
    pub address: u32,
    /// Size in bytes.
    pub size: u32,
}

/// The image.
pub struct Image {
    /// Content of the flash from [`FLASH`] on.
    pub flash: Vec<u8>,
    /// By address.
    pub symbols: Vec<Symbol>,
    /// What the numbers in the log stand for.
    pub log_table: Table,
}

impl Image {
    /// Reads an ELF.
    ///
    /// # Errors
    /// The file cannot be read, or is no firmware with a defmt log for this chip.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let bytes = std::fs::read(path).with_context(|| format!("can't read {}", path.display()))?;
        Self::parse(&bytes).with_context(|| path.display().to_string())
    }

    fn parse(bytes: &[u8]) -> anyhow::Result<Self> {
        let elf = object::read::elf::ElfFile32::<object::Endianness>::parse(bytes)?;
        let mut flash = vec![0xFF; FLASH_SIZE];
        use object::read::elf::ProgramHeader;
        for segment in elf.elf_program_headers() {
            let endian = elf.endian();
            let data = segment.data(endian, bytes).ok().context("a segment lies beyond the file")?;
            if segment.p_type(endian) != object::elf::PT_LOAD || data.is_empty() {
                continue;
            }
            let at = segment.p_paddr(endian).wrapping_sub(FLASH) as usize;
            let room = flash.get_mut(at..at.saturating_add(data.len()));
            room.context("a segment lies outside sectors 0 to 5 of the flash")?.copy_from_slice(data);
        }
        ensure!(flash.iter().any(|byte| *byte != 0xFF), "nothing to load");
        let log_table = Table::parse(bytes)?.context("no defmt log in it (section .defmt)")?;
        Ok(Self { flash, symbols: symbols(&elf), log_table })
    }

    /// The word of the flash at an address.
    pub fn word(&self, address: u32) -> Option<u32> {
        let at = address.checked_sub(FLASH)? as usize;
        Some(u32::from_le_bytes(self.flash.get(at..at + 4)?.try_into().ok()?))
    }

    /// Where a name lies.
    ///
    /// # Errors
    /// There is none of this name.
    pub fn address(&self, name: &str) -> anyhow::Result<u32> {
        let symbol = self.symbols.iter().find(|s| s.name == name);
        Ok(symbol.with_context(|| format!("the image has no symbol {name}"))?.address)
    }

    /// The function at an address, and how far into it.
    pub fn describe(&self, address: u32) -> String {
        let address = address & !1;
        let after = self.symbols.partition_point(|s| s.address <= address);
        let symbol = after.checked_sub(1).and_then(|i| self.symbols.get(i));
        match symbol.filter(|s| address - s.address < s.size.max(4)) {
            Some(s) => format!("{address:#010x} ({} + {:#x})", s.name, address - s.address),
            None => format!("{address:#010x} (no symbol)"),
        }
    }
}

fn symbols(elf: &object::read::elf::ElfFile32<'_>) -> Vec<Symbol> {
    let named = |kind| matches!(kind, SymbolKind::Text | SymbolKind::Data | SymbolKind::Unknown);
    let mut symbols: Vec<Symbol> = elf
        .symbols()
        .filter(|s| named(s.kind()) && s.address() != 0)
        .filter_map(|s| {
            let name = format!("{:#}", rustc_demangle::demangle(s.name().ok()?));
            let is_place = !name.is_empty() && !name.starts_with('$');
            is_place.then_some(Symbol { name, address: s.address() as u32 & !1, size: s.size() as u32 })
        })
        .collect();
    symbols.sort_by_key(|s| s.address);
    symbols
}
