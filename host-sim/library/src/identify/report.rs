//! The report of an identification: one structure, printed for people or as JSON.

use std::fmt::{self, Display};

use serde::Serialize;

use super::detrend::Detrend;
use super::estimate::Uncertain;
use super::findings::{Findings, Fits, Parameter};
use super::model::Order;
use super::poles::Complex;
use super::warning::Warning;

/// All results; `--json` prints this as one flat object. What does not exist is null.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What was asked.
    #[serde(flatten)]
    pub question: Question,
    /// What the model says.
    #[serde(flatten)]
    pub findings: Findings,
    /// Fits in the estimation range.
    #[serde(flatten)]
    pub fits: Fits,
    /// Where a simulation starts.
    pub initial_state: String,
    /// Fits in the validation range.
    pub validation: Option<Validation>,
    /// Reasons for doubt.
    pub warnings: Vec<Warning>,
}

/// What was identified from what, and how.
#[derive(Clone, Debug, Serialize)]
pub struct Question {
    /// The recording.
    pub file: String,
    /// Data rows in the file.
    pub rows: usize,
    /// First row of the estimation range, from 0.
    pub from: usize,
    /// First row behind the estimation range.
    pub to: usize,
    /// Input column.
    pub u: String,
    /// Output column.
    pub y: String,
    /// Orders of the model.
    pub order: Order,
    /// Sample time, s.
    pub ts_s: f64,
    /// Forgetting factor.
    pub lambda: f64,
    /// What was done about the values at rest.
    pub detrend: Detrend,
    /// Whether that was left to the program.
    pub detrend_chosen: bool,
}

/// Fits in the validation range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Validation {
    /// First row, from 0.
    pub from: usize,
    /// First row behind the range.
    pub to: usize,
    /// How well the model does there.
    #[serde(flatten)]
    pub fits: Fits,
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.question.write(f)?;
        self.findings.write_parameters(f)?;
        self.findings.write_features(f, &self.question)?;
        self.write_fits(f)?;
        if !self.warnings.is_empty() {
            writeln!(f)?;
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning: {warning}"))
    }
}

impl Report {
    fn write_fits(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Question { from, to, .. } = self.question;
        writeln!(f, "\n{:<32}{:>12}{:>14}", "fit", "one step", "simulated")?;
        let mut line = |range: &str, from, to, fits: &Fits| {
            let (one_step, simulated) = (percent(fits.one_step_fit_pct), percent(fits.simulated_fit_pct));
            writeln!(f, "{:<32}{one_step:>12}{simulated:>14}", format!("{range}, rows {from}:{to}"))
        };
        line("estimation", from, to, &self.fits)?;
        if let Some(v) = &self.validation {
            line("validation", v.from, v.to, &v.fits)?;
        }
        writeln!(f, "simulated {}", self.initial_state)
    }
}

impl Question {
    fn write(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, rows, from, to, u, y, ts_s, lambda, .. } = self;
        let Order { na, nb, nk } = self.order;
        let detrend = match self.detrend {
            Detrend::Auto | Detrend::None => "no offset removed",
            Detrend::Mean => "means removed",
            Detrend::Offset => "offset of y estimated",
        };
        writeln!(f, "ARX({na},{nb},{nk}) from {u} to {y}, {file}")?;
        writeln!(f, "rows {from}:{to} of {rows}, {ts_s} s apart; lambda {lambda}, {detrend}")?;
        if self.detrend_chosen && self.detrend == Detrend::Offset {
            writeln!(f, "since {y} is not zero while {u} is; --detrend none takes it as if it were")?;
        }
        writeln!(f)
    }
}

