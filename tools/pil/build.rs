//! The images have a linker script of their own, under a name of its own: a `memory.x` at the root of the workspace is
//! the board's, and the linker would find it before any other.

fn main() {
    println!("cargo::rerun-if-changed=netduinoplus2.x");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("netduinoplus2.x");
        println!("cargo::rustc-link-arg-bins=-T{}", script.display());
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
}
