//! The folder that the results of a run go to: whether it can be written to is known before the work, and what an earlier
//! run has left there is not lost.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;

use pt326_host::experiment::Record;
use pt326_host::record::files;
use pt326_host::record::summary::Summary;
use pt326_host::record::trace::write_trace;

/// What is made of a run.
pub(super) const FILES: [&str; 6] =
    ["report.html", "trace.csv", "summary.json", "figure4.svg", "figure5.svg", "figure6.svg"];

/// A folder for results, which can be written to.
#[derive(Debug)]
pub struct Folder {
    dir: PathBuf,
}

impl Folder {
    /// Makes the folder if need be, and tries whether it takes files.
    ///
    /// # Errors
    /// It is no folder, or no file can be made there.
    pub fn open(dir: &Path) -> anyhow::Result<Self> {
        let attempt = || {
            fs::create_dir_all(dir)?;
            let trial = dir.join(".pt326");
            File::create(&trial)?;
            fs::remove_file(trial)
        };
        attempt().with_context(|| format!("can't write to the folder {}", dir.display()))?;
        Ok(Self { dir: dir.to_owned() })
    }

    /// Writes trace, summary, and report with figures, or a page in their place. Results of another run are moved to a folder of their own before.
    ///
    /// # Errors
    /// The file that can't be written or moved.
    pub fn write(&self, record: &Record, summary: &Summary, page: Option<&str>) -> anyhow::Result<Written> {
        let moved = self.set_aside_another(record)?;
        files::write(record, summary, page, &self.dir)?;
        Ok(Written { dir: self.dir.clone(), moved, has_figures: page.is_none() })
    }

    /// Moves what is there to the first free `earlier-N`, unless it is of the same run.
    fn set_aside_another(&self, record: &Record) -> anyhow::Result<Option<PathBuf>> {
        let old: Vec<&str> = FILES.into_iter().filter(|name| self.dir.join(name).exists()).collect();
        if old.is_empty() || is_trace_of(record, &self.dir.join("trace.csv")) {
            return Ok(None);
        }
        let free = (1..).map(|n| self.dir.join(format!("earlier-{n}"))).find(|aside| !aside.exists());
        let aside = free.context("no name is free for the earlier results")?;
        let attempt = || {
            fs::create_dir(&aside)?;
            old.iter().try_for_each(|name| fs::rename(self.dir.join(name), aside.join(name)))
        };
        attempt().with_context(|| format!("can't move the earlier results to {}", aside.display()))?;
        Ok(Some(aside))
    }
}

/// What was written, for people.
#[derive(Debug)]
pub struct Written {
    dir: PathBuf,
    /// Where the results of another run were moved, if there were any.
    moved: Option<PathBuf>,
    has_figures: bool,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dir = self.dir.display();
        let figures = if self.has_figures { ", figures as .svg" } else { "" };
        writeln!(f, "Written to {dir}: report.html (open this), trace.csv, summary.json{figures}")?;
        self.moved
            .iter()
            .try_for_each(|aside| writeln!(f, "The earlier results are now in {}", aside.display()))
    }
}

/// Whether a file holds the trace of this run.
fn is_trace_of(record: &Record, path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let mut rest = SameAs(BufReader::new(file));
    write_trace(record, &mut rest).is_ok() && rest.0.fill_buf().is_ok_and(<[u8]>::is_empty)
}

/// Takes only what a reader holds.
struct SameAs<R>(R);

impl<R: BufRead> Write for SameAs<R> {
    fn write(&mut self, new: &[u8]) -> io::Result<usize> {
        let old = self.0.fill_buf()?;
        let length = old.len().min(new.len());
        if length == 0 || old[..length] != new[..length] {
            return Err(io::Error::other("it differs"));
        }
        self.0.consume(length);
        Ok(length)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
