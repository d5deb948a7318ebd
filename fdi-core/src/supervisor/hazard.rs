//! What would make heating dangerous now: every rule asked on every tick, whatever the mode, the most telling answer first.
//!
//! Each comparison says what is allowed, and trips on everything else: a limit or a value that is no number, since a bit of the
//! memory has flipped, trips.

use super::{Mode, Situation, Supervisor, SupervisorState, Trip, TripReason};
use crate::known::STANDSTILL;
use crate::sense::{Reading, Sample, Validity};
use crate::units::Percent;

impl Supervisor {
    /// What trips, or would if the heater were on.
    pub(super) fn hazard(&self, state: &mut SupervisorState, now: &Situation) -> Option<TripReason> {
        state.lost = if now.regulated.value.is_some() { 0 } else { state.lost.saturating_add(1) };
        let by_models = state.mode != Mode::Off && now.feedback.heater_stuck_on;
        let heating = state.mode.is_heating();
        let account = self.account.step(&mut state.account, now, heating, state.mode != Mode::Tune);
        let unasked = account.unasked || by_models;
        let by_t1 = heating && !now.regulated.is_virtual;
        let named = by_t1 && now.feedback.t1_contradicted;
        state.named = if named { state.named.saturating_add(1) } else { 0 };
        let by_sensors = self.sensor_hazard(state.lost > self.lost_ticks, now);
        let without_air = self.is_without_air(now).then_some(TripReason::AirFlowLost);
        let contradicted = state.named > self.named_ticks;
        by_sensors
            .or(unasked.then_some(TripReason::HeaterStuckOn))
            .or(without_air)
            .or((heating && self.is_short_of_air(now)).then_some(TripReason::AirFlowLost))
            .or(account.heat)
            .or(contradicted.then_some(TripReason::T1Contradicted))
    }

    /// By what was announced of the fan. An announcement only ever takes heat away: no limit is widened for it.
    /// One that stands still is too little whatever `supervisor.min_air_flow` allows.
    fn is_without_air(&self, now: &Situation) -> bool {
        now.known.fan.is_some_and(|level| !(level.0 >= STANDSTILL && level >= self.config.min_air_flow))
    }

    /// By what the thermistors say, each by itself.
    fn sensor_hazard(&self, lost_too_long: bool, now: &Situation) -> Option<TripReason> {
        let (t1, t2) = (now.sample.t1, now.sample.t2);
        if now.regulated.is_virtual {
            return match now.regulated.value {
                None if lost_too_long => Some(TripReason::T1Lost),
                Some(virtual_t1) if !(virtual_t1 <= self.config.over_temperature) => {
                    Some(TripReason::T1OverTemperature)
                }
                _ if self.is_hot(t2) => Some(TripReason::T2OverTemperature),
                _ => None,
            };
        }
        match t1.validity {
            Validity::Open => Some(TripReason::T1Open),
            Validity::Short => Some(TripReason::T1Short),
            Validity::OutOfRange => Some(TripReason::T1OutOfRange),
            _ if self.is_hot(t1) => Some(TripReason::T1OverTemperature),
            _ if self.is_hot(t2) => Some(TripReason::T2OverTemperature),
            Validity::Stuck if lost_too_long => Some(TripReason::T1Stuck),
            Validity::Missing | Validity::Spike | Validity::Rate if lost_too_long => Some(TripReason::T1Lost),
            _ => None,
        }
    }

    /// What is a hazard of one sample by itself, whatever was before: too hot, or a broken or shorted T1 where it is regulated.
    pub fn is_hazardous(&self, sample: &Sample, virtual_t1: bool) -> bool {
        let t1_broken = matches!(sample.t1.validity, Validity::Open | Validity::Short | Validity::OutOfRange);
        self.is_hot(sample.t2) || !virtual_t1 && (t1_broken || self.is_hot(sample.t1))
    }

    /// Hotter than allowed, whatever else is thought of the reading: a jump, or more than is plausible, is hot all the
    /// same, and so is a shorted thermistor. Only where no code came there is nothing to judge.
    fn is_hot(&self, reading: Reading) -> bool {
        reading.validity != Validity::Missing && !(reading.celsius <= self.config.over_temperature)
    }

    /// By the models. A heater that gives more than it is asked for looks like too little air.
    fn is_short_of_air(&self, now: &Situation) -> bool {
        let air_flow = now.feedback.air_flow.filter(|_| !now.feedback.heater_faulty);
        air_flow.is_some_and(|flow| !(flow >= self.config.min_air_flow))
    }

    /// The record of a trip. Out of line: it is long, and made once.
    #[cold]
    pub(super) fn trip(&self, reason: TripReason, state: &SupervisorState, now: &Situation) -> Trip {
        Trip {
            reason,
            tick: now.tick,
            raw: now.raw,
            sample: *now.sample,
            setpoint: now.setpoint,
            limit: self.config.over_temperature,
            power: Percent(state.account.mean_power()),
            needed: state.account.power_for(now.setpoint).map(Percent),
        }
    }
}
