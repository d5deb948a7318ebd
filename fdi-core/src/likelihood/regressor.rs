//! The regressors of the regression: what y1 and y2 would do if one thing changed by one unit.

/// What may change. The first [`LASTING`] are asked over a minute, too; what is only a nuisance stands at both ends, so that what hypotheses free
/// stands together: [`FREED`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Regressor {
    /// Share of the wall.
    Wall,
    /// Delay of the whole answer, ticks.
    Shift,
    /// Heater power, by its whole.
    Power,
    /// `1/f - 1` with f the air flow: secants over `HypothesisTuning::secants`.
    LessFlow,
    MoreFlow,
    /// Offsets of T1 and T2, degC.
    Offset1,
    Offset2,
    /// Share of the rise that T1 and T2 see on top.
    Gain1,
    Gain2,
    /// What T1 would read behind an extra lag, less what it should; and the share of the rise that is lost behind that lag.
    ShortLag,
    LongLag,
    ShortLoss,
    LongLoss,
    /// Drifts, degC for each unit of time.
    Ramp1,
    Ramp2,
    /// By how much more power's answer is later than assumed, ticks times its share: a fault begins between two samples.
    Late,
    /// T1 and T2 exchanged.
    Exchanged,
    /// A constant power, %.
    Constant,
    /// How much T0 is above its mean of some time: the inlet's way to T1 and to T2 is not T0's, degC.
    Inlet1,
    Inlet2,
}

impl Regressor {
    /// What people call it, and its unit; none for shares.
    pub(super) const fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::Power => ("power", ""),
            Self::LessFlow => ("less flow", "1/f - 1"),
            Self::MoreFlow => ("more flow", "1/f - 1"),
            Self::Offset1 => ("offset of T1", "degC"),
            Self::Offset2 => ("offset of T2", "degC"),
            Self::Gain1 => ("gain of T1", ""),
            Self::Gain2 => ("gain of T2", ""),
            Self::Wall => ("wall", ""),
            Self::Shift => ("shift", "ticks"),
            Self::Inlet1 => ("inlet at T1", ""),
            Self::Inlet2 => ("inlet at T2", ""),
            Self::ShortLag => ("short lag", ""),
            Self::LongLag => ("long lag", ""),
            Self::ShortLoss => ("short loss", ""),
            Self::LongLoss => ("long loss", ""),
            Self::Ramp1 => ("ramp of T1", "degC/min"),
            Self::Ramp2 => ("ramp of T2", "degC/min"),
            Self::Late => ("late", "ticks"),
            Self::Exchanged => ("exchanged", ""),
            Self::Constant => ("constant", "%"),
        }
    }
}

/// How many there are, and how many of them are asked over a minute.
pub(super) const COUNT: usize = Regressor::Inlet2 as usize + 1;
pub(super) const LASTING: usize = Regressor::Gain2 as usize + 1;
/// Those that a hypothesis frees: from the first on, so many.
pub(super) const FIRST_FREED: usize = Regressor::Power as usize;
pub(super) const FREED: usize = Regressor::Constant as usize + 1 - FIRST_FREED;

/// Values of regressors in both channels.
pub(super) type Regressors<const N: usize = COUNT> = [[f32; 2]; N];

/// The regressors of what sensors do.
pub(super) const SENSORS: [Regressor; 10] = [
    Regressor::Offset1,
    Regressor::Offset2,
    Regressor::Gain1,
    Regressor::Gain2,
    Regressor::ShortLag,
    Regressor::LongLag,
    Regressor::ShortLoss,
    Regressor::LongLoss,
    Regressor::Ramp1,
    Regressor::Ramp2,
];

/// The regressors of what the process does.
pub(super) const PROCESS: [Regressor; 5] =
    [Regressor::Power, Regressor::LessFlow, Regressor::MoreFlow, Regressor::Late, Regressor::Constant];

/// What a hypothesis or a nuisance moves: one regressor, or two together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// One.
    Of(Regressor),
    /// T0 reads too much: T1 and T2 seem to rise less.
    Offset0,
    /// T0 drifts.
    Ramp0,
    /// A lag between the short and the long one, and the loss behind it.
    MidLag,
    MidLoss,
}

impl Direction {
    /// What people call it, and its unit; none for shares.
    #[cfg(feature = "tuning")]
    pub(super) const fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::Of(regressor) => regressor.name(),
            Self::Offset0 => ("T0", "degC"),
            Self::Ramp0 => ("ramp of T0", "degC/min"),
            Self::MidLag => ("middle lag", ""),
            Self::MidLoss => ("middle loss", ""),
        }
    }

    /// How many there are.
    pub(super) const COUNT: usize = COUNT + 4;

    /// Its place among all directions.
    pub(super) const fn place(self) -> usize {
        match self {
            Self::Of(regressor) => regressor as usize,
            Self::Offset0 => COUNT,
            Self::Ramp0 => COUNT + 1,
            Self::MidLag => COUNT + 2,
            Self::MidLoss => COUNT + 3,
        }
    }

    /// The regressors that it moves.
    #[inline]
    pub(super) const fn regressors(self) -> [usize; 2] {
        match self {
            Self::Of(regressor) => [regressor as usize; 2],
            Self::Offset0 => [Regressor::Offset1 as usize, Regressor::Offset2 as usize],
            Self::Ramp0 => [Regressor::Ramp1 as usize, Regressor::Ramp2 as usize],
            Self::MidLag => [Regressor::ShortLag as usize, Regressor::LongLag as usize],
            Self::MidLoss => [Regressor::ShortLoss as usize, Regressor::LongLoss as usize],
        }
    }

    /// The regressors that it moves, with by how much.
    #[inline]
    pub(super) fn moves(self) -> impl Iterator<Item = (usize, f32)> {
        self.regressors().into_iter().zip(self.weights()).filter(|(_, weight)| *weight != 0.0)
    }

    /// By how much it moves each of them.
    #[inline]
    pub(super) fn weights(self) -> [f32; 2] {
        match self {
            Self::Of(_) => [1.0, 0.0],
            Self::Offset0 | Self::Ramp0 => [-1.0, -1.0],
            Self::MidLag | Self::MidLoss => [0.5, 0.5],
        }
    }
}
