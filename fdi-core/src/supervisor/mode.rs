//! Modes, what leads to them, and what a user can ask for: the words of the supervisor, without its rules.

use core::fmt;

use crate::numbered::numbered;
use crate::observation::Phase;
use crate::sense::{RawSample, Sample};
use crate::units::{Celsius, Percent, Seconds};

/// Why the heater was switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TripReason {
    /// T1 reads as a broken wire.
    T1Open,
    /// T1 reads as a short circuit.
    T1Short,
    /// T1 reads a temperature that the rig cannot have.
    T1OutOfRange,
    /// T1 has given no valid sample for too long (none, spikes, loose contact).
    T1Lost,
    /// T1 does not move although the heater does.
    T1Stuck,
    /// T1 is above the limit.
    T1OverTemperature,
    /// T2 is above the limit.
    T2OverTemperature,
    /// The air flow is too small to heat.
    AirFlowLost,
    /// The heater heats although it is not asked to.
    HeaterStuckOn,
    /// T2 is far hotter than T1.
    SensorsDisagree,
    /// T1 shows less warmth than this power must give.
    NoResponse,
    /// The same, by what was learnt of the rig.
    ExcessPower,
    /// T1 does not answer to the heater as T2 does.
    T1Contradicted,
    /// Full power for long, and T1 stays below the set-point.
    OutOfReach,
}

numbered! {
    TripReason from 1;
    Self::T1Open => 1, "t1_open", "T1 reads as a broken wire";
    Self::T1Short => 2, "t1_short", "T1 reads as a short circuit";
    Self::T1OutOfRange => 3, "t1_out_of_range", "T1 reads a temperature that the rig cannot have";
    Self::T1Lost => 4, "t1_lost", "T1 gave no valid sample for too long";
    Self::T1Stuck => 5, "t1_stuck", "T1 did not move although the heater did";
    Self::T1OverTemperature => 6, "t1_over_temperature", "T1 is above the limit";
    Self::T2OverTemperature => 7, "t2_over_temperature", "T2 is above the limit";
    Self::AirFlowLost => 8, "air_flow_lost", "too little air to heat, a heater that gives more than it is asked for, or a T1 that reads far too high";
    Self::HeaterStuckOn => 9, "heater_stuck_on", "the rig heats although the heater is off";
    Self::SensorsDisagree => 10, "sensors_disagree", "T2 is far hotter than T1: T1 is out of the tube or stands still, or wires are swapped";
    Self::NoResponse => 11, "no_response", "much power, and T1 has not risen: T1 out of the tube, or nothing heats";
    Self::ExcessPower => 12, "excess_power", "far more power than was learnt for this set-point: T1 out of the tube, or the rig changed";
    Self::T1Contradicted => 13, "t1_contradicted", "T1 does not answer to the heater as T2 does: T1 is out of the tube or stands still, or wires are swapped";
    Self::OutOfReach => 14, "out_of_reach", "full power for long, and T1 stays below the set-point: it is out of reach";
}

/// The record of a trip: what was seen on the tick that tripped.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trip {
    /// Why.
    pub reason: TripReason,
    /// When.
    pub tick: u32,
    /// Codes as they came.
    pub raw: RawSample,
    /// Temperatures and validities.
    pub sample: Sample,
    /// The temperature that was wanted.
    pub setpoint: Celsius,
    /// The temperature above which T1 or T2 trips.
    pub limit: Celsius,
    /// What had driven the heater up to then: its mean over half an answer time.
    pub power: Percent,
    /// The power that this set-point needed by what was learnt, where that is known.
    pub needed: Option<Percent>,
}

/// How the modes are kept in memory: four bits apart, so that a flipped bit makes of no mode another one.
const KEPT: [u8; 6] = [0x0F, 0x33, 0x3C, 0x55, 0x5A, 0x66];

const _: () = {
    let mut i = 0;
    while i < KEPT.len() {
        let mut j = 0;
        while j < i {
            assert!((KEPT[i] ^ KEPT[j]).count_ones() >= 4, "modes are four bits apart");
            j += 1;
        }
        i += 1;
    }
};

/// Mode of the instrument; the diagram is in the module's documentation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// Heater off, waiting to be armed.
    #[default]
    Off = KEPT[0],
    /// Regulating; not yet fit to learn what is normal.
    Settle {
        /// Ticks in a row that were fit for learning.
        steady: u32,
    } = KEPT[1],
    /// Regulating and learning the baseline.
    Learn {
        /// Samples accepted so far. The second half counts what it has learnt; neither count alone ends learning, so
        /// a second half that lags cannot end it with the count of an earlier baseline.
        accepted: u32,
    } = KEPT[2],
    /// Regulating and watching for faults.
    Monitor = KEPT[3],
    /// The power of an experiment, from which PID settings are told; then off.
    Tune = KEPT[4],
    /// Heater off until acknowledged.
    Tripped(Trip) = KEPT[5],
}

