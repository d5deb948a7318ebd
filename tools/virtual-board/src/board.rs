//! The board on the desk: power, buttons, wires, terminal and debug probe, for programs that do what a person would.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::{Context, bail};

use crate::chip::{Analog, Chip};
use crate::clock::Cause;
use crate::cpu::{Cpu, Outcome};
use crate::image::Image;
use crate::power::Supply;
use crate::rtt::{Line, Probe};
use crate::time::{MS, Ps};

/// The board's supply, V.
const NOMINAL: f64 = 3.3;
/// Ports by number.
const PORT_A: usize = 0;
const PORT_C: usize = 2;

/// A NUCLEO-F411RE with its ST-LINK.
pub struct Board {
    /// Core and chip.
    pub cpu: Cpu,
    /// The debug probe.
    pub probe: Probe,
    /// The image that it runs.
    pub image: Rc<Image>,
    /// The log so far.
    pub log: Vec<Line>,
    /// What the terminal has shown and nobody has taken.
    terminal: String,
    /// Resets so far, with the time of each.
    pub resets: Vec<(Ps, Cause)>,
    /// Whoever runs the board wants to know of a cut supply before power comes back.
    pub power_is_cut: bool,
}

impl Board {
    /// Powers up a board with the interlock closed and the button released.
    ///
    /// # Errors
    /// The image has no log, or the emulator refuses.
    pub fn new(image: Rc<Image>, analog: Box<dyn Analog>) -> anyhow::Result<Self> {
        let mut board = Self {
            cpu: Cpu::new(image.clone(), analog)?,
            probe: Probe::new(image.clone())?,
            image,
            log: Vec::new(),
            terminal: String::new(),
            resets: Vec::new(),
            power_is_cut: false,
        };
        board.interlock(true);
        board.button(false);
        Ok(board)
    }

    /// The time.
    pub fn now(&self) -> Ps {
        self.cpu.now()
    }

    /// The chip.
    pub fn chip(&self) -> &Chip {
        self.cpu.chip()
    }

    /// Runs for a time.
    ///
    /// # Errors
    /// The program did something that is not modelled.
    pub fn run_for(&mut self, time: Ps) -> anyhow::Result<()> {
        let until = self.now() + time;
        self.run_to(until).map(drop)
    }

    /// Runs until a time, or until a watched address is reached, which is returned.
    ///
    /// # Errors
    /// The program did something that is not modelled.
    pub fn run_to(&mut self, until: Ps) -> anyhow::Result<Option<u32>> {
        if self.power_is_cut {
            bail!("the supply is cut: power_cycle() first");
        }
        loop {
            match self.cpu.run(until)? {
                Outcome::Time => {
                    self.collect();
                    return Ok(None);
                }
                Outcome::Watched(address) => return Ok(Some(address)),
                Outcome::Asleep => self.probe.read(&mut self.cpu, &mut self.log)?,
                Outcome::Reset(cause) => {
                    self.resets.push((self.now(), cause));
                    self.probe.restart();
                }
                Outcome::Call(number, _) => {
                    bail!("the program asks a debugger for {number:#x}, and none is here")
                }
                Outcome::PowerCut => {
                    self.power_is_cut = true;
                    return Ok(None);
                }
            }
        }
    }

    /// Runs until something is true, looking each millisecond.
    ///
    /// # Errors
    /// It has not become true in the time given; the end of the log is told.
    pub fn run_until(
        &mut self,
        what: &str,
        time: Ps,
        mut is_true: impl FnMut(&mut Self) -> bool,
    ) -> anyhow::Result<()> {
        let until = self.now() + time;
        while self.now() < until {
            self.run_for(MS)?;
            if is_true(self) {
                return Ok(());
            }
        }
        let tail: Vec<String> = self.log.iter().rev().take(20).rev().map(Line::to_string).collect();
        bail!("not within {} ms: {what}; the log ends with\n{}", time / MS, tail.join("\n"))
    }

    fn collect(&mut self) {
        let sent = self.cpu.touch(|chip, _| chip.usart.take_sent());
        self.terminal += &String::from_utf8_lossy(&sent);
    }

    /// Sends bytes from the terminal.
    pub fn send(&mut self, bytes: &[u8]) {
        self.cpu.touch(|chip, now| chip.usart.receive(bytes, now));
    }

