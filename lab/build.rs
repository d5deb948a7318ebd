//! Lists the files of the exercises, so that a new one is a file and nothing else.

use std::path::Path;
use std::{env, fs};

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=exercises");
    let folder = Path::new(&env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("exercises");
    let mut files: Vec<_> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.sort();
    let line = |file: &std::path::PathBuf| {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        format!("({name:?}, include_str!({:?})),\n", file.display().to_string())
    };
    let list: String =
        files.iter().filter(|file| file.extension().is_some_and(|end| end == "json")).map(line).collect();
    let to = Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join("exercises.rs");
    fs::write(to, format!("&[\n{list}]"))
}
