//! A folder of files as a zip file: deflated, with the first day that a zip file knows, so that the same files give the same bytes.

use std::io::{Cursor, Write};

use ::zip::write::SimpleFileOptions;
use ::zip::{CompressionMethod, DateTime, ZipWriter};

/// A zip file of these files in a folder. Those that `runs` names may be run.
///
/// # Errors
/// More than a zip file can hold.
pub(crate) fn of(folder: &str, files: &[(String, Vec<u8>)], runs: &str) -> Result<Vec<u8>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("the zip file of {folder} cannot be made: {error}");
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(9))
            .last_modified_time(DateTime::default())
            .unix_permissions(if name == runs { 0o755 } else { 0o644 });
        zip.start_file(format!("{folder}/{name}"), options).map_err(|error| failed(&error))?;
        zip.write_all(bytes).map_err(|error| failed(&error))?;
    }
    Ok(zip.finish().map_err(|error| failed(&error))?.into_inner())
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use ::zip::ZipArchive;

    use super::*;

    #[test]
    fn what_was_packed_is_unpacked_and_the_same_files_give_the_same_bytes() {
        let files = [("a.txt".to_owned(), b"first first first".to_vec()), ("run".to_owned(), vec![7; 1000])];
        let zip = of("dist", &files, "run").unwrap();
        assert!(zip.len() < 500, "{} bytes", zip.len());
        assert_eq!(zip, of("dist", &files, "run").unwrap());
        let mut archive = ZipArchive::new(Cursor::new(zip)).unwrap();
        assert_eq!(archive.len(), 2);
        for ((name, bytes), mode) in files.iter().zip([0o644, 0o755]) {
            let mut file = archive.by_name(&format!("dist/{name}")).unwrap();
            let mut unpacked = Vec::new();
            file.read_to_end(&mut unpacked).unwrap();
            assert_eq!((&unpacked, file.unix_mode().map(|mode| mode & 0o777)), (bytes, Some(mode)));
            assert_eq!(file.last_modified().map(|time| time.year()), Some(1980));
        }
    }
}
