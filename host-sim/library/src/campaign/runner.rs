//! Runs what is not finished of a campaign.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::Context;
use rayon::prelude::*;

use super::cell::Cell;
use super::run;
use super::store::{Shard, Store};

/// What is left to be done.
pub struct Remaining<'a> {
    cells: &'a [Cell],
    /// Cell and number of each run, the longest first so that no core is left with one at the end.
    runs: Vec<(usize, u64)>,
    store: Store,
}

/// How far it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Runs that are finished, those of earlier times too.
    pub finished: usize,
    /// All runs of the shard.
    pub of: usize,
}

impl<'a> Remaining<'a> {
    /// The runs of a shard that are not in its store.
    pub fn new(cells: &'a [Cell], shard: Shard, store: Store) -> Self {
        let mut runs = shard.runs(cells);
        runs.retain(|run| !store.finished.contains(run));
        runs.sort_by(|a, b| ticks(cells, b).total_cmp(&ticks(cells, a)));
        Self { cells, runs, store }
    }

    /// Number of runs that are left.
    pub fn count(&self) -> usize {
        self.runs.len()
    }

    /// Number of runs that are finished.
    pub fn finished(&self) -> usize {
        self.store.finished.len()
    }

    /// Simulated time that is left, s.
    pub fn seconds(&self) -> f64 {
        self.runs.iter().map(|run| self.cells[run.0].scenario.duration).sum()
    }

    /// Simulated ticks that are left: a tick takes about as long on any rig, a second does not.
    pub fn ticks(&self) -> f64 {
        self.runs.iter().map(|run| ticks(self.cells, run)).sum()
    }

    /// Runs them on the threads of the current pool; begins none any more once `stop` is set. `advance` is given the
    /// ticks of each that is finished.
    ///
    /// # Errors
    /// A run that is not possible; a store that can't be written.
    pub fn run(self, stop: &AtomicBool, advance: impl Fn(f64) + Sync) -> anyhow::Result<Progress> {
        let before = self.finished();
        let of = before + self.count();
        let (cells, store) = (self.cells, Mutex::new(self.store));
        let done = AtomicUsize::new(0);
        self.runs.par_iter().with_max_len(1).try_for_each(|one| {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let cell = &cells[one.0];
            let row = run::run(cell, one.0, one.1)
                .with_context(|| format!("cell {:?}, run {}", cell.name, one.1))?;
            store.lock().map_err(|_| anyhow::anyhow!("another thread has failed"))?.push(&row)?;
            done.fetch_add(1, Ordering::Relaxed);
            advance(ticks(cells, one));
            anyhow::Ok(())
        })?;
        Ok(Progress { finished: before + done.into_inner(), of })
    }
}

fn ticks(cells: &[Cell], run: &(usize, u64)) -> f64 {
    let cell = &cells[run.0];
    cell.scenario.duration / cell.sample_time()
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use crate::campaign::definition::Campaign;
    use crate::campaign::store::Header;

    /// A run of an oven, which has a tick every ten seconds, takes no longer for all its hours.
    #[test]
    fn the_run_with_the_most_ticks_is_first() {
        let campaign: Campaign = toml::from_str(
            "[[plant]]\nname = \"oven\"\nrig = { preset = \"oven\" }\ninstrument = \"oven\"\n[[plant]]\nname = \"paper\"\n\
             [[cell]]\nname = \"quiet\"\nruns = 1\nduration = 850.0\nplants = [\"oven\"]\n\
             [[cell]]\nname = \"longer\"\nruns = 1\nduration = 900.0\nplants = [\"paper\"]\n",
        )
        .unwrap();
        let config = Config::default();
        let cells = campaign.expand(&config).unwrap();
        let header = Header::new(&campaign, &config, Shard::WHOLE).unwrap();
        let path = std::env::temp_dir().join(format!("pt326-ticks-{}.jsonl", std::process::id()));
        let store = Store::open(&path, &header, true, || panic!("nobody else has it")).unwrap();
        let remaining = Remaining::new(&cells, Shard::WHOLE, store);
        let names: Vec<_> = remaining.runs.iter().map(|run| cells[run.0].name.as_str()).collect();
        assert_eq!(names, ["longer @ paper", "quiet @ oven"]);
        let expected = 900.0 / 0.11 + cells[0].scenario.duration / cells[0].sample_time();
        assert!((remaining.ticks() - expected).abs() < 1.0, "{} {expected}", remaining.ticks());
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn what_was_stopped_goes_on_where_it_stopped() {
        let campaign: Campaign =
            toml::from_str("[[cell]]\nname = \"quiet\"\nruns = 6\nduration = 5.0\n").unwrap();
        let config = Config::default();
        let cells = campaign.expand(&config).unwrap();
        let header = Header::new(&campaign, &config, Shard::WHOLE).unwrap();
        let path = std::env::temp_dir().join(format!("pt326-runner-{}.jsonl", std::process::id()));
        let open = |fresh| {
            let store = Store::open(&path, &header, fresh, || panic!("nobody else has it")).unwrap();
            Remaining::new(&cells, Shard::WHOLE, store)
        };
        let run = |remaining: Remaining, stop_after: usize| {
            let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
            let advance = |_| {
                let now = done.fetch_add(1, Ordering::Relaxed) + 1;
                stop.fetch_or(now >= stop_after, Ordering::Relaxed);
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            pool.install(|| remaining.run(&stop, advance)).unwrap()
        };
        assert_eq!(run(open(true), 2), Progress { finished: 2, of: 6 });
        let again = open(false);
        assert_eq!((again.finished(), again.count(), again.seconds()), (2, 4, 20.0));
        assert_eq!(run(again, 9), Progress { finished: 6, of: 6 });
        std::fs::remove_file(&path).unwrap();
    }
}
