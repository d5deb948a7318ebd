//! What was learnt of a rig, in units that people know.

/// The model in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Static gain from the power to T1, degC per %.
    pub gain: f32,
    /// How the gain grows with the power: share for each 20 %.
    pub curvature: f32,
    /// What T1 reads above T0 without power, degC.
    pub offset: f32,
    /// Time constant of the heater, s.
    pub heater: f32,
    /// That of T1, s.
    pub lag: f32,
    /// That of the wall, s.
    pub wall: f32,
    /// Dead time from the heater to T1, s.
    pub dead_time: f32,
    /// Share of T1's rise that comes with the wall.
    pub wall_share: f32,
    /// Share of T1's rise that reaches T2. Without T2 this and what follows of it are those of T1 again.
    pub reaches: f32,
    /// Time constant of T2, s.
    pub lag2: f32,
    /// Transport from T1 to T2, s.
    pub transport: f32,
    /// Static gain from the heater beside to T1, degC per %.
    pub gain_beside: f32,
    /// Time constant on its way, beside that of the heater, s.
    pub lag_beside: f32,
    /// Standard deviations of what is left of T1 and T2 when it is whitened, degC; 0 where there is no T2.
    pub noise: [f32; 2],
}
