//! What comes over a wire: frames among text, the codes of a simulated board, and what a page orders.
#![no_main]

use libfuzzer_sys::fuzz_target;
use firmware_logic::stream::codes::Codes;
use firmware_logic::stream::frame::{Reader, Step};
use pt326_lab::protocol;
use pt326_lab::scene::{Order, Scene};

fuzz_target!(|data: &[u8]| {
    let mut reader = Reader::<80>::default();
    for &byte in data {
        if let Step::Line(line) = reader.push(byte) {
            let _ = Codes::parse(line);
        }
    }
    let _ = protocol::read::<Order>(data);
    let _ = protocol::read::<Scene>(data);
});
