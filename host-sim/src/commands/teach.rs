//! `pt326 teach`: a user's own faults, from a recording in which they were made.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use fdi_core::Config;
use fdi_core::likelihood::taught::Responses;

use super::replay::{ReplayArgs, again};
use super::terminal::{WARNING, print, styled};
use pt326_host::settings::commented_toml_of;
use pt326_host::teach::{Diagnoses, Marks, Said, Taught};

/// Arguments of `teach`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Make a fault by hand (a hand before the inlet, a cap on T1), some 20 s long, three times or more, each time after the rig has come to rest, and \
note when. The end of each repetition, a quarter to a half of it, says which of the paper's five residuals are low, normal or high; what all repetitions \
have in common is the row, anything else may be anything (x). A row that some symptoms would match together with a row that is there \
is not taught. A name that the settings have already is taught anew.

All rows are then tried on the recording: whether each repetition is found, and what else is named. A row that a recording without a fault \
(--quiet) shows is not taught either.

The likelihood diagnosis is taught what the fault changes, in the mean of the repetitions, and tried in the same way. It tells the fault by this name beside \
its own.

With --out the settings are written with what was taught, for `pt326 run --config` and `pt326 board settings load`.

The exit code is 1 if a name could not be taught to both diagnoses.

Examples:
  pt326 teach board.log --fault hand:385..410,495..520,605..630 --out taught.toml
  pt326 teach out/trace.csv --fault hand:400..425 --fault cap:480..505 --fault hand:640..665")]
pub struct TeachArgs {
    /// The recording: a board's log from its start on, or a trace.csv.
    pub file: PathBuf,
    /// A fault, and when it was there, s; may be given several times, for one name, too.
    #[arg(long = "fault", value_name = "NAME:FROM..TO,...", required = true)]
    pub faults: Vec<Marks>,
    /// Settings that the recording was made with, TOML; on a board's log its own settings come on top.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Seed of the run that made a trace.csv. Default: that of the summary.json beside it, else 1.
    #[arg(long)]
    pub seed: Option<u64>,
    /// A recording of the same rig in which nothing was done, such as a night: what it shows is not taught. May be given several times.
    #[arg(long, value_name = "FILE")]
    pub quiet: Vec<PathBuf>,
    /// Write the settings with what was taught.
    #[arg(long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
}

/// Runs the command; the exit code says whether every name was taught.
///
/// # Errors
/// A file that is no recording; one to which the core does not come again; a time at which nothing was monitored; full tables.
pub fn run(args: &TeachArgs) -> anyhow::Result<ExitCode> {
    let marks = Marks::by_name(&args.faults);
    let lesson = watch(args, &args.file, args.seed, None)?;
    let quiet = |taught: Option<&Responses>| {
        let each = args.quiet.iter().map(|file| Ok(watch(args, file, None, taught)?.watch));
        each.collect::<anyhow::Result<Vec<_>>>()
    };
    let mut taught = Taught::of(&lesson.watch, &lesson.config, &marks, &quiet(None)?)?;
    // A response is in no table that could be looked up: the core says what it makes of it.
    let responses = taught.config.likelihood.taught.clone();
    let again = watch(args, &args.file, args.seed, Some(&responses))?;
    taught.recall(&again.watch, &marks, &quiet(Some(&responses))?);
    for lesson in &taught.lessons {
        print(&format!("\n{lesson}"))?;
    }
    if let Some(out) = &args.out {
        let head = "# Settings with rows of `pt326 teach`: for `run --config`, `board settings load`.\n";
        std::fs::write(out, head.to_owned() + &commented_toml_of(&taught.config))
            .with_context(|| format!("{} cannot be written", out.display()))?;
        print(&format!("\nWritten to {}\n", out.display()))?;
    }
    if taught.all_stand() && taught.all_are_recalled() {
        return Ok(ExitCode::SUCCESS);
    }
    print(&format!("{}\n", styled(WARNING, "Not every name was taught to both diagnoses.")))?;
    Ok(ExitCode::from(1))
}

/// A recording that was run through the core again, and the settings at its end.
struct Watched {
    watch: Diagnoses,
    config: Config,
}

/// Runs a recording through the core again, which must come to it, or, with `taught`, as if these faults had been taught before.
fn watch(
    args: &TeachArgs,
    file: &Path,
    seed: Option<u64>,
    taught: Option<&Responses>,
) -> anyhow::Result<Watched> {
    let args = ReplayArgs { file: file.to_owned(), config: args.config.clone(), seed, out: PathBuf::new() };
    let mut said = Vec::new();
    let again = again(&args, taught, |instrument, _, report| said.push(Said::of(instrument, report)))?;
    if taught.is_none() {
        print(&again.told)?;
        ensure!(again.agrees, "nothing is taught from a recording to which the core does not come again");
    }
    Ok(Watched { watch: Diagnoses { sample_time: again.record.sample_time, said }, config: again.config })
}
