//! Building things with the cargo that started us.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, ensure};

const TARGET: &str = "thumbv7em-none-eabihf";
/// The profile of the board's image. The source is what ships; the link is for speed, where the board's is for size (docs/evidence/performance.md).
const PROFILE: &str = "firmware";

/// Where cargo puts what it builds: two levels above this program.
pub(crate) fn target_dir() -> anyhow::Result<PathBuf> {
    let program = std::env::current_exe()?;
    let dir = program.ancestors().nth(2).context("this program lies in no target folder")?;
    Ok(dir.to_owned())
}

/// A cargo command in this workspace.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    cargo
}

/// Builds an image of the crate `pil` and says where it lies.
pub(crate) fn build(name: &str) -> anyhow::Result<PathBuf> {
    let arguments =
        ["build", "--quiet", "--profile", PROFILE, "-p", "pil", "--bin", name, "--target", TARGET];
    let status = cargo(&arguments).stdin(Stdio::null()).status().context("can't run cargo")?;
    ensure!(
        status.success(),
        "the image {name} can't be built (is the target there? rustup target add {TARGET})"
    );
    Ok(target_dir()?.join(TARGET).join(PROFILE).join(name))
}
