//! A zip file (PKWARE's APPNOTE 6.3), as far as a folder of some files needs it: deflated, without times, so that the same files give the same
//! bytes.

use std::io::Write;

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};

/// 1 January 1980, the first day that a zip file knows.
const DAY: u16 = 1 << 5 | 1;
/// Version that unpacks it, and the method.
const VERSION: u16 = 20;
const DEFLATED: u16 = 8;

/// A zip file of these files in a folder.
pub(crate) fn of(folder: &str, files: &[(String, Vec<u8>)]) -> Vec<u8> {
    let (mut zip, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let (name, packed, mut crc) = (format!("{folder}/{name}"), deflated(bytes), Crc::new());
        crc.update(bytes);
        let mut about = Vec::new();
        // Version, flags, method, time, day.
        [VERSION, 0, DEFLATED, 0, DAY].iter().for_each(|half| about.extend(half.to_le_bytes()));
        let sizes = [crc.sum(), packed.len() as u32, bytes.len() as u32];
        sizes.iter().for_each(|word| about.extend(word.to_le_bytes()));
        about.extend((name.len() as u16).to_le_bytes());
        about.extend(0_u16.to_le_bytes()); // nothing more
        let at = zip.len() as u32;
        zip.extend([b"PK\x03\x04", &*about, name.as_bytes(), &packed].concat());
        directory.extend([b"PK\x01\x02", &VERSION.to_le_bytes()[..], &about, &[0; 10]].concat());
        directory.extend([&at.to_le_bytes()[..], name.as_bytes()].concat());
    }
    let (count, at, length) = (files.len() as u16, zip.len() as u32, directory.len() as u32);
    zip.extend(directory);
    zip.extend([b"PK\x05\x06", &[0; 4][..], &count.to_le_bytes(), &count.to_le_bytes()].concat());
    zip.extend([&length.to_le_bytes()[..], &at.to_le_bytes(), &[0; 2]].concat());
    zip
}

/// Into memory, where nothing fails.
fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::DeflateDecoder;

    use super::*;

    fn word(zip: &[u8], at: usize) -> usize {
        u32::from_le_bytes(zip[at..at + 4].try_into().unwrap()) as usize
    }

    #[test]
    fn what_was_packed_is_found_by_the_directory_and_unpacked() {
        let files = [("a.txt".to_owned(), b"first first first".to_vec()), ("b".to_owned(), vec![7; 1000])];
        let zip = of("dist", &files);
        let end = zip.len() - 22;
        assert_eq!((&zip[end..end + 4], zip[end + 10]), (&b"PK\x05\x06"[..], 2));
        let mut entry = word(&zip, end + 16);
        assert_eq!(entry + word(&zip, end + 12), end);
        for (name, bytes) in &files {
            let (length, at) = (name.len() + 5, word(&zip, entry + 42));
            assert_eq!((&zip[entry..entry + 4], &zip[at..at + 4]), (&b"PK\x01\x02"[..], &b"PK\x03\x04"[..]));
            for place in [entry + 46, at + 30] {
                assert_eq!(&zip[place..place + length], format!("dist/{name}").as_bytes());
            }
            let mut unpacked = Vec::new();
            let packed = &zip[at + 30 + length..][..word(&zip, at + 18)];
            DeflateDecoder::new(packed).read_to_end(&mut unpacked).unwrap();
            assert_eq!(unpacked, *bytes);
            entry += 46 + length;
        }
        assert_eq!(entry, end);
    }
}
