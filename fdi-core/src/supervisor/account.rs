//! One account of the heat: what the heater was given must show as warmth of the air, no less and no more than the rig's gain lets expect.
//!
//! **Example.** T1 is at its set-point of 35 degC in a room of 22 degC, at 43 % of power: the rig gives 0.3 degC for each per cent. T1 and T2 slip
//! out of the tube. They fall, and the controller asks for full power, which is 30 degC. 10 of them may be missing, and T1 shows none. When the other
//! 20 have been missing for half of a time constant, a quarter of an answer time, it trips: after 1 to 2 s.
//!
//! ```text
//! (1)  owed    += max(power * least_gain - MARGIN,  power * gain - max(LIMIT, MISSING * warmth)) - warmth
//! (2)  surplus += warmth - MARGIN - power * most_gain * ratio_of_air
//! ```
//!
//! Either trips above `LIMIT`. Both are in degC times time constants, and never below 0: a lack of 5 degC trips after two time constants, one of 20
//! degC after a half. What one sample adds is smoothed by the filter of the warmth. `warmth` is T1 above the cold rig. (1) says that T1 is out of the tube, or
//! nothing heats; (2) that there is too little air, or heat that nobody asked for.
//!
//! * `least_gain` is a third of what is declared.
//! * `gain` is what was learnt; before that the most that T1 has shown, which fades; and never less than what the check has measured.
//! * `most_gain` is what was learnt; before that the least that T1 has shown; and no more than one and a half times what the check has measured.
//!
//! What does not trip by (1) for ever bounds the true air, where `gain` is the true one: it is above the room by no more than
//! `warmth + max(LIMIT, MISSING * warmth)`. At a set-point of 65 degC in a room of 22 degC that is 65 + 21.5 = 87 degC. Where `gain` is too low by a
//! factor, because both thermistors were out before a check or any warmth had shown it, so is that bound; then only full power without a rise
//! (`REACH`), or heat that reaches T1 or T2 after all, ends it.

mod memory;

use super::config::SupervisorConfig;
use super::{Situation, TripReason};
use crate::bounds::{larger, smaller};
use crate::diagnosis::baseline::{Baseline, Statistics};
use crate::diagnosis::residual::Residual;
use crate::filter::LowPass;
use crate::identify::config::IdentificationConfig;
use crate::sense::{Reading, Sample, Validity};
use crate::units::{Celsius, Percent, Seconds};

/// So much power on average is harmless, wherever it goes, %: less than the usual set-points need. On the rig that is stronger than the reference
/// rig by 3.3 it makes the air 20 degC warmer.
pub(crate) const HARMLESS: f32 = 20.0;
/// What noise, turbulence and a room that moves may make of a warmth, degC; of the difference of two readings at rest, what `check` allows.
const MARGIN: f32 = 2.0;
const AT_REST: f32 = 3.0;
/// The plant's declaration may be wrong by this factor; and no settings ask for less than this gain, degC per %.
const NOMINAL_RATIO: f32 = 3.0;
const LEAST_GAIN: f32 = 0.09;
/// The limit of both sums, degC times time constants. Chosen: the over-temperature is 10 degC above the highest set-point by default. By (1) as many degC may
/// be missing.
const LIMIT: f32 = 10.0;
/// This share of what T1 shows may be missing where that is more. Chosen: a fan stronger by half takes no more. A check may have measured too little of the
/// gain by the same share, and by what little air is allowed (at worst 0.62 of it, measured on the simulated rigs).
const MISSING: f32 = 0.5;
/// Time constants of the means of power and warmth, in answer times. The first two are chosen: with 0.25 for the second a rig that is sixteen times slower than
/// declared trips, with it none of the rigs of the campaigns does. The third is how long a rig takes to be steady, and how long T1 may be named out of the tube, or standing still, before that trips.
const QUICK: f32 = 0.125;
const SLOW: f32 = 0.375;
pub(super) const SETTLED: f32 = 4.0;
/// An answer time above this counts as this, s; no name is waited for longer.
pub(super) const LONGEST_ANSWER: f32 = 300.0;
/// What was seen of the gain fades over so many time constants of heating, and is seen only where the power is above this, %.
const FADES: f32 = 2400.0;
const SHOWS: f32 = 8.0;
/// Full power, in answer times, with T1 below the set-point by this, degC, is a set-point out of reach. By then the rig has long been steady.
const REACH: f32 = 8.0;
const FULL: f32 = 0.9;
/// `supervisor.min_air_flow` within these, %: the account does not tell less from none, nor more from noise.
const LEAST_AIR: (f32, f32) = (1.0, 65.0);
/// Less than this on average is no power, %. Without any, warmth below this is none, degC, and it must lose this share in every `cooling_time`.
const NO_POWER: f32 = 0.5;
const WARM: f32 = 8.0;
const LOSS: f32 = 0.1;
/// A room is no warmer than this, degC, grows warmer by 1 degC a minute at most, and while the rig heats is followed by 6 degC an hour, only while T1 is as
/// warm above T0 as the power makes it within a factor.
const HOTTEST_ROOM: f32 = 45.0;
const ROOM_RATE: f32 = 1.0 / 60.0;
const HEATED_RATE: f32 = 6.0 / 3600.0;
const CONSISTENT: f32 = 1.25;
/// Samples from which a cold rig is told: one of them may be as wrong as it likes.
const SAMPLES: usize = 5;

