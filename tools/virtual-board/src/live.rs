//! The board against the wall clock: its serial port is a pseudo-terminal, and what a person does at the desk comes line by line.

use std::rc::Rc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use pt326::commands::console::Defect;
use pt326::commands::console::play::Play;

use crate::clock::Cause;
use crate::image::Image;
use crate::port::Port;
use crate::scene::Scene;
use crate::time::{MS, Ps, SECOND};

/// What a person can do, beside the plays of `pt326 console`.
pub const HELP: &str = "\
fault VERB [tN] [SIZE] [SECONDS]   something happens to the rig, such as: fault offset t2 1.5 25
wire WRONG | wire ok               wires a thermistor wrongly, or mends it all; as in `pt326 console`
interlock open | closed            the contact on the break input
button down | up                   the blue button
heater                             says what the heater is given, in %
reset | power                      the black button; power off and on
unplug | plug                      the USB cable, while the board has power from elsewhere
quit";

/// Longest time between two looks at the port: a byte waits no longer.
const SLICE: Ps = 2 * MS;

/// A board that lives while time passes.
pub struct Live {
    /// Board and rig.
    pub scene: Scene,
    port: Port,
    speed: f64,
    begin: Instant,
    from: Ps,
}

impl Live {
    /// Powers it up, a rig at rest on its wires; time passes `speed` times as fast as on the wall.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn new(image: Rc<Image>, port: Port, speed: f64) -> anyhow::Result<Self> {
        let mut scene = Scene::powered_up(image)?;
        scene.connect(&[]);
        Ok(Self { scene, port, speed, begin: Instant::now(), from: 0 })
    }

    /// Lives on until a line says `quit`. Every other line is one of [`HELP`]; what is wrong with it goes to `tell`.
    ///
    /// # Errors
    /// The program did something that is not modelled, or the port fails.
    pub fn run(&mut self, lines: &Receiver<String>, mut tell: impl FnMut(&str)) -> anyhow::Result<()> {
        (self.begin, self.from) = (Instant::now(), self.scene.board.now());
        loop {
            self.catch_up(&mut tell)?;
            match lines.recv_timeout(Duration::from_millis(1)) {
                Ok(line) if line.trim() == "quit" => return Ok(()),
                Ok(line) => {
                    if let Err(error) = self.act(&line, &mut tell) {
                        tell(&format!("error: {error:#}"));
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => std::thread::sleep(Duration::from_millis(1)),
            }
        }
    }

    /// Runs up to the present.
    fn catch_up(&mut self, tell: &mut impl FnMut(&str)) -> anyhow::Result<()> {
        let passed = (self.begin.elapsed().as_secs_f64() * self.speed * SECOND as f64) as Ps;
        let due = self.from + passed;
        let behind = due.saturating_sub(self.scene.board.now());
        if behind > (self.speed.max(1.0) * SECOND as f64) as Ps {
            tell("this machine is too slow for that: time is lost");
            (self.begin, self.from) = (Instant::now(), self.scene.board.now());
            return Ok(());
        }
        while self.scene.board.now() < due {
            let board = &mut self.scene.board;
            board.send(&self.port.receive()?);
            board.run_to(due.min(board.now() + SLICE))?;
            self.port.send(board.take_terminal().as_bytes());
            board.log.clear();
        }
        Ok(())
    }

    fn act(&mut self, line: &str, tell: &mut impl FnMut(&str)) -> anyhow::Result<()> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let board = &mut self.scene.board;
        match words[..] {
            [] => {}
            ["interlock", "open"] => board.interlock(false),
            ["interlock", "closed"] => board.interlock(true),
            ["button", "down"] => board.button(true),
            ["button", "up"] => board.button(false),
            ["heater"] => tell(&format!("heater {}", 100.0 * board.heater())),
            ["reset"] => board.reset(Cause::Pin)?,
            ["power"] => board.power_cycle()?,
            ["plug"] => self.port.plug()?,
            ["unplug"] => self.port.unplug(),
            _ => self.play(line)?,
        }
        Ok(())
    }

    fn play(&mut self, line: &str) -> anyhow::Result<()> {
        let play =
            Play::parse(line)?.with_context(|| format!("\"{line}\" given, expected one of\n{HELP}"))?;
        let mut wires = self.scene.rig.0.borrow_mut();
        let Some(rig) = wires.rig() else { bail!("there is no rig") };
        match play {
            Play::Rig(faults) => faults.into_iter().for_each(|fault| rig.inject(fault)),
            Play::Mend => {
                rig.clear();
                self.scene.board.interlock(true);
            }
            Play::Power(Defect::InterlockOpen) => self.scene.board.interlock(false),
            Play::Power(_) | Play::Wait(_) => bail!("not on this board; expected one of\n{HELP}"),
        }
        Ok(())
    }
}
