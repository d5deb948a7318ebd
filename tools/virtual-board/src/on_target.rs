//! Runs the tests that `cargo fw-test` runs on a board, as the probe does: which there are stands in the ELF; each begins with a power-up, asks by
//! semihosting which it is, and exits.

use std::path::Path;
use std::rc::Rc;

use anyhow::{Context, bail, ensure};
use object::{Object, ObjectSection, ObjectSymbol};

use crate::closed_loop::Shared;
use crate::cpu::{Cpu, Outcome};
use crate::image::Image;
use crate::time::{Ps, SECOND};
use crate::wiring::AT_REST;

/// Operations of semihosting.
const GET_COMMAND_LINE: u32 = 0x15;
const EXIT: u32 = 0x18;
const EXIT_EXTENDED: u32 = 0x20;
/// The reason of an exit that is none of an error.
const APPLICATION_EXIT: u32 = 0x2_0026;

/// Longest test.
const LIMIT: Ps = 60 * SECOND;
/// Break input, on port A.
const BREAK_PIN: usize = 6;

/// Name of each test in an ELF, and where the function is that runs it.
///
/// # Errors
/// It cannot be read, or has no tests.
pub fn tests(path: &Path) -> anyhow::Result<Vec<(String, u32)>> {
    let bytes = std::fs::read(path)?;
    let elf = object::File::parse(&*bytes)?;
    let section = elf.section_by_name(".embedded_test").context("no tests in it")?;
    let data = section.data()?;
    let mut tests = Vec::new();
    for symbol in elf.symbols().filter(|symbol| symbol.section_index() == Some(section.index())) {
        // {"disambiguator":..,"name":"..",..}; what is no test is no object.
        let Some((_, rest)) = symbol.name()?.split_once("\"name\":\"") else { continue };
        let name = rest.split('"').next().unwrap_or_default().to_owned();
        let at = symbol.address() as usize;
        let word = data.get(at..at + 4).context("a test lies beyond its section")?;
        tests.push((name, u32::from_le_bytes(word.try_into()?)));
    }
    ensure!(!tests.is_empty(), "no tests in it");
    Ok(tests)
}

/// Runs one, with the interlock closed or open.
///
/// # Errors
/// It fails, or does what is not modelled.
pub fn run(image: Rc<Image>, function: u32, interlock: bool) -> anyhow::Result<()> {
    let mut cpu = Cpu::new(image, Box::new(Shared::at_rest(AT_REST)))?;
    cpu.touch(|chip, now| chip.wire(0, BREAK_PIN, interlock.then_some(false), now));
    loop {
        match cpu.run(LIMIT)? {
            Outcome::Asleep | Outcome::Reset(_) => {}
            Outcome::Call(GET_COMMAND_LINE, block) => {
                let line = format!("run_addr {function}\0");
                let [place, room] = [cpu.word(block)?, cpu.word(block + 4)?];
                ensure!(line.len() <= room as usize, "the program takes {room} bytes, {line:?} has more");
                cpu.set_bytes(place, line.as_bytes())?;
                cpu.set_word(block + 4, line.len() as u32 - 1)?;
                cpu.answer(0)?;
            }
            Outcome::Call(EXIT, APPLICATION_EXIT) => return Ok(()),
            Outcome::Call(EXIT_EXTENDED, block)
                if [cpu.word(block)?, cpu.word(block + 4)?] == [APPLICATION_EXIT, 0] =>
            {
                return Ok(());
            }
            Outcome::Call(EXIT | EXIT_EXTENDED, _) => bail!("it fails"),
            other => bail!("{other:?}"),
        }
    }
}
