//! What each cycle of a check says, and what comes next.

use fdi_core::TripReason;

use super::answers::Answers;
use super::lock_in::{Answer, Noise};
use super::{
    CALM_CYCLES, CLOSED_TICKS, CheckFinding, LEVELS, MAX_DOUBTS, MOST_CYCLES, ORDER_CYCLES, STILL, SelfTest,
    Stage, WAITING_CYCLES, rest,
};

impl SelfTest {
    /// A cycle is over: what does it say, and what comes next?
    pub(super) fn end_cycle(&mut self, hazard: Option<TripReason>) {
        self.cycles += 1;
        match self.stage {
            Stage::Rest | Stage::Cooling => self.end_rest(hazard),
            Stage::MosfetOff => self.end_mosfet_off(),
            Stage::Pulses => self.end_pulse(),
            Stage::Order => self.end_order(),
            Stage::Settle => self.enter(Stage::ContactorOpen),
            Stage::ContactorOpen => self.end_contactor_open(),
            Stage::Over => {}
        }
    }

    fn end_rest(&mut self, hazard: Option<TripReason>) {
        for ((resting, cycle), start) in self.resting.iter_mut().zip(&self.cycle).zip(&mut self.start) {
            resting.end_cycle(*start + cycle.mean());
        }
        if rest::broken(&self.resting, MAX_DOUBTS * self.step_ticks, &mut self.findings) {
            return self.end();
        }
        self.waited += 1;
        let wait = self.waited > 1 && rest::is_worth_waiting(&self.resting);
        if wait && self.waited < WAITING_CYCLES {
            self.noises = [Noise::default(); 3];
            self.enter(Stage::Cooling);
        } else {
            self.noises.iter_mut().zip(&self.cycle).for_each(|(noise, cycle)| noise.add(cycle));
            if self.cycles >= CALM_CYCLES {
                return self.begin_heating(hazard);
            }
        }
        for (resting, start) in self.resting.iter_mut().zip(&mut self.start) {
            resting.begin_cycle();
            *start = resting.mean;
        }
    }

    fn begin_heating(&mut self, hazard: Option<TripReason>) {
        rest::judge(&self.resting, &mut self.findings);
        if let Some(reason) = hazard
            && self.findings.iter().all(CheckFinding::is_note)
        {
            let _ = self.findings.push(CheckFinding::Hazard(reason));
        }
        if !self.findings.iter().all(CheckFinding::is_note) {
            return self.end();
        }
        self.start = self.resting.map(|resting| resting.mean);
        self.enter(Stage::MosfetOff);
    }

    /// The answers to the cycle that has just ended.
    fn measure_cycle(&mut self) {
        self.answers = self.cycle.map(|cycle| Answer::of(&cycle));
    }

    fn answers(&self) -> Answers<'_> {
        let moves = self.codes.map(|(low, high)| high - low > STILL);
        Answers { answers: &self.answers, noises: &self.noises, moves }
    }

    fn end_mosfet_off(&mut self) {
        self.measure_cycle();
        if self.answers().any() {
            return self.fail(CheckFinding::MosfetShorted);
        }
        self.noises.iter_mut().zip(&self.cycle).for_each(|(noise, cycle)| noise.add(cycle));
        if self.cycles as usize >= CLOSED_TICKS.len() {
            self.enter(Stage::Pulses);
        }
    }

    fn end_pulse(&mut self) {
        self.measure_cycle();
        if self.answers().any() || self.level + 1 >= LEVELS.len() {
            self.answers = [Answer::default(); 3];
            self.enter(Stage::Order);
        } else {
            self.level += 1;
        }
    }

    fn end_order(&mut self) {
        self.answers.iter_mut().zip(&self.cycle).for_each(|(answer, cycle)| answer.add(cycle));
        if self.cycles < ORDER_CYCLES {
            return;
        }
        if !self.answers().is_loud() {
            if self.level + 1 < LEVELS.len() {
                self.level += 1;
                self.answers = [Answer::default(); 3];
                return self.enter(Stage::Order);
            }
            if self.cycles < MOST_CYCLES {
                return;
            }
        }
        match self.answers().judge() {
            Some(finding) if !finding.is_note() => self.fail(finding),
            note => {
                if let Some(note) = note {
                    let _ = self.findings.push(note);
                }
                self.judged_cycles = self.cycles;
                // Over whole cycles the mean of the power, half of a pulse, shows as a mean, however slow the rig is; and the room may have moved.
                let [room, air, _] = &self.answers;
                self.measured_gain = 2.0 * (air.mean() - room.mean()) / self.pulse();
                self.answers = [Answer::default(); 3];
                self.enter(Stage::Settle);
            }
        }
    }

    fn end_contactor_open(&mut self) {
        self.answers.iter_mut().zip(&self.cycle).for_each(|(answer, cycle)| answer.add(cycle));
        if self.answers().any() {
            let _ = self.findings.push(CheckFinding::NoContactor);
            self.end();
        } else if self.cycles >= self.judged_cycles {
            self.end();
        }
    }
}
