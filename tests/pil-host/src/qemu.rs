//! The emulator: a Cortex-M4F with the memory map of an STM32F4.

use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow, ensure};

const PROGRAM: &str = "qemu-system-arm";
/// Where the linker script expects the recorded codes.
const INPUT_ADDRESS: &str = "0x08080000";

/// The emulator with an image and the codes that it reads; its console is standard error.
fn command(image: &Path, codes: &Path) -> Command {
    let mut qemu = Command::new(PROGRAM);
    let loader = format!("loader,file={},addr={INPUT_ADDRESS},force-raw=on", codes.display());
    qemu.args(["-machine", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-device", &loader, "-kernel"])
        .arg(image)
        .stdin(Stdio::null());
    qemu
}

/// Runs an image to its end and returns what it printed.
pub(crate) fn run(image: &Path, codes: &Path) -> anyhow::Result<String> {
    let output = command(image, codes).output().map_err(missing)?;
    let text = String::from_utf8(output.stderr).context("the image printed no text")?;
    ensure!(output.status.success(), "the image failed:\n{text}");
    Ok(text)
}

fn missing(error: std::io::Error) -> anyhow::Error {
    if error.kind() == ErrorKind::NotFound {
        anyhow!("{PROGRAM} is missing: install the package {PROGRAM} (Debian: apt-get install {PROGRAM})")
    } else {
        anyhow!(error).context(PROGRAM)
    }
}