/// The rules, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Account {
    /// What gain a rig may have at least, and at most, degC per %.
    least_gain: f32,
    most_gain: f32,
    /// How much more the power gives at the least air.
    ratio_of_air: f32,
    full: f32,
    /// A tick in time constants, each a quarter of an answer time; ticks of full power.
    tick: f32,
    reach_ticks: f32,
    /// Share of what may be left that goes in a tick.
    loss: f32,
    room_step: f32,
    heated_step: f32,
    quick: LowPass,
    slow: LowPass,
    settled: LowPass,
    disagreement: f32,
    disagreement_ticks: u32,
    t1_before: LowPass,
}

/// The rig in regulation, as it was learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Learnt {
    /// Rise of T1 over the room for each per cent of power, degC per %; 0 where that is not known.
    pub(super) gain: f32,
    /// The same of T2.
    pub(super) t2_gain: f32,
    /// T1 above T2, degC.
    pub(super) t1_over_t2: f32,
}

impl Learnt {
    /// T1 above T2, degC: as it was, or in a colder rig, where T2 is above the room by this `warmth`, as much less.
    fn t1_over_t2(&self, warmth: f32) -> f32 {
        let known = self.gain > 0.0 && self.t2_gain > 0.0;
        let share = if known { self.gain / self.t2_gain - 1.0 } else { 0.0 };
        smaller(self.t1_over_t2, share * warmth)
    }
}

/// The memory. Temperatures in degC, power in %.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AccountState {
    /// The cold rig; the last samples of it.
    pub(super) cold: Option<f32>,
    /// By so much a room may have become warmer since the last tick at rest.
    room_rise: f32,
    recent: [f32; SAMPLES],
    samples: usize,
    /// T0, T1 and T2, those that are good.
    pub(super) readings: [Option<f32>; 3],
    /// T1 above `cold`, averaged, and T2.
    warmth: [f32; 2],
    /// Power for each share of the nominal air, %: its quick mean, the slow mean of that, and its settled mean.
    power: [f32; 3],
    /// Bounds of the gain as seen; 0 for not yet.
    seen: (f32, f32),
    /// The gain that a check has measured, degC per %; 0 for none.
    pub(super) checked: f32,
    owed: f32,
    surplus: f32,
    /// Ticks of full power without a rise, and T1's warmth when they began.
    full: f32,
    full_from: f32,
    /// Warmth that may be left of heat that was asked for, and whether it heated on the tick before.
    left: f32,
    was_heating: bool,
    t1_before: Option<f32>,
    disagreeing: u32,
    /// Power, T1 and T2 over the samples that belong to the baseline.
    sums: Statistics<3>,
    pub(super) learnt: Option<Learnt>,
}

/// What the account says.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Verdict {
    /// Heat unasked, in any mode.
    pub(super) unasked: bool,
    /// While it heats.
    pub(super) heat: Option<TripReason>,
}

