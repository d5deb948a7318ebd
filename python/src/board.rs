//! A real board at a serial port.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fdi_core::likelihood::Readiness;
use fdi_core::schema::{FIELDS, Numbers};
use fdi_core::{FaultClass, Mode, TripReason};
use firmware_logic::console::request::Request;
use pt326_host::board::watch::Watch;
use pt326_host::board::{find, refusal};
use pt326_lab::scene::Order;
use pt326_lab::told::Told;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::convert::{python, refused};

/// Between two looks at what has come.
const PAUSE: Duration = Duration::from_millis(5);
/// Ticks that may wait while an answer is waited for: hours.
const MOST_WAITING: usize = 100_000;

/// A real board at a serial port: its ticks as they come, its console, and stop. As long as nobody says `heat=True`, nothing that it is asked from
/// here makes it heat; with it the heater is switched off again where a `with` ends, however that may be. What it does by itself it goes on with.
///
/// `port` is the only one that a board may be at, unless it is given. A board that says nothing for `patience` s is an error.
#[pyclass(module = "pt326")]
pub(crate) struct Board {
    watch: Mutex<Watch>,
    heat: bool,
    patience: Duration,
    linked: bool,
    settings: BTreeMap<String, f32>,
    said: Vec<String>,
    rows: VecDeque<Numbers>,
}

#[pymethods]
impl Board {
    #[new]
    #[pyo3(signature = (port = None, *, heat = false, patience = 15.0))]
    fn new(py: Python<'_>, port: Option<&str>, heat: bool, patience: f64) -> PyResult<Self> {
        let patience =
            Duration::try_from_secs_f64(patience).map_err(|why| refused(format!("patience: {why}")))?;
        let watch = python(py.detach(|| Watch::open(&find(port)?)))?;
        Ok(Self {
            watch: Mutex::new(watch),
            heat,
            patience,
            linked: true,
            settings: BTreeMap::new(),
            said: Vec::new(),
            rows: VecDeque::new(),
        })
    }

    /// Its port.
    #[getter]
    fn port(&mut self) -> String {
        self.watch().name().to_owned()
    }

    /// Ts, s.
    #[getter]
    fn sample_time(&mut self) -> f64 {
        self.watch().sample_time()
    }

    /// Whether it may be made to heat from here.
    #[getter]
    fn heat(&self) -> bool {
        self.heat
    }

    /// Whether it was heard lately.
    #[getter]
    fn linked(&self) -> bool {
        self.linked
    }

    /// Its numbers that are not the defaults, as far as they have been heard.
    #[getter]
    fn settings(&self) -> BTreeMap<String, f32> {
        self.settings.clone()
    }

    /// What its console has said without being asked.
    #[getter]
    fn said(&self) -> Vec<String> {
        self.said.clone()
    }

    /// Heater off. It is on its way before this returns, whatever else is under way.
    fn stop(&mut self) -> PyResult<()> {
        python(self.watch().order(&Order::Stop))
    }

    /// Begins to regulate; only with `heat=True`.
    fn arm(&mut self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, "arm")
    }

    /// How it is.
    fn status(&mut self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, "status")
    }

    /// Types a line on its console and gives the answer. What it refuses is raised.
    fn ask(&mut self, py: Python<'_>, line: &str) -> PyResult<String> {
        let heats = matches!(Request::parse(line), Ok(Request::Arm | Request::Tune(_) | Request::Check));
        if heats && !self.heat {
            return Err(refused(format!("`{line}` makes the board heat: that takes Board(.., heat=True)")));
        }
        python(self.watch().order(&Order::Console { line: line.to_owned() }))?;
        let echo = format!("> {line}\n");
        let begun = Instant::now();
        loop {
            match self.next(py, begun)? {
                Told::Said(text) if text.starts_with(&echo) => {
                    let answer = text[echo.len()..].to_owned();
                    return match refusal(&answer) {
                        Some(error) => Err(refused(format!("the board says to `{line}`: {error}"))),
                        None => Ok(answer),
                    };
                }
                Told::Refused { why, .. } => return Err(refused(why)),
                Told::Row(row) if self.rows.len() < MOST_WAITING => self.rows.push_back(row),
                other => self.take(other),
            }
        }
    }

    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    /// The next tick.
    fn __next__<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        if let Some(row) = self.rows.pop_front() {
            return self.tick(py, &row);
        }
        let begun = Instant::now();
        loop {
            match self.next(py, begun)? {
                Told::Row(row) => return self.tick(py, &row),
                other => self.take(other),
            }
        }
    }

    fn __repr__(&mut self) -> String {
        format!("<pt326.Board at {}, {}>", self.port(), if self.linked { "heard" } else { "silent" })
    }

    fn __enter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (*_raised: "object"))]
    fn __exit__(&mut self, _raised: &Bound<'_, PyTuple>) -> PyResult<()> {
        if self.heat { self.stop() } else { Ok(()) }
    }
}

impl Board {
    fn watch(&mut self) -> &mut Watch {
        self.watch.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// What it tells next; waits for it.
    fn next(&mut self, py: Python<'_>, begun: Instant) -> PyResult<Told> {
        loop {
            if let Some(told) = self.watch().take() {
                return Ok(told);
            }
            if begun.elapsed() > self.patience {
                return Err(refused(format!("the board has said nothing for {:?}", self.patience)));
            }
            py.detach(|| std::thread::sleep(PAUSE));
            py.check_signals()?;
        }
    }

    /// What is neither a tick nor an answer.
    fn take(&mut self, told: Told) {
        match told {
            Told::Order(Order::Set { name, value }) => drop(self.settings.insert(name, value)),
            Told::Link(linked) => self.linked = linked,
            Told::Said(text) => self.said.push(text),
            Told::Refused { why, .. } => self.said.push(why),
            _ => {}
        }
    }

    /// A tick by the names of the numbers, with None where one is not defined.
    fn tick<'py>(&mut self, py: Python<'py>, row: &Numbers) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        let sample_time = self.watch().sample_time();
        let place = |x: f32| if x.is_nan() { None } else { Some(x as usize) };
        for (field, &x) in FIELDS.iter().zip(row) {
            let word = match field.name {
                "tick" => {
                    dict.set_item("t", f64::from(x) * sample_time)?;
                    continue;
                }
                "mode" => place(x).and_then(|place| Mode::NAMES.get(place)).copied(),
                "readiness" => place(x).and_then(|place| Readiness::NAMES.get(place)).copied(),
                "trip" => place(x).and_then(|place| TripReason::NAMES.get(place.checked_sub(1)?)).copied(),
                "class" => {
                    let class =
                        |number| FaultClass::ALL.into_iter().find(|class| class.number() as usize == number);
                    place(x).and_then(class).map(FaultClass::name)
                }
                _ => {
                    dict.set_item(field.name, Some(x).filter(|x| !x.is_nan()))?;
                    continue;
                }
            };
            dict.set_item(field.name, word)?;
        }
        Ok(dict)
    }
}
