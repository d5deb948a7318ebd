//! How far an experiment has come, and why it ended without a model.

use super::lag::Lag;

/// Why an experiment ended without a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unclear {
    /// A stop or a trip ended it.
    Stopped,
    /// T1 gave nothing to believe for some ticks.
    NoSample,
    /// T1 did not rise by 2 degC.
    NoAnswer,
    /// T1 rose by more than 35 degC.
    TooHot,
    /// T1 fell while the power was switched.
    Fell,
    /// T1 did not stand still under constant power.
    NotStill,
    /// The relay did not make it oscillate.
    NoSwing,
    /// What was measured is no lag with dead time.
    NoLag,
}

impl Unclear {
    /// The reason in words, for people.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Stopped => "it was stopped, or tripped",
            Self::NoSample => "T1 gave no valid sample",
            Self::NoAnswer => {
                "T1 did not rise by 2 degC: is the heater connected, is identification.y_scale right?"
            }
            Self::TooHot => "T1 rose by more than 35 degC: is identification.y_scale right?",
            Self::Fell => "T1 fell although it was heated: is it out of the tube?",
            Self::NotStill => {
                "T1 did not come to a stand under constant power: is it still warm, does the room or the air change?"
            }
            Self::NoSwing => "switching the power did not make T1 swing",
            Self::NoLag => "the answer of T1 is that of no lag with dead time",
        }
    }
}

/// How far an experiment has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Standing {
    /// No power: noise and beginning.
    Rest,
    /// Constant power, until T1 stands still.
    Warm,
    /// The relay: its period.
    Swing,
    /// The relay: the answer at that period.
    Measure,
    /// It has ended, with a model or without.
    Over(Result<Lag, Unclear>),
}

impl Standing {
    /// What is done, for people.
    pub const fn words(&self) -> &'static str {
        match self {
            Self::Rest => "at rest",
            Self::Warm => "constant power until T1 stands still",
            Self::Swing => "power switched up and down: the period",
            Self::Measure => "power switched up and down: the answer",
            Self::Over(Ok(_)) => "done",
            Self::Over(Err(unclear)) => unclear.words(),
        }
    }
}