impl Account {
    pub(super) fn new(
        c: &SupervisorConfig,
        identification: &IdentificationConfig,
        output_max: Percent,
        ts: Seconds,
    ) -> Self {
        let answer = smaller(identification.answer_time.0, LONGEST_ANSWER);
        let nominal = identification.y_scale.0 / identification.u_scale.0;
        let ts = ts.0;
        Self {
            least_gain: larger(LEAST_GAIN, nominal / NOMINAL_RATIO),
            most_gain: nominal * NOMINAL_RATIO,
            ratio_of_air: 100.0 / larger(smaller(c.min_air_flow.0, LEAST_AIR.1), LEAST_AIR.0),
            full: FULL * output_max.0,
            tick: 4.0 * ts / answer,
            reach_ticks: REACH * answer / ts,
            loss: smaller(1.0, LOSS * ts / c.cooling_time.0),
            room_step: ROOM_RATE * ts,
            heated_step: HEATED_RATE * ts,
            // Over two samples at least: power that comes and goes from one to the next is its mean.
            quick: LowPass::euler(larger(QUICK * answer, 2.0 * ts), ts),
            slow: LowPass::euler(larger(SLOW * answer, 2.0 * ts), ts),
            settled: LowPass::euler(SETTLED * answer, ts),
            disagreement: c.max_disagreement.0,
            disagreement_ticks: c.disagreement_time.ticks(Seconds(ts)),
            t1_before: LowPass::euler(c.disagreement_time.0, ts),
        }
    }

    /// One tick; `regulates` where it heats towards a set-point, and not as an experiment.
    pub(super) fn step(
        &self,
        state: &mut AccountState,
        now: &Situation,
        heating: bool,
        regulates: bool,
    ) -> Verdict {
        self.follow_power(state, now);
        self.follow_cold(state, now.sample, heating);
        self.follow_warmth(state, now.sample);
        let lacking = self.lacking(state, now.regulated.is_virtual);
        let unexplained = self.unexplained(state, heating, now.regulated.is_virtual);
        let add = |sum: &mut f32, degrees: f32| {
            // What is no number stays so, and trips.
            *sum = smaller(larger(*sum + degrees * self.tick, 0.0), 2.0 * LIMIT);
        };
        add(&mut state.surplus, unexplained);
        if heating {
            add(&mut state.owed, lacking);
            self.see_gain(state, now);
        } else {
            // What tripped has half the patience the next time, until power is accounted for again.
            state.owed = smaller(state.owed, 0.5 * LIMIT);
            (state.full, state.disagreeing, state.t1_before) = Default::default();
        }
        let excessive = !(state.surplus <= LIMIT);
        // While it heats, a T2 that stays cold says which it is: air that stands still brings it nothing. At rest nothing else trips.
        let [t1, t2] = state.warmth;
        let is_still = heating && t2 <= 0.5 * t1;
        let stuck_on = excessive && !is_still && !(now.pid.0 >= NO_POWER);
        let heat = heating.then(|| self.while_heating(state, now, excessive, regulates)).flatten();
        Verdict { unasked: stuck_on, heat }
    }

    fn while_heating(
        &self,
        state: &mut AccountState,
        now: &Situation,
        excessive: bool,
        regulates: bool,
    ) -> Option<TripReason> {
        let lacks =
            regulates && now.pid.0 >= self.full && !now.mean_error.is_some_and(|error| error <= MARGIN);
        // A rig that still grows warmer may get there.
        if !lacks || state.warmth[0] > state.full_from + MARGIN {
            (state.full, state.full_from) = (0.0, state.warmth[0]);
        } else {
            state.full += 1.0;
        }
        if excessive {
            Some(TripReason::AirFlowLost)
        } else if self.disagree(state, now) {
            Some(TripReason::SensorsDisagree)
        } else if !(state.owed <= LIMIT) {
            Some(if state.learnt.is_some() { TripReason::ExcessPower } else { TripReason::NoResponse })
        } else {
            (!(state.full <= self.reach_ticks)).then_some(TripReason::OutOfReach)
        }
    }

