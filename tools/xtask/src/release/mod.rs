//! `cargo xtask release`: all that a release holds, in one folder. What this machine cannot make is left out, and the end says what would
//! install it; only what could be made and failed is an error.

mod check;
mod programs;
mod python;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{dist, image, zip};

/// The version of the workspace.
const VERSION: &str = env!("CARGO_PKG_VERSION");
const USAGE: &str = "\
Makes what a release holds, in dist/release-VERSION.

    cargo xtask release                       all of it; what this machine cannot make is left out and said
    cargo xtask release --only windows,deb    these pieces only; the others that are there stay
    cargo xtask release --check               looks at what is there: sums, and whether the programs run

Pieces: board, linux, deb, windows, macos, wheel, sbom. SHA256SUMS are always made; `--only sums` makes nothing else.";

/// Why a piece was not made.
enum Why {
    /// This machine lacks something; what would bring it.
    Missing(String),
    /// It could have been made.
    Failed(String),
}

impl From<String> for Why {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

/// Makes one piece in a folder.
type Make = fn(&Path) -> Result<(), Why>;

/// The pieces by their names, in the order in which they are made.
const PIECES: [(&str, Make); 8] = [
    ("board", board),
    ("linux", programs::linux),
    ("deb", programs::deb),
    ("windows", programs::windows),
    ("macos", programs::macos),
    ("wheel", python::wheel),
    ("sbom", sbom),
    ("sums", |_| Ok(())),
];

/// Makes what was asked for.
///
/// # Errors
/// A piece that could have been made and was not; a file that is not what it should be; an argument that is none.
pub(crate) fn run(arguments: impl Iterator<Item = OsString>) -> Result<(), String> {
    let arguments: Vec<String> = arguments.map(|word| word.to_string_lossy().into_owned()).collect();
    let folder = image::root().join("dist").join(format!("release-{VERSION}"));
    let only: Vec<&str> = match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => {
            // What an earlier version of the sources has left there is no part of this release.
            let _ = std::fs::remove_dir_all(&folder);
            PIECES.iter().map(|(name, _)| *name).collect()
        }
        ["--check"] => return check::report(&folder),
        ["--only", pieces] => pieces.split(',').collect(),
        ["--help" | "-h"] => {
            println!("{USAGE}");
            return Ok(());
        }
        other => return Err(format!("release {}, expected:\n{USAGE}", other.join(" "))),
    };
    if let Some(unknown) = only.iter().find(|piece| PIECES.iter().all(|(name, _)| name != *piece)) {
        return Err(format!("no piece is named {unknown}, expected:\n{USAGE}"));
    }
    make(&folder, &only)
}

fn make(folder: &Path, only: &[&str]) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let (mut missing, mut failed) = (Vec::new(), Vec::new());
    for (name, make) in PIECES.iter().filter(|(name, _)| only.contains(name)) {
        println!("== {name}");
        match make(folder) {
            Ok(()) => {}
            Err(Why::Missing(what)) => missing.push(format!("{name:8} {what}")),
            Err(Why::Failed(why)) => failed.push(format!("{name:8} {why}")),
        }
    }
    let sums = dist::sums(&check::files(folder)?);
    write(&folder.join(dist::SUMS), sums.as_bytes())?;
    let checked = check::report(folder);
    for (title, pieces) in [("Left out; what would bring it", &missing), ("Failed", &failed)] {
        if !pieces.is_empty() {
            println!("\n{title}:\n  {}", pieces.join("\n  "));
        }
    }
    checked?;
    if failed.is_empty() { Ok(()) } else { Err("what is listed as failed was not made".into()) }
}

/// The folder of the board as a zip file, and the lab's page beside it, for whom a page is enough.
fn board(folder: &Path) -> Result<(), Why> {
    let files = dist::files()?;
    let page = files.iter().find(|(name, _)| name == dist::PAGE).map_or(&[][..], |(_, bytes)| bytes);
    write(&folder.join(dist::PAGE), page)?;
    let name = format!("pt326-board-{VERSION}");
    Ok(write(&folder.join(format!("{name}.zip")), &zip::of(&name, &files, "")?)?)
}

/// Which crates, in which versions, are in the program for Linux: CycloneDX, as JSON.
fn sbom(folder: &Path) -> Result<(), Why> {
    const LIST: &str = "release-sbom";
    needs("cargo-cyclonedx", "cargo install --locked cargo-cyclonedx")?;
    let root = image::root();
    let options =
        ["cyclonedx", "--quiet", "--format", "json", "--features", "live", "--target", programs::LINUX];
    let named = ["--override-filename", LIST, "--manifest-path"];
    done(cargo().args(options).args(named).arg(root.join("host-sim/Cargo.toml")).current_dir(&root))?;
    // It writes one beside each manifest of the workspace, and names our crates by where they lie.
    let lists = beside_manifests(&root, &format!("{LIST}.json"));
    let list = dist::read(&root.join("host-sim").join(format!("{LIST}.json")));
    lists.iter().try_for_each(std::fs::remove_file).map_err(|error| format!("{LIST}.json: {error}"))?;
    let list = String::from_utf8_lossy(&list?).replace(&root.display().to_string(), "");
    Ok(write(&folder.join(format!("pt326-{VERSION}.cdx.json")), list.as_bytes())?)
}

/// Files of this name beside the manifests of our crates, which lie two folders deep at most.
fn beside_manifests(root: &Path, name: &str) -> Vec<PathBuf> {
    let folders = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries
            .map(|entry| entry.path())
            .filter(|path| path.join("Cargo.toml").is_file() || path == &root.join("tools"))
            .collect()
    };
    let outer = folders(root);
    let inner = outer.iter().flat_map(|folder| folders(folder));
    outer.iter().cloned().chain(inner).map(|folder| folder.join(name)).filter(|file| file.is_file()).collect()
}

fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command to its end.
fn done(command: &mut Command) -> Result<(), String> {
    let name = format!("{command:?}");
    let status = command.status().map_err(|error| format!("{name}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name} has failed")) }
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(file, bytes).map_err(|error| format!("{}: {error}", file.display()))
}

/// A program on the search path.
fn found(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|file| file.is_file())
}

/// A program that a piece cannot do without, and what installs it.
fn needs(program: &str, install: &str) -> Result<(), Why> {
    found(program).map(drop).ok_or_else(|| Why::Missing(install.into()))
}
