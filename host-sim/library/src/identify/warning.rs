//! What the recording cannot support: reasons to doubt an estimate, as data.

use std::fmt;

use serde::Serialize;

use super::estimate::Estimate;
use super::findings::is_stable;
use super::model::{Signals, rms};
use super::poles::roots;

/// A reason to doubt what was identified.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "warning", rename_all = "kebab-case")]
pub enum Warning {
    /// The input has one value throughout.
    InputConstant,
    /// The input changes on fewer rows than there are b parameters.
    InputChangesRarely {
        /// On how many rows it changes.
        changes: usize,
    },
    /// The input moves, but by less than 2 % of its size.
    InputSwingSmall {
        /// Largest minus smallest value, in % of the root mean square.
        swing_pct: f64,
    },
    /// The data leave these parameters open.
    Undetermined {
        /// Their names.
        parameters: Vec<String>,
    },
    /// Too little is known of the static gain.
    GainUncertain {
        /// Its standard deviation in % of its value; null if there is no value.
        sd_pct: Option<f64>,
    },
    /// A pole on or outside the unit circle.
    Unstable,
    /// The residuals are correlated in time.
    ResidualsColoured {
        /// Lag of the largest correlation, in samples.
        lag: usize,
        /// That correlation, -1..=1.
        correlation: f64,
    },
    /// The last a or b lies within two standard deviations of zero.
    OrderHigh {
        /// Which of them.
        parameters: Vec<String>,
    },
    /// The steps in which y was recorded exceed the residuals.
    OutputCoarse {
        /// Typical step between neighbouring values, in units of y.
        step: f64,
        /// How many values y takes.
        levels: usize,
    },
    /// Rows were used both to estimate and to validate.
    ValidationOverlaps,
    /// The times of the rows are not equally spaced.
    TimesUneven {
        /// Column of the times.
        column: String,
        /// The first row that comes too early or too late.
        row: usize,
        /// How long after the row before it, s.
        step_s: f64,
        /// The usual step, s.
        usual_s: f64,
        /// How many rows come too early or too late.
        places: usize,
    },
    /// The times of the rows are not `--ts` apart.
    TimesContradictTs {
        /// Column of the times.
        column: String,
        /// The usual step, s.
        usual_s: f64,
        /// What was asked for, s.
        ts_s: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InputConstant => write!(
                f,
                "the input is constant: nothing tells its effect from an offset of the output, so a static gain \
                 is right only if y is zero when u is; record a change of the input, with rows before it"
            ),
            Self::InputChangesRarely { changes } => write!(
                f,
                "the input changes on {changes} rows only: too few to tell the b parameters apart; excite it more, or \
                 lower NB"
            ),
            Self::InputSwingSmall { swing_pct } => write!(
                f,
                "the input moves by {swing_pct:.2} % of its size only: what is not removed as offset decides the gain"
            ),
            Self::Undetermined { parameters } => write!(
                f,
                "the data leave open: {}; such values are arbitrary, though predictions do not suffer",
                parameters.join(", ")
            ),
            Self::GainUncertain { sd_pct: Some(sd) } => {
                write!(f, "the static gain is uncertain: its standard deviation is {sd:.0} % of it")
            }
            Self::GainUncertain { sd_pct: None } => {
                write!(f, "there is no static gain: the data do not determine it, or the model integrates")
            }
            Self::Unstable => {
                write!(f, "the model is unstable: gain and poles describe no real steady state")
            }
            Self::ResidualsColoured { lag, correlation } => write!(
                f,
                "the residuals are not white (correlation {correlation:.2} at lag {lag}): the parameters are biased and \
                 the standard deviations too small; trust the simulated fit"
            ),
            Self::OrderHigh { parameters } => write!(
                f,
                "within two standard deviations of zero: {}; a lower order may do as well",
                parameters.join(", ")
            ),
            Self::OutputCoarse { step, levels } => write!(
                f,
                "the output comes in steps of about {step:.3} ({levels} values), larger than the residuals: the steps \
                 act as noise that is not random"
            ),
            Self::TimesUneven { column, row, step_s, usual_s, places } => write!(
                f,
                "the times are uneven: by column {column}, row {row} is {} s after the row before it, and {usual_s} s is usual \
                 ({places} such places); the model takes all rows as equally spaced, so leave gaps out with --from and \
                 --to, or resample",
                (step_s * 1e6).round() / 1e6
            ),
            Self::TimesContradictTs { column, usual_s, ts_s } => write!(
                f,
                "--ts is {ts_s} s, but column {column} rises by {usual_s} a row: bandwidth and time constants are wrong, \
                 unless that column is not in s"
            ),
            Self::ValidationOverlaps => {
                write!(f, "the validation rows overlap the estimation rows: their fit proves less")
            }
        }
    }
}

