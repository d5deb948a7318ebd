//! `cargo fmu`: pt326_rig.fmu and pt326_instrument.fmu.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, bail, ensure};
use pt326_fmu::description;
use pt326_fmu::model::{Model, models};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

const HELP: &str = "\
Makes pt326_rig.fmu and pt326_instrument.fmu, for simulators that read FMI 3.0 (docs/fmi.md).

    cargo fmu [--out FOLDER] [TARGET ...]

FOLDER is target/fmu unless it is given. The files are for this machine, and for each TARGET besides, by its name for rustup:

    rustup target add x86_64-pc-windows-gnu
    cargo fmu x86_64-pc-windows-gnu

It needs a linker for each: for this one Debian's gcc-mingw-w64-x86-64.";
const LICENCES: [(&str, &str); 3] = [
    ("LICENSE-MIT", include_str!("../../LICENSE-MIT")),
    ("LICENSE-APACHE", include_str!("../../LICENSE-APACHE")),
    ("THIRD-PARTY.txt", include_str!("../../THIRD-PARTY.txt")),
];

/// The library for a kind of machine.
struct Binary {
    /// How FMI calls the kind: architecture and system.
    platform: String,
    suffix: &'static str,
    bytes: Vec<u8>,
}

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("fmu: {why:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> anyhow::Result<()> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let (mut folder, mut triples) = (target.join("fmu"), Vec::new());
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "-h" | "--help" => {
                println!("{HELP}");
                return Ok(());
            }
            "--out" => folder = arguments.next().context("--out, expected a folder behind it")?.into(),
            option if option.starts_with('-') => bail!("{option}, expected --out FOLDER or --help"),
            triple => triples.push(triple.to_owned()),
        }
    }
    let targets = std::iter::once(None).chain(triples.iter().map(|triple| Some(triple.as_str())));
    let binaries: Vec<Binary> =
        targets.map(|triple| binary(&target, triple)).collect::<anyhow::Result<_>>()?;
    std::fs::create_dir_all(&folder).with_context(|| format!("can't make {}", folder.display()))?;
    for model in models() {
        let file = folder.join(format!("{}.fmu", model.identifier));
        let bytes = packed(model, &binaries)?;
        std::fs::write(&file, &bytes).with_context(|| format!("can't write {}", file.display()))?;
        println!("{}: {} kB", file.display(), bytes.len() / 1000);
    }
    let platforms: Vec<_> = binaries.iter().map(|binary| binary.platform.as_str()).collect();
    println!("for {}", platforms.join(", "));
    Ok(())
}

/// The folder of the workspace.
fn root() -> PathBuf {
    let here = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(PathBuf::new, PathBuf::from);
    here.parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Builds the library for a target of rustup, or for this machine.
fn binary(target: &Path, triple: Option<&str>) -> anyhow::Result<Binary> {
    let (architecture, system) = match triple {
        None => (std::env::consts::ARCH, std::env::consts::OS),
        Some(triple) => {
            triple.split_once('-').with_context(|| format!("{triple}, expected a target of rustup"))?
        }
    };
    let (system, prefix, suffix) = match system {
        name if name.contains("windows") => ("windows", "", ".dll"),
        name if name.contains("darwin") || name == "macos" => ("darwin", "lib", ".dylib"),
        name if name.contains("linux") => ("linux", "lib", ".so"),
        other => bail!("{other} is no system of FMI, expected Windows, Linux or macOS"),
    };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--release", "-p", "pt326-fmu", "--lib"]);
    if let Some(triple) = triple {
        build.args(["--target", triple]);
    }
    let status = build.status().context("cargo cannot be run")?;
    let advice = triple.map_or(String::new(), |triple| {
        format!(" for {triple}; are target and linker there? (rustup target add {triple})")
    });
    ensure!(status.success(), "the library was not built{advice}");
    let folder = triple.map_or_else(|| target.to_owned(), |triple| target.join(triple)).join("release");
    let file = folder.join(format!("{prefix}pt326_fmu{suffix}"));
    let bytes = std::fs::read(&file).with_context(|| format!("can't read {}", file.display()))?;
    Ok(Binary { platform: format!("{architecture}-{system}"), suffix, bytes })
}

/// The .fmu of a model. The same files give the same bytes: all have the first day that a zip file knows.
fn packed(model: &Model, binaries: &[Binary]) -> anyhow::Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut add = |name: &str, bytes: &[u8]| -> anyhow::Result<()> {
        zip.start_file(name, options)?;
        Ok(zip.write_all(bytes)?)
    };
    add("modelDescription.xml", description::model_description(model)?.as_bytes())?;
    add("terminalsAndIcons/terminalsAndIcons.xml", description::terminals()?.as_bytes())?;
    for (name, text) in LICENCES {
        add(&format!("documentation/licenses/{name}"), text.as_bytes())?;
    }
    for Binary { platform, suffix, bytes } in binaries {
        add(&format!("binaries/{platform}/{}{suffix}", model.identifier), bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}
