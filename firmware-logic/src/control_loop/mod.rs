//! One tick of the control half on the board: the controller of the core, the interlock around it, and the heater
//! that both act on. No lock, no log, no allocation; nothing in it waits.

#[cfg(test)]
mod explored;
mod heater;
mod order;
mod record;
#[cfg(test)]
mod tests;

use fdi_core::control::{Controller, ControllerState};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{AdcCode, Celsius, Command, Feedback, Mode, Percent, RawSample, Refusal, Tick};

use crate::cadence::Arrival;
use crate::doubled::Doubled;
use crate::interlock::{Interlock, Lockout};
use crate::self_test::{Ending, Output, Proof, SelfTest};

pub use heater::Heater;
pub use order::{Denial, Order, OrderKind, Outcome, next_order};
pub use record::TickRecord;

/// The code of "no sample".
pub const NO_SAMPLE: RawSample = {
    const NONE: AdcCode = AdcCode(f32::NAN);
    RawSample { t0: NONE, t1: NONE, t2: NONE, supply: NONE }
};

/// What an order has permitted: nothing, to regulate or to tune, or to check. Sixteen bits apart.
const NOTHING: Doubled = Doubled::new(0);
const REGULATE: Doubled = Doubled::new(0x5555_AAAA);
const CHECK: Doubled = Doubled::new(0x3333_CCCC);
const PASSED: Doubled = Doubled::new(u32::MAX);

/// The control half of the instrument on the board.
#[derive(Clone, Debug)]
pub struct ControlLoop {
    controller: Controller,
    /// What [`Self::controller`] was when its settings had been checked.
    checked_controller: Controller,
    state: ControllerState,
    interlock: Interlock,
    /// Only an order gives it; without it nothing is driven, whatever the mode is or a check wants.
    permit: Doubled,
    /// The loop wants the output enabled: if it is not, something cut it.
    driving: bool,
    applied: Percent,
    /// The self-test, until all of it has been reported.
    check: Option<SelfTest>,
    /// Whether it has passed.
    checked: Doubled,
    /// The gain that it has measured, which the controller is to be told.
    measured_gain: Option<f32>,
    /// The interlock's contact has kept the output off, or cut it.
    seen_to_cut: bool,
    /// Dangerous codes that were seen since the last tick.
    hazard: Option<RawSample>,
}

impl ControlLoop {
    /// A loop that is off.
    pub fn new(controller: Controller, setpoint: Celsius, interlock: Interlock) -> Self {
        let state = controller.start(setpoint);
        Self {
            checked_controller: controller,
            controller,
            state,
            interlock,
            permit: NOTHING,
            driving: false,
            applied: Percent(0.0),
            check: None,
            checked: NOTHING,
            measured_gain: None,
            seen_to_cut: false,
            hazard: None,
        }
    }

    /// A baseline was restored: there is no need to learn one.
    pub fn restored(&mut self, baseline: &Baseline) {
        self.controller.restored(&mut self.state, baseline);
    }

    /// A look at the rig between two ticks: what is dangerous by itself takes the power and opens the contactor at once, and is what
    /// the next tick sees.
    pub fn look(&mut self, raw: RawSample, heater: &mut impl Heater) {
        let must_cut = || !self.is_intact() || self.controller.must_cut(&self.state, raw);
        if self.driving && self.hazard.is_none() && must_cut() {
            heater.drive(Percent(0.0));
            heater.contactor(false);
            self.hazard = Some(raw);
        }
    }

    /// Something that the loop does not see by itself keeps the heater off from now on, or lets it not come on: it is latched, and both
    /// outputs are off at once.
    pub fn lock_out(&mut self, lockout: Lockout, heater: &mut impl Heater) {
        self.interlock.latch(lockout);
        self.stop(Ending::Cut, heater);
    }

