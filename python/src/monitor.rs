//! The diagnosis of recordings, and of what comes in from a rig that something else controls.

use std::path::PathBuf;

use fdi_core::likelihood::inputs::Inputs;
use fdi_core::likelihood::model::Model;
use fdi_core::{Observed, Units};
use pt326_host::recording::fit_rig::Fitted;
use pt326_host::recording::intervals::{Known, numbers};
use pt326_host::recording::run::{Training, as_tick, diagnose};
use pt326_host::recording::text::text_of;
use pt326_host::recording::{self, Reading};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::config::{Config, or_default};
use crate::convert::{error, from_table, in_python, python, refused, to_python, to_table};
use crate::instrument::Report;
use crate::run::Record;
use crate::wait::wait;

/// The diagnosis alone, for a heater that something else controls: temperatures and power in, reports out. It learns from the samples of which
/// `learn` is said.
#[pyclass(module = "pt326")]
#[derive(Clone)]
pub(crate) struct Monitor {
    monitor: fdi_core::Monitor,
    sample_time: f64,
}

#[pymethods]
impl Monitor {
    /// `t0`, `t2`, `fan`: what of it the rig has. `celsius` is how many degC one unit of a temperature counts for, `full_power` the power that is 100 %.
    #[new]
    #[pyo3(signature = (config = None, *, t0 = true, t2 = true, fan = true, celsius = 1.0, full_power = 100.0))]
    fn new(
        config: Option<&Bound<'_, Config>>,
        t0: bool,
        t2: bool,
        fan: bool,
        celsius: f32,
        full_power: f32,
    ) -> PyResult<Self> {
        let config = or_default(config);
        let inputs = Inputs { t0, t2, fan, ..Inputs::ALL };
        let monitor =
            fdi_core::Monitor::new(&config, inputs, Units { celsius, full_power }).map_err(error)?;
        Ok(Self { monitor, sample_time: pt326_host::experiment::as_written(config.sample_time.0) })
    }

    /// One sample: temperatures, and what drives the heater from it on. What is None, or no number, is missing.
    #[pyo3(signature = (t0 = None, t1 = None, t2 = None, power = None, *, beside = None, fan = None, supply = None, learn = false))]
    #[expect(clippy::too_many_arguments, reason = "Python names them")]
    fn step(
        &mut self,
        t0: Option<f32>,
        t1: Option<f32>,
        t2: Option<f32>,
        power: Option<f32>,
        beside: Option<f32>,
        fan: Option<f32>,
        supply: Option<f32>,
        learn: bool,
    ) -> Report {
        let (seen, report) =
            self.monitor.step(&Observed { t: [t0, t1, t2], power, beside, fan, supply, learn });
        Report { raw: None, tick: as_tick(&seen), report, applied: seen.power, sample_time: self.sample_time }
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    /// The next sample is the first of another recording of the same rig.
    fn resume(&mut self) {
        self.monitor.resume();
    }

    /// What was learnt, in s, degC and %; None: nothing yet.
    #[pyo3(signature = () -> "dict[str, typing.Any] | None")]
    fn model<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.monitor.model().map(|model| as_dict(py, &model)).transpose()
    }
}

fn as_dict<'py>(py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in numbers(model) {
        dict.set_item(name, value)?;
    }
    dict.set_item("noise", model.noise)?;
    Ok(dict)
}

/// A recording of a heater that something else controls, as it is read by `pt326 diagnose`.
#[pyclass(module = "pt326")]
pub(crate) struct Recording {
    recording: recording::Recording,
    /// Another of the same heater, to learn from.
    other: Option<recording::Recording>,
    trained: Option<recording::training::Trained>,
}

#[pymethods]
impl Recording {
    /// From a file, or from the text of one; `reading` has the options of `pt326 diagnose`: map, ts, resample, full_power, degc, fan. Another
    /// of the same heater is read with it, in the same units, to learn from.
    #[new]
    #[pyo3(signature = (path: "str | os.PathLike[str] | None" = None, text = None, reading: "dict[str, object] | None" = None, other_path: "str | os.PathLike[str] | None" = None, other_text = None))]
    fn new(
        path: Option<PathBuf>,
        text: Option<String>,
        reading: Option<&Bound<'_, PyAny>>,
        other_path: Option<PathBuf>,
        other_text: Option<String>,
    ) -> PyResult<Self> {
        let reading: Reading = from_table(reading.map(to_table).transpose()?.unwrap_or_default())?;
        for (name, value) in
            [("ts", reading.sample_time), ("full_power", reading.full_power), ("degc", reading.celsius)]
        {
            if value.is_some_and(|value| !(value > 0.0 && value.is_finite())) {
                return Err(refused(format!(
                    "{name} is {}, expected a number above 0",
                    value.unwrap_or_default()
                )));
            }
        }
        let named = |path: Option<PathBuf>, text: Option<String>| match path {
            Some(path) => python(text_of(&path)).map(Some),
            None => Ok(text.map(|text| ("data".to_owned(), text))),
        };
        let Some((file, text)) = named(path, text)? else {
            return Err(refused("expected a path or a text".into()));
        };
        let other = named(other_path, other_text)?;
        let (recording, other) = python(recording::Recording::with_other((file, &text), other, &reading))?;
        Ok(Self { recording, other, trained: None })
    }

