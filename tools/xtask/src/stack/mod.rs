//! `cargo run -p xtask -- stack IMAGE`: a bound of the stack, from the image's machine code, against what memory.x reserves.

mod bound;
mod disassembly;

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use bound::Program;

/// Prints the bound; an error if the stack can be deeper than what is reserved.
pub(crate) fn check(image: Option<&OsStr>) -> Result<(), String> {
    let image =
        Path::new(image.unwrap_or_else(|| OsStr::new("target/thumbv7em-none-eabihf/firmware/firmware")));
    let code = tool(&["-d", "-C", "--no-show-raw-insn"], image)?;
    let data = tool(&["-s", "-j", ".vector_table", "-j", ".rodata", "-j", ".data"], image)?;
    let symbols = tool(&["-t"], image)?;
    let symbol = |name| disassembly::symbol(&symbols, name).ok_or(format!("no symbol {name}"));
    let size = symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?);
    let program = Program::new(disassembly::functions(&code)?, &disassembly::words(&data))?;
    let bound = program.bound()?;
    for (what, bytes) in &bound {
        println!("{bytes:6}  {what}");
    }
    let total: u32 = bound.iter().map(|(_, bytes)| bytes).sum();
    println!("{total:6}  of {size} bytes");
    for way in program.ways() {
        println!("the deepest way:");
        way.iter().for_each(|(name, frame)| println!("{frame:6}    {name}"));
    }
    if total > size {
        Err(format!("the stack may need {total} bytes, expected at most {size}"))
    } else {
        Ok(())
    }
}

fn tool(arguments: &[&str], image: &Path) -> Result<String, String> {
    const NAME: &str = "arm-none-eabi-objdump";
    let output = Command::new(NAME).args(arguments).arg(image).output();
    let output =
        output.map_err(|e| format!("{NAME}: {e} (Debian: apt-get install binutils-arm-none-eabi)"))?;
    if !output.status.success() {
        return Err(format!("{NAME}: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
