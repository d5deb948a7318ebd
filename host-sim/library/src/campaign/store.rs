//! The results file: a header that says what they are results of, then a line of JSON for each finished run. A campaign
//! that was interrupted goes on where it stopped; the parts of a cluster are put together from it.

use std::collections::HashSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use fdi_core::Config;
use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::definition::Campaign;
use super::run::RunRow;

/// Which part of the runs: every `of`-th, from the `part`-th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1.
    pub part: usize,
    /// Number of parts.
    pub of: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// Its runs: cell and number in the cell.
    pub fn runs(self, cells: &[Cell]) -> Vec<(usize, u64)> {
        let all = cells.iter().enumerate().flat_map(|(i, cell)| (0..cell.runs).map(move |run| (i, run)));
        all.skip(self.part - 1).step_by(self.of).collect()
    }

    /// Name of its results file.
    pub fn file_name(self) -> String {
        if self == Self::WHOLE {
            "runs.jsonl".into()
        } else {
            format!("runs.{}-of-{}.jsonl", self.part, self.of)
        }
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((part, of)) if part >= 1 && part <= of => Ok(Self { part, of }),
            _ => Err("expected part/parts, such as 1/4".into()),
        }
    }
}

/// What the results are results of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The campaign, TOML.
    pub campaign: String,
    /// The settings of the instrument that it began with, TOML.
    pub config: String,
    /// Hash of the program, since another one may come to other results.
    pub build: String,
    /// Which part of the runs.
    pub shard: Shard,
}

impl Header {
    /// Of this program.
    ///
    /// # Errors
    /// The program can't be read.
    pub fn new(campaign: &Campaign, config: &Config, shard: Shard) -> anyhow::Result<Self> {
        let program = std::env::current_exe().and_then(std::fs::read).context("can't read this program")?;
        let (words, rest) = program.as_chunks();
        let words = words.iter().map(|&word| u64::from_le_bytes(word)).chain(rest.iter().map(|&b| b.into()));
        let hash = words.fold(0xcbf2_9ce4_8422_2325_u64, |h, x| (h ^ x).wrapping_mul(0x0000_0100_0000_01b3));
        Ok(Self {
            campaign: toml::to_string(campaign)?,
            config: toml::to_string(config)?,
            build: format!("{hash:016x}"),
            shard,
        })
    }

    /// # Errors
    /// In what `other` differs.
    fn must_equal(&self, other: &Self) -> anyhow::Result<()> {
        same_text("campaign", &self.campaign, &other.campaign)?;
        same_text("configuration", &self.config, &other.config)?;
        ensure!(self.build == other.build, "they were made by another build of this program");
        let (ours, theirs) = (self.shard.of, other.shard.of);
        ensure!(ours == theirs, "theirs is one of {theirs} parts, this one of {ours}");
        Ok(())
    }
}

fn same_text(what: &str, ours: &str, theirs: &str) -> anyhow::Result<()> {
    if ours == theirs {
        return Ok(());
    }
    let mut pairs = ours.lines().zip(theirs.lines());
    match pairs.find(|(a, b)| a != b) {
        Some((ours, theirs)) => bail!("their {what} has `{theirs}` where this one has `{ours}`"),
        None => bail!(
            "their {what} is another one: it has {} lines, this one {}",
            theirs.lines().count(),
            ours.lines().count()
        ),
    }
}

/// A results file that is open for more.
pub struct Store {
    file: File,
    path: PathBuf,
    /// Cell and run of what is finished.
    pub finished: HashSet<(usize, u64)>,
}

impl Store {
    /// Opens the file, or begins it. What an interruption has left of a last line is cut off. It is ours alone from then on: while another
    /// program has it, such as the same part of a campaign on a node that was given up too early, this waits, and `waits` is told.
    ///
    /// # Errors
    /// Results of another campaign; a file that can't be read or written.
    pub fn open(path: &Path, header: &Header, fresh: bool, waits: impl FnOnce()) -> anyhow::Result<Self> {
        let place = || format!("can't write {}", path.display());
        let mut file =
            OpenOptions::new().read(true).append(true).create(true).open(path).with_context(place)?;
        lock(&file, waits).with_context(place)?;
        let mut text = String::new();
        if !fresh {
            file.read_to_string(&mut text).with_context(|| format!("can't read {}", path.display()))?;
        }
        let whole = whole_lines(&text);
        let mut finished = HashSet::new();
        if !whole.is_empty() {
            let (found, rows) = parse(whole).with_context(|| path.display().to_string())?;
            header.must_equal(&found).with_context(|| {
                format!(
                    "{} holds results that these can't join; --fresh deletes them, --out DIR goes elsewhere",
                    path.display()
                )
            })?;
            finished.extend(rows.iter().map(|row| (row.cell, row.run)));
        }
        file.set_len(whole.len() as u64).with_context(place)?;
        let mut store = Self { file, path: path.to_owned(), finished };
        if whole.is_empty() {
            store.line(header)?;
        }
        Ok(store)
    }

