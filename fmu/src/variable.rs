//! Variables of a model, and what they hold.

use anyhow::{Context, ensure};

/// What a variable holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `Float64`. NaN: not defined now.
    Real(f64),
    /// `Int32`.
    Whole(i32),
    /// `Boolean`.
    Flag(bool),
    /// `String`.
    Text(String),
}

impl Value {
    /// Its type in FMI 3.0.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Real(_) => "Float64",
            Self::Whole(_) => "Int32",
            Self::Flag(_) => "Boolean",
            Self::Text(_) => "String",
        }
    }

    /// The number that bounds are about.
    fn number(&self) -> Option<f64> {
        match self {
            Self::Real(x) => Some(*x),
            Self::Whole(n) => Some(f64::from(*n)),
            _ => None,
        }
    }
}

/// What a variable is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The time of the simulation.
    Time,
    /// It is set before the simulation begins.
    Parameter,
    /// It follows from the parameters.
    Calculated,
    /// It is set before each step, and holds over it.
    Input,
    /// It is known after each step.
    Output,
}

/// A variable. Its place in its model's list is its value reference.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name; a dot makes a group.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// What it holds at first, which says its type, too.
    pub start: Value,
    /// Its unit, empty where it has none.
    pub unit: &'static str,
    /// The least and the largest that a parameter may be, and to which an input is held; NaN is within no bounds, though codes may be missing.
    pub bounds: Option<(f64, f64)>,
    /// What it is.
    pub about: &'static str,
}

impl Variable {
    /// One without unit and bounds.
    pub fn new(role: Role, name: impl Into<String>, start: Value, about: &'static str) -> Self {
        Self { name: name.into(), role, start, unit: "", bounds: None, about }
    }

    /// The time, the first variable of each model.
    pub fn time() -> Self {
        Self::new(Role::Time, "time", Value::Real(0.0), "Time of the simulation").unit("s")
    }

    /// It in a unit.
    pub fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// It within bounds.
    pub fn within(self, min: f64, max: f64) -> Self {
        Self { bounds: Some((min, max)), ..self }
    }

    /// What it holds when somebody sets it, and what is to be told of that. An input out of bounds is held to them: what computes a power
    /// rounds, and what winds up goes beyond the most that a heater has.
    fn taken(&self, value: Value) -> anyhow::Result<(Value, Option<String>)> {
        let name = &self.name;
        let (is, holds) = (value.type_name(), self.start.type_name());
        ensure!(is == holds, "{name} is set as {is}, expected {holds}");
        let (Some((min, max)), Some(x)) = (self.bounds, value.number()) else { return Ok((value, None)) };
        if (min..=max).contains(&x) {
            return Ok((value, None));
        }
        let wrong = format!("{name} is {x}, expected {min} to {max} {}", self.unit);
        ensure!(self.role == Role::Input && !x.is_nan(), "{wrong}");
        let held = x.clamp(min, max);
        Ok((Value::Real(held), Some(format!("{wrong}: held to {held}"))))
    }
}

/// The variables of an instance.
#[derive(Clone, Debug)]
pub struct Values {
    table: &'static [Variable],
    values: Vec<Value>,
}

impl Values {
    /// Each as it starts.
    pub fn new(table: &'static [Variable]) -> Self {
        Self { table, values: table.iter().map(|variable| variable.start.clone()).collect() }
    }

    /// The variable of a value reference.
    ///
    /// # Errors
    /// There is none.
    pub fn variable(&self, reference: u32) -> anyhow::Result<&'static Variable> {
        let last = self.table.len() - 1;
        self.table
            .get(reference as usize)
            .with_context(|| format!("value reference {reference}, expected 0 to {last}"))
    }

    /// What the variable of a value reference holds.
    ///
    /// # Errors
    /// There is none.
    pub fn get(&self, reference: u32) -> anyhow::Result<&Value> {
        self.variable(reference).map(|_| &self.values[reference as usize])
    }

    /// Sets a variable as a user does, and says if that is an input that is held to its bounds.
    ///
    /// # Errors
    /// There is none, it has another type, or the value is out of bounds.
    pub fn set(&mut self, reference: u32, value: Value) -> anyhow::Result<Option<String>> {
        let (value, told) = self.variable(reference)?.taken(value)?;
        self.values[reference as usize] = value;
        Ok(told)
    }

    fn place(&self, name: &str) -> usize {
        self.table
            .iter()
            .position(|variable| variable.name == name)
            .expect("a variable of the model's own list")
    }

    /// Puts what a model has to say into one of its variables.
    pub fn tell(&mut self, name: &str, value: Value) {
        let place = self.place(name);
        self.values[place] = value;
    }

    /// What a variable holds; 0 if it is no number.
    pub fn real(&self, name: &str) -> f64 {
        self.values[self.place(name)].number().unwrap_or(0.0)
    }

    /// What a variable holds; false if it is no flag.
    pub fn flag(&self, name: &str) -> bool {
        self.values[self.place(name)] == Value::Flag(true)
    }

    /// What a variable holds; nothing if it is no text.
    pub fn text(&self, name: &str) -> &str {
        match &self.values[self.place(name)] {
            Value::Text(text) => text,
            _ => "",
        }
    }
}
