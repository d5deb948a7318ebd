//! Many runs: the same one with many seeds, and campaigns.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use fdi_core::FaultClass;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pt326_host::campaign::cell::Cell;
use pt326_host::campaign::definition::{ABLATION_TOML, CAMPAIGN_TOML, Campaign, PHYSICS_TOML, QUICK, USUAL};
use pt326_host::campaign::output;
use pt326_host::campaign::results::Results;
use pt326_host::campaign::run::{self, Observation, Output, RunRow};
use pt326_host::campaign::store::Shard;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::config::{Config, or_default};
use crate::convert::{Seed, error, from_table, python, refused, to_python, to_table};
use crate::wait::wait;

/// The same experiment with many seeds, on all cores: `pt326 repeat --json`.
#[pyfunction]
#[pyo3(signature = (scenario: "object" = None, config = None, runs = 200, first_seed: "int" = Seed(1), preset = None, disturbance = None, fault_size: "str | float | None" = None, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "dict[str, typing.Any]")]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub(crate) fn repeat<'py>(
    py: Python<'py>,
    scenario: Option<&Bound<'py, PyAny>>,
    config: Option<&Bound<'py, Config>>,
    runs: u64,
    first_seed: Seed,
    preset: Option<&str>,
    disturbance: Option<&str>,
    fault_size: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    if !(1..=1_000_000).contains(&runs) {
        return Err(refused(format!("runs is {runs}, expected 1 to 1000000")));
    }
    let (config, scenario) = crate::run::experiment(scenario, config, preset, disturbance, fault_size)?;
    let repeated = wait(py, progress, move |shared| {
        shared.bar.set_length(runs);
        pt326_host::repeat::repeat(&config, &scenario, first_seed.0, runs, &shared.bar, &shared.stop)
    })?;
    to_python(py, &repeated)
}

/// A campaign, ready to run: its cells, and the rows of those runs that are finished.
#[pyclass(module = "pt326")]
pub(crate) struct Cells {
    campaign: Campaign,
    cells: Vec<Cell>,
    rows: Vec<RunRow>,
}

#[pymethods]
impl Cells {
    /// `definition` is the path of a TOML, a dict, or the name of a campaign that is built in: default, quick, physics or ablation. `scale`
    /// multiplies the numbers of runs; `only` is in the names of the cells that are wanted.
    #[new]
    #[pyo3(signature = (definition: "str | os.PathLike[str] | dict[str, object]", config = None, only = None, scale = None, first_seed: "int | None" = None))]
    fn new(
        definition: &Bound<'_, PyAny>,
        config: Option<&Bound<'_, Config>>,
        only: Option<String>,
        scale: Option<f64>,
        first_seed: Option<Seed>,
    ) -> PyResult<Self> {
        let (mut campaign, usual) = named(definition)?;
        campaign.scale *= scale.unwrap_or(usual);
        campaign.only = only.unwrap_or(campaign.only);
        campaign.seeds_from = first_seed.map_or(campaign.seeds_from, |seed| seed.0);
        let cells = python(campaign.expand(&or_default(config)))?;
        Ok(Self { campaign, cells, rows: Vec::new() })
    }

    /// Names of the cells.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.cells.iter().map(Cell::label).collect()
    }

    /// Cell and number of each run.
    #[getter]
    fn runs(&self) -> Vec<(usize, u64)> {
        Shard::WHOLE.runs(&self.cells)
    }

    /// Runs all, on all cores.
    #[pyo3(signature = (progress: "typing.Callable[[int, int | None], object] | None" = None))]
    fn run(&mut self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let (cells, runs) = (self.cells.clone(), self.runs());
        self.rows = wait(py, progress, move |shared| {
            shared.bar.set_length(runs.len() as u64);
            let one = |&(cell, number): &(usize, u64)| {
                anyhow::ensure!(!shared.stop.load(Ordering::Relaxed), "stopped");
                let row = kept(&run::run(&cells[cell], cell, number)?);
                shared.bar.inc(1);
                row
            };
            runs.par_iter().with_max_len(1).map(one).collect()
        })?;
        Ok(())
    }

    /// Runs some, on all cores, and gives for each what a detector sees: T0, T1, T2 in degC (NaN where one reads nothing) and the power in %, a
    /// row a tick.
    #[pyo3(signature = (runs) -> "list[numpy.ndarray]")]
    fn watch<'py>(
        &mut self,
        py: Python<'py>,
        runs: Vec<(usize, u64)>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f32>>>> {
        let cells = self.cells.clone();
        let done: Vec<(RunRow, Vec<f32>)> = wait(py, None, move |shared| {
            let one = |&(cell, number): &(usize, u64)| {
                anyhow::ensure!(!shared.stop.load(Ordering::Relaxed), "stopped");
                let mut seen = Vec::new();
                let row = run::run_before(&cells[cell], cell, number, |_, row| {
                    let sample = &row.tick.sample;
                    let read = [sample.t0, sample.t1, sample.t2].map(|t| t.read().unwrap_or(f32::NAN));
                    seen.extend(read);
                    seen.push(row.applied.0);
                })?;
                Ok((kept(&row)?, seen))
            };
            runs.par_iter().with_max_len(1).map(one).collect::<anyhow::Result<_>>()
        })?;
        let arrays = done.into_iter().map(|(row, seen)| {
            self.rows.push(row);
            let ticks = seen.len() / 4;
            seen.into_pyarray(py).reshape([ticks, 4])
        });
        arrays.collect()
    }

    /// What the finished runs showed: campaign.json.
    #[pyo3(signature = () -> "dict[str, typing.Any]")]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &py.detach(|| self.whole(&self.sorted())))
    }

    /// The same of a detector from outside: what its `observers` saw stands where else the likelihood diagnosis does.
    #[pyo3(signature = (observers) -> "dict[str, typing.Any]")]
    fn results_of<'py>(
        &self,
        py: Python<'py>,
        observers: Vec<Bound<'py, Observer>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut rows = self.rows.clone();
        if rows.len() != observers.len() {
            return Err(refused(format!("{} observers of {} runs", observers.len(), rows.len())));
        }
        for (row, observer) in rows.iter_mut().zip(&observers) {
            row.likelihood = observer.borrow().observed()?;
        }
        rows.sort_by_key(|row| (row.cell, row.run));
        to_python(py, &py.detach(|| self.whole(&rows)))
    }

    /// A row for each finished run: runs.csv.
    fn runs_csv(&self, py: Python<'_>) -> PyResult<String> {
        let text = py.detach(|| Ok(String::from_utf8(output::runs_csv(&self.cells, &self.sorted())?)?));
        python(text)
    }

    /// What `pt326 campaign` prints.
    fn table(&self, py: Python<'_>) -> String {
        py.detach(|| output::table::of(&self.whole(&self.sorted())))
    }

    /// Writes what `pt326 campaign` writes into a folder, and gives the names.
    #[pyo3(signature = (folder: "str | os.PathLike[str]"))]
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<String> {
        python(py.detach(|| {
            std::fs::create_dir_all(&folder)?;
            let rows = self.sorted();
            output::write(&self.whole(&rows), &self.cells, &rows, &folder)
        }))
    }

    /// Who scores a detector over one run.
    fn observer(&self, cell: usize, run: u64) -> PyResult<Observer> {
        let of = self.cells.get(cell).filter(|of| run < of.runs);
        let of = of.ok_or_else(|| refused(format!("there is no run {run} of a cell {cell}")))?;
        Ok(Observer {
            observer: Some(run::Observer::new(of, of.seed(run))),
            observed: None,
            sample_time: of.sample_time(),
        })
    }
}

