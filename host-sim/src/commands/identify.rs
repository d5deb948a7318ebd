//! `pt326 identify`: the core's identification on a recorded file.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::terminal::{WARNING, print, styled};
use pt326_host::identify::detrend;
use pt326_host::identify::model::Order;
use pt326_host::identify::{Asked, identify};
use pt326_host::recording::table::Table;

/// Arguments of `identify`.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
The file has one sample in each row, at equal times; commas, semicolons, tabs or blanks separate columns. Lines that \
begin with # are skipped. Rows are counted from 0, without the header and the skipped lines. A range has its first row \
and not its last: --from 0 --to 600 is the first 600 rows, and --validate 600:1000 the 400 after them. A column of \
times in s (named t, time, t_s, ...) is checked for gaps and against --ts.

The model is y[k] + a1 y[k-1] + .. + aNA y[k-NA] = b1 u[k-NK] + .. + bNB u[k-NK-NB+1] + e[k]. The board's recursive \
least squares finds its parameters; static gain, bandwidth and poles follow from them. The fit is \
100 % (1 - |y - model| / |y - mean(y)|), one step ahead and simulated from the input alone. Nearly any model of a slow \
process fits one step ahead: trust the simulated fit, on rows that were not used to estimate.

Examples:
  pt326 identify out/trace.csv --u pa_pct --y y1_c --order 3,3,1 --from 1700 --to 3300
  pt326 identify step.txt --u 2 --y 3 --order 1,1,1 --ts 1 --to 600 --validate 600:1000 --json
  head -500 step.csv | pt326 identify - --u Q1 --y T1 --order 2,1,1")]
pub struct IdentifyArgs {
    /// The recording; - is standard input.
    pub file: PathBuf,
    /// The column of the input: its name in the header or, if none has that name, its number, counted from 1.
    #[arg(long, value_name = "COL")]
    pub u: String,
    /// The column of the output, likewise.
    #[arg(long, value_name = "COL")]
    pub y: String,
    /// Orders of the model: number of past outputs (1 to 8), number of inputs (1 to 8), delay in samples (1 to 100).
    #[arg(long, value_name = "NA,NB,NK")]
    pub order: Order,
    /// Sample time in s. Default: the usual step in the column of times, if there is one.
    #[arg(long, value_name = "S", value_parser = sample_time)]
    pub ts: Option<f64>,
    /// Forgetting factor, 0.5 to 1: a row n samples before the last has the weight lambda^n. With 1 all rows weigh the
    /// same; with less, the model is that of about the last 1 / (1 - lambda) rows.
    #[arg(long, value_name = "L", default_value_t = 1.0, value_parser = forgetting_factor)]
    pub lambda: f64,
    /// What to do about the values that u and y have at rest.
    #[arg(long, value_enum, default_value_t = Detrend::Auto)]
    pub detrend: Detrend,
    /// First row to estimate from, counted from 0.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub from: usize,
    /// The row after the last one to estimate from. Default: the number of rows.
    #[arg(long, value_name = "M")]
    pub to: Option<usize>,
    /// Rows to test the model on, from N to M - 1.
    #[arg(long, value_name = "N:M", value_parser = row_range)]
    pub validate: Option<Range<usize>>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    pub json: bool,
}

fn sample_time(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|s: &f64| *s > 0.0 && s.is_finite());
    seconds.ok_or_else(|| "expected a number of seconds above 0".into())
}

fn forgetting_factor(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|l| (0.5..=1.0).contains(l))
        .ok_or_else(|| "expected a number from 0.5 to 1".into())
}

fn row_range(text: &str) -> Result<Range<usize>, String> {
    let range = text.split_once(':').and_then(|(n, m)| Some(n.trim().parse().ok()?..m.trim().parse().ok()?));
    range.filter(|r| r.start < r.end).ok_or_else(|| "expected two row numbers N:M with N < M".into())
}

/// Runs `pt326 identify`: prints the report to standard output.
///
/// # Errors
/// What is wrong in the file or the arguments, by name.
pub fn run(args: &IdentifyArgs) -> anyhow::Result<()> {
    let report = identify(&args.asked(), &Table::read(&args.file)?)?;
    let text = match args.json {
        true => serde_json::to_string_pretty(&report)? + "\n",
        false => report.to_string().replace("warning:", &styled(WARNING, "warning:")),
    };
    print(&text)
}

/// The library's [`detrend::Detrend`] as a word of the command line, with its help.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Detrend {
    /// As offset, if y is clearly not zero when u is, as a temperature is not; else as none. The report says which.
    Auto,
    /// Take both as they are: right if y is zero when u is, as a rise above room temperature is.
    None,
    /// Subtract the means: for small movements about an operating point.
    Mean,
    /// Estimate what y is when u is zero, together with the model: right for steps and other transients, too.
    Offset,
}

impl From<Detrend> for detrend::Detrend {
    fn from(word: Detrend) -> Self {
        match word {
            Detrend::Auto => Self::Auto,
            Detrend::None => Self::None,
            Detrend::Mean => Self::Mean,
            Detrend::Offset => Self::Offset,
        }
    }
}

