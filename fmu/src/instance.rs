//! An instance of a model, and what may be done to it when.

use std::ffi::CString;

use anyhow::{Context, bail, ensure};

use crate::model::{Model, Running};
use crate::variable::{Role, Value, Values};

/// How far a step may differ from whole sample times, as a share of one (chosen: a step of single precision is right to 1e-7 of it).
const STEP_TOLERANCE: f64 = 1e-6;
/// How far the beginning of a step may differ from the end of the one before, as a share of the sample time (chosen: importers add
/// their times up, some in single precision; one that leaves out or repeats a step is off by a whole one).
const TIME_TOLERANCE: f64 = 0.01;
/// Besides, units in the last place of the time: a step is the difference of two rounded times, and those of a clock that counts from 1970
/// are right to 2.4e-7 s (derived: half a unit for each time and for each difference, doubled).
const LAST_PLACES: f64 = 4.0;

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
    /// What was given out last, which an importer may read until its next call.
    texts: Vec<CString>,
}

impl Instance {
    /// A new one.
    pub fn new(model: &'static Model) -> Self {
        let values = Values::new(&model.variables);
        let (state, running, texts) = (State::Instantiated, None, Vec::new());
        Self { model, values, state, running, texts }
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

    /// Takes as many steps as sample times fit into `length` from the time `from` on, s, and gives what the model refused to do. The inputs
    /// hold over all of them.
    ///
    /// # Errors
    /// It is not its time, or the step is not the next one by whole sample times. Nothing has changed then.
    pub fn step(&mut self, from: f64, length: f64) -> anyhow::Result<Vec<String>> {
        self.expect("fmi3DoStep", &[State::StepMode])?;
        let (now, end) = (self.now(), from + length);
        let running = self.running.as_mut().context("the model has not begun")?;
        let sample_time = running.sample_time();
        let largest = from.abs().max(end.abs());
        let rounding = LAST_PLACES * (largest.next_up() - largest);
        let ticks = (length / sample_time).round();
        ensure!(
            ticks >= 1.0 && (length - ticks * sample_time).abs() <= STEP_TOLERANCE * sample_time + rounding,
            "the step is {length} s long, expected the sample time, {sample_time} s, or a whole multiple of it"
        );
        ensure!(
            (from - now).abs() <= TIME_TOLERANCE * sample_time + rounding,
            "the step begins at {from} s, expected {now} s, where the one before ended"
        );
        let mut refused = Vec::new();
        for _ in 0..ticks as u64 {
            refused.extend(running.step(&mut self.values));
        }
        self.values.tell("time", Value::Real(end));
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

    /// Sets a variable, and says if that is an input that is held to its bounds.
    ///
    /// # Errors
    /// There is none of this reference, it cannot be set now, has another type, or the value is out of bounds.
    pub fn set(&mut self, reference: u32, value: Value) -> anyhow::Result<Option<String>> {
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
