//! `pt326` for the systems that a build reaches from here, each as a zip file with manual pages and completions, and as a Debian package.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{VERSION, Why, cargo, done, needs, write};
use crate::{dist, image, zip};

/// Runs on any Linux of this processor: it is linked with nothing.
pub(super) const LINUX: &str = "x86_64-unknown-linux-musl";
/// By the linker of Debian's MinGW.
pub(super) const WINDOWS: &str = "x86_64-pc-windows-gnu";
const MACS: [&str; 2] = ["aarch64-apple-darwin", "x86_64-apple-darwin"];

/// Texts that go with a program, beside its own README.txt: that of the sources points to pages that are not there.
const TEXTS: [&str; 4] = ["CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT", dist::LICENCES];
const README: &str = include_str!("PROGRAM.txt");
/// Shells, and the names that they look for.
const SHELLS: [(&str, &str); 4] =
    [("bash", "pt326.bash"), ("zsh", "_pt326"), ("fish", "pt326.fish"), ("powershell", "_pt326.ps1")];

/// `pt326` for Linux.
pub(super) fn linux(folder: &Path) -> Result<(), Why> {
    archive(folder, LINUX, "pt326")
}

/// `pt326` for Windows.
pub(super) fn windows(folder: &Path) -> Result<(), Why> {
    if !cfg!(windows) {
        needs("x86_64-w64-mingw32-gcc", "apt-get install gcc-mingw-w64-x86-64")?;
    }
    archive(folder, WINDOWS, "pt326.exe")
}

/// `pt326` for macOS: a build from elsewhere would need Apple's SDK, for the frameworks that the serial port uses.
pub(super) fn macos(folder: &Path) -> Result<(), Why> {
    if !cfg!(target_os = "macos") {
        return Err(Why::Missing("a Mac; on a public host .github/workflows/release.yml has one".into()));
    }
    MACS.iter().try_for_each(|target| archive(folder, target, "pt326"))
}

/// `pt326` as a Debian package: the program for any Linux, with manual pages and completions.
pub(super) fn deb(folder: &Path) -> Result<(), Why> {
    needs("cargo-deb", "cargo install --locked cargo-deb")?;
    build(LINUX)?;
    extras(LINUX)?;
    for_debian(&built(LINUX).join("extras"))?;
    let options = ["deb", "--no-build", "--no-strip", "-p", "pt326", "--target", LINUX, "--output"];
    let file = folder.join(format!("pt326_{VERSION}_amd64.deb"));
    Ok(done(cargo().args(options).arg(file).current_dir(image::root()))?)
}

/// Manual pages and changelogs as Debian has them, packed without times.
fn for_debian(extras: &Path) -> Result<(), Why> {
    let when = Command::new("git").args(["log", "-1", "--format=%cD"]).current_dir(image::root()).output();
    let when = when.map_err(|error| format!("git: {error}"))?.stdout;
    let debian = format!(
        "pt326 ({VERSION}-1) unstable; urgency=medium\n\n  * See changelog.gz.\n\n -- The PT-326 FDI authors <authors@pt326.invalid>  {}",
        String::from_utf8_lossy(&when)
    );
    write(&extras.join("changelog.Debian"), debian.as_bytes())?;
    write(&extras.join("changelog"), &dist::read(&image::root().join("CHANGELOG.md"))?)?;
    let folder = std::fs::read_dir(extras.join("man")).map_err(|error| format!("man: {error}"))?;
    let pages = folder
        .flatten()
        .map(|entry| entry.path())
        .filter(|page| page.extension().is_some_and(|of| of == "1"));
    let all = pages.chain(["changelog", "changelog.Debian"].map(|name| extras.join(name)));
    // The others stay: the zip files take the pages as they are.
    Ok(done(Command::new("gzip").args(["--best", "--no-name", "--keep", "--force"]).args(all))?)
}

/// The zip file of a target.
fn archive(folder: &Path, target: &str, program: &str) -> Result<(), Why> {
    build(target)?;
    let mut files = vec![(program.to_owned(), dist::read(&built(target).join(program))?)];
    files.push(("README.txt".into(), README.into()));
    for text in TEXTS {
        files.push((text.into(), dist::read(&image::root().join(text))?));
    }
    if let Some(native) = native() {
        build(native)?;
        files.extend(extras(native)?);
    }
    let name = name(target);
    Ok(write(&folder.join(format!("{name}.zip")), &zip::of(&name, &files, program)?)?)
}

/// The name of a target's zip file, without its ending.
pub(super) fn name(target: &str) -> String {
    format!("pt326-{VERSION}-{target}")
}

/// The target whose program this machine can run, to have it write manual pages and completions.
fn native() -> Option<&'static str> {
    match (std::env::consts::OS, std::env::consts::ARCH) {
        ("linux", "x86_64") => Some(LINUX),
        ("macos", "aarch64") => Some(MACS[0]),
        ("macos", _) => Some(MACS[1]),
        ("windows", _) => Some(WINDOWS),
        _ => None,
    }
}

/// Where cargo puts the program of a target.
fn built(target: &str) -> PathBuf {
    image::target().join(target).join("release")
}

/// Builds the program of a target, without symbols, and without the paths of this machine.
fn build(target: &str) -> Result<(), Why> {
    let libraries = Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
    let libraries = libraries.map_err(|error| format!("rustc cannot be run: {error}"))?;
    if !Path::new(String::from_utf8_lossy(&libraries.stdout).trim()).is_dir() {
        return Err(Why::Missing(format!("rustup target add {target}")));
    }
    let flags = image::rustflags(target);
    let options = ["build", "--release", "--locked", "-p", "pt326", "--features", "live", "--target", target];
    let settings = ["--config", "profile.release.package.pt326.strip=\"symbols\"", "--config", &flags];
    Ok(done(cargo().args(options).args(settings).current_dir(image::root()))?)
}

/// Has the program write manual pages and completions; the files, by their names in the zip file. The Debian package takes them from there.
fn extras(target: &str) -> Result<Vec<(String, Vec<u8>)>, Why> {
    let (program, folder) = (built(target).join("pt326"), built(target).join("extras"));
    let mut files = Vec::new();
    let man = folder.join("man");
    done(Command::new(&program).args(["man", "--out"]).arg(&man))?;
    for (shell, name) in SHELLS {
        let script = Command::new(&program).args(["completions", shell]).output();
        let script = script.map_err(|error| format!("{}: {error}", program.display()))?.stdout;
        write(&folder.join(name), &script)?;
        files.push((format!("completions/{name}"), script));
    }
    let mut pages: Vec<PathBuf> = std::fs::read_dir(&man)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(|error| format!("{}: {error}", man.display()))?;
    pages.retain(|page| page.extension().is_some_and(|of| of == "1"));
    pages.sort();
    for page in pages {
        let name = page.file_name().unwrap_or_default().to_string_lossy().into_owned();
        files.push((format!("man/{name}"), dist::read(&page)?));
    }
    Ok(files)
}
