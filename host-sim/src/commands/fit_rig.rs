//! `pt326 fit-rig`: a simulated rig that answers as a recorded one does.

use std::path::PathBuf;

use anyhow::Context;
use indicatif::ProgressBar;

use super::diagnose::ReadingArgs;
use super::terminal::print;
use pt326_host::recording::Recording;
use pt326_host::recording::fit_rig::Fitted;

/// Arguments of `fit-rig`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
The model that the diagnosis learns gives gain, lags, dead time and wall; what it leaves unexplained gives noise and wander. What one thermistor \
cannot tell (T2, where there is none; the fan) is the reference rig's.

Examples:
  pt326 fit-rig prbs.csv -o my-rig.toml
  pt326 fit-rig dryer.csv --map t1=y --map power=u --ts 0.08 --full-power 10 --degc 10 -o dryer.toml
  pt326 run --scenario my-rig.toml --config my-settings.toml")]
pub struct FitRigArgs {
    /// The recording, without a fault and with a power that moves.
    #[arg(value_name = "RECORD")]
    pub file: PathBuf,
    #[command(flatten)]
    /// How to read it.
    pub reading: ReadingArgs,
    /// Which heater, counted from 1, if the recording has several.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub heater: usize,
    /// The scenario to write.
    #[arg(short, long, value_name = "FILE.toml")]
    pub out: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// A bad file or value, a recording that nothing can be learnt from, or a file that can't be written.
pub fn run(args: &FitRigArgs) -> anyhow::Result<()> {
    let recording = Recording::read(&args.file, &args.reading.reading()?)?;
    let fitted = Fitted::new(&recording, args.heater, &ProgressBar::hidden())?;
    std::fs::write(&args.out, &fitted.scenario)
        .with_context(|| format!("can't write {}", args.out.display()))?;
    print(&format!(
        "{}{}{}\nFit, simulated: {:.1} % of T1\nWritten to {}\n",
        fitted.warning,
        fitted.beyond,
        recording.heaters[args.heater - 1].map,
        fitted.fit,
        args.out.display()
    ))
}