    /// Types a line and waits for the prompt after its answer, which is returned.
    ///
    /// # Errors
    /// There is no prompt within ten seconds.
    pub fn command(&mut self, line: &str) -> anyhow::Result<String> {
        self.take_terminal();
        self.send(format!("{line}\r").as_bytes());
        self.run_until(&format!("an answer to `{line}`"), 10_000 * MS, |board| {
            board.terminal.ends_with("> ") || board.power_is_cut
        })?;
        let text = self.take_terminal();
        let answer = text.split_once("\r\n").map_or("", |(_, answer)| answer);
        Ok(answer.trim_end_matches("> ").replace("\r\n", "\n").trim_end().to_owned())
    }

    /// Takes what the terminal shows.
    pub fn take_terminal(&mut self) -> String {
        self.collect();
        std::mem::take(&mut self.terminal)
    }

    /// Whether the log has a line that contains this text.
    pub fn logged(&self, text: &str) -> bool {
        self.log.iter().any(|line| line.text.contains(text))
    }

    /// Times of the log's lines in s, as the board tells them.
    pub fn log_times(&self) -> Vec<f64> {
        self.log.iter().filter_map(|line| line.timestamp.parse().ok()).collect()
    }

    /// Closes or opens the contact between the break input and ground.
    pub fn interlock(&mut self, closed: bool) {
        self.cpu.touch(|chip, now| chip.wire(PORT_A, 6, closed.then_some(false), now));
    }

    /// Presses or releases the user button, which the board pulls up.
    pub fn button(&mut self, pressed: bool) {
        self.cpu.touch(|chip, now| chip.wire(PORT_C, 13, Some(!pressed), now));
    }

    /// Share of the time that the heater's pin is high.
    pub fn heater(&self) -> f64 {
        self.chip().heater()
    }

    /// Share of the time that the contactor's pin is high.
    pub fn contactor(&self) -> f64 {
        self.chip().contactor()
    }

    /// When the heater's pin has last become low; `None` while it is not.
    pub fn heater_off_since(&self) -> Option<Ps> {
        low_since(&self.chip().heater_log)
    }

    /// The same of the contactor's pin.
    pub fn contactor_open_since(&self) -> Option<Ps> {
        low_since(&self.chip().contactor_log)
    }

    /// Resets the chip from outside.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn reset(&mut self, cause: Cause) -> anyhow::Result<()> {
        self.cpu.reset(cause)?;
        self.probe.restart();
        self.resets.push((self.now(), cause));
        Ok(())
    }

    /// A debugger halts the core for a time, and lets it go on.
    ///
    /// # Errors
    /// A peripheral that runs on did something that is not modelled.
    pub fn halt(&mut self, time: Ps) -> anyhow::Result<()> {
        self.cpu.touch(|chip, now| chip.halt(true, now));
        self.run_for(time)?;
        self.cpu.touch(|chip, now| chip.halt(false, now));
        Ok(())
    }

    /// The supply goes to a voltage within a time, which passes.
    ///
    /// # Errors
    /// The program did something that is not modelled.
    pub fn supply(&mut self, volts: f64, time: Ps) -> anyhow::Result<()> {
        self.cpu.touch(|chip, now| chip.power.supply.ramp(volts, time, now));
        self.run_for(time)
    }

    /// Takes power away and gives it back.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn power_cycle(&mut self) -> anyhow::Result<()> {
        self.power_is_cut = false;
        self.cpu.touch(|chip, _| {
            chip.flash.cut = None;
            chip.power.supply = Supply::steady(NOMINAL);
        });
        self.cpu.power_cycle()?;
        self.probe.restart();
        Ok(())
    }
}

fn low_since(log: &[(Ps, f64)]) -> Option<Ps> {
    log.last().filter(|(_, high)| *high == 0.0).map(|(at, _)| *at)
}

/// The image that VIRTUAL_BOARD_ELF names, or else the one that `cargo fw` has built: beside this program, in the folder
/// of the board's target.
///
/// # Errors
/// It is not there.
pub fn default_image() -> anyhow::Result<PathBuf> {
    if let Some(path) = std::env::var_os("VIRTUAL_BOARD_ELF") {
        return Ok(path.into());
    }
    let this = std::env::current_exe()?;
    let found = this.ancestors().map(|folder| folder.join("thumbv7em-none-eabihf/firmware/firmware"));
    found.into_iter().find(|path| path.is_file()).context(
        "no firmware image found; build it with `cargo fw`, or name one with --elf PATH (tests: VIRTUAL_BOARD_ELF=PATH)",
    )
}

/// Reads the image at a path, or the one that `cargo fw` has built.
///
/// # Errors
/// It is not there, or no image for this board.
pub fn load(path: Option<&Path>) -> anyhow::Result<Rc<Image>> {
    let path = path.map_or_else(default_image, |path| Ok(path.to_owned()))?;
    Image::read(&path).map(Rc::new)
}
