//! The tests that a board with a probe runs (`cargo fw-test`), on the virtual board: with the interlock closed, and open.

use std::path::PathBuf;

use virtual_board::board::default_image;
use virtual_board::image::Image;
use virtual_board::on_target;

/// The image of the tests: what ON_TARGET_ELF names, or what `cargo fw-test --no-run` has built.
fn image() -> PathBuf {
    let beside = || {
        let built = default_image().expect("an image");
        built.ancestors().nth(3).map(|target| target.join("on-target/on_target.elf")).expect("a folder")
    };
    std::env::var_os("ON_TARGET_ELF").map_or_else(beside, PathBuf::from)
}

#[test]
fn all_pass() {
    let path = image();
    let tests = on_target::tests(&path)
        .unwrap_or_else(|why| panic!("{}: {why}; cargo fw-test --no-run", path.display()));
    let image = std::rc::Rc::new(Image::read(&path).expect("an image"));
    let mut failed = Vec::new();
    for (name, function) in &tests {
        for interlock in [true, false] {
            if let Err(why) = on_target::run(image.clone(), *function, interlock) {
                failed.push(format!(
                    "{name}, interlock {}: {why:#}",
                    if interlock { "closed" } else { "open" }
                ));
            }
        }
    }
    assert!(failed.is_empty(), "{} tests, of which fail:\n{}", tests.len(), failed.join("\n"));
}