    /// By how much less than it must T1 shows, degC; while it is known to be wrong, T2.
    fn lacking(&self, state: &AccountState, by_t2: bool) -> f32 {
        let [quick, slow, ..] = state.power;
        let power = smaller(quick, slow);
        let learnt = state.learnt.as_ref();
        let warmth = if by_t2 {
            state.warmth[1] + learnt.map_or(0.0, |learnt| larger(0.0, learnt.t1_over_t2(state.warmth[1])))
        } else {
            state.warmth[0]
        };
        let known = learnt.map(|learnt| learnt.gain).filter(|gain| !(*gain <= 0.0)).unwrap_or(state.seen.0);
        let known = larger(known, state.checked);
        let least = self.least_gain * power - MARGIN;
        larger(least, known * power - larger(LIMIT, MISSING * warmth)) - warmth
    }

    /// By how much warmer than the power makes it the rig is, degC.
    fn unexplained(&self, state: &mut AccountState, heating: bool, by_t2: bool) -> f32 {
        let [quick, slow, settled] = state.power;
        let unpowered = state.is_unpowered();
        let [t1, t2] = state.warmth;
        // In air that stands still T1 is hot alone, beside the element. At rest a T1 that is hot alone is in the sun.
        let warmth = if heating && !by_t2 { t1 } else { smaller(t1, t2) };
        let most = match state.learnt {
            Some(learnt) if !(learnt.gain <= 0.0) => learnt.gain,
            _ if state.seen.1 > 0.0 => state.seen.1,
            // It was learnt at too little power to tell.
            Some(_) if !(state.checked > 0.0) => self.most_gain,
            _ => f32::MAX,
        };
        let most = if state.checked > 0.0 { smaller(most, (1.0 + MISSING) * state.checked) } else { most };
        let given = larger(larger(quick, slow), settled) * most * self.ratio_of_air;
        // What is there when the power goes, or from the start on, may be left of it. The fan may be off, too: then it cools slowly, but it cools.
        let stopped = core::mem::replace(&mut state.was_heating, heating) && !heating;
        let known = heating || unpowered && !stopped && state.samples >= SAMPLES;
        let lost = if heating { self.slow.share() } else { self.loss };
        state.left = if known { state.left * (1.0 - lost) } else { larger(0.0, warmth) };
        match (heating, unpowered) {
            (_, true) if warmth <= WARM => -LIMIT,
            (true, _) => warmth - MARGIN - larger(given, state.left),
            (false, true) => warmth - state.left,
            (false, false) => -LIMIT,
        }
    }

    /// The bounds of the gain, by what T1 shows.
    fn see_gain(&self, state: &mut AccountState, now: &Situation) {
        let [quick, slow, settled] = state.power;
        let fade = self.tick / FADES;
        state.seen.0 = larger(state.seen.0 * (1.0 - fade), 0.0);
        state.seen.1 *= 1.0 + fade;
        if now.regulated.is_virtual {
            return;
        }
        let (most, least) = (larger(larger(quick, slow), settled), smaller(smaller(quick, slow), settled));
        let warmth = state.warmth[0];
        if most > SHOWS {
            state.seen.0 = larger(state.seen.0, (warmth - MARGIN) / most);
        }
        if least > SHOWS {
            let above = (warmth + MARGIN) / least;
            state.seen.1 = if state.seen.1 > 0.0 { smaller(state.seen.1, above) } else { above };
        }
    }

    /// T1 and T2 hang in the same air, T2 downstream: while there is power, T2 is not much hotter than T1, nor than T1 was before, since it is late.
    fn disagree(&self, state: &mut AccountState, now: &Situation) -> bool {
        let readable =
            |reading: Reading| matches!(reading.validity, Validity::Good | Validity::Spike | Validity::Rate);
        let (t1, t2) = (now.sample.t1, now.sample.t2);
        if readable(t1) && readable(t2) {
            let (t1, t2) = (t1.celsius.0, t2.celsius.0);
            let before = state.t1_before.get_or_insert(t1);
            self.t1_before.follow(before, t1);
            // What was learnt allows no more than the limit again: a T2 that was hotter than that has tripped before it was learnt.
            let learnt = state.learnt.map_or(0.0, |learnt| learnt.t1_over_t2(state.warmth[1]));
            let difference = larger(learnt, -self.disagreement);
            // What is no number is above the limit.
            if t2 - larger(t1, *before) + difference <= self.disagreement {
                state.disagreeing = 0;
            } else if !state.is_unpowered() {
                state.disagreeing = state.disagreeing.saturating_add(1);
            }
        }
        state.disagreeing > self.disagreement_ticks
    }
}
