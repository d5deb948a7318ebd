//! All that runs in every tick, on inputs that the compiler knows nothing of. The panic handler calls a function that
//! exists nowhere, so the linker names it if, and only if, some panic can be reached. `tools/no-panic/check` runs this.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("a check of linking for the board, see tools/no-panic/check");
}
