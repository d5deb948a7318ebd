//! `pt326 teach`: a user's own faults, from a recording in which they were made.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};

use super::replay::{Again, ReplayArgs, again};
use super::terminal::{WARNING, print, styled};
use crate::settings::commented_toml_of;
use crate::teach::{Marks, Taught, Watch};

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
    let lesson = whole(args, &args.file, args.seed)?;
    let quiet = args.quiet.iter().map(|file| Ok(Watch::of(&whole(args, file, None)?.record)));
    let (quiet, marks) = (quiet.collect::<anyhow::Result<Vec<_>>>()?, Marks::by_name(&args.faults));
    let mut taught = Taught::of(&Watch::of(&lesson.record), &lesson.config, &marks, &quiet)?;
    // A response is in no table that could be looked up: the core says what it makes of it.
    let responses = taught.config.likelihood.taught.clone();
    let with = |file: &Path, seed| {
        Ok::<_, anyhow::Error>(Watch::of(&again(&asked(args, file, seed), Some(&responses))?.record))
    };
    let quiet = args.quiet.iter().map(|file| with(file, None)).collect::<anyhow::Result<Vec<_>>>()?;
    taught.recall(&with(&args.file, args.seed)?, &marks, &quiet);
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

fn asked(args: &TeachArgs, file: &Path, seed: Option<u64>) -> ReplayArgs {
    ReplayArgs { file: file.to_owned(), config: args.config.clone(), seed, out: PathBuf::new() }
}

/// A recording to which the core comes again.
fn whole(args: &TeachArgs, file: &Path, seed: Option<u64>) -> anyhow::Result<Again> {
    let again = again(&asked(args, file, seed), None)?;
    print(&again.told)?;
    ensure!(again.agrees, "nothing is taught from a recording to which the core does not come again");
    Ok(again)
}
