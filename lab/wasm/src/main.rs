//! `cargo lab`: the page with the session within it, one file that opens with a double click.

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use flate2::Compression;
use flate2::read::GzEncoder;
use pt326_lab::exercise;
use pt326_lab::page::{Source, html, packed};

const TARGET: &str = "wasm32-unknown-unknown";
const SESSION: &str = "pt326_lab_wasm.wasm";
/// A file that fits where mail and courses put it, bytes.
const LIMIT: usize = 545_000;

fn main() -> ExitCode {
    match write(std::env::args_os().nth(1).as_deref()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("lab: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Builds the session for a browser and writes the page to `file`, or to lab.html.
fn write(file: Option<&OsStr>) -> Result<(), String> {
    exercise::module().map_err(|error| format!("{error:#}"))?;
    let cargo = || Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let build = ["build", "--quiet", "--profile", "lab", "-p", "pt326-lab-wasm", "--lib", "--target", TARGET];
    let status = cargo().args(build).status().map_err(|error| format!("cargo cannot be run: {error}"))?;
    if !status.success() {
        return Err("the session was not built".into());
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let wasm = target.join(TARGET).join("lab").join(SESSION);
    let wasm = std::fs::read(&wasm).map_err(|error| format!("{}: {error}", wasm.display()))?;
    let page = packed(&html(Source::InPage(&gzip(&wasm))), gzip).ok_or("the page has no modules")?;
    let file = Path::new(file.unwrap_or(OsStr::new("lab.html")));
    std::fs::write(file, &page).map_err(|error| format!("{}: {error}", file.display()))?;
    println!(
        "{}: {} kB; the session in it is {} kB unpacked",
        file.display(),
        page.len() / 1000,
        wasm.len() / 1000
    );
    if page.len() > LIMIT { Err(format!("more than {LIMIT} bytes")) } else { Ok(()) }
}

/// Packs what a browser unpacks by its own `DecompressionStream`.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    // Neither reading from memory nor writing there fails.
    let _ = GzEncoder::new(bytes, Compression::best()).read_to_end(&mut packed);
    packed
}

/// The folder of the workspace.
fn root() -> PathBuf {
    let here = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(PathBuf::new, PathBuf::from);
    here.ancestors().nth(2).map_or_else(PathBuf::new, Path::to_path_buf)
}
