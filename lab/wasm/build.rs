//! `cargo lab` builds for the browser when it runs: it asks whether it can, before a minute is spent on what comes first. Other builds of this
//! crate need no such target, so the alias says that it is meant (PT326_LAB, see .cargo/config.toml).

use std::path::Path;
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";

fn main() {
    println!("cargo::rerun-if-env-changed=PT326_LAB");
    println!("cargo::rerun-if-changed=build.rs");
    let (Some(_), Some(rustc)) = (std::env::var_os("PT326_LAB"), std::env::var_os("RUSTC")) else { return };
    let asked = Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    let folder =
        asked.map(|asked| String::from_utf8_lossy(&asked.stdout).trim().to_owned()).unwrap_or_default();
    if !Path::new(&folder).is_dir() {
        println!(
            "cargo::error=cargo lab needs the target {TARGET} of this toolchain: rustup target add {TARGET}"
        );
    }
}
