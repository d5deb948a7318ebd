//! The files of a run: trace.csv, summary.json, the figures and report.html.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Context;

use crate::experiment::Record;
use crate::record::summary::Summary;
use crate::record::trace::write_trace;
use crate::record::{figure, report};

/// Writes them into a folder, which is made if need be. `page`: what is told in place of the lab's page with the paper's figures.
///
/// # Errors
/// The folder or file that can't be written.
pub fn write(record: &Record, summary: &Summary, page: Option<&str>, dir: &Path) -> anyhow::Result<()> {
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
    if let Some(page) = page {
        return write("report.html", &|out| Ok(out.write_all(page.as_bytes())?));
    }
    figure::draw_all(record, dir)?;
    write("report.html", &|out| Ok(out.write_all(report::html(record, summary).as_bytes())?))
}