    /// One tick. `feedback` is what the other half last reported.
    pub fn tick(
        &mut self,
        raw: RawSample,
        arrival: Arrival,
        order: Option<Order>,
        feedback: Feedback,
        heater: &mut impl Heater,
    ) -> TickRecord {
        let raw = self.hazard.take().unwrap_or(raw);
        self.controller.feed_back(&mut self.state, feedback);
        // Whoever orders a stop may have disabled the output already, rather than wait for this tick.
        let stopping = matches!(order, Some(Order::Command(Command::Stop)));
        if self.driving && !heater.is_enabled() && !stopping {
            let lockout = heater.cut_by();
            self.seen_to_cut |= lockout == Lockout::BreakInput;
            self.lock_out(lockout, heater);
        }
        let damaged = feedback.settings_damaged || !self.is_intact();
        if damaged {
            self.interlock.latch(Lockout::Settings);
            self.stop(Ending::Settings, heater);
        }
        // An order of its own, so that a replay of the log knows of it.
        let order =
            order.or_else(|| self.measured_gain.take().map(|gain| Order::Command(Command::Gain(gain))));
        let outcome = order.map(|order| self.carry_out(order, damaged, heater));
        let tick = self.controller.step(&mut self.state, raw);
        match self.permitted(&tick, raw) {
            Some(output) => self.actuate(output, heater),
            None => self.lock_out(Lockout::Memory, heater),
        }
        self.record(raw, tick, arrival, outcome)
    }

    /// A tick that never began: the core sees a sample that is missing, so that its time goes on and a T1 missing for
    /// too long trips. What drove the heater meanwhile is the power of the tick before.
    pub fn missed(&mut self, arrival: Arrival, heater: &mut impl Heater) -> TickRecord {
        let tick = self.controller.step(&mut self.state, NO_SAMPLE);
        if !tick.mode.is_heating() {
            self.stop(Ending::MissedTick, heater);
        }
        let applied = if heater.is_enabled() { self.applied } else { Percent(0.0) };
        TickRecord { applied, missed: true, ..self.record(NO_SAMPLE, tick, arrival, None) }
    }

    fn record(
        &mut self,
        raw: RawSample,
        tick: Tick,
        arrival: Arrival,
        outcome: Option<Outcome>,
    ) -> TickRecord {
        let news = self.check.as_mut().and_then(SelfTest::news);
        if self.check.as_ref().is_some_and(SelfTest::is_reported) {
            self.check = None;
        }
        TickRecord {
            arrival,
            lockout: self.interlock.lockout(),
            outcome,
            news,
            checked: self.has_passed(),
            ..TickRecord::new(raw, tick, self.applied)
        }
    }

    fn stop(&mut self, ending: Ending, heater: &mut impl Heater) {
        self.permit = NOTHING;
        self.actuate(Output::Off, heater);
        if let Some(check) = &mut self.check {
            check.abort(ending);
        }
        // Stop is possible in every mode.
        let _ = self.controller.command(&mut self.state, Command::Stop);
    }

    /// Whether limits and all else that the settings have given are those that were checked.
    fn is_intact(&self) -> bool {
        self.controller == self.checked_controller
    }

    /// Settings that are `damaged` can be mended by a reset alone: whatever is ordered before it would go by them, or would
    /// put what is left of them in force.
    fn carry_out(&mut self, order: Order, damaged: bool, heater: &mut impl Heater) -> Outcome {
        let kind = order.kind();
        let result = match order {
            _ if damaged && kind != OrderKind::Command(Command::Stop) => {
                Err(Denial::LockedOut(Lockout::Settings))
            }
            Order::Retune(controller) => {
                let result = self.controller.retune(&mut self.state, controller);
                if result.is_ok() {
                    self.checked_controller = self.controller;
                    if let Some(check) = &mut self.check {
                        check.abort(Ending::Settings);
                    }
                }
                result.map_err(Denial::Refused)
            }
            Order::Command(command) => self.command(command, heater),
            Order::Check => self.begin_check(heater),
        };
        Outcome { order: kind, result }
    }

    fn has_passed(&self) -> bool {
        self.checked == PASSED
    }

    fn is_checking(&self) -> bool {
        self.check.as_ref().is_some_and(|check| check.ending().is_none())
    }

