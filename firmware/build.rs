//! Linker arguments for the target, and the state of the sources for the boot banner.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rustc-env=GIT_DESCRIBE={}", git_describe());
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
        // memory.x is ours and lies at the root of the workspace, so it is searched there and nowhere else.
        println!("cargo::rustc-link-search={}", root.display());
        for arg in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo::rustc-link-arg-bins={arg}");
            println!("cargo::rustc-link-arg-tests={arg}");
        }
        println!("cargo::rustc-link-arg-tests=-Tembedded-test.x");
    }
}

/// Commit, and whether the tree differs from it; "unknown" where this is no checkout.
fn git_describe() -> String {
    for file in ["HEAD", "index"] {
        // In a worktree .git is a file, so git is asked where these are.
        if let Some(path) = git(&["rev-parse", "--git-path", file]) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    git(&["describe", "--always", "--dirty", "--tags"]).unwrap_or_else(|| "unknown".into())
}

fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
