//! Does every run and prints the hashes: as an image for the emulator, and on the host to compare. Started by `cargo pil`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
extern "C" fn main() -> ! {
    let done = pil::runs::write_all(&pil::board::input::recording(), &mut pil::board::Console);
    pil::board::exit(done.is_ok())
}

/// The same runs on the host: prints the hashes of the recording that it is given.
#[cfg(not(target_os = "none"))]
fn main() {
    let path = std::env::args_os().nth(1).expect("the path of a recording; `cargo pil` writes one");
    let bytes = std::fs::read(path).expect("a recording that can be read");
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|&number| f32::from_le_bytes(number)).collect();
    // The first number is their count, which only the image needs.
    let rows = numbers.get(1..).unwrap_or_default().as_chunks().0;
    let mut text = String::new();
    pil::runs::write_all(&pil::recording::Recording::new(rows).expect("a row"), &mut text).expect("memory");
    print!("{text}");
}
