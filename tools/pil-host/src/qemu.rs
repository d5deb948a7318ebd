//! The emulator: a Cortex-M4F with the memory map of an STM32F4.

use std::io::{BufReader, ErrorKind};
use std::path::Path;
use std::process::{ChildStderr, Command, Stdio};

use anyhow::{Context, anyhow, ensure};

const PROGRAM: &str = "qemu-system-arm";
/// Where the linker script expects the recording.
const INPUT_ADDRESS: &str = "0x08040000";

/// The emulator with an image and the recording that it reads; its console is standard error.
fn command(image: &Path, recording: &Path) -> Command {
    let mut qemu = Command::new(PROGRAM);
    let loader = format!("loader,file={},addr={INPUT_ADDRESS},force-raw=on", recording.display());
    qemu.args(["-machine", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-device", &loader, "-kernel"])
        .arg(image)
        .stdin(Stdio::null());
    qemu
}

/// Runs an image to its end and returns what it printed.
pub(crate) fn run(image: &Path, recording: &Path, options: &[&str]) -> anyhow::Result<String> {
    let output = command(image, recording).args(options).output().map_err(missing)?;
    let text = String::from_utf8(output.stderr).context("the image printed no text")?;
    ensure!(output.status.success(), "the image failed:\n{text}");
    Ok(text)
}

/// Runs an image and hands the log of every block that it translates and executes to `read`, as it comes.
pub(crate) fn trace<T>(
    image: &Path,
    recording: &Path,
    read: impl FnOnce(BufReader<ChildStderr>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let mut qemu = command(image, recording);
    let mut qemu =
        qemu.args(["-d", "in_asm,exec,nochain"]).stderr(Stdio::piped()).spawn().map_err(missing)?;
    let log = qemu.stderr.take().context("no log")?;
    let result = read(BufReader::with_capacity(1 << 20, log));
    let status = qemu.wait()?;
    let result = result?;
    ensure!(status.success(), "the traced image failed");
    Ok(result)
}

fn missing(error: std::io::Error) -> anyhow::Error {
    if error.kind() == ErrorKind::NotFound {
        anyhow!("{PROGRAM} is missing: install the package {PROGRAM} (Debian: apt-get install {PROGRAM})")
    } else {
        anyhow!(error).context(PROGRAM)
    }
}