numbered! {
    Mode from 0;
    Self::Off => 0, "off";
    Self::Settle { .. } => 1, "settle";
    Self::Learn { .. } => 2, "learn";
    Self::Monitor => 3, "monitor";
    Self::Tripped(_) => 4, "tripped";
    Self::Tune => 5, "tune";
}

impl Mode {
    /// Whether the heater may be driven.
    pub fn is_heating(&self) -> bool {
        self.phase().is_heated()
    }

    /// What of it the diagnosis goes by.
    pub fn phase(&self) -> Phase {
        match self {
            Self::Off => Phase::Off,
            Self::Settle { .. } | Self::Tune => Phase::Heated,
            Self::Learn { .. } => Phase::Learning,
            Self::Monitor => Phase::Watched,
            Self::Tripped(_) => Phase::Tripped,
        }
    }
}

/// What keeps a sample out of the baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Blocker {
    /// The drive is or was just at a limit.
    Saturated,
    /// The mean control error is too large, or not known yet.
    OutOfRegulation,
    /// The excitation is off or cut away.
    Unexcited,
    /// A thermistor gave no valid sample.
    InvalidSample,
    /// All is well, but not yet for long enough.
    NotSteady,
    /// The models have given no gain or bandwidth that may be believed for many samples: see `identification.gain_max`.
    NotIdentified,
}

numbered! {
    Blocker from 1;
    Self::Saturated => 1, "saturated", "the power is at a limit";
    Self::OutOfRegulation => 2, "out_of_regulation", "T1 is too far from the set-point";
    Self::Unexcited => 3, "unexcited", "the excitation is off or cut away";
    Self::InvalidSample => 4, "invalid_sample", "a thermistor gives no valid sample";
    Self::NotSteady => 5, "not_steady", "not steady for long enough yet";
    Self::NotIdentified => 6, "not_identified", "the models give no gain or bandwidth to be believed; see identification.gain_max";
}

/// Highest level of the fan that can be announced, %.
pub const FASTEST_FAN: f32 = 200.0;

/// Longest time for which an alarm can be shelved: a day.
pub const LONGEST_SHELVING: Seconds = Seconds(86_400.0);

/// A command of the user.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Begin to regulate.
    Arm,
    /// Begin the experiment from which PID settings are told: see [`crate::tune`].
    Tune,
    /// Heater off. Works in every mode.
    Stop,
    /// Leave a trip whose cause has gone. While monitoring: an alarm is known, and advice until it ends or is called another name.
    Acknowledge,
    /// What the diagnosis has named is advice for so long, however often it ends and comes back; 0 puts an end to that. Only what may be shelved:
    /// [`Finding::may_be_shelved`](crate::Finding::may_be_shelved).
    Shelve(Seconds),
    /// Forget the baseline and learn it anew.
    Relearn,
    /// New set-point.
    SetPoint(Celsius),
    /// Switch the excitation on or off.
    Excite(bool),
    /// The rig's gain that its wiring check has measured, degC of T1 per %. 0, or what is no number: none was.
    Gain(f32),
    /// Announces the level of the fan; 100 % is the level at which the rig is learnt.
    Fan(Percent),
}

impl Command {
    /// Whether it switches the heater on.
    pub fn heats(&self) -> bool {
        matches!(self, Self::Arm | Self::Tune)
    }
}

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The command makes no sense in this mode.
    NotInMode(&'static str),
    /// The cause of the trip persists, or would trip at once.
    CausePersists(TripReason),
    /// The settings widen this limit, and the heater is on.
    WidensLimit(&'static str),
    /// The set-point is not a number within the limits.
    SetPoint {
        /// What was asked for.
        wanted: f32,
        /// Lowest accepted.
        min: f32,
        /// Highest accepted.
        max: f32,
    },
    /// T0, T1 and T2, in degC, are further apart than at rest, and no heat that was asked for explains it.
    NotAtRest([f32; 3]),
    /// A level of the fan that none has, %.
    Fan(f32),
    /// A time for which nothing is shelved, s.
    Shelving(f32),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotInMode(mode) => write!(f, "not possible in mode {mode}"),
            Self::CausePersists(reason) => {
                write!(f, "refused, for it persists (trip {}): {}", reason.number(), reason.words())
            }
            Self::WidensLimit(name) => {
                write!(f, "{name} can't be widened while the heater is on, expected `stop` first")
            }
            Self::SetPoint { wanted, min, max } => {
                write!(f, "set-point {wanted} degC refused, expected {min} to {max} degC")
            }
            Self::NotAtRest([t0, t1, t2]) => {
                write!(
                    f,
                    "T0, T1 and T2 read {t0:.1}, {t1:.1} and {t2:.1} degC, expected within 3 degC at rest: let the rig cool, `check` it"
                )
            }
            Self::Shelving(time) => {
                write!(f, "shelving for {time} s refused, expected 0 to {} s", LONGEST_SHELVING.0)
            }
            Self::Fan(level) => write!(f, "fan level {level} % refused, expected 0 to {FASTEST_FAN} %"),
        }
    }
}

impl core::error::Error for Refusal {}
