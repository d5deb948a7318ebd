//! Is a release what it should be? Every file is listed with its sum and carries the version, the Linux program needs no other file, and the
//! programs start and tell the version.

use std::io::{Cursor, Read};
use std::path::Path;
use std::process::Command;

use object::Endianness;
use object::elf::{FileHeader64, PT_INTERP};
use object::read::elf::{FileHeader, ProgramHeader};
use zip::ZipArchive;

use super::programs::{LINUX, WINDOWS, name};
use super::{VERSION, done, found, write};
use crate::{dist, image};

/// All files of a folder but the sums, by name.
///
/// # Errors
/// A folder or file that cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, String> {
    let unreadable = |error| format!("{}: {error}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name != dist::SUMS {
            files.push((name, dist::read(&entry.path())?));
        }
    }
    files.sort();
    Ok(files)
}

/// Says what is there, and what was tried.
///
/// # Errors
/// What is wrong, all of it.
pub(super) fn report(folder: &Path) -> Result<(), String> {
    let files = files(folder)?;
    let sums = String::from_utf8_lossy(&dist::read(&folder.join(dist::SUMS))?).into_owned();
    let mut wrong = mistakes(&files, &sums);
    println!("\n{}:", folder.display());
    for (name, bytes) in &files {
        println!("  {:9.1} kB  {name}", bytes.len() as f64 / 1e3);
    }
    println!("Checked: sums and names");
    for (target, program, try_it) in
        [(LINUX, "pt326", alone as fn(&[u8]) -> Result<String, String>), (WINDOWS, "pt326.exe", in_wine)]
    {
        let archive = format!("{}.zip", name(target));
        let Some((_, bytes)) = files.iter().find(|(name, _)| *name == archive) else { continue };
        match packed(bytes, &format!("{}/{program}", name(target))).and_then(|program| try_it(&program)) {
            Ok(how) => println!("Checked: {archive}: {how}"),
            Err(why) => wrong.push(format!("{archive}: {why}")),
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// What is wrong with the names and sums of these files.
fn mistakes(files: &[(String, Vec<u8>)], sums: &str) -> Vec<String> {
    let unnamed = files.iter().filter(|(name, _)| name != dist::PAGE && !name.contains(VERSION));
    let mut wrong: Vec<String> =
        unnamed.map(|(name, _)| format!("{name}: not of version {VERSION}")).collect();
    let now = dist::sums(files);
    wrong.extend(now.lines().filter(|line| !sums.lines().any(|other| other == *line)).map(|line| {
        format!("{}: another sum than {} has, or none", line.split("  ").last().unwrap_or(line), dist::SUMS)
    }));
    let there = |name: &str| files.iter().any(|(file, _)| file == name);
    let gone = sums.lines().filter_map(|line| line.split("  ").last()).filter(|name| !there(name));
    wrong.extend(gone.map(|name| format!("{name}: listed in {} and not there", dist::SUMS)));
    wrong
}

/// A file of a zip file.
fn packed(archive: &[u8], name: &str) -> Result<Vec<u8>, String> {
    let mut archive = ZipArchive::new(Cursor::new(archive)).map_err(|error| error.to_string())?;
    let mut file = archive.by_name(name).map_err(|error| format!("{name}: {error}"))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|error| format!("{name}: {error}"))?;
    Ok(bytes)
}

/// Whether a program of Linux asks for a loader, and so for libraries.
fn asks_for_a_loader(elf: &[u8]) -> Result<bool, object::Error> {
    let header = FileHeader64::<Endianness>::parse(elf)?;
    let endian = header.endian()?;
    let segments = header.program_headers(endian, elf)?;
    Ok(segments.iter().any(|segment| segment.p_type(endian) == PT_INTERP))
}

/// The Linux program in a folder where nothing else is.
fn alone(program: &[u8]) -> Result<String, String> {
    if asks_for_a_loader(program).map_err(|error| error.to_string())? {
        return Err("the program is not static: it asks for a loader".into());
    }
    if !cfg!(target_os = "linux") || found("unshare").is_none() {
        return Ok("static; not run here".into());
    }
    let root = image::target().join("release-root");
    let unshare = |program: &[&str]| {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--root"]).arg(&root).args(program);
        command.output().map_err(|error| format!("unshare: {error}"))
    };
    let _ = std::fs::remove_dir_all(&root);
    std::fs::create_dir_all(&root).map_err(|error| format!("{}: {error}", root.display()))?;
    executable(&root.join("pt326"), program)?;
    let out = unshare(&["/pt326", "--version"])?;
    says_the_version(&out)?;
    Ok(format!("static; `pt326 --version` runs in an empty root and says {VERSION}"))
}

/// What Rust's library takes from bcryptprimitives.dll, which Wine 8 lacks.
const RANDOM: &str = "#include <windows.h>
BOOLEAN NTAPI SystemFunction036(PVOID, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE to, SIZE_T count) { return SystemFunction036(to, (ULONG)count); }";

/// The Windows program in Wine, where there is one.
fn in_wine(program: &[u8]) -> Result<String, String> {
    let (Some(wine), Some(compiler)) = (found("wine"), found("x86_64-w64-mingw32-gcc")) else {
        return Ok("not run: there is no wine here (apt-get install wine64 wine)".into());
    };
    let folder = image::target().join("release-wine");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    write(&folder.join("pt326.exe"), program)?;
    write(&folder.join("random.c"), RANDOM.as_bytes())?;
    let mut library = Command::new(compiler);
    library.args(["-shared", "-o", "bcryptprimitives.dll", "random.c", "-ladvapi32"]);
    done(library.current_dir(&folder))?;
    let mut wine = Command::new(wine);
    let quiet =
        wine.args(["pt326.exe", "--version"]).env("WINEPREFIX", folder.join("c")).env("WINEDEBUG", "-all");
    let out = quiet.current_dir(&folder).output().map_err(|error| format!("wine: {error}"))?;
    says_the_version(&out)?;
    Ok(format!("`pt326 --version` runs in Wine and says {VERSION}"))
}

fn says_the_version(out: &std::process::Output) -> Result<(), String> {
    let (said, error) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    if out.status.success() && said.trim() == format!("pt326 {VERSION}") {
        return Ok(());
    }
    Err(format!("--version said {:?}, expected \"pt326 {VERSION}\": {}", said.trim(), error.trim()))
}

/// Writes a program that may be run.
fn executable(file: &Path, program: &[u8]) -> Result<(), String> {
    write(file, program)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(file, mode).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn release() -> Vec<(String, Vec<u8>)> {
        vec![(dist::PAGE.to_owned(), b"page".to_vec()), (format!("pt326-{VERSION}.zip"), b"zip".to_vec())]
    }

    #[test]
    fn a_file_that_changed_or_came_or_went_is_named() {
        let sums = dist::sums(&release());
        assert_eq!(mistakes(&release(), &sums), [""; 0]);

        let mut changed = release();
        changed[1].1.push(b'!');
        let told = format!("pt326-{VERSION}.zip: another sum than SHA256SUMS has, or none");
        assert_eq!(mistakes(&changed, &sums), [told]);
        assert_eq!(mistakes(&release()[1..], &sums), ["lab.html: listed in SHA256SUMS and not there"]);
        let come = [release(), vec![(format!("new-{VERSION}"), Vec::new())]].concat();
        assert_eq!(mistakes(&come, &sums).len(), 1);
    }

    #[test]
    fn a_file_of_another_version_is_named() {
        let old = vec![("pt326-0.0.1.zip".to_owned(), Vec::new())];
        assert_eq!(mistakes(&old, &dist::sums(&old)), [format!("pt326-0.0.1.zip: not of version {VERSION}")]);
    }

    /// This test itself is linked with the C library of the machine.
    #[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
    #[test]
    fn a_program_that_needs_libraries_is_refused() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert!(alone(&own).unwrap_err().contains("not static"));
    }
}
