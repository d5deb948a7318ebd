//! The instrument, tick by tick.

use fdi_core::schema::{COLUMNS, FIELDS, Moment, Value};
use fdi_core::{Celsius, Command, FaultClass, Percent, RawSample, Tick};
use firmware_logic::control_loop::TickRecord;
use firmware_logic::finding::Sentence;
use firmware_logic::log_line::tick::TickLine;
use pt326_host::experiment::{as_written, tick_time, with_prbs_phase};
use pt326_host::record::summary::with_degree_sign;
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyTypeError};
use pyo3::prelude::*;

use crate::config::{Config, or_default};
use crate::convert::{Error, Seed, error};
use crate::rig::{Codes, raw};

/// The instrument: what the board runs, bit for bit. Each tick takes `control(codes)`, which gives the power, then `diagnose()`.
///
/// It is off until `arm()`. `seed` moves the start of the excitation as `pt326 run --seed` does; with 1 it is the board's.
#[pyclass(module = "pt326")]
#[derive(Clone)]
pub(crate) struct Instrument {
    instrument: fdi_core::Instrument,
    sample_time: f64,
    /// What `control` has handed on, and `diagnose` has not taken yet.
    waiting: Option<(RawSample, Tick)>,
    /// The last tick.
    tick: Option<Tick>,
}

#[pymethods]
impl Instrument {
    #[new]
    #[pyo3(signature = (config = None, seed: "int" = Seed(1)))]
    fn new(config: Option<&Bound<'_, Config>>, seed: Seed) -> PyResult<Self> {
        let config = with_prbs_phase(&or_default(config), seed.0);
        let instrument = fdi_core::Instrument::new(&config).map_err(error)?;
        Ok(Self { instrument, sample_time: as_written(config.sample_time.0), waiting: None, tick: None })
    }

    /// First half of a tick: takes in the codes (`Codes`, or three or four numbers), gives the power to drive the heater with, %.
    #[pyo3(signature = (codes: "Codes | typing.Sequence[float]"))]
    fn control(&mut self, codes: &Bound<'_, PyAny>) -> PyResult<f32> {
        let raw = sampled(codes)?;
        let tick = self.instrument.control(raw);
        self.waiting = Some((raw, tick));
        self.tick = Some(tick);
        Ok(tick.drive.0)
    }

    /// Second half of the tick. `applied` is what the heater really gets, %, where that is not what `control` gave.
    #[pyo3(signature = (applied = None))]
    fn diagnose(&mut self, applied: Option<f32>) -> PyResult<Report> {
        let (raw, tick) = self
            .waiting
            .take()
            .ok_or_else(|| PyRuntimeError::new_err("control comes before diagnose on each tick"))?;
        let applied = applied.map_or(tick.drive, Percent);
        let report = self.instrument.diagnose(&tick, applied);
        Ok(Report { raw: Some(raw), tick, report, applied, sample_time: self.sample_time })
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    /// Begins to regulate.
    fn arm(&mut self) -> PyResult<()> {
        self.command(Command::Arm)
    }

    /// Heater off.
    fn stop(&mut self) -> PyResult<()> {
        self.command(Command::Stop)
    }

    /// Leaves a trip whose cause has gone.
    fn acknowledge(&mut self) -> PyResult<()> {
        self.command(Command::Acknowledge)
    }

    /// Forgets what is normal and learns it anew.
    fn relearn(&mut self) -> PyResult<()> {
        self.command(Command::Relearn)
    }

    /// Switches the excitation on or off.
    fn excite(&mut self, on: bool) -> PyResult<()> {
        self.command(Command::Excite(on))
    }

    /// Announces the level of the fan, %.
    fn fan(&mut self, level: f32) -> PyResult<()> {
        self.command(Command::Fan(Percent(level)))
    }

    /// Asks for another set-point, degC.
    fn set_setpoint(&mut self, celsius: f32) -> PyResult<()> {
        self.command(Command::SetPoint(Celsius(celsius)))
    }

    /// Takes over other settings without a bump; the set-point stays.
    fn retune(&mut self, config: &Bound<'_, Config>) -> PyResult<()> {
        self.instrument.retune(&config.borrow().0).map_err(error)
    }

    /// Ts, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// What the thermistors read on the last tick, degC: T0, T1, T2. None where one reads nothing.
    #[getter]
    fn temperatures(&self) -> (Option<f32>, Option<f32>, Option<f32>) {
        let read = |of: fn(&Tick) -> fdi_core::Reading| self.tick.as_ref().and_then(|tick| of(tick).read());
        (read(|tick| tick.sample.t0), read(|tick| tick.sample.t1), read(|tick| tick.sample.t2))
    }

    /// The mode of the last tick: off, settle, learn, monitor, tripped or tune.
    #[getter]
    fn mode(&self) -> &'static str {
        self.tick.as_ref().map_or("off", |tick| tick.mode.numbered().1)
    }
}

impl Instrument {
    fn command(&mut self, command: Command) -> PyResult<()> {
        self.instrument.command(command).map_err(|refusal| Error::new_err(refusal.to_string()))
    }
}

/// The codes that somebody has given.
fn sampled(codes: &Bound<'_, PyAny>) -> PyResult<RawSample> {
    if let Ok(codes) = codes.cast::<Codes>() {
        return Ok(codes.get().0);
    }
    let numbers: Vec<f32> = codes.extract()?;
    match *numbers.as_slice() {
        [t0, t1, t2] => Ok(raw([t0, t1, t2, 0.0])),
        [t0, t1, t2, supply] => Ok(raw([t0, t1, t2, supply])),
        _ => Err(PyTypeError::new_err(format!(
            "{} codes, expected those of T0, T1, T2 and the supply",
            numbers.len()
        ))),
    }
}

