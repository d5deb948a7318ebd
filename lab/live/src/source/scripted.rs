//! A board of the tests: it tells what it is made to tell, and notes what it is ordered.

use std::sync::mpsc::{Receiver, Sender, channel};

use pt326_lab::scene::Order;

use super::{Source, Told};

pub(crate) struct Scripted {
    sample_time: f64,
    told: Receiver<Told>,
    ordered: Sender<Order>,
    /// Why it refuses every order, where it does.
    pub(crate) refuses: Option<&'static str>,
}

impl Scripted {
    /// A board of this Ts in s, what makes it tell, and the orders that it is given.
    pub(crate) fn new(sample_time: f64) -> (Self, Sender<Told>, Receiver<Order>) {
        let (tell, told) = channel();
        let (ordered, orders) = channel();
        (Self { sample_time, told, ordered, refuses: None }, tell, orders)
    }
}

impl Source for Scripted {
    fn name(&self) -> String {
        "/dev/some-port".into()
    }

    fn kind(&self) -> &'static str {
        "board"
    }

    fn can(&self) -> &'static [&'static str] {
        &["order"]
    }

    fn sample_time(&self) -> f64 {
        self.sample_time
    }

    fn has_own_time(&self) -> bool {
        true
    }

    fn next(&mut self) -> Option<Told> {
        self.told.try_recv().ok()
    }

    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        let _ = self.ordered.send(order); // where the test listens
        self.refuses.map_or(Ok(()), |why| Err(anyhow::anyhow!(why)))
    }

    fn setpoint_limits(&self) -> Option<[f32; 2]> {
        Some([20.0, 60.0])
    }
}
