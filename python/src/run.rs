//! An experiment, whole.

use std::path::{Path, PathBuf};

use fdi_core::schema::{COLUMNS, Entry, FIELDS, Kind, Moment, Value};
use numpy::IntoPyArray;
use pt326_host::experiment::scenario::{Scenario, read_scenario};
use pt326_host::experiment::{FaultSize, Row, as_written, on_rig, tick_time};
use pt326_host::isolability::{Isolability, Question, output};
use pt326_host::record::summary::{Summary, sentence};
use pt326_host::record::trace::write_trace;
use pt326_host::record::{files, table};
use pt326_host::score::signature_class;
use pt326_host::{experiment, settings};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::config::Config;
use crate::convert::{Seed, from_table, python, refused, to_python, to_table};
use crate::rig::disturbance;
use crate::wait::wait;

/// What describes an experiment, put together as the command line does; faults are of their nominal sizes where none is given.
pub(crate) fn experiment(
    scenario: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, Config>>,
    preset: Option<&str>,
    surroundings: Option<&str>,
    fault_size: Option<&Bound<'_, PyAny>>,
) -> PyResult<(fdi_core::Config, Scenario)> {
    let config = match config {
        Some(config) => config.borrow().0.clone(),
        None => python(settings::preset(preset.unwrap_or_default()).and_then(settings::from_table))?,
    };
    let scenario = match scenario {
        None => Scenario::default(),
        Some(given) => match given.extract::<PathBuf>() {
            Ok(path) => python(read_scenario(Some(&path)))?,
            Err(_) => from_table(to_table(given)?)?,
        },
    };
    let size = match fault_size {
        Some(size) => size.str()?.to_str()?.parse().map_err(|why| refused(format!("fault_size: {why}")))?,
        None => FaultSize::default(),
    };
    let surroundings = surroundings.map(disturbance).transpose()?;
    let scenario = python(on_rig(scenario, &config, preset, surroundings, size))?;
    Ok((config, scenario))
}

/// Runs an experiment on the simulated rig: `pt326 run`, to the same bits.
#[pyfunction]
#[pyo3(signature = (scenario: "object" = None, config = None, seed: "int" = Seed(1), preset = None, disturbance = None, fault_size: "str | float | None" = None))]
pub(crate) fn run(
    py: Python<'_>,
    scenario: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, Config>>,
    seed: Seed,
    preset: Option<&str>,
    disturbance: Option<&str>,
    fault_size: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let (config, scenario) = experiment(scenario, config, preset, disturbance, fault_size)?;
    let record = wait(py, None, move |_| experiment::run(&config, &scenario, seed.0))?;
    Ok(Record(record))
}

/// Which faults can be told apart on a rig, how soon, and from which size on: isolability.csv.
#[pyfunction]
#[pyo3(signature = (scenario: "object" = None, config = None, seed: "int" = Seed(1), preset = None, disturbance = None, within = vec![1.0, 10.0, 60.0], equal_odds = false, progress: "typing.Callable[[int, int | None], object] | None" = None))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub(crate) fn isolability(
    py: Python<'_>,
    scenario: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, Config>>,
    seed: Seed,
    preset: Option<&str>,
    disturbance: Option<&str>,
    within: Vec<f64>,
    equal_odds: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let mut horizons = within;
    if let Some(s) = horizons.iter().find(|s| !(0.01..=1e5).contains(*s)) {
        return Err(refused(format!("within has {s}, expected 0.01 to 100000 s")));
    }
    horizons.sort_by(f64::total_cmp);
    let (config, scenario) = experiment(scenario, config, preset, disturbance, None)?;
    wait(py, progress, move |shared| {
        shared.bar.set_length((scenario.duration / as_written(config.sample_time.0)) as u64);
        let question = Question { seed: seed.0, horizons, equal_odds };
        Ok(output::csv(&Isolability::of(&config, &scenario, &question, &shared.bar)?))
    })
}

/// The paper's experiment as a dict, to be changed and run: rig, faults, what its user does.
#[pyfunction]
#[pyo3(signature = () -> "dict[str, typing.Any]")]
pub(crate) fn scenario(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    to_python(py, &Scenario::default())
}

/// A run, whole.
#[pyclass(frozen, module = "pt326")]
pub(crate) struct Record(pub(crate) pt326_host::experiment::Record);

