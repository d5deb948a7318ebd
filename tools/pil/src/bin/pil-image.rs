//! Image for the comparison with the host: does every run and prints the hashes. Started by `cargo pil`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let done = pil::runs::write_all(&pil::board::input::recording(), &mut pil::board::Console);
    pil::board::exit(done.is_ok())
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This is an image for an emulated Cortex-M4F: run `cargo pil`.");
}
