//! What can be served: something that gives a row of numbers for each tick.

use pt326_lab::fields::FIELDS;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;

/// The numbers of a tick, in the order of [`FIELDS`].
pub type Numbers = [f32; FIELDS.len()];

/// A rig that is watched.
pub trait Source: Send + 'static {
    /// Its name for people.
    fn name(&self) -> String;

    /// Which commands make sense.
    fn can(&self) -> &'static [&'static str];

    /// Ts in s.
    fn sample_time(&self) -> f64;

    /// The next tick; `None` where there is none yet, or none any more.
    fn tick(&mut self) -> Option<Numbers>;

    /// Does what is ordered.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        let _ = order;
        anyhow::bail!("a recording takes no orders")
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
        &["order", "run", "trace"]
    }

    fn sample_time(&self) -> f64 {
        Self::sample_time(self)
    }

    fn tick(&mut self) -> Option<Numbers> {
        let row = self.step();
        Some(self.numbers(&row))
    }

    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        Self::order(self, order)
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
    rows: std::vec::IntoIter<Numbers>,
}

impl Recording {
    /// From its rows.
    pub fn new(name: String, sample_time: f64, rows: Vec<Numbers>) -> Self {
        Self { name, sample_time, rows: rows.into_iter() }
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

    fn tick(&mut self) -> Option<Numbers> {
        self.rows.next()
    }
}
