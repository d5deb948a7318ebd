//! `cargo dist-board`: a folder to hand on that needs nothing else, and a zip of it: what to do, the image for each board as ELF and as the
//! bytes of its flash, the lab's page, safety, wiring and the first day to print, licences, and checksums that `sha256sum -c` reads.

use std::ffi::OsStr;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};
use sha2::{Digest, Sha256};

use crate::{guide, image, zip};

/// The boards, by their features of the firmware.
const BOARDS: [&str; 2] = ["nucleo-f411re", "nucleo-f446re"];
/// Where the flash begins, in memory.x.
const FLASH: u32 = 0x0800_0000;
/// What flash reads where nothing was written.
const BLANK: u8 = 0xFF;
/// Longest image: where the settings begin, in memory.x.
const LONGEST: usize = 256 * 1024;
/// The lab's page.
pub(crate) const PAGE: &str = "lab.html";
/// Checksums of all other files of a folder.
pub(crate) const SUMS: &str = "SHA256SUMS";
/// Licences of what is within by others; `tools/licences` makes it.
pub(crate) const LICENCES: &str = "THIRD-PARTY.txt";
const GUIDE: &str = "safety-wiring-first-day.html";
const README: &str = include_str!("README.txt");

/// Fills `folder`, or dist/, and writes its zip.
pub(crate) fn write(folder: Option<&OsStr>) -> Result<(), String> {
    let folder = Path::new(folder.unwrap_or(OsStr::new("dist")));
    let name = folder.file_name().and_then(OsStr::to_str).ok_or("a folder with a name is needed")?;
    let files = files()?;
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let zipped = folder.with_extension("zip");
    std::fs::write(&zipped, zip::of(name, &files, "")?)
        .map_err(|error| format!("{}: {error}", zipped.display()))?;
    for (name, bytes) in files {
        println!("{:8} {name}", bytes.len());
        let file = folder.join(name);
        std::fs::write(&file, bytes).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    println!("in {} and {}; there: sha256sum -c {SUMS}", folder.display(), zipped.display());
    Ok(())
}

/// Builds both images and the page: the files of the folder, with their sums.
///
/// # Errors
/// What cargo could not build; a file that cannot be read.
pub(crate) fn files() -> Result<Vec<(String, Vec<u8>)>, String> {
    let mut files = Vec::new();
    // The board that is built by default last, so that target/ holds its image, as after `cargo fw`.
    for board in BOARDS.iter().rev() {
        let features = ["--no-default-features", "--features", board].map(Into::into);
        image::cargo("build", features.into_iter())?;
        let elf = read(&image::built())?;
        let bin = flash(&elf).map_err(|why| format!("{board}: {why}"))?;
        files.extend([(format!("pt326-{board}.elf"), elf), (format!("pt326-{board}.bin"), bin)]);
    }
    let page = image::target().join(PAGE);
    lab(&page)?;
    let guide = guide::page(&image::root().join("docs"))?;
    files.extend([
        (PAGE.into(), read(&page)?),
        (GUIDE.into(), guide.into()),
        ("README.txt".into(), README.into()),
    ]);
    for text in [LICENCES, "LICENSE-MIT", "LICENSE-APACHE"] {
        files.push((text.into(), read(&image::root().join(text))?));
    }
    files.sort();
    files.push((SUMS.into(), sums(&files).into_bytes()));
    Ok(files)
}

/// What `sha256sum -c` reads.
pub(crate) fn sums(files: &[(String, Vec<u8>)]) -> String {
    files.iter().map(|(name, bytes)| format!("{}  {name}\n", sum(bytes))).collect()
}

/// Writes the lab's page.
fn lab(page: &Path) -> Result<(), String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).arg("lab").arg(page).status();
    match status.map_err(|error| format!("cargo cannot be run: {error}"))?.success() {
        true => Ok(()),
        false => Err("the page was not built".into()),
    }
}

/// The bytes of a file; an error names it.
pub(crate) fn read(file: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))
}

