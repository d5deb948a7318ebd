//! What control and supervision need to know of the heat, from the same residuals, every tick and whatever the bank makes of
//! them: a stand-in for T1, the air flow, and whether the rig heats unasked.

/// Memory of the correction of the stand-in, s.
const STAND_IN_TIME: f32 = 2.0;
/// T2 and the models may disagree by so much about T1: degC, and share of the rise. Beyond it one of them is wrong, too, and
/// nothing is left to regulate by.
const MAX_CORRECTION: f32 = 3.0;
const MAX_CORRECTION_SHARE: f32 = 0.2;
/// The heater is stuck on when a thermistor has been so much hotter than expected for so long, and hardly any rise is
/// expected: degC, s, degC.
const TOO_HOT: f32 = 4.0;
const TOO_HOT_TIME: f32 = 2.0;
const HARDLY_WARM: f32 = 1.5;
/// Memory of the rises that the air flow is judged by, s, and the smallest rise that says anything, degC.
const FLOW_TIME: f32 = 2.0;
const FLOW_MIN_RISE: f32 = 2.0;

/// Ts and the shares of the memories that are renewed in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heat {
    sample_time: f32,
    stand_in: f32,
    flow: f32,
}

/// The memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeatState {
    /// What T1 by the models lacks, as T2 shows it, degC.
    correction: f32,
    /// For how long the rig has been hot without power, s.
    too_hot: f32,
    /// Low-passed rises of T1 and T2, and what was expected of them, degC.
    rises: [[f32; 2]; 2],
}

impl Heat {
    pub(super) fn new(sample_time: f32) -> Self {
        let share = |time: f32| (sample_time / time).min(1.0);
        Self { sample_time, stand_in: share(STAND_IN_TIME), flow: share(FLOW_TIME) }
    }

    /// Takes in the rises of T1 and T2 where valid, what was expected of them, and what is left of them, degC; `along` is
    /// the share of T1's rise that reaches T2.
    pub(super) fn step(
        &self,
        s: &mut HeatState,
        y: [Option<f32>; 2],
        expected: [f32; 2],
        e: [Option<f32>; 2],
        along: f32,
    ) {
        if let Some(e) = e[1] {
            s.correction += self.stand_in * (e / along - s.correction);
        }
        let hot = expected[0] < HARDLY_WARM && e.iter().flatten().any(|&e| e > TOO_HOT);
        s.too_hot = if hot { (s.too_hot + self.sample_time).min(TOO_HOT_TIME) } else { 0.0 };
        if let [Some(y1), Some(y2)] = y {
            for ([measured, foretold], (y, expected)) in
                s.rises.iter_mut().zip([y1, y2].into_iter().zip(expected))
            {
                *measured += self.flow * (y - *measured);
                *foretold += self.flow * (expected - *foretold);
            }
        }
    }
}

impl HeatState {
    /// Right after training at the rise `trained` of T1.
    pub(super) fn new(trained: f32) -> Self {
        Self { correction: 0.0, too_hot: 0.0, rises: [[trained; 2]; 2] }
    }

    /// T1's rise by T2 and the models, where the models alone expect `expected`, degC; None where the two disagree.
    pub(super) fn stand_in(&self, expected: f32) -> Option<f32> {
        let limit = MAX_CORRECTION + MAX_CORRECTION_SHARE * expected.abs();
        (self.correction.abs() <= limit).then_some(expected + self.correction)
    }

    /// Air flow by the static gain, % of normal, the larger of what T1 and T2 say; None where it is too cold to tell.
    pub(super) fn air_flow(&self) -> Option<f32> {
        let flow = |[measured, expected]: [f32; 2]| {
            (expected > FLOW_MIN_RISE && measured > FLOW_MIN_RISE).then(|| 100.0 * expected / measured)
        };
        Some(flow(self.rises[0])?.max(flow(self.rises[1])?))
    }

    /// Whether the rig has been hot without power for too long.
    pub(super) fn heater_stuck_on(&self) -> bool {
        self.too_hot >= TOO_HOT_TIME
    }
}
