//! `host-sim run`: one experiment, its table, its files.

use std::io::Write;
use std::path::Path;

use crate::commands::RunArgs;
use crate::experiment::{self, Record};
use crate::record::summary::Summary;
use crate::record::{files, table};

/// Runs the experiment, prints what happened and writes everything into `--out`.
///
/// # Errors
/// A bad file or value, or a folder that can't be written.
pub fn run(args: &RunArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load()?;
    tell(&experiment::run(&config, &scenario, args.seed)?, &args.out)
}

/// Prints what a run showed and writes its files.
///
/// # Errors
/// A folder that can't be written.
pub fn tell(record: &Record, dir: &Path) -> anyhow::Result<()> {
    let summary = Summary::new(record);
    std::io::stdout().write_all(table::of_run(record, &summary).as_bytes())?;
    files::write(record, &summary, dir)?;
    let out = dir.display();
    println!(
        "\nWritten to {out}: report.html (open this), trace.csv, summary.json, figure4 to figure6 as .svg and .png"
    );
    Ok(())
}
