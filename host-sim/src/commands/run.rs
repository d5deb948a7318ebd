//! `host-sim run`: one experiment, its table, its files.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Context;

use crate::commands::RunArgs;
use crate::experiment::{self, Record};
use crate::record::summary::Summary;
use crate::record::table;
use crate::record::trace::write_trace;
use crate::record::{figure, report};

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
    write_files(record, &summary, dir)?;
    let out = dir.display();
    println!(
        "\nWritten to {out}: report.html (open this), trace.csv, summary.json, figure4 to figure6 as .svg and .png"
    );
    Ok(())
}

/// Writes trace, summary, figures and report.
///
/// # Errors
/// The folder or file that can't be written.
pub fn write_files(record: &Record, summary: &Summary, dir: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(dir).with_context(|| format!("can't make the folder {}", dir.display()))?;
    let write = |name: &str, content: &dyn Fn(&mut BufWriter<File>) -> anyhow::Result<()>| {
        let path = dir.join(name);
        let attempt = || -> anyhow::Result<()> {
            let mut out = BufWriter::new(File::create(&path)?);
            content(&mut out)?;
            Ok(out.flush()?)
        };
        attempt().with_context(|| format!("can't write {}", path.display()))
    };
    write("trace.csv", &|out| Ok(write_trace(record, out)?))?;
    write("summary.json", &|out| {
        serde_json::to_writer_pretty(&mut *out, summary)?;
        Ok(writeln!(out)?)
    })?;
    figure::draw_all(record, dir)?;
    write("report.html", &|out| Ok(out.write_all(report::html(record, summary)?.as_bytes())?))
}