/// What lies in the flash from its beginning, of an ELF: the segments where they are loaded from, not where they run.
fn flash(elf: &[u8]) -> Result<Vec<u8>, String> {
    let unreadable = |error: object::Error| format!("the image cannot be read: {error}");
    let header = FileHeader32::<Endianness>::parse(elf).map_err(unreadable)?;
    let endian = header.endian().map_err(unreadable)?;
    let mut bin = Vec::new();
    for segment in header.program_headers(endian, elf).map_err(unreadable)? {
        let bytes = segment.data(endian, elf).map_err(|()| "the image is cut off")?;
        if segment.p_type(endian) != PT_LOAD || bytes.is_empty() {
            continue;
        }
        let address = segment.p_paddr(endian);
        let end = address.checked_sub(FLASH).map(|from| (from as usize, from as usize + bytes.len()));
        let Some((from, to)) = end.filter(|(_, to)| *to <= LONGEST) else {
            return Err(format!(
                "a segment at {address:#x}, expected it in the {LONGEST} bytes from {FLASH:#x}"
            ));
        };
        bin.resize(bin.len().max(to), BLANK);
        bin[from..to].copy_from_slice(bytes);
    }
    starts(&bin).then_some(bin).ok_or_else(|| "no vector table at its beginning".into())
}

/// Whether it begins as a program of this board does: a stack in RAM, and a first instruction in its own flash.
fn starts(bin: &[u8]) -> bool {
    let word = |at: usize| {
        bin.get(at..at + 4).map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let own = FLASH..FLASH + bin.len() as u32;
    word(0).is_some_and(|stack| stack >> 28 == 2)
        && word(4).is_some_and(|entry| entry & 1 == 1 && own.contains(&entry))
}

/// SHA-256, hexadecimal.
fn sum(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF of two segments, each a word count of its bytes: where it is loaded from, where it runs, what is in it.
    fn elf(segments: [(u32, u32, &[u8]); 2]) -> Vec<u8> {
        const HEADER: u32 = 52;
        const SEGMENT: u32 = 32;
        let mut elf = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
        let halves =
            |elf: &mut Vec<u8>, all: &[u16]| elf.extend(all.iter().flat_map(|half| half.to_le_bytes()));
        let words =
            |elf: &mut Vec<u8>, all: &[u32]| elf.extend(all.iter().flat_map(|word| word.to_le_bytes()));
        halves(&mut elf, &[2, 40]);
        words(&mut elf, &[1, FLASH, HEADER, 0, 0]);
        halves(&mut elf, &[HEADER as u16, SEGMENT as u16, 2, 0, 0, 0]);
        let mut offset = HEADER + 2 * SEGMENT;
        for (load, run, bytes) in segments {
            let size = bytes.len() as u32;
            words(&mut elf, &[PT_LOAD, offset, run, load, size, size, 5, 4]);
            offset += size;
        }
        segments.iter().for_each(|(_, _, bytes)| elf.extend_from_slice(bytes));
        elf
    }

    /// Stack and entry.
    const TABLE: &[u8] = &[0, 0x80, 0, 0x20, 9, 0, 0, 0x08];
    const RAM: u32 = 0x2000_8800;

    #[test]
    fn data_lie_where_they_are_loaded_from_and_gaps_are_blank() {
        let bin = flash(&elf([(FLASH, FLASH, TABLE), (FLASH + 12, RAM, &[7, 8])])).unwrap();
        assert_eq!(bin, [TABLE, &[BLANK; 4], &[7, 8]].concat());
    }

    #[test]
    fn what_would_not_start_or_would_overwrite_the_settings_is_refused() {
        let refused = |segments| flash(&elf(segments)).expect_err("refused");
        let late = refused([(FLASH, FLASH, TABLE), (FLASH + LONGEST as u32 - 1, RAM, &[7, 8])]);
        assert!(late.contains("expected it in"), "{late}");
        let ram = refused([(FLASH, FLASH, TABLE), (RAM, RAM, &[7, 8])]);
        assert!(ram.contains("expected it in"), "{ram}");
        let bare = refused([(FLASH + 4, FLASH + 4, TABLE), (FLASH + 12, RAM, &[7, 8])]);
        assert!(bare.contains("vector table"), "{bare}");
        assert!(flash(&elf([(FLASH, FLASH, TABLE), (FLASH + 12, RAM, &[7, 8])])[..80]).is_err());
    }

    #[test]
    fn a_sum_is_that_of_the_standard() {
        assert_eq!(sum(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
