//! The bank: hypotheses, nuisances, faults of a user's own.

use super::tuning;

tuning! {
    /// Hypotheses: means and standard deviations of what they free, and within which that is possible (docs/diagnosis.md, section 6).
    pub struct HypothesisTuning: hypotheses {
        /// Standard deviation of an offset of T1, T2 or T0.
        offset_sd = 2.0, "degC", chosen "faults of the campaign are 0.5 to 3 degC";
        /// Standard deviation of a change of the air flow, 1/f - 1.
        flow_sd = 0.3, "1", chosen "faults of the campaign are 10 to 50 %";
        /// Largest loss of air flow, 1/f - 1.
        most_flow_loss = 4.0, "1", chosen "a fifth of the air is left";
        /// Largest gain of air flow, 1/f - 1, without its sign.
        most_flow_gain = 0.7, "1", chosen "3.3 times the air";
        /// Standard deviation of a change of the heater's power, and of the share of the rise that a clogged T1 loses.
        share_sd = 0.25, "1", chosen "faults of the campaign are 10 to 100 %";
        /// Largest change of the heater's power, both signs.
        most_power = 1.1, "1", derived "all of it, and a tenth for the estimate's error";
        /// A thermistor that loses more of its rise is not clogged, but out of the tube; one that was clogged when it was learnt sees at most as much more when it is mended. A change of the process that is larger is judged a second time, with more room for how late it begins (`late`).
        large = 0.4, "1", chosen "a heater that fails wholly has no size without the second judgement (tests/closed_loop)";
        /// Standard deviation of the lag of a clogged thermistor, as a share of the regressor's lag.
        lag_sd = 0.15, "1", chosen "";
        /// Standard deviation of a drift.
        drift_sd = 3.0, "degC/min", chosen "";
        /// Standard deviation of what a fault does wholly, as a share: the gain that a stuck thermistor loses, two thermistors that are exchanged, a heater that follows nothing of what is asked for.
        wholly_sd = 0.03, "1", chosen "";
        /// Largest share of its gain that a stuck thermistor shows, both signs.
        stuck_most = 0.1, "1", chosen "with 0.15 a large error of T2 on the hot end is called stuck (page tests)";
        /// Standard deviation of the jump with which a drift begins, and of what a stuck thermistor reads around what it read before.
        jump_sd = 0.2, "degC", chosen "";
        /// Mean and standard deviation of the power of a heater that gives the same whatever is asked for.
        constant = 40.0, "%", chosen "";
        /// Least such power: below it all of the power is lost, which has a size.
        least_constant = 5.0, "%", chosen "commit c08f067";
        /// Standard deviation of how late a change of the process begins, ticks times its share. With a larger value, the timing that tells air flow from power is lost.
        late_sd = 0.03, "ticks", chosen "";
        /// Share of the residence time, and at least a tick, within which a change of the process begins anywhere. It is asked of a large change, and of any where there is no fan: there the timing has to tell nothing apart, and a slow rig shows its onset late.
        late = 0.1, "1", derived "a tick of the reference rig";
        /// Log odds beforehand of a drift, and of a thermistor out of the tube.
        uncommon = -3.0, "1", chosen "one of them for 20 of the common ones";
        /// Log odds beforehand of faults that are rarer still.
        rare = -5.0, "1", measured "with -4 MFS1 has its name 0.08 s later (95 % of 200 runs)";
        /// A thermistor that is further from what it means to be out of the tube or to be exchanged is neither. `pt326 isolability` assumes no fault further from its prior's mean.
        farthest = 5.0, "standard deviations", chosen "";
    }
}

impl HypothesisTuning {
    /// A thermistor that sees less of the rise is out of the tube.
    #[inline(always)]
    pub(in crate::likelihood) fn seen(&self) -> f32 {
        1.0 - self.large
    }

    /// The air flows with which the regressors of less and of more flow are computed: less by the hypothesis' standard deviation, and more by as much.
    #[inline(always)]
    pub(in crate::likelihood) fn flows(&self) -> [f32; 2] {
        [1.0 / (1.0 + self.flow_sd), 1.0 + self.flow_sd]
    }

    /// From which loss of air on, in `1/f - 1`, it is computed anew, and with which flow: with about half of the air, where a short secant fits nothing.
    #[inline(always)]
    pub(in crate::likelihood) fn half_closed(&self) -> (f32, f32) {
        (self.large, 1.0 / (1.0 + 3.0 * self.flow_sd))
    }

    /// The changes of `1/f - 1` of these, over which both regressors are secants.
    #[inline(always)]
    pub(in crate::likelihood) fn secants(&self) -> [f32; 2] {
        self.flows().map(|flow| 1.0 / flow - 1.0)
    }
}

tuning! {
    /// Nuisances: standard deviations of what moves without being a fault (docs/diagnosis.md, section 6). What is learnt of a rig widens them.
    pub struct NuisanceTuning: nuisances {
        /// Power since an onset; its learnt steps are never taken to be smaller.
        onset_power = 0.02, "1", chosen "mains";
        /// Air flow since an onset, 1/f - 1.
        onset_flow = 0.006, "1", chosen "fan, mains";
        /// Offsets of T1 and T2 since an onset.
        onset_offset = 0.08, "degC", chosen "turbulence that is slower than the whitening filter remembers";
        /// T0 since an onset.
        onset_t0 = 0.12, "degC", chosen "the air that is drawn in is not what T0 reads";
        /// Error in the share of the wall, since an onset and since training.
        wall = 0.03, "1", measured "prototype 2: errors of the fit";
        /// Error of the dead time, since an onset and since training.
        shift = 0.07, "ticks", measured "prototype 2: errors of the fit, 8 ms";
        /// Motion of T0 that reaches T1 and T2 at another time, as a share of it.
        inlet = 1.0, "1", chosen "a draught reaches T0 later than T1";
        /// Power since training. Of air flow, offsets and T0 twice as much has moved since training as since an onset.
        trained_power = 0.025, "1", chosen "mains";
        /// Error of the model's power, air flow (1/f - 1) and wall right after training.
        error = 0.1, "1", chosen "";
        /// Error of the model's dead time right after training.
        error_shift = 0.5, "ticks", chosen "";
    }
}

impl NuisanceTuning {
    /// What the tracker follows: power, air flow and both offsets. It begins with these standard deviations.
    #[inline(always)]
    pub(in crate::likelihood) fn tracked(&self) -> [f32; 4] {
        [self.onset_power, self.onset_flow, self.onset_offset, self.onset_offset]
    }
}

tuning! {
    /// Faults of a user's own (docs/diagnosis.md, section 8). Standard deviations of what they change are those of the hypotheses.
    pub struct TaughtTuning: taught {
        /// Standard deviation of the lags that such a fault changes, as a share of the regressors' lags.
        lag_sd = 0.5, "1", chosen "";
        /// Standard deviation of the size of a taught fault, as a share of the size that was taught.
        size_sd = 0.2, "1", chosen "";
        /// Least size of a taught fault, as a share of the size that was taught.
        least_size = 0.3, "1", chosen "";
        /// Largest size of a taught fault, as a share of the size that was taught.
        most_size = 3.0, "1", chosen "";
        /// Log odds beforehand of a taught fault: somebody has seen it on this rig.
        prior = 3.0, "1", measured "lessons and runs of tests/closed_loop/taught (docs/diagnosis.md, section 8)";
        /// Least evidence of a taught fault without those odds. A response that changes hardly anything would otherwise fit anything.
        least_gain = 3.0, "1", chosen "";
    }
}
