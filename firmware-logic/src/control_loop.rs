//! One tick of the control half on the board: the controller of the core, the interlock around it, and the heater
//! that both act on. No lock, no log, no allocation; nothing in it waits.

use core::fmt;

use fdi_core::control::{Controller, ControllerState};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{AdcCode, Celsius, Command, Feedback, Percent, RawSample, Refusal, Tick};

use crate::cadence::Arrival;
use crate::explain::Explained;
use crate::interlock::{Hold, Interlock};

/// The power output as the loop sees it.
pub trait Heater {
    /// Sets the power; has an effect at the output only while it is enabled.
    fn drive(&mut self, power: Percent);
    /// Enables the output. Without effect while the break input is open.
    fn enable(&mut self);
    /// Disables the output at once.
    fn disable(&mut self);
    /// Whether the output is enabled; hardware may have disabled it.
    fn is_enabled(&self) -> bool;
    /// Whether the break input is open, which means "stop".
    fn break_is_open(&self) -> bool;
    /// What disabled the output, where the loop did not.
    fn cut_by(&self) -> Hold;
}

/// What the other half asks of this one.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "copied once a second at most, into a queue of two")]
pub enum Order {
    /// A command of the user. `Acknowledge` releases the interlock, too.
    Command(Command),
    /// New settings.
    Retune(Controller),
}

/// Why an order was not carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Denial {
    /// The supervisor refused.
    Refused(Refusal),
    /// Something holds the heater off until it is acknowledged.
    Held(Hold),
    /// The interlock on the break input is open.
    BreakOpen,
}

impl fmt::Display for Denial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => Explained(refusal).fmt(f),
            Self::Held(hold) => write!(f, "held off: {hold}; expected `ack` first"),
            Self::BreakOpen => {
                f.write_str("the interlock on the break input is open, expected it closed to ground")
            }
        }
    }
}

/// What became of an order on a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outcome {
    /// The command; `None` for new settings.
    pub command: Option<Command>,
    /// Whether it was carried out.
    pub result: Result<(), Denial>,
}

/// All that one tick of this half tells the other.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beat {
    /// Codes as they came.
    pub raw: RawSample,
    /// What the controller decided.
    pub tick: Tick,
    /// What the heater really gets until the next tick.
    pub applied: Percent,
    /// When the tick began; no sample was taken on a tick that was missed.
    pub arrival: Arrival,
    /// This beat stands for a tick that was missed.
    pub missed: bool,
    /// What holds the heater off.
    pub hold: Option<Hold>,
    /// The order carried out or denied before this tick.
    pub outcome: Option<Outcome>,
}

/// The code of "no sample".
const NO_SAMPLE: RawSample =
    RawSample { t0: AdcCode(f32::NAN), t1: AdcCode(f32::NAN), t2: AdcCode(f32::NAN) };

/// The control half of the instrument on the board.
#[derive(Clone, Debug)]
pub struct ControlLoop {
    controller: Controller,
    state: ControllerState,
    interlock: Interlock,
    /// The loop wants the output enabled: if it is not, something cut it.
    driving: bool,
    applied: Percent,
}

impl ControlLoop {
    /// A loop that is off.
    pub fn new(controller: Controller, setpoint: Celsius, interlock: Interlock) -> Self {
        let state = controller.start(setpoint);
        Self { controller, state, interlock, driving: false, applied: Percent(0.0) }
    }

    /// Hears that the other half has a baseline from an earlier life.
    pub fn restored(&mut self, baseline: &Baseline) {
        self.controller.restored(&mut self.state, baseline);
    }

    /// One tick. `feedback` is what the other half last reported.
    pub fn tick(
        &mut self,
        raw: RawSample,
        arrival: Arrival,
        order: Option<Order>,
        feedback: Feedback,
        heater: &mut impl Heater,
    ) -> Beat {
        self.controller.heard(&mut self.state, feedback);
        // Whoever orders a stop may have disabled the output already, rather than wait for this tick.
        let stopping = matches!(order, Some(Order::Command(Command::Stop)));
        if self.driving && !heater.is_enabled() && !stopping {
            self.interlock.latch(heater.cut_by());
            self.stop(heater);
        }
        let outcome = order.map(|order| self.carry_out(order, heater));
        let tick = self.controller.step(&mut self.state, raw);
        self.actuate(&tick, heater);
        Beat {
            raw,
            tick,
            applied: self.applied,
            arrival,
            missed: false,
            hold: self.interlock.hold(),
            outcome,
        }
    }

    /// A tick that never began: the core sees a sample that is missing, so that its time goes on and a T1 missing for
    /// too long trips. What drove the heater meanwhile is the power of the tick before.
    pub fn missed(&mut self, arrival: Arrival, heater: &mut impl Heater) -> Beat {
        let tick = self.controller.step(&mut self.state, NO_SAMPLE);
        if !tick.mode.is_heating() {
            self.actuate(&tick, heater);
        }
        let applied = if heater.is_enabled() { self.applied } else { Percent(0.0) };
        Beat {
            raw: NO_SAMPLE,
            tick,
            applied,
            arrival,
            missed: true,
            hold: self.interlock.hold(),
            outcome: None,
        }
    }

    fn stop(&mut self, heater: &mut impl Heater) {
        heater.disable();
        self.driving = false;
        self.applied = Percent(0.0);
        // Stop is possible in every mode.
        let _ = self.controller.command(&mut self.state, Command::Stop);
    }

    fn carry_out(&mut self, order: Order, heater: &mut impl Heater) -> Outcome {
        match order {
            Order::Retune(controller) => {
                let result = self.controller.check_retune(&self.state, &controller);
                if result.is_ok() {
                    self.controller = controller;
                }
                Outcome { command: None, result: result.map_err(Denial::Refused) }
            }
            Order::Command(command) => {
                Outcome { command: Some(command), result: self.command(command, heater) }
            }
        }
    }

    fn command(&mut self, command: Command, heater: &mut impl Heater) -> Result<(), Denial> {
        match command {
            Command::Arm => {
                if let Some(hold) = self.interlock.hold() {
                    return Err(Denial::Held(hold));
                }
                if heater.break_is_open() {
                    return Err(Denial::BreakOpen);
                }
            }
            Command::Acknowledge => {
                let released = self.interlock.acknowledge();
                let result = self.controller.command(&mut self.state, command);
                // One acknowledgement serves both latches; without a trip the supervisor has nothing to say.
                let nothing_tripped = matches!(result, Err(Refusal::NotInMode(_)));
                return if released && nothing_tripped { Ok(()) } else { result.map_err(Denial::Refused) };
            }
            Command::Stop => self.stop(heater),
            Command::Relearn | Command::SetPoint(_) | Command::Excite(_) => {}
        }
        self.controller.command(&mut self.state, command).map_err(Denial::Refused)
    }

    /// The heater first gets its power and then its enable, so that an old power never shows.
    fn actuate(&mut self, tick: &Tick, heater: &mut impl Heater) {
        let heat = tick.mode.is_heating();
        if heat {
            heater.drive(tick.drive);
            if !self.driving {
                heater.enable();
            }
        } else {
            heater.disable();
            heater.drive(Percent(0.0));
        }
        self.driving = heat;
        self.applied = if heat && heater.is_enabled() { tick.drive } else { Percent(0.0) };
    }
}
