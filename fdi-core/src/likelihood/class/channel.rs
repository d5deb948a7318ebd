//! The thermistors that a class may be of.

/// A thermistor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Channel {
    /// Room.
    T0,
    /// Outlet, in the loop.
    T1,
    /// Outlet, downstream.
    T2,
}

impl Channel {
    /// Its name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::T0 => "T0",
            Self::T1 => "T1",
            Self::T2 => "T2",
        }
    }
}

/// Two thermistors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pair {
    /// Outlet and outlet downstream.
    T1T2,
    /// Room and outlet.
    T0T1,
    /// Room and outlet downstream.
    T0T2,
}
