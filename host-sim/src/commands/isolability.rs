//! `pt326 isolability`: which faults can be told apart on a rig, in numbers.

use std::path::PathBuf;

use anyhow::ensure;

use super::experiment::ExperimentArgs;
use super::results::Folder;
use super::terminal::{print, progress};
use pt326_host::experiment;
use pt326_host::isolability::{Isolability, Question, output};

/// Arguments of `isolability`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
How small a fault can still be told apart? The instrument learns the rig as in any run, with what the scenario's user does and without its \
faults. From then on each fault is assumed to begin every 100 samples. Its signature is computed from the model, the learnt \
noise and the power that is really applied. A cell of the table is the size from which on the fault of its row is told from the fault of its column, of \
whatever size; it is the median over all onsets. Told means: odds of 20 to 1 in the mean (a Kullback-Leibler distance of ln 20), if both were equally \
likely beforehand; a rare fault needs more, as in the diagnosis. Mains, room, sensors and model may vary as much as \
the diagnosis allows them. docs/diagnosis.md, section 14, has the equation.

  none      from no fault at all: it can be seen          any    at every size that it may have
  all       from all others and none: it can be named     -      at no size that it may have
  off, out  reads too high or too low; out of the tube

Time counts from the first sample that shows anything. A real alarm asks for more before it is raised, and says \"air flow or heater power\" for the \
first 3 s. The power is that of a rig without a fault; how the controller reacts to a fault shows more.

Examples:
  pt326 isolability
  pt326 isolability --preset trainer --within 0.5,5,30 --out trainer
  pt326 isolability --scenario my.toml      does more excitation help? is another set-point better?

Written: isolability.csv, and a picture for each time, such as isolability-10s.svg.")]
pub struct IsolabilityArgs {
    /// Seed of the rig's noise and of the phase of the excitation.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Times within which a fault is to be told, s.
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', default_value = "1,10,60")]
    pub within: Vec<f64>,
    /// Take rare faults (stuck, exchanged, out of the tube, drifting, mended) to be as likely beforehand as all others.
    #[arg(long)]
    pub equal_odds: bool,
    #[command(flatten)]
    /// The experiment.
    pub experiment: ExperimentArgs,
    /// Folder for isolability.csv and the pictures; made if need be.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// A bad file or value, a run in which nothing was learnt, or a folder that can't be written.
pub fn run(args: &IsolabilityArgs) -> anyhow::Result<()> {
    let mut horizons = args.within.clone();
    for s in &horizons {
        ensure!((0.01..=1e5).contains(s), "--within has {s}, expected 0.01 to 100000 s");
    }
    horizons.sort_by(f64::total_cmp);
    let (config, scenario) = args.experiment.load()?;
    Folder::open(&args.out)?;
    let ticks = scenario.duration / experiment::as_written(config.sample_time.0);
    let bar = progress(ticks as u64, "ticks");
    let question = Question { seed: args.seed, horizons, equal_odds: args.equal_odds };
    let found = Isolability::of(&config, &scenario, &question, &bar)?;
    bar.finish_and_clear();
    output::write_csv(&found, &args.out.join("isolability.csv"))?;
    let pictures = output::draw(&found, &args.out)?;
    print(&format!(
        "{}Median of {} onsets from {:.0} s on; the sign is the row's.\nWritten to {}: isolability.csv, {} (.svg)\n",
        output::tables(&found),
        found.onsets,
        found.armed_at,
        args.out.display(),
        pictures.join(", ")
    ))
}
