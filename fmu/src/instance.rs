//! An instance of a model, and what may be done to it when.

use std::ffi::CString;

use anyhow::{Context, bail, ensure};

use crate::model::{Model, Running};
use crate::variable::{Role, Value, Values};

/// How far a step may differ from the sample time, as a share of it: importers add up their times.
const STEP_TOLERANCE: f64 = 1e-6;
/// How far the beginning of a step may differ from the end of the one before, as a share of the sample time.
const TIME_TOLERANCE: f64 = 0.01;

/// What an importer has brought an instance to, in the words of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Instantiated,
    InitializationMode,
    StepMode,
    Terminated,
}

/// An instance of a model.
pub struct Instance {
    model: &'static Model,
    values: Values,
    state: State,
    running: Option<Box<dyn Running>>,
    /// Time of the first step, s.
    start: f64,
    steps: u64,
    /// What was given out last, which an importer may read until its next call.
    texts: Vec<CString>,
}

impl Instance {
    /// A new one.
    pub fn new(model: &'static Model) -> Self {
        let values = Values::new(&model.variables);
        let (state, running, texts) = (State::Instantiated, None, Vec::new());
        Self { model, values, state, running, start: 0.0, steps: 0, texts }
    }

    fn expect(&self, what: &str, states: &[State]) -> anyhow::Result<()> {
        ensure!(states.contains(&self.state), "{what} in the state {:?}, expected {states:?}", self.state);
        Ok(())
    }

    /// Begins its initialization for a simulation from `start` on, s.
    ///
    /// # Errors
    /// It is not its time, or `start` is not finite.
    pub fn enter_initialization(&mut self, start: f64) -> anyhow::Result<()> {
        self.expect("fmi3EnterInitializationMode", &[State::Instantiated])?;
        ensure!(start.is_finite(), "the start time is {start}, expected a finite time in s");
        self.start = start;
        self.state = State::InitializationMode;
        self.values.tell("time", Value::Real(start));
        Ok(())
    }

    /// Ends its initialization: the model begins.
    ///
    /// # Errors
    /// It is not its time, or the parameter that is wrong.
    pub fn exit_initialization(&mut self) -> anyhow::Result<()> {
        self.expect("fmi3ExitInitializationMode", &[State::InitializationMode])?;
        self.begin()?;
        self.state = State::StepMode;
        Ok(())
    }

    /// Begins the model, unless it has since a parameter was set last.
    fn begin(&mut self) -> anyhow::Result<()> {
        if self.running.is_none() {
            self.running = Some((self.model.begin)(&mut self.values)?);
        }
        Ok(())
    }

    /// Takes a step of `length` from the time `from`, s, and gives what the model refused to do.
    ///
    /// # Errors
    /// It is not its time, or the step is not the next one by the sample time. Nothing has changed then.
    pub fn step(&mut self, from: f64, length: f64) -> anyhow::Result<Vec<String>> {
        self.expect("fmi3DoStep", &[State::StepMode])?;
        let running = self.running.as_mut().context("the model has not begun")?;
        let sample_time = running.sample_time();
        ensure!(
            (length - sample_time).abs() <= STEP_TOLERANCE * sample_time,
            "the step is {length} s long, expected the sample time, {sample_time} s"
        );
        let time = |steps: u64| self.start + steps as f64 * sample_time;
        let now = time(self.steps);
        ensure!(
            (from - now).abs() <= TIME_TOLERANCE * sample_time,
            "the step begins at {from} s, expected {now} s, where the one before ended"
        );
        let refused = running.step(&mut self.values);
        let now = time(self.steps + 1);
        self.steps += 1;
        self.values.tell("time", Value::Real(now));
        Ok(refused)
    }

    /// The time that it has come to, s.
    pub fn now(&self) -> f64 {
        self.values.real("time")
    }

    /// Ends the simulation; the outputs can still be read.
    ///
    /// # Errors
    /// It is not its time.
    pub fn terminate(&mut self) -> anyhow::Result<()> {
        self.expect("fmi3Terminate", &[State::StepMode])?;
        self.state = State::Terminated;
        Ok(())
    }

    /// Makes it as new.
    pub fn reset(&mut self) {
        *self = Self::new(self.model);
    }

    /// What a variable holds.
    ///
    /// # Errors
    /// There is none of this reference; a parameter is wrong, so that nothing can be known.
    pub fn get(&mut self, reference: u32) -> anyhow::Result<&Value> {
        if self.state == State::InitializationMode {
            self.begin()?;
        }
        self.values.get(reference)
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// There is none of this reference, it cannot be set now, has another type, or the value is out of bounds.
    pub fn set(&mut self, reference: u32, value: Value) -> anyhow::Result<()> {
        let variable = self.values.variable(reference)?;
        let what = format!("{} is set", variable.name);
        let before = [State::Instantiated, State::InitializationMode];
        match variable.role {
            Role::Parameter => {
                self.expect(&what, &before)?;
                self.running = None;
            }
            Role::Input => self.expect(&what, &[before[0], before[1], State::StepMode])?,
            role => bail!("{what}, expected a parameter or an input; it is of the kind {role:?}"),
        }
        self.values.set(reference, value)
    }

    /// What some variables of text hold. They stay where they are until the next call.
    ///
    /// # Errors
    /// There is none of a reference, or it holds no text.
    pub fn texts(&mut self, references: &[u32]) -> anyhow::Result<&[CString]> {
        let mut texts = Vec::with_capacity(references.len());
        for &reference in references {
            let name = &self.values.variable(reference)?.name;
            match self.get(reference)? {
                Value::Text(text) => texts.push(CString::new(text.as_str())?),
                other => bail!("{name} is read by fmi3GetString, expected fmi3Get{}", other.type_name()),
            }
        }
        self.texts = texts;
        Ok(&self.texts)
    }

    /// The name of a variable, for messages.
    pub fn name(&self, reference: u32) -> anyhow::Result<&'static str> {
        self.values.variable(reference).map(|variable| variable.name.as_str())
    }
}
