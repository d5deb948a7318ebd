//! Where most tests begin: a board on the desk with the rig on its wires, at rest or heating.

use std::rc::Rc;

use anyhow::{Context, ensure};
use fdi_core::Config;
use pt326_host::experiment::as_written;
use pt326_host::experiment::scenario::Scenario;
use pt326_rig::Rig;
use pt326_rig::fault::Fault;

use crate::board::Board;
use crate::closed_loop::{Shared, TICK};
use crate::image::Image;
use crate::time::{MS, Ps, SECOND, US};
use crate::wiring::AT_REST;

/// What lets a board arm that has not checked itself.
pub const WAIVE_CHECK: &str = "set supervisor.check_before_arming false";

/// A board and a rig.
pub struct Scene {
    /// The board.
    pub board: Board,
    /// The rig on its wires.
    pub rig: Shared,
}

impl Scene {
    /// Powered up two ticks ago, nothing armed, the rig at ambient temperature.
    ///
    /// # Errors
    /// The program did something that is not modelled.
    pub fn at_rest(image: Rc<Image>) -> anyhow::Result<Self> {
        let mut scene = Self::powered_up(image)?;
        scene.board.run_for(3 * TICK)?;
        Ok(scene)
    }

    /// Powered up at this moment.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn powered_up(image: Rc<Image>) -> anyhow::Result<Self> {
        let rig = Shared::at_rest(AT_REST);
        Ok(Self { board: Board::new(image, Box::new(rig.clone()))?, rig })
    }

    /// Armed five seconds ago, the set-point reached.
    ///
    /// # Errors
    /// The board does not arm.
    pub fn heating(image: Rc<Image>) -> anyhow::Result<Self> {
        Self::heating_with(image, 32_000)
    }

    /// The same, with an oscillator of the watchdog that runs at so many Hz since before it was powered up.
    ///
    /// # Errors
    /// The board does not arm.
    pub fn heating_with(image: Rc<Image>, oscillator: u64) -> anyhow::Result<Self> {
        let mut scene = Self::powered_up(image)?;
        scene.board.cpu.touch(|chip, _| chip.watchdog.oscillator = oscillator);
        scene.board.run_for(3 * TICK)?;
        scene.arm()?;
        scene.board.run_for(5 * SECOND)?;
        ensure!(scene.board.heater() > 0.05, "armed, but the heater is off");
        Ok(scene)
    }

    /// Puts a fresh rig on the wires, without faults, and arms; without a check, which takes a minute.
    ///
    /// # Errors
    /// The board does not arm.
    pub fn arm(&mut self) -> anyhow::Result<()> {
        self.board.command(WAIVE_CHECK)?;
        self.connect(&[]);
        let answer = self.board.command("arm")?;
        ensure!(answer.starts_with("ok"), "the board does not arm: {answer}");
        Ok(())
    }

    /// Puts a fresh rig on the wires.
    pub fn connect(&mut self, faults: &[Fault]) {
        let scenario = Scenario::default();
        let sample_time = as_written(Config::default().sample_time.0);
        let rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, 1, faults);
        self.rig.0.borrow_mut().start(rig);
    }

    /// Breaks or shorts the wire of a thermistor (0 is T0), or has it read a code.
    pub fn wire_sensor(&mut self, sensor: usize, code: u16) {
        self.rig.0.borrow_mut().overrides[sensor] = Some(code);
    }

    /// Runs until the heater's pin is low for good, and with it the contactor's; the time from now until then.
    ///
    /// # Errors
    /// It is not low within `limit`, or does not stay so for as long again.
    pub fn time_until_off(&mut self, limit: Ps) -> anyhow::Result<Ps> {
        let begin = self.board.now();
        self.board.run_for(2 * limit)?;
        let times =
            [("heater", self.board.heater_off_since()), ("contactor", self.board.contactor_open_since())]
                .map(|(pin, off)| {
                    let time = off.with_context(|| {
                        format!("the {pin}'s pin is still high after {} ms", 2 * limit / MS)
                    })?;
                    let time = time.saturating_sub(begin);
                    ensure!(
                        time <= limit,
                        "the {pin}'s pin went low after {} us, expected {} us",
                        time / US,
                        limit / US
                    );
                    Ok(time)
                });
        let [heater, contactor] = times;
        heater.and_then(|time| contactor.map(|_| time))
    }
}