/// What both diagnoses say on a tick. `report["rsg1_f"]` is any number of the tick, by its name in trace.csv.
#[pyclass(frozen, module = "pt326")]
pub(crate) struct Report {
    /// None where temperatures came, and no codes.
    pub(crate) raw: Option<RawSample>,
    pub(crate) tick: Tick,
    pub(crate) report: fdi_core::Report,
    pub(crate) applied: Percent,
    pub(crate) sample_time: f64,
}

#[pymethods]
impl Report {
    /// Time of the tick, s.
    #[getter]
    fn t(&self) -> f64 {
        tick_time(self.report.tick, self.sample_time)
    }

    /// Whether the likelihood diagnosis watches: untrained, training, armed, refused_..., restarted.
    #[getter]
    fn readiness(&self) -> &'static str {
        self.report.likelihood.readiness.numbered().1
    }

    /// The likelihood diagnosis says that something is wrong.
    #[getter]
    fn alarm(&self) -> bool {
        self.report.likelihood.alarm
    }

    /// What is wrong, once that can be told.
    #[getter]
    fn finding(&self) -> Option<Finding> {
        let likelihood = &self.report.likelihood;
        let finding = likelihood.finding?;
        let sentence = Sentence {
            finding: &finding,
            sample: &self.tick.sample,
            expected: likelihood.expected,
            sample_time: self.sample_time as f32,
        };
        let sentence = with_degree_sign(&sentence.to_string());
        Some(Finding { finding, sentence, sample_time: self.sample_time })
    }

    /// The fault of the user's own that it is.
    #[getter]
    fn taught(&self) -> Option<String> {
        self.report.likelihood.taught.map(|taught| taught.name.to_string())
    }

    /// What T0, T1 and T2 should read by the models, degC.
    #[getter]
    fn expected(&self) -> (Option<f32>, Option<f32>, Option<f32>) {
        self.report.likelihood.expected.into()
    }

    /// The paper's detection vector by the low-passed residuals; None while it does not monitor.
    #[getter]
    fn fdv(&self) -> Option<u8> {
        self.report.filtered.map(|verdict| verdict.fdv)
    }

    /// The paper's isolation vector by the low-passed residuals; None while it does not monitor.
    #[getter]
    fn fiv(&self) -> Option<u8> {
        self.report.filtered.map(|verdict| verdict.fiv)
    }

    /// The line that a board's log has of this tick, as `pt326 replay` reads it; None of a `Monitor`, which sees no codes.
    fn log_line(&self) -> Option<String> {
        let record = TickRecord::new(self.raw?, self.tick, self.applied);
        Some(TickLine::new(&record, &self.report).to_string())
    }

    /// Samples that the baseline has been learnt from.
    #[getter]
    fn learned(&self) -> u32 {
        self.report.learned
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let entry = COLUMNS.iter().chain(&FIELDS).find(|entry| entry.name == name);
        let entry = entry.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let on = Moment { applied: self.applied, ..Moment::new(&self.tick, &self.report) };
        Ok(match entry.number.value(&on) {
            Value::Named((_, name)) | Value::Choice(Some((_, name))) => name.into_pyobject(py)?.into_any(),
            Value::Tick(Some(tick)) => tick_time(tick, self.sample_time).into_pyobject(py)?.into_any(),
            other => Some(other.number()).filter(|x| !x.is_nan()).into_pyobject(py)?.into_any(),
        })
    }

    fn __repr__(&self) -> String {
        let said = self.finding().map_or(String::new(), |finding| format!(": {}", finding.sentence));
        format!("<pt326.Report at {:.2} s, {}{said}>", self.t(), self.readiness())
    }
}

/// A fault that the likelihood diagnosis has named.
#[pyclass(frozen, module = "pt326")]
pub(crate) struct Finding {
    finding: fdi_core::Finding,
    sentence: String,
    sample_time: f64,
}

#[pymethods]
impl Finding {
    /// Its class, such as `t2_offset`.
    #[getter]
    fn name(&self) -> &'static str {
        self.finding.class.name()
    }

    /// Probability of the class among all that were considered.
    #[getter]
    fn confidence(&self) -> f32 {
        self.finding.confidence
    }

    /// How large it is, in `unit`; None where the class has no size.
    #[getter]
    fn magnitude(&self) -> Option<f32> {
        self.finding.magnitude.map(|magnitude| magnitude.value)
    }

    /// Half of the 95 % interval of the magnitude.
    #[getter]
    fn half_width(&self) -> Option<f32> {
        self.finding.magnitude.map(|magnitude| magnitude.half_width)
    }

    /// Unit of the magnitude.
    #[getter]
    fn unit(&self) -> &'static str {
        self.finding.class.unit()
    }

    /// When it is thought to have begun, s.
    #[getter]
    fn onset(&self) -> f64 {
        tick_time(self.finding.onset, self.sample_time)
    }

    /// All of it as a sentence.
    #[getter]
    fn sentence(&self) -> &str {
        &self.sentence
    }

    fn __repr__(&self) -> String {
        format!("<pt326.Finding {}: {}>", self.name(), self.sentence)
    }

    /// Names of all classes.
    #[staticmethod]
    fn classes() -> Vec<&'static str> {
        FaultClass::ALL.iter().map(|class| class.name()).collect()
    }
}