/// Smallest swing of the input that is not remarked on, as a share of its root mean square.
const SWING_MIN: f64 = 0.02;
/// Largest standard deviation of the static gain that is not remarked on, as a share of the gain.
const GAIN_SD_MAX: f64 = 0.2;
/// Lags at which the residuals are examined.
const LAGS: usize = 10;
/// Residuals below this share of y are rounding of single precision, and say nothing.
const ROUNDING: f64 = 1e-6;

/// What is doubtful in an estimate from `s`.
pub fn warnings(s: &Signals, e: &Estimate) -> Vec<Warning> {
    let stable = is_stable(&roots(&e.model.a));
    let noise_seen = rms(&e.residuals) > ROUNDING * rms(&s.y);
    let residuals = [coloured(e), order_high(e), coarse(s, e)];
    let all = [input(s, e), undetermined(e), gain(e), (!stable).then_some(Warning::Unstable)];
    all.into_iter().chain(residuals.into_iter().filter(|_| noise_seen)).flatten().collect()
}

fn input(s: &Signals, e: &Estimate) -> Option<Warning> {
    let (u, nb) = (&s.u, e.model.order.nb);
    let (min, max) = u.iter().fold((u[0], u[0]), |(min, max), &u| (min.min(u), max.max(u)));
    let changes = u.windows(2).filter(|w| w[0] != w[1]).count();
    let swing = (max - min) / rms(u);
    match changes {
        0 => Some(Warning::InputConstant),
        _ if swing < SWING_MIN && e.output_at_zero.is_none() => {
            Some(Warning::InputSwingSmall { swing_pct: 100.0 * swing })
        }
        _ if changes < nb => Some(Warning::InputChangesRarely { changes }),
        _ => None,
    }
}

fn undetermined(e: &Estimate) -> Option<Warning> {
    let parameters: Vec<String> =
        e.model.order.names().zip(&e.sd).filter(|(_, sd)| sd.is_none()).map(|(name, _)| name).collect();
    (!parameters.is_empty()).then_some(Warning::Undetermined { parameters })
}

fn gain(e: &Estimate) -> Option<Warning> {
    match e.static_gain {
        None => Some(Warning::GainUncertain { sd_pct: None }),
        Some(gain) => {
            let share = gain.sd / gain.value.abs();
            (share > GAIN_SD_MAX).then_some(Warning::GainUncertain { sd_pct: Some(100.0 * share) })
        }
    }
}

/// Weighted autocorrelation of the residuals against three standard deviations of that of white noise.
fn coloured(e: &Estimate) -> Option<Warning> {
    let (r, w) = (&e.residuals, &e.weights);
    let sum = |lag: usize| (lag..r.len()).map(|k| w[k] * r[k] * r[k - lag]).sum::<f64>();
    let total: f64 = w.iter().sum();
    let effective = total * total / w.iter().map(|w| w * w).sum::<f64>();
    let power = sum(0);
    let (lag, correlation) = (1..=LAGS.min(r.len() - 1))
        .map(|lag| (lag, sum(lag) / power))
        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
    (correlation.abs() > 3.0 / effective.sqrt()).then_some(Warning::ResidualsColoured { lag, correlation })
}

fn order_high(e: &Estimate) -> Option<Warning> {
    let order = e.model.order;
    let values: Vec<f64> = e.model.a.iter().chain(&e.model.b).copied().collect();
    let in_doubt = |i: usize| e.sd[i].is_some_and(|sd| values[i].abs() < 2.0 * sd);
    let last = [(order.na, order.na - 1), (order.nb, order.parameters() - 1)];
    let parameters: Vec<String> = last
        .into_iter()
        .filter(|&(orders, i)| orders > 1 && in_doubt(i))
        .filter_map(|(_, i)| order.names().nth(i))
        .collect();
    (!parameters.is_empty()).then_some(Warning::OrderHigh { parameters })
}