    /// Begins the self-test, with the proof that the interlock cuts; neither power nor contactor take part in that.
    fn begin_check(&mut self, heater: &mut impl Heater) -> Result<(), Denial> {
        let mode = self.controller.mode(&self.state);
        if self.check.is_some() {
            return Err(Denial::Checking);
        }
        if *mode != Mode::Off {
            return Err(Denial::Refused(Refusal::NotInMode(mode.name())));
        }
        if let Some(lockout) = self.interlock.lockout() {
            return Err(Denial::LockedOut(lockout));
        }
        self.actuate(Output::Off, heater);
        let proof = if heater.break_is_open() {
            heater.enable();
            if heater.is_enabled() { Proof::OpenButEnabled } else { Proof::OpenHolds }
        } else if heater.test_break() {
            Proof::Cuts { seen: self.seen_to_cut }
        } else {
            Proof::DoesNotCut
        };
        heater.disable();
        self.seen_to_cut |= proof == Proof::OpenHolds;
        // Its first step, in this tick, takes the old pass away.
        self.check = Some(SelfTest::new(proof, &self.controller.plant()));
        self.permit = CHECK;
        Ok(())
    }

    fn command(&mut self, command: Command, heater: &mut impl Heater) -> Result<(), Denial> {
        match command {
            Command::Arm | Command::Tune => {
                if let Some(lockout) = self.interlock.lockout() {
                    return Err(Denial::LockedOut(lockout));
                }
                if heater.break_is_open() {
                    return Err(Denial::BreakOpen);
                }
                if self.is_checking() {
                    return Err(Denial::Checking);
                }
                if self.controller.checks_before_arming() && !self.has_passed() {
                    return Err(Denial::Unchecked);
                }
            }
            Command::Acknowledge => {
                let released = self.interlock.acknowledge();
                let result = self.controller.command(&mut self.state, command);
                // One acknowledgement serves both latches; without a trip the supervisor has nothing to say.
                let nothing_tripped = matches!(result, Err(Refusal::NotInMode(_)));
                return if released && nothing_tripped { Ok(()) } else { result.map_err(Denial::Refused) };
            }
            Command::Stop => self.stop(Ending::Stopped, heater),
            Command::Relearn
            | Command::Gain(_)
            | Command::SetPoint(_)
            | Command::Excite(_)
            | Command::Fan(_)
            | Command::Shelve(_) => {}
        }
        self.controller.command(&mut self.state, command).map_err(Denial::Refused)?;
        if command.heats() {
            self.permit = REGULATE;
        }
        Ok(())
    }

    /// What the output is to be until the next tick: the controller's drive, or the self-test's. `None` for either where no order
    /// has permitted it, or something is latched: then a bit has flipped in the memory.
    fn permitted(&mut self, tick: &Tick, raw: RawSample) -> Option<Output> {
        let needed = match (tick.mode.is_heating(), self.is_checking()) {
            (true, _) => REGULATE,
            (_, true) => CHECK,
            _ => {
                self.permit = NOTHING;
                return Some(Output::Off);
            }
        };
        if self.permit != needed || self.interlock.lockout().is_some() {
            self.check = None;
            return None;
        }
        let Some(check) = self.check.as_mut().filter(|_| needed == CHECK) else {
            return Some(Output::On { power: tick.drive, contactor: true });
        };
        let output = check.step(&tick.sample, &raw, self.controller.hazard(&self.state));
        self.measured_gain = check.measured_gain();
        self.checked = if self.measured_gain.is_some() { PASSED } else { NOTHING };
        Some(output)
    }

    /// The output first gets its power and then its enable, so that an old power never shows.
    fn actuate(&mut self, output: Output, heater: &mut impl Heater) {
        let Output::On { power, contactor } = output else {
            heater.disable();
            heater.contactor(false);
            heater.drive(Percent(0.0));
            (self.driving, self.applied) = (false, Percent(0.0));
            return;
        };
        heater.drive(power);
        heater.contactor(contactor);
        if !self.driving {
            heater.enable();
        }
        self.driving = true;
        self.applied = if heater.is_enabled() && contactor { power } else { Percent(0.0) };
    }
}
