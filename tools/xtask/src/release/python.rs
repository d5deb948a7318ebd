//! The Python package: a wheel for this system, for every CPython from 3.10 on, and the source archive.

use std::path::Path;
use std::process::Command;

use super::{Why, done};
use crate::image;

/// Builds both with maturin, which is put into an environment of its own.
pub(super) fn wheel(folder: &Path) -> Result<(), Why> {
    let environment = image::target().join("release-python");
    let bin = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let maturin = bin.join(if cfg!(windows) { "maturin.exe" } else { "maturin" });
    if !maturin.is_file() {
        let made = done(Command::new("python3").args(["-m", "venv"]).arg(&environment));
        made.map_err(|_| Why::Missing("apt-get install python3-venv".into()))?;
        let pip = ["install", "--quiet", "--disable-pip-version-check", "--require-hashes", "--requirement"];
        let tools = image::root().join("tools/xtask/src/release/python-tools.txt");
        let installed = done(Command::new(bin.join("pip")).args(pip).arg(tools));
        installed.map_err(|_| Why::Missing("a way to PyPI, for: pip install 'maturin[zig]'".into()))?;
    }
    // Zig links with an old glibc's names, so that the wheel runs on distributions of ten years, too.
    let old: &[&str] =
        if cfg!(target_os = "linux") { &["--zig", "--compatibility", "manylinux2014"] } else { &[] };
    let python = image::root().join("python");
    // No folder of this machine stands in what is built: cargo takes these options one behind the other, parted by this sign.
    let flags = image::remaps().join("\x1f");
    let build = |what: &[&str]| {
        let path = std::env::join_paths(
            [bin.clone()].into_iter().chain(std::env::var_os("PATH").iter().flat_map(std::env::split_paths)),
        );
        let path = path.map_err(|error| format!("PATH: {error}"))?;
        done(
            Command::new(&maturin)
                .args(what)
                .arg("--out")
                .arg(folder)
                .current_dir(&python)
                .env("PATH", path)
                .env("CARGO_ENCODED_RUSTFLAGS", &flags),
        )
    };
    build(&["sdist"])?;
    Ok(build(&[&["build", "--release", "--locked", "--strip"], old].concat())?)
}