impl Findings {
    fn write_parameters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:<16}{:>14}{:>20}", "parameter", "value", "standard deviation")?;
        for Parameter { name, value, sd } in &self.parameters {
            let sd = sd.map_or("undetermined".into(), |sd| digits(sd, 3));
            writeln!(f, "{name:<16}{:>14}{sd:>20}", digits(*value, 6))?;
        }
        writeln!(f)
    }

    fn write_features(&self, f: &mut fmt::Formatter<'_>, q: &Question) -> fmt::Result {
        let Question { u, y, ts_s, .. } = q;
        let mut line = |name: &str, text: String| writeln!(f, "{name:<16}{text}");
        let (variance, noise_sd) = (digits(self.noise_variance, 4), digits(self.noise_variance.sqrt(), 4));
        line("noise variance", format!("{variance}, a standard deviation of {noise_sd} {y}"))?;
        line(
            "static gain",
            match self.static_gain {
                Some(Uncertain { value, sd }) => {
                    format!("{} +- {} {y} per {u}", digits(value, 4), digits(sd, 2))
                }
                None => "none: the data do not determine it, or the model integrates".into(),
            },
        )?;
        if let Some(Uncertain { value, sd }) = self.output_at_zero_input {
            line("offset", format!("{} +- {} {y} where {u} is 0", digits(value, 4), digits(sd, 2)))?;
        }
        line(
            "bandwidth",
            match self.bandwidth_rad_s {
                Some(w) => format!("{} rad/s = 3 / t95, t95 = {} s", digits(w, 4), digits(3.0 / w, 4)),
                None => format!("none: {}", self.bandwidth_reason.unwrap_or_default()),
            },
        )?;
        if let Some(time) = self.residence_time_s {
            line("residence time", format!("{} s, time constants and dead time together", digits(time, 4)))?;
        }
        line("stable", if self.stable { "yes" } else { "no" }.into())?;
        let poles: Vec<String> = self.poles.iter().filter_map(|p| pole(p, *ts_s)).collect();
        line("poles", poles.join(", "))
    }
}

/// An imaginary part below this is rounding.
const REAL: f64 = 1e-9;

/// A pole: a conjugate pair once, a real one between 0 and 1 with its time constant.
fn pole(p: &Complex, ts: f64) -> Option<String> {
    let re = digits(p.re, 5);
    match p.im {
        im if im > REAL => Some(format!("{re} +- {}i", digits(im, 5))),
        im if im < -REAL => None,
        _ if 0.0 < p.re && p.re < 1.0 => Some(format!("{re} ({} s)", digits(-ts / p.re.ln(), 4))),
        _ => Some(re),
    }
}

fn percent(fit: Option<f64>) -> String {
    match fit {
        Some(fit) if fit < -999.0 => "below -999 %".into(),
        Some(fit) => format!("{fit:.2} %"),
        None => "none".into(),
    }
}

/// `x` with so many significant digits; as a power of ten where it is very small or large.
fn digits(x: f64, significant: i32) -> String {
    let magnitude = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    let decimals = |n: i32| usize::try_from(n).unwrap_or(0);
    if (-4..7).contains(&magnitude) {
        format!("{x:.*}", decimals(significant - 1 - magnitude))
    } else {
        format!("{x:.*e}", decimals(significant - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits() {
        let text = [0.0, 1.0, -0.994806, 0.0000123456, 575.2837, 123456.7, 1.5e9].map(|x| digits(x, 4));
        assert_eq!(text, ["0.000", "1.000", "-0.9948", "1.235e-5", "575.3", "123457", "1.500e9"]);
    }

    #[test]
    fn a_conjugate_pair_is_written_once() {
        let text = |re, im| pole(&Complex { re, im }, 2.0);
        assert_eq!(text(0.5, 0.25).as_deref(), Some("0.50000 +- 0.25000i"));
        assert_eq!(text(0.5, -0.25), None);
        assert_eq!(text((-0.025f64).exp(), -1e-30).as_deref(), Some("0.97531 (80.00 s)"));
        assert_eq!(text(-0.5, 0.0).as_deref(), Some("-0.50000"));
    }

    #[test]
    fn a_fit_that_runs_away_is_not_spelt_out() {
        assert_eq!([Some(98.321), Some(-1e30), None].map(percent), ["98.32 %", "below -999 %", "none"]);
    }
}