#[pymethods]
impl Record {
    /// Names of the columns of trace.csv.
    #[staticmethod]
    fn columns() -> Vec<&'static str> {
        COLUMNS.iter().map(|column| column.name).collect()
    }

    /// Unit of a column; empty where it has none.
    #[staticmethod]
    fn unit(name: &str) -> PyResult<&'static str> {
        Ok(entry(name)?.number.unit)
    }

    /// A column: an array of float64 with NaN where it is not defined, or a list of words.
    #[pyo3(signature = (name: "str") -> "numpy.ndarray | list[str | None]")]
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let entry = entry(name)?;
        let record = &self.0;
        let values = record.rows.iter().map(|row| entry.number.value(&moment(row)));
        match entry.number.kind {
            Kind::Named | Kind::Choice => {
                let words = values.map(|value| match value {
                    Value::Named((_, name)) | Value::Choice(Some((_, name))) => Some(name),
                    _ => None,
                });
                words.collect::<Vec<_>>().into_pyobject(py)
            }
            Kind::Tick => {
                let times = values.map(|value| match value {
                    Value::Tick(Some(tick)) => tick_time(tick, record.sample_time),
                    _ => f64::NAN,
                });
                Ok(times.collect::<Vec<_>>().into_pyarray(py).into_any())
            }
            _ => {
                let numbers = values.map(|value| match value {
                    Value::Reading(reading) => f64::from(reading.celsius.0),
                    other => f64::from(other.number()),
                });
                Ok(numbers.collect::<Vec<_>>().into_pyarray(py).into_any())
            }
        }
    }

    fn __len__(&self) -> usize {
        self.0.rows.len()
    }

    /// Ts, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.0.sample_time
    }

    /// How many standard deviations a threshold lies from the mean.
    #[getter]
    fn sigma_factor(&self) -> f64 {
        self.0.sigma_factor
    }

    /// All scores: summary.json.
    #[pyo3(signature = () -> "dict[str, typing.Any]")]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &py.detach(|| Summary::new(&self.0)))
    }

    /// What `pt326 run` prints.
    fn table(&self, py: Python<'_>) -> String {
        py.detach(|| table::of_run(&self.0, &Summary::new(&self.0)))
    }

    /// trace.csv.
    fn trace(&self, py: Python<'_>) -> PyResult<String> {
        let text = py.detach(|| -> anyhow::Result<String> {
            let mut out = Vec::new();
            write_trace(&self.0, &mut out)?;
            Ok(String::from_utf8(out)?)
        });
        python(text)
    }

    /// Writes what `pt326 run` writes: trace.csv, summary.json, figures, report.html.
    #[pyo3(signature = (folder: "str | os.PathLike[str]"))]
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let write = |folder: &Path| files::write(&self.0, &Summary::new(&self.0), None, folder);
        python(py.detach(|| write(&folder)))
    }

    /// What was said, and when: a dict each.
    #[pyo3(signature = () -> "list[dict[str, typing.Any]]")]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        events(&self.0).into_iter().map(|event| event.into_dict(py)).collect()
    }
}

fn entry(name: &str) -> PyResult<&'static Entry> {
    let found = COLUMNS.iter().chain(&FIELDS).find(|entry| entry.name == name);
    found.ok_or_else(|| PyKeyError::new_err(name.to_owned()))
}

fn moment(row: &Row) -> Moment<'_> {
    Moment { truth: row.truth, applied: row.applied, ..Moment::new(&row.tick, &row.report) }
}

/// A time in which one thing was said.
struct Event {
    by: &'static str,
    at: f64,
    until: f64,
    name: Option<String>,
    finding: Option<fdi_core::Finding>,
    onset: Option<f64>,
    sentence: Option<String>,
}

impl Event {
    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        let magnitude = self.finding.and_then(|finding| finding.magnitude);
        dict.set_item("by", self.by)?;
        dict.set_item("at", self.at)?;
        dict.set_item("until", self.until)?;
        dict.set_item("name", self.name)?;
        dict.set_item("confidence", self.finding.map(|finding| finding.confidence))?;
        dict.set_item("magnitude", magnitude.map(|magnitude| magnitude.value))?;
        dict.set_item("half_width", magnitude.map(|magnitude| magnitude.half_width))?;
        dict.set_item("unit", self.finding.map(|finding| finding.class.unit()))?;
        dict.set_item("onset", self.onset)?;
        dict.set_item("sentence", self.sentence)?;
        Ok(dict)
    }
}

/// Alarms and names of the likelihood diagnosis, names of the paper's, and trips; in the order of time.
fn events(record: &pt326_host::experiment::Record) -> Vec<Event> {
    let time = |row: &Row| record.time(row.tick.index);
    let mut events = Vec::new();
    let mut gather = |by: &'static str, what: &dyn Fn(&Row) -> Option<Option<String>>| {
        for rows in record.rows.chunk_by(|a, b| what(a) == what(b)) {
            let (first, last) = (&rows[0], &rows[rows.len() - 1]);
            let Some(name) = what(first) else { continue };
            let finding = last.report.likelihood.finding.filter(|_| by == "likelihood" && name.is_some());
            events.push(Event {
                by,
                at: time(first),
                until: time(last) + record.sample_time,
                sentence: finding.as_ref().map(|finding| sentence(record, last, finding)),
                onset: finding.map(|finding| record.time(finding.onset)),
                finding,
                name,
            });
        }
    };
    gather("likelihood", &|row| {
        let likelihood = &row.report.likelihood;
        likelihood.alarm.then(|| likelihood.finding.map(|finding| finding.class.name().to_owned()))
    });
    gather("signature", &|row| {
        let fiv = row.report.filtered.filter(|verdict| verdict.fdv != 0)?.fiv;
        let own =
            || record.names.rows.iter().find(|(number, _)| *number == fiv).map(|(_, name)| name.clone());
        Some(own().or_else(|| signature_class(fiv).map(|class| class.name().to_owned())))
    });
    gather("trip", &|row| match row.tick.mode {
        fdi_core::Mode::Tripped(trip) => Some(Some(trip.reason.name().to_owned())),
        _ => None,
    });
    events.sort_by(|a, b| a.at.total_cmp(&b.at));
    events
}
