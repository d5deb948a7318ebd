//! The grey-box model of `fdi_core` in f64, from any state.

use fdi_core::likelihood::Parameter::{
    self, Curvature, Delay1, Delay2, Gain, Heater, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall1, Wall2,
    WallTime,
};
use fdi_core::likelihood::Parameters;
use fdi_core::likelihood::tuning::ModelTuning;

/// How many parameters there are.
pub(super) const PARAMETERS: usize = Parameters::COUNT;
/// How many numbers say how a stretch begins.
pub(super) const STATES: usize = 7;
/// By parameter: as in [`Parameters`], times in ticks.
pub type Theta = [f64; PARAMETERS];

/// A prior's mean and standard deviation, or a range's ends, of each parameter.
pub(super) type Pairs = [(f64, f64); PARAMETERS];
/// How a stretch begins: heat x; by how much m and w of T1 are above that; the same of T2 or, without T2, heat of the heater beside and by how much
/// its lag is above that, in % of power; then what T1 and T2 read higher than in the first stretch, degC.
pub(super) type State = [f64; STATES];

/// A tick, in % and degC.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// What has driven the heater since the row before.
    pub(super) power: f64,
    /// The same of the heater beside.
    pub(super) beside: f64,
    /// Rises of T1 and T2; NaN: not known.
    pub(super) y: [f64; 2],
}

/// Rows without a gap.
pub(super) type Stretch = Vec<Row>;

/// What of the model is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plant<'a> {
    /// T2 is measured; otherwise a heater beside is known.
    pub(super) t2: bool,
    /// What is fixed of the model.
    pub(super) model: &'a ModelTuning,
}

/// The share of the way that a lag goes in a tick.
fn share(ticks: f64) -> f64 {
    -(-1.0 / ticks.max(0.01)).exp_m1()
}

/// What the air carried so many ticks ago, newest last; before the first row as on it.
fn air(past: &[f64], delay: f64) -> f64 {
    let newest = past.len() - 1;
    let whole = delay as usize;
    let ago = |ticks: usize| past[newest.saturating_sub(ticks)];
    ago(whole) + (delay - whole as f64) * (ago(whole + 1) - ago(whole))
}

impl Plant<'_> {
    /// What T1 and T2 read by the model.
    pub(super) fn simulate(&self, p: &Theta, stretch: &[Row], start: &State) -> Vec<[f64; 2]> {
        self.run(p, stretch, start, true)
    }

    /// How what they read changes with each number of [`State`].
    pub(super) fn by_state(&self, p: &Theta, stretch: &[Row]) -> [Vec<[f64; 2]>; STATES] {
        std::array::from_fn(|which| {
            let mut unit = [0.0; STATES];
            unit[which] = 1.0;
            self.run(p, stretch, &unit, false)
        })
    }

    /// Which numbers of [`State`] mean something.
    pub(super) fn has_state(&self, which: usize, beside: bool, first: bool, t0: bool) -> bool {
        match which {
            0..=2 => true,
            3 | 4 => self.t2 || beside,
            5 => !first && !t0,
            _ => !first && !t0 && self.t2,
        }
    }

    fn run(&self, p: &Theta, stretch: &[Row], start: &State, driven: bool) -> Vec<[f64; 2]> {
        let of = |which: Parameter| p[which as usize];
        let time = |which: Parameter| of(which).exp();
        let gain = time(Gain);
        let gains = [gain, gain * of(Reaches2)];
        let slow = [of(Wall1), of(Wall1) + of(Wall2)];
        let [mut x, m1, w1, m2, w2, c1, c2] = *start;
        let (mut m, mut w) = ([x + m1, x + m2], [x + w1, x + w2]);
        let (mut xb, mut mb) = (m2, m2 + w2);
        let offsets = if driven { [c1 + of(Offset1), c2 + of(Offset2)] } else { [c1, c2] };
        let delays = [of(Delay1), of(Delay1) + of(Delay2)];
        let [heater, wall, lag1, lag2] = [Heater, WallTime, Lag1, Lag2].map(|which| share(time(which)));
        let (lags, mut heat) = ([lag1, lag2], Vec::with_capacity(stretch.len()));
        let channels = if self.t2 { 2 } else { 1 };
        let rises = |m: &[f64; 2], w: &[f64; 2], mb: f64| {
            std::array::from_fn(|i| {
                if i >= channels {
                    return f64::NAN;
                }
                let beside = if self.t2 { 0.0 } else { gains[1] * mb };
                offsets[i] + gains[i] * (m[i] + slow[i] * (w[i] - m[i])) + beside
            })
        };
        let step = |row: &Row| if driven { [row.power, row.beside] } else { [0.0; 2] };
        stretch
            .iter()
            .enumerate()
            .map(|(k, row)| {
                if k > 0 {
                    let [power, beside] = step(row);
                    let bent = 1.0
                        + of(Curvature) * (power - f64::from(self.model.centre)) / f64::from(self.model.step);
                    x += heater * (power * bent - x);
                    xb += heater * (beside - xb);
                    mb += lags[1] * (xb - mb);
                }
                heat.push(x);
                for i in (0..channels).filter(|_| k > 0) {
                    m[i] += lags[i] * (air(&heat, delays[i]) - m[i]);
                    w[i] += wall * (m[i] - w[i]);
                }
                rises(&m, &w, mb)
            })
            .collect()
    }
}
