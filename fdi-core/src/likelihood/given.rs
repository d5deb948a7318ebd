//! A model that was fitted elsewhere, to all samples at once: what training would have given.

use super::process::{Motion, Parameter, Parameters};
use super::second_heater::SecondHeater;
use super::training::{Trained, longest_delay, make_twin};
use super::verdict::RejectReason;
use super::whitening::ResidualStatistics;
use super::{Likelihood, LikelihoodState, Work};

/// What was fitted.
#[derive(Clone, Copy, Debug)]
pub struct Fitted<'a> {
    /// The parameters; times in ticks.
    pub parameters: Parameters,
    /// Standard deviation of how the gain grows with the power, a share for each 20 %.
    pub curvature_sd: f32,
    /// What stands for a T0 that is missing, degC.
    pub base: f32,
    /// What the model leaves of the rises of T1 and T2, and these themselves, degC, tick by tick: what is normal.
    pub left: &'a [([f32; 2], [f32; 2])],
}

impl Likelihood {
    /// Is armed with a model. How the rig is when it is seen next has to be told or found: see [`Likelihood::resume`].
    ///
    /// # Errors
    /// Why it cannot be trusted.
    pub(crate) fn take(&self, state: &mut LikelihoodState, fitted: &Fitted) -> Result<(), RejectReason> {
        let mut parameters = fitted.parameters;
        let delay = parameters.get(Parameter::Delay1) + parameters.get(Parameter::Delay2);
        // NaN is too long, too.
        if !(delay <= longest_delay(&self.tuning)) {
            return Err(RejectReason::DeadTime);
        }
        let mut statistics = ResidualStatistics::default();
        fitted.left.iter().for_each(|(e, y)| statistics.push(*e, *y));
        let (mut motion, beside) = (Motion::default(), SecondHeater::steady(&parameters, 0.0));
        if !self.inputs.t2 {
            make_twin(&mut parameters, &mut motion);
        }
        let trained = Trained {
            parameters,
            motion,
            whitening: statistics.finish(&self.tuning.whitening, self.inputs.channels())?,
            mean: [0.0; 2],
            beside,
            power: 0.0,
            rise: statistics.level(0),
            curvature_error: fitted.curvature_sd,
        };
        state.trained = Some(self.watch.start(&trained));
        (state.work, state.current, state.given) = (Work::Nothing, true, true);
        Ok(())
    }
}
