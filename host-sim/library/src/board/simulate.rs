//! The simulated rig beside a board that takes its codes from the port: what the board gives to its heater drives the rig, and what the
//! rig's thermistors read is what the board's next tick sees.

use std::sync::{Arc, Mutex, PoisonError};

use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::stream::codes::Codes;
use pt326_rig::Rig;

use crate::experiment::sample;

/// A rig that answers the lines of a board's stream.
#[derive(Clone)]
pub struct SimulatedRig(Arc<Mutex<State>>);

struct State {
    rig: Rig,
    /// What was sent for the tick that is due.
    sent: Option<Codes>,
    unseen: u32,
}

impl SimulatedRig {
    /// A rig whose time begins with the board's tick 0.
    pub fn new(rig: Rig) -> Self {
        Self(Arc::new(Mutex::new(State { rig, sent: None, unseen: 0 })))
    }

    /// Does something to the rig.
    pub fn touch<T>(&self, change: impl FnOnce(&mut Rig) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).rig)
    }

    /// Ticks for which codes were sent that the board did not see: they came too late.
    pub fn unseen(&self) -> u32 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).unseen
    }

    /// What the board is to be sent after a line of its stream.
    pub fn answer(&self, line: &str) -> Option<Codes> {
        let state = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match LogLine::find(line) {
            Ok(Some(LogLine::Start { .. })) => state.send(0),
            Ok(Some(LogLine::Tick(tick))) => {
                state.follow(&tick);
                state.send(tick.tick().wrapping_add(1))
            }
            _ => None,
        }
    }
}

impl State {
    /// The rig lives through a tick.
    fn follow(&mut self, tick: &TickLine) {
        if let Some(sent) = self.sent
            && !(sent.tick == tick.tick() && bits(&sent) == bits(&Codes { tick: sent.tick, raw: tick.raw() }))
        {
            self.unseen += 1;
        }
        self.rig.advance(f64::from(tick.applied().0));
    }

    fn send(&mut self, tick: u32) -> Option<Codes> {
        self.sent = Some(Codes { tick, raw: sample(&mut self.rig) });
        self.sent
    }
}

/// A code that is missing equals itself.
fn bits(codes: &Codes) -> [u32; 3] {
    [codes.raw.t0, codes.raw.t1, codes.raw.t2].map(|code| code.0.to_bits())
}

#[cfg(test)]
mod tests {
    use fdi_core::schema::WORDS;
    use fdi_core::{AdcCode, RawSample};
    use pt326_rig::{Disturbance, RigConfig};

    use super::*;

    fn rig() -> SimulatedRig {
        SimulatedRig::new(Rig::new(&RigConfig::default(), Disturbance::Calm, 0.11, 1, &[]))
    }

    /// A record of a tick that saw these codes and gave this power.
    fn record(tick: u32, raw: RawSample, applied: f32) -> String {
        let mut words = [0; WORDS];
        words[0] = tick;
        let codes = [raw.t0, raw.t1, raw.t2].map(|code: AdcCode| code.0.to_bits());
        words[2..5].copy_from_slice(&codes);
        words[9] = applied.to_bits();
        TickLine(words).to_string()
    }

    #[test]
    fn each_tick_is_answered_with_the_codes_of_the_next_and_power_warms() {
        let rig = rig();
        let mut codes = rig.answer("log format 5").expect("codes");
        let cold = codes.raw.t1.0;
        for k in 0..100 {
            assert_eq!(codes.tick, k);
            codes = rig.answer(&record(k, codes.raw, 50.0)).expect("codes");
        }
        assert!(codes.raw.t1.0 < cold - 100.0, "{} after {cold}", codes.raw.t1.0);
        assert_eq!(rig.unseen(), 0);
        assert_eq!(rig.answer("mode 3 off -> settle"), None);
    }

    #[test]
    fn codes_that_came_too_late_are_counted() {
        let rig = rig();
        let codes = rig.answer("log format 5").expect("codes");
        let nothing =
            RawSample { t0: AdcCode(f32::NAN), t1: AdcCode(f32::NAN), t2: AdcCode(f32::NAN), ..codes.raw };
        rig.answer(&record(0, nothing, 0.0));
        assert_eq!(rig.unseen(), 1);
    }
}
