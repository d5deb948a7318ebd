//! What can be served: something that gives a row of numbers for each tick.

#[cfg(test)]
pub(crate) mod scripted;

pub use fdi_core::schema::Numbers;
use pt326_lab::names::Names;
use pt326_lab::protocol;
use pt326_lab::refusal::Refused;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
pub use pt326_lab::told::Told;
use serde_json::{Value, json};

/// A rig that is watched.
pub trait Source: Send + 'static {
    /// Its name for people.
    fn name(&self) -> String;

    /// What it is, as the page's hello says it.
    fn kind(&self) -> &'static str {
        "live"
    }

    /// Which commands make sense.
    fn can(&self) -> &'static [&'static str];

    /// Ts in s.
    fn sample_time(&self) -> f64;

    /// Its ticks come in a time of their own, which no clock sets; it then also tells itself which orders were carried out.
    fn has_own_time(&self) -> bool {
        false
    }

    /// The next tick, or what else there is to tell; `None` where there is nothing yet, or nothing any more.
    fn next(&mut self) -> Option<Told>;

    /// Does what is ordered, or has it done soon. Does not wait.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        let _ = order;
        Err(Refused::Recorded.into())
    }

    /// Lowest and highest set-point that it takes, degC; `None` where it takes none.
    fn setpoint_limits(&self) -> Option<[f32; 2]> {
        None
    }

    /// Begins another scene, of a simulated rig.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    fn open(&mut self, scene: Scene) -> anyhow::Result<()> {
        let _ = scene;
        Err(Refused::NotSimulated.into())
    }

    /// What a client is told of how it began: `ts`, of a simulated rig what `opened` tells, of a recording its names.
    fn opening(&self) -> Value {
        json!({ "type": "opened", "ts": self.sample_time() })
    }

    /// The scene that leads here, of a simulated rig.
    fn scene(&self) -> Option<Scene> {
        None
    }

    /// The trace of all ticks so far, line by line, where there is one.
    fn trace(&self) -> Option<Vec<String>> {
        None
    }
}

/// The simulated rig.
impl Source for Session {
    fn name(&self) -> String {
        let Scene { preset, seed, .. } = self.scene();
        format!("{preset}, seed {seed}")
    }

    fn can(&self) -> &'static [&'static str] {
        &["order", "break", "open", "run", "trace"]
    }

    fn sample_time(&self) -> f64 {
        Self::sample_time(self)
    }

    fn next(&mut self) -> Option<Told> {
        let row = self.step();
        Some(Told::Row(self.numbers(&row)))
    }

    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        Self::order(self, order)
    }

    fn setpoint_limits(&self) -> Option<[f32; 2]> {
        let supervisor = &self.config().supervisor;
        Some([supervisor.setpoint_min.0, supervisor.setpoint_max.0])
    }

    fn open(&mut self, scene: Scene) -> anyhow::Result<()> {
        *self = Self::new(scene)?;
        Ok(())
    }

    fn opening(&self) -> Value {
        protocol::opened(self)
    }

    fn scene(&self) -> Option<Scene> {
        Some(Self::scene(self))
    }

    fn trace(&self) -> Option<Vec<String>> {
        Some(Self::trace(self).ok()?.collect())
    }
}

/// A recording: its rows, one after another.
pub struct Recording {
    name: String,
    sample_time: f64,
    names: Names,
    rows: std::vec::IntoIter<Numbers>,
}

impl Recording {
    /// From its rows, and what its faults are called.
    pub fn new(name: String, sample_time: f64, names: Names, rows: Vec<Numbers>) -> Self {
        Self { name, sample_time, names, rows: rows.into_iter() }
    }
}

impl Source for Recording {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn can(&self) -> &'static [&'static str] {
        &["run"]
    }

    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    fn next(&mut self) -> Option<Told> {
        self.rows.next().map(Told::Row)
    }

    fn opening(&self) -> Value {
        let Names { rows, taught } = &self.names;
        json!({ "type": "opened", "ts": self.sample_time, "own_names": rows, "taught_names": taught })
    }
}