impl IdentifyArgs {
    fn asked(&self) -> Asked {
        Asked {
            u: self.u.clone(),
            y: self.y.clone(),
            order: self.order,
            ts: self.ts,
            lambda: self.lambda,
            detrend: self.detrend.into(),
            from: self.from,
            to: self.to,
            validate: self.validate.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use pt326_host::identify::warning::Warning;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        args: IdentifyArgs,
    }

    fn args(options: &str) -> Asked {
        let line = format!("x f --u u --y y --ts 0.5 {options}");
        Cli::try_parse_from(line.split_whitespace()).unwrap().args.asked()
    }

    /// y[k] = 0.9 y[k-1] + 0.2 u[k-1] exactly, u a square wave; from row 60 on, y is twice that.
    fn table() -> Table {
        let (mut text, mut y) = ("u,y\n".to_owned(), 0.0);
        for k in 0..100 {
            let u = if (k / 8_u32).is_multiple_of(2) { 1.0 } else { 3.0 };
            let gain = if k < 60 { 1.0 } else { 2.0 };
            text += &format!("{u},{}\n", gain * y);
            y = 0.9 * y + 0.2 * u;
        }
        Table::parse("f".into(), &text).unwrap()
    }

    fn error(options: &str) -> String {
        identify(&args(options), &table()).unwrap_err().to_string()
    }

    #[test]
    fn finds_an_exact_model_and_says_so() {
        let report = identify(&args("--order 1,1,1 --to 60"), &table()).unwrap();
        let close = |x: f64, expected: f64| assert!((x - expected).abs() < 1e-5, "{x}, expected {expected}");
        close(report.findings.parameters[0].value, -0.9);
        close(report.findings.parameters[1].value, 0.2);
        close(report.findings.static_gain.unwrap().value, 2.0);
        close(report.fits.simulated_fit_pct.unwrap(), 100.0);
        assert_eq!(report.warnings, []);
        assert_eq!(report.initial_state, "from the first measured row of the range");
    }

    #[test]
    fn a_range_is_all_that_counts_and_validation_sees_what_lies_beyond() {
        let report = identify(&args("--order 1,1,1 --to 60 --validate 61:100"), &table()).unwrap();
        let validation = report.validation.unwrap();
        assert_eq!((validation.from, validation.to), (61, 100));
        assert!(validation.fits.simulated_fit_pct.unwrap() < 50.0, "{validation:?}");
        let second = identify(&args("--order 1,1,1 --from 61 --validate 50:70"), &table()).unwrap();
        assert!((second.findings.static_gain.unwrap().value - 4.0).abs() < 1e-4);
        assert_eq!(second.warnings, [Warning::ValidationOverlaps]);
    }

    #[test]
    fn forgetting_follows_a_change() {
        let gain = |options: &str| {
            let report = identify(&args(options), &table()).unwrap();
            report.findings.static_gain.unwrap().value
        };
        assert!((gain("--order 1,1,1 --lambda 0.6") - 4.0).abs() < 1e-3);
        assert!((gain("--order 1,1,1") - 4.0).abs() > 0.1);
    }

    #[test]
    fn means_are_removed_on_request() {
        let report = identify(&args("--order 1,1,1 --from 20 --to 60 --detrend mean"), &table()).unwrap();
        assert!((report.findings.static_gain.unwrap().value - 2.0).abs() < 0.05);
        assert!(report.to_string().contains("means removed"));
    }

    #[test]
    fn json_is_one_flat_object_with_nulls_where_nothing_is() {
        let report = identify(&args("--order 2,1,1 --to 60"), &table()).unwrap();
        let json: serde_json::Value = serde_json::to_value(&report).unwrap();
        let keys: Vec<&String> = json.as_object().unwrap().keys().collect();
        for key in [
            "file",
            "rows",
            "from",
            "to",
            "order",
            "ts_s",
            "lambda",
            "detrend",
            "parameters",
            "noise_variance",
            "static_gain",
            "bandwidth_rad_s",
            "bandwidth_reason",
            "residence_time_s",
            "stable",
            "poles",
            "one_step_fit_pct",
            "simulated_fit_pct",
            "initial_state",
            "validation",
            "warnings",
        ] {
            assert!(keys.iter().any(|k| *k == key), "{key} is missing in {keys:?}");
        }
        assert_eq!(json["order"], serde_json::json!({"na": 2, "nb": 1, "nk": 1}));
        assert_eq!((&json["rows"], &json["to"]), (&100.into(), &60.into()));
        assert!(json["validation"].is_null());
    }

    #[test]
    fn what_cannot_be_done_is_refused_by_name() {
        assert!(error("--order 1,1,1 --to 101").contains("<= 100, the number of data rows"));
        assert!(error("--order 1,1,1 --from 50 --to 50").contains("rows 50:50 of f"));
        assert!(
            error("--order 8,8,100 --to 60").contains("60 rows are too few: 16 parameters need at least 124")
        );
        assert!(error("--order 1,1,1 --to 60 --validate 60:62").contains("--validate: 2 rows are too few"));
        assert!(error("--order 8,8,1 --lambda 0.5").contains("raise --lambda"));
    }

    #[test]
    fn bad_options_are_refused() {
        for bad in [
            "--order 1,1",
            "--order 1,1,1 --lambda 0.4",
            "--order 1,1,1 --lambda nan",
            "--order 1,1,1 --validate 5:5",
        ] {
            let line = format!("x f --u u --y y --ts 0.5 {bad}");
            assert!(Cli::try_parse_from(line.split_whitespace()).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "inf", "x"] {
            assert!(sample_time(bad).is_err(), "{bad}");
        }
    }
}