    /// Whoever reads the results must know this.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.recording.remarks.iter().map(|remark| in_python(remark)).collect()
    }

    /// What each heater's columns are.
    #[getter]
    fn heaters(&self) -> Vec<String> {
        self.recording.heaters.iter().map(|heater| heater.map.to_string()).collect()
    }

    /// Ts, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.recording.sample_time
    }

    fn __len__(&self) -> usize {
        self.recording.len()
    }

    /// The rig was cold and its heater off before the first sample. Gives for how long that is put before it, s.
    fn put_rest_before(&mut self) -> f64 {
        self.recording.put_rest_before()
    }

    /// Learns from the other recording if there is one, from a part (from, to in s), or from a part that seems normal; then watches. A model that explains less than
    /// 30 % of T1 is refused, unless `force`.
    #[pyo3(signature = (heater = 1, train = None, from_rest = false, force = false, config = None, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "tuple[Record, dict[str, typing.Any]]")]
    #[expect(clippy::too_many_arguments, reason = "Python names them")]
    fn diagnose<'py>(
        &mut self,
        py: Python<'py>,
        heater: usize,
        train: Option<(f64, f64)>,
        from_rest: bool,
        force: bool,
        config: Option<&Bound<'py, Config>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Record, Bound<'py, PyDict>)> {
        let recording = self.recording.clone();
        let (which, count) = (heater.wrapping_sub(1), recording.heaters.len());
        if which >= count {
            return Err(refused(format!("heater: the recording has heaters 1 to {count}")));
        }
        let end = recording.len() as f64 * recording.sample_time;
        let own = |part, why: String| Some(Training::Own(part, why));
        let training = match (&self.other, train) {
            (Some(_), Some(_)) => return Err(refused("train and train_on: expected one of them".into())),
            (Some(other), None) => Some(Training::Other(Box::new(other.clone()))),
            (None, Some((from, to))) if from >= 0.0 && from < to && to <= end + 1e-6 => {
                own(recording.at(from)..recording.at(to), format!("{from} to {to} s are said to be normal"))
            }
            (None, Some((from, to))) => {
                return Err(refused(format!("train ({from}, {to}): expected 0 <= from < to <= {end} s")));
            }
            (None, None) if from_rest => {
                own(0..recording.len(), "all of it is taken for one heating up from rest".into())
            }
            (None, None) => None,
        };
        let config = or_default(config);
        let (because, done) = wait(py, progress, move |shared| {
            let training = match training {
                Some(training) => training,
                None => Training::find(&recording, &recording.heaters[which], &config)?,
            };
            let because = match &training {
                Training::Own(_, why) | Training::Found(_, why, _) => why.clone(),
                Training::Other(other) => format!("all of {}, which is said to be normal", other.file),
            };
            Ok((because, diagnose(&recording, which, &training, &[], &config, &shared.bar)?))
        })?;
        let warning =
            in_python(&python(done.trained.accepted(force, "Or take it as it is with force=True"))?);
        let learnt = PyDict::new(py);
        learnt.set_item("warning", warning)?;
        learnt.set_item("because", because)?;
        learnt.set_item("model", as_dict(py, &done.trained.model)?)?;
        let intervals = PyDict::new(py);
        for (name, known) in &done.trained.intervals {
            let ends = match known {
                Known::Within(low, high) => Some((low, high)),
                Known::No => None,
            };
            intervals.set_item(name, ends)?;
        }
        learnt.set_item("intervals", intervals)?;
        learnt.set_item("unknown", &done.trained.unknown)?;
        learnt.set_item("fit", done.trained.fit)?;
        learnt.set_item("fit_on_the_rest", done.fit_on_the_rest)?;
        learnt.set_item("watched_from", done.watched_from as f64 * self.recording.sample_time)?;
        learnt.set_item("thinned", done.thinned)?;
        learnt.set_item("restarts", done.restarts)?;
        self.trained = Some(done.trained);
        Ok((Record(done.record), learnt))
    }

    /// A simulated rig that answers as one of its heaters does: `pt326 fit-rig`. All of the recording is taken for normal.
    #[pyo3(signature = (heater = 1, progress: "typing.Callable[[int, int | None], object] | None" = None) -> "dict[str, typing.Any]")]
    fn fit_rig<'py>(
        &self,
        py: Python<'py>,
        heater: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let recording = self.recording.clone();
        let fitted = wait(py, progress, move |shared| Fitted::new(&recording, heater, &shared.bar))?;
        let scenario: toml::Table = fitted.scenario.parse().map_err(error)?;
        let dict = PyDict::new(py);
        dict.set_item("scenario", to_python(py, &scenario)?)?;
        dict.set_item("toml", fitted.scenario)?;
        dict.set_item("fit", fitted.fit)?;
        dict.set_item("warning", in_python(&fitted.warning))?;
        dict.set_item("beyond", fitted.beyond)?;
        Ok(dict)
    }

    /// A monitor that has learnt what `diagnose` learnt, for what comes next from the same rig.
    fn monitor(&self) -> PyResult<Monitor> {
        let trained =
            self.trained.as_ref().ok_or_else(|| PyRuntimeError::new_err("diagnose comes before"))?;
        let mut monitor = trained.monitor.clone();
        monitor.resume();
        Ok(Monitor { monitor, sample_time: self.recording.sample_time })
    }
}