    /// Adds a run.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn push(&mut self, row: &RunRow) -> anyhow::Result<()> {
        self.line(row)
    }

    fn line(&mut self, value: &impl Serialize) -> anyhow::Result<()> {
        let line = serde_json::to_string(value)? + "\n";
        self.file.write_all(line.as_bytes()).with_context(|| format!("can't write {}", self.path.display()))
    }
}

/// Nobody else has the file until it is closed. Some file systems have no locks: then two programs may write it, as ever.
fn lock(file: &File, waits: impl FnOnce()) -> std::io::Result<()> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            waits();
            file.lock()
        }
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// All runs of a campaign.
pub struct Whole {
    /// Its definition.
    pub campaign: Campaign,
    /// Its cells.
    pub cells: Vec<Cell>,
    /// Its runs, in order.
    pub rows: Vec<RunRow>,
}

/// A results file that was read.
struct Part<'a> {
    path: &'a Path,
    header: Header,
    rows: Vec<RunRow>,
}

/// Reads the results files of all shards of a campaign.
///
/// # Errors
/// A file that is none; shards of several campaigns; a shard that is missing or not finished.
pub fn read(paths: &[PathBuf]) -> anyhow::Result<Whole> {
    let parts: Vec<Part> = paths.iter().map(|path| Part::read(path)).collect::<anyhow::Result<_>>()?;
    let (first, others) = parts.split_first().context("no results file")?;
    for part in others {
        let same = first.header.must_equal(&part.header);
        same.with_context(|| format!("{} does not belong to {}", part.path.display(), first.path.display()))?;
    }
    let campaign: Campaign = toml::from_str(&first.header.campaign)?;
    let cells = campaign.expand(&toml::from_str(&first.header.config)?)?;
    must_be_whole(&parts, &cells)?;
    let mut rows: Vec<RunRow> = parts.into_iter().flat_map(|part| part.rows).collect();
    rows.sort_by_key(|row| (row.cell, row.run));
    rows.dedup_by_key(|row| (row.cell, row.run));
    Ok(Whole { campaign, cells, rows })
}

/// # Errors
/// The shards that are missing, or have not all of their runs, or have others.
fn must_be_whole(parts: &[Part], cells: &[Cell]) -> anyhow::Result<()> {
    let of = parts[0].header.shard.of;
    let mut problems = Vec::new();
    for part in 1..=of {
        let shard = Shard { part, of };
        let wanted: HashSet<(usize, u64)> = shard.runs(cells).into_iter().collect();
        let is_this = |file: &&Part| file.header.shard == shard;
        let Some(file) = parts.iter().find(is_this) else {
            problems.push(format!("part {part} of {of} is missing"));
            continue;
        };
        let found: HashSet<(usize, u64)> = file.rows.iter().map(|row| (row.cell, row.run)).collect();
        let path = file.path.display();
        ensure!(found.is_subset(&wanted), "{path} has runs that are not of part {part} of {of}");
        if found.len() < wanted.len() {
            let (found, wanted) = (found.len(), wanted.len());
            problems.push(format!("{path} has {found} of {wanted} runs: its command, given again, goes on"));
        }
    }
    ensure!(problems.is_empty(), "{}", problems.join("\n"));
    Ok(())
}

impl<'a> Part<'a> {
    fn read(path: &'a Path) -> anyhow::Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("can't read {}", path.display()))?;
        let (header, rows) = parse(whole_lines(&text)).with_context(|| path.display().to_string())?;
        Ok(Self { path, header, rows })
    }
}

/// A text without what an interruption has left of its last line.
fn whole_lines(text: &str) -> &str {
    &text[..text.rfind('\n').map_or(0, |end| end + 1)]
}

fn parse(text: &str) -> anyhow::Result<(Header, Vec<RunRow>)> {
    let mut lines = text.lines();
    let header = serde_json::from_str(lines.next().unwrap_or_default())
        .context("line 1: expected the header of a campaign's results")?;
    let rows = lines
        .zip(2..)
        .map(|(line, number)| serde_json::from_str(line).with_context(|| format!("line {number}")))
        .collect::<anyhow::Result<_>>()?;
    Ok((header, rows))
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn whoever_comes_second_waits_and_then_sees_what_the_first_has_done() {
        let campaign: Campaign =
            toml::from_str("[[cell]]\nname = \"quiet\"\nruns = 2\nduration = 5.0\n").unwrap();
        let header = Header::new(&campaign, &Config::default(), Shard::WHOLE).unwrap();
        let path = std::env::temp_dir().join(format!("pt326-store-{}.jsonl", std::process::id()));
        let mut first = Store::open(&path, &header, true, || panic!("nobody else has it")).unwrap();
        let (tell, told) = channel();
        let second = std::thread::spawn({
            let path = path.clone();
            move || Store::open(&path, &header, false, || tell.send(()).unwrap()).unwrap().finished
        });
        told.recv().expect("the second waits");
        first.push(&RunRow { run: 1, ..RunRow::default() }).unwrap();
        drop(first);
        assert_eq!(second.join().unwrap(), HashSet::from([(0, 1)]));
        std::fs::remove_file(&path).unwrap();
    }
}