/// Looks at the values that y takes, if it takes most of them more than once.
fn coarse(s: &Signals, e: &Estimate) -> Option<Warning> {
    let mut levels = s.y.clone();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let mut steps: Vec<f64> = levels.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let step = *steps.get(steps.len() / 2)?;
    let repeats = 2 * levels.len() < s.y.len();
    (repeats && step > e.noise_variance.sqrt())
        .then_some(Warning::OutputCoarse { step, levels: levels.len() })
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::super::estimate::estimate;
    use super::super::model::{Order, mean};
    use super::*;

    const LAG: Order = Order { na: 1, nb: 1, nk: 1 };

    /// A lag of gain 2 under `u`, with white equation noise of the standard deviation `noise`.
    fn record(noise: f64, u: impl Fn(usize) -> f64) -> Signals {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
        let u: Vec<f64> = (0..1000).map(u).collect();
        let mut y = vec![0.0];
        for k in 1..u.len() {
            y.push(0.9 * y[k - 1] + 0.2 * u[k - 1] + noise * rng.sample::<f64, _>(StandardNormal));
        }
        Signals { u, y }
    }

    fn square(k: usize) -> f64 {
        if (k / 15).is_multiple_of(2) { 20.0 } else { 60.0 }
    }

    fn found(s: &Signals, order: Order) -> Vec<Warning> {
        warnings(s, &estimate(s, order, 1.0).unwrap())
    }

    #[test]
    fn a_sound_experiment_gives_no_warning() {
        assert_eq!(found(&record(0.3, square), LAG), []);
    }

    #[test]
    fn an_input_that_hardly_moves_is_noticed() {
        let constant = found(&record(0.3, |_| 50.0), LAG);
        assert_eq!(constant[0], Warning::InputConstant);
        let small = found(&record(0.3, |k| 50.0 + square(k) / 100.0), LAG);
        assert!(
            matches!(small[0], Warning::InputSwingSmall { swing_pct } if (swing_pct - 0.8).abs() < 0.01),
            "{small:?}"
        );
        let moved = record(0.3, |k| 50.0 + square(k) / 100.0);
        let about_means = found(&moved.minus(mean(&moved.u), mean(&moved.y)), LAG);
        assert!(!about_means.iter().any(|w| matches!(w, Warning::InputSwingSmall { .. })), "{about_means:?}");
        let step = |k| if k < 100 { 0.0 } else { 50.0 };
        assert_eq!(found(&record(0.3, step), LAG), []);
        assert_eq!(
            found(&record(0.3, step), Order { nb: 2, ..LAG })[0],
            Warning::InputChangesRarely { changes: 1 }
        );
    }

    #[test]
    fn without_movement_about_the_mean_the_gain_is_open() {
        let recorded = record(0.3, |_| 0.1); // which has no exact binary form
        let warnings = found(&recorded.minus(mean(&recorded.u), mean(&recorded.y)), LAG);
        assert!(warnings.contains(&Warning::Undetermined { parameters: vec!["b1".into()] }), "{warnings:?}");
        assert!(warnings.contains(&Warning::GainUncertain { sd_pct: None }), "{warnings:?}");
    }

    #[test]
    fn a_gain_drowned_in_noise_is_uncertain() {
        let warnings = found(&record(30.0, |k| square(k) - 40.0), LAG);
        let sd = |w: &Warning| matches!(w, Warning::GainUncertain { sd_pct: Some(sd) } if *sd > 20.0);
        assert!(warnings.iter().any(sd), "{warnings:?}");
    }

    #[test]
    fn an_unstable_model_is_named() {
        let y: Vec<f64> = (0..300).map(|k| 1.02f64.powi(k)).collect();
        let s = Signals { u: (0..300).map(square).collect(), y };
        assert!(found(&s, LAG).contains(&Warning::Unstable));
    }

    #[test]
    fn measurement_noise_colours_the_residuals() {
        let mut s = record(0.0, square);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
        s.y.iter_mut().for_each(|y| *y += rng.sample::<f64, _>(StandardNormal));
        let warnings = found(&s, LAG);
        let negative = |w: &Warning| matches!(w, Warning::ResidualsColoured { lag: 1, correlation } if *correlation < -0.2);
        assert!(warnings.iter().any(negative), "{warnings:?}");
    }

    #[test]
    fn superfluous_orders_are_named() {
        let warnings = found(&record(0.3, square), Order { na: 3, nb: 2, nk: 1 });
        assert_eq!(warnings, [Warning::OrderHigh { parameters: vec!["a3".into(), "b2".into()] }]);
    }

    #[test]
    fn coarse_steps_of_the_output_are_measured() {
        let mut s = record(0.1, square);
        s.y.iter_mut().for_each(|y| *y = (*y / 2.0).round() * 2.0);
        let coarse = |w: &Warning| matches!(w, Warning::OutputCoarse { step: 2.0, levels: 20..60 });
        let warnings = found(&s, LAG);
        assert!(warnings.iter().any(coarse), "{warnings:?}");
    }

    #[test]
    fn rounding_is_not_taken_for_noise() {
        assert_eq!(found(&record(0.0, square), LAG), []);
    }

    #[test]
    fn every_warning_is_data_with_a_name_and_a_sentence() {
        let warning = Warning::ResidualsColoured { lag: 2, correlation: -0.25 };
        let json = serde_json::to_string(&warning).unwrap();
        assert_eq!(json, r#"{"warning":"residuals-coloured","lag":2,"correlation":-0.25}"#);
        assert!(warning.to_string().contains("correlation -0.25 at lag 2"));
    }
}
