//! `cargo fw`, `fw-run` and `fw-attach`: cargo on the board's image, with the paths of this machine taken out of it. Panic
//! messages carry the names of source files; those of dependencies and of generated code are absolute, so that two checkouts
//! gave two images. Cargo's own settings cannot name a folder that is known only when it runs, hence this program.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";
/// Where cargo unpacks what it gets from crates.io. Its folders name themselves, and forty of them stand in the image.
const PACKAGES: &str = "registry/src/index.crates.io-1949cf8c6b5b557f";
const ATTACH: &str =
    "['probe-rs', 'attach', '--chip', 'STM32F411RETx', '--no-catch-hardfault', '--no-catch-reset']";

/// Runs cargo on the image; `verb` is build, run or attach.
pub(crate) fn cargo(verb: &str, arguments: impl Iterator<Item = OsString>) -> Result<(), String> {
    let command = if verb == "build" { "build" } else { "run" };
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args([command, "--profile", "firmware", "-p", "firmware", "--target", TARGET]);
    cargo.arg("--config").arg(format!("target.{TARGET}.rustflags=[{}]", remaps().join(", ")));
    if verb == "attach" {
        cargo.arg("--config").arg(format!("target.{TARGET}.runner={ATTACH}"));
    }
    let status = cargo.args(arguments).status().map_err(|error| format!("cargo cannot be run: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("cargo {command} has failed")) }
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

/// Options for rustc, as strings of TOML: folders of this machine, and what the image calls them. Of two that fit the compiler takes the later.
pub(crate) fn remaps() -> Vec<String> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let packages = home.as_ref().map(|home| home.join(PACKAGES));
    [(Some(root()), "pt326"), (Some(target()), "target"), (home, "cargo"), (packages, "")]
        .into_iter()
        .filter_map(|(folder, name)| Some((folder.filter(|folder| folder.is_absolute())?, name)))
        .map(|(folder, name)| quoted(&format!("--remap-path-prefix={}={name}", folder.display())))
        .collect()
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn a_path_of_any_system_is_one_string() {
        assert_eq!(quoted(r#"C:\Users\a "b""#), r#""C:\\Users\\a \"b\"""#);
    }
}
