//! `cargo fw`, `fw-run` and `fw-attach`: cargo on the board's image, sealed with its checksum, and with the paths of this machine taken out of
//! it. Panic messages carry the names of source files; those of dependencies and of generated code are absolute, so that two checkouts
//! gave two images. Cargo's own settings cannot name a folder that is known only when it runs, hence this program.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crc::{CRC_32_MPEG_2, Crc};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSection};

const TARGET: &str = "thumbv7em-none-eabihf";
/// Where cargo unpacks what it gets from crates.io. Its folders name themselves, and forty of them stand in the image.
const PACKAGES: &str = "registry/src/index.crates.io-1949cf8c6b5b557f";
/// What runs an image, for cargo; who has set it wants something else, such as another probe.
const RUNNER: &str = "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER";

/// Builds the image, and has a probe run or attach to it where `verb` says so; else it is build.
pub(crate) fn cargo(verb: &str, arguments: impl Iterator<Item = OsString>) -> Result<(), String> {
    let arguments: Vec<OsString> = arguments.collect();
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--profile", "firmware", "-p", "firmware", "--target", TARGET]);
    start(cargo.arg("--config").arg(rustflags(TARGET)).args(&arguments))?;
    seal(&built())?;
    if verb == "build" {
        return Ok(());
    }
    run(verb, &arguments, &built())
}

/// Has a probe do something with an image.
fn run(verb: &str, arguments: &[OsString], image: &Path) -> Result<(), String> {
    let runner = std::env::var(RUNNER).unwrap_or_else(|_| probe(verb, arguments));
    let mut words = runner.split_whitespace();
    start(Command::new(words.next().unwrap_or_default()).args(words).arg(image))
}

fn start(command: &mut Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.status().map_err(|error| format!("{name} cannot be run: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name} has failed")) }
}

/// Writes the checksum of an image into its section `.seal`, which is the last of it: by CRC-32/MPEG-2, which the chip's own unit computes over
/// words from their highest byte on. With it the checksum of all is 0.
fn seal(path: &Path) -> Result<(), String> {
    let told = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut file = std::fs::read(path).map_err(|error| told(&error))?;
    let (at, sum) = checksum(&file).map_err(|error| told(&error))?;
    file[at..at + 4].copy_from_slice(&sum.to_le_bytes());
    // Into the same file: cargo has another name for it, and would take that one's content next time.
    std::fs::write(path, file).map_err(|error| told(&error))
}

/// Where the checksum of an image belongs in its file, and what it is.
fn checksum(file: &[u8]) -> Result<(usize, u32), String> {
    let elf = ElfFile32::<Endianness>::parse(file).map_err(|error| error.to_string())?;
    let section = elf.section_by_name(".seal").ok_or("no section .seal in it")?;
    let place = section.file_range().ok_or("nothing in its section .seal")?.0 as usize;
    let end = section.address();
    let mut flash = Vec::new();
    let mut parts: Vec<(u64, &[u8])> = Vec::new();
    for segment in elf.elf_program_headers() {
        let data = segment.data(elf.endian(), file).map_err(|()| "a segment lies beyond the file")?;
        if segment.p_type(elf.endian()) == object::elf::PT_LOAD && !data.is_empty() {
            parts.push((segment.p_paddr(elf.endian()).into(), data));
        }
    }
    parts.sort_by_key(|(at, _)| *at);
    let begin = parts.first().map_or(0, |(at, _)| *at);
    for (at, data) in parts {
        flash.resize((at - begin) as usize, 0xFF); // what no segment fills stays erased
        flash.extend_from_slice(data);
    }
    if flash.len() as u64 != end - begin + 4 {
        return Err(format!("its section .seal is at {end:#x}, expected the last word of it"));
    }
    flash.truncate((end - begin) as usize);
    flash.chunks_exact_mut(4).for_each(<[u8]>::reverse);
    Ok((place, Crc::<u32>::new(&CRC_32_MPEG_2).checksum(&flash)))
}