impl Cells {
    fn sorted(&self) -> Vec<RunRow> {
        let mut rows = self.rows.clone();
        rows.sort_by_key(|row| (row.cell, row.run));
        rows
    }

    fn whole(&self, rows: &[RunRow]) -> Results {
        Results::new(&self.campaign, &self.cells, rows)
    }
}

/// A row as the results file of the command line gives it back: reading JSON may cost its last bit.
fn kept(row: &RunRow) -> anyhow::Result<RunRow> {
    Ok(serde_json::from_str(&serde_json::to_string(row)?)?)
}

/// The campaign of a name, of a path, or of a dict; and by what its numbers of runs are multiplied if nobody says.
fn named(definition: &Bound<'_, PyAny>) -> PyResult<(Campaign, f64)> {
    let Ok(path) = definition.extract::<PathBuf>() else {
        return Ok((from_table(to_table(definition)?)?, 1.0));
    };
    let built_in = match path.to_str() {
        Some("default") => Some((CAMPAIGN_TOML, USUAL)),
        Some("quick") => Some((CAMPAIGN_TOML, QUICK)),
        Some("physics") => Some((PHYSICS_TOML, USUAL)),
        Some("ablation") => Some((ABLATION_TOML, 1.0)),
        _ => None,
    };
    match built_in {
        Some((text, usual)) => Ok((toml::from_str(text).map_err(error)?, usual)),
        None => Ok((python(Campaign::read(&path))?, 1.0)),
    }
}

/// Scores a detector over one run as ours are scored, tick by tick.
#[pyclass(module = "pt326")]
pub(crate) struct Observer {
    observer: Option<run::Observer>,
    observed: Option<Observation>,
    sample_time: f64,
}

#[pymethods]
impl Observer {
    /// Lets a detector see a run, a row (T0, T1, T2, power) a tick: calls `step(t0, t1, t2, power)`, which gives the name of a class (any other
    /// word: an alarm without a name), or None where all is well. `armed`, where it has that, says whether it watches.
    #[pyo3(signature = (detector: "object", seen: "numpy.ndarray"))]
    fn watch(&mut self, detector: &Bound<'_, PyAny>, seen: PyReadonlyArray2<'_, f32>) -> PyResult<()> {
        let mut observer =
            self.observer.take().ok_or_else(|| refused("this run has been seen already".into()))?;
        let step = detector.getattr("step")?;
        let tells_armed = detector.hasattr("armed")?;
        let seen = seen.as_slice().map_err(|why| refused(why.to_string()))?;
        for (index, row) in seen.chunks_exact(4).enumerate() {
            let said = step.call1((row[0], row[1], row[2], row[3]))?;
            let armed = !tells_armed || detector.getattr("armed")?.is_truthy()?;
            let alarm = !said.is_none();
            let named = if alarm { class(&said)? } else { None };
            let t = pt326_host::experiment::tick_time(index as u32, self.sample_time);
            observer.observe(t, &Output { alarm: (armed || alarm).then_some(alarm), advice: false, named });
        }
        self.observed = Some(observer.finish());
        Ok(())
    }
}

impl Observer {
    fn observed(&self) -> PyResult<Observation> {
        self.observed.clone().ok_or_else(|| refused("this run has not been seen yet".into()))
    }
}

fn class(said: &Bound<'_, PyAny>) -> PyResult<Option<FaultClass>> {
    let word = said.cast::<pyo3::types::PyString>()?;
    let word = word.to_cow()?;
    Ok(FaultClass::ALL.into_iter().find(|class| class.name() == word))
}