/// What brings an image to the board that the features name, or watches it there.
///
/// Since April 2025 (its pull request 3224, in 0.32 and before) probe-rs halts the core at a HardFault and at a reset unless it is told not to.
/// The fault handler, which cuts the heater and keeps the crash record, would never run then. `run` and `attach` both take the flags; that was
/// read in the sources of probe-rs and not tried, for want of a probe.
fn probe(verb: &str, arguments: &[OsString]) -> String {
    let is_446 = |word: &OsString| word.to_string_lossy().contains("nucleo-f446re");
    let chip = if arguments.iter().any(is_446) { "STM32F446RETx" } else { "STM32F411RETx" };
    format!("probe-rs {verb} --chip {chip} --no-catch-hardfault --no-catch-reset")
}

/// Builds the tests of `firmware/tests/on_target.rs`, sealed, and has a probe run them on a board; with `--no-run` it only builds them, and says
/// where they are.
pub(crate) fn test(arguments: impl Iterator<Item = OsString>) -> Result<(), String> {
    let (no_run, arguments): (Vec<_>, Vec<_>) = arguments.partition(|word| word == "--no-run");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args([
        "test",
        "--profile",
        "firmware",
        "-p",
        "firmware",
        "--target",
        TARGET,
        "--test",
        "on_target",
    ]);
    cargo
        .args(["--no-run", "--message-format", "json-render-diagnostics", "--config"])
        .arg(rustflags(TARGET));
    // Cargo builds the image with them, and would put it, without a checksum, where `cargo fw` has put its own.
    let folder = target().join("on-target");
    cargo.arg("--target-dir").arg(&folder).args(&arguments).stderr(Stdio::inherit());
    let output = cargo.output().map_err(|error| format!("cargo cannot be run: {error}"))?;
    if !output.status.success() {
        return Err("cargo test has failed".into());
    }
    let said = String::from_utf8_lossy(&output.stdout);
    // Cargo builds the image, too, and tells of each in a line of JSON.
    let line = said.lines().find(|line| line.contains("\"name\":\"on_target\"")).unwrap_or_default();
    let path = line.split("\"executable\":\"").nth(1).and_then(|rest| rest.split('"').next());
    let built = path.ok_or("cargo has said nothing of an executable")?.replace("\\\\", "\\");
    let sealed = folder.join("on_target.elf");
    std::fs::copy(&built, &sealed).map_err(|error| format!("{built}: {error}"))?;
    seal(&sealed)?;
    if !no_run.is_empty() {
        println!("{}", sealed.display());
        return Ok(());
    }
    run("run", &arguments, &sealed)
}

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(PathBuf::new, PathBuf::from);
    own.ancestors().nth(2).map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Where cargo builds.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Where the image is that was built last.
pub(crate) fn built() -> PathBuf {
    target().join(TARGET).join("firmware").join("firmware")
}

/// A setting of cargo's that takes the folders of this machine out of what is built for a target.
pub(crate) fn rustflags(target: &str) -> String {
    let all: Vec<String> = remaps().iter().map(|option| quoted(option)).collect();
    format!("target.{target}.rustflags=[{}]", all.join(", "))
}

/// Options for rustc: folders of this machine, and what the image calls them. Of two that fit the compiler takes the later.
pub(crate) fn remaps() -> Vec<String> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let packages = home.as_ref().map(|home| home.join(PACKAGES));
    [(Some(root()), "pt326"), (Some(target()), "target"), (home, "cargo"), (packages, "")]
        .into_iter()
        .filter_map(|(folder, name)| Some((folder.filter(|folder| folder.is_absolute())?, name)))
        .map(|(folder, name)| format!("--remap-path-prefix={}={name}", folder.display()))
        .collect()
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::{probe, quoted};

    #[test]
    fn a_probe_is_told_the_chip_of_the_board() {
        let of = |words: &[&str]| probe("attach", &words.iter().map(Into::into).collect::<Vec<_>>());
        let flags = "--no-catch-hardfault --no-catch-reset";
        assert_eq!(of(&[]), format!("probe-rs attach --chip STM32F411RETx {flags}"));
        for named in
            [&["--no-default-features", "--features", "nucleo-f446re"][..], &["--features=nucleo-f446re"]]
        {
            assert_eq!(of(named), format!("probe-rs attach --chip STM32F446RETx {flags}"));
        }
    }

    #[test]
    fn a_path_of_any_system_is_one_string() {
        assert_eq!(quoted(r#"C:\Users\a "b""#), r#""C:\\Users\\a \"b\"""#);
    }
}
