//! The session's time, in a thread of its own: so many ticks as have become due, and orders between them.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use anyhow::ensure;
use pt326_lab::protocol;
use pt326_lab::refusal::{self, Refused};
use pt326_lab::scene::{Order, Scene};
use serde_json::{Value, json};
use tokio::sync::{oneshot, watch};

use crate::guard::random;
use crate::history::{History, MOST_ROWS};
use crate::source::{Source, Told};

/// How often it is looked whether a tick is due.
const BEAT: Duration = Duration::from_millis(20);
/// Ticks at a time: after a long sleep of the machine the past is not made up for. Of a source with a time of its own, what it tells.
const MOST_AT_ONCE: f64 = 2000.0;
/// Fastest clock.
pub const FASTEST: f64 = 100.0;

/// What the clock is asked for.
pub(crate) enum Ask {
    Order(Order),
    /// Another scene, and how many ticks of it at once; none: until it monitors.
    Open(Scene, Option<u32>),
    Run(f64),
    Skip,
    Scene,
    Trace,
}

/// A message, or the one that says why not.
pub(crate) type Answer = Result<Value, Value>;

/// A question, and where its answer goes.
type Question = (Ask, oneshot::Sender<Answer>);

/// A session that goes by its clock.
#[derive(Clone)]
pub struct Clock {
    pub(crate) history: Arc<Mutex<History>>,
    /// Changes with every row and note.
    pub(crate) changed: watch::Receiver<()>,
    asks: Sender<Question>,
}

/// Starts the clock, of a simulated rig where it monitors; it ends when nobody can ask any more.
///
/// # Errors
/// The system gives no random numbers.
pub fn start(source: impl Source, speed: f64) -> anyhow::Result<Clock> {
    let (asks, asked) = channel();
    let (tell, changed) = watch::channel(());
    let mut history = History::new(hello(&source), random()?);
    history.setpoint_limits = source.setpoint_limits();
    let history = Arc::new(Mutex::new(history));
    let keeper =
        Keeper { source, history: history.clone(), tell, speed: speed.clamp(0.0, FASTEST), owed: 0.0 };
    std::thread::spawn(move || keeper.run(&asked));
    Ok(Clock { history, changed, asks })
}

/// What a client is told first of a source.
fn hello(source: &impl Source) -> Value {
    let mut hello = protocol::hello(source.kind(), source.can());
    hello["name"] = json!(source.name());
    for key in ["scene", "ts", "settings", "own_names", "taught_names"] {
        if let Some(value) = source.opening().get(key) {
            hello[key] = value.clone();
        }
    }
    hello
}

impl Clock {
    /// Asks for something.
    pub(crate) async fn ask(&self, ask: Ask) -> Answer {
        let (answer, answered) = oneshot::channel();
        let ended = |_| json!({ "type": "refused", "why": "the session has ended" });
        self.asks.send((ask, answer)).map_err(|_| ended(()))?;
        answered.await.map_err(|_| ended(()))?
    }

    pub(crate) fn history(&self) -> MutexGuard<'_, History> {
        lock(&self.history)
    }
}

/// Nobody can leave a history half written: what is done to it does not panic.
fn lock(history: &Mutex<History>) -> MutexGuard<'_, History> {
    history.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

struct Keeper<S> {
    source: S,
    history: Arc<Mutex<History>>,
    tell: watch::Sender<()>,
    speed: f64,
    /// Ticks that are due, and a part of one.
    owed: f64,
}

impl<S: Source> Keeper<S> {
    fn run(mut self, asked: &Receiver<Question>) {
        if self.source.scene().is_some() {
            self.skip();
        }
        let mut before = Instant::now();
        loop {
            match asked.recv_timeout(BEAT) {
                Ok((ask, answer)) => {
                    let told = self.answer(ask).map_err(|error| refusal::message(&error));
                    let _ = answer.send(told); // who asked may have gone
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            let now = Instant::now();
            let due = (now - before).as_secs_f64() / self.source.sample_time() * self.speed;
            before = now;
            self.owed = (self.owed + due).min(MOST_AT_ONCE);
            let ticks = self.owed.floor();
            self.owed -= ticks;
            // A board that floods does not keep from being asked, either.
            self.ticks(if self.source.has_own_time() { MOST_AT_ONCE as usize } else { ticks as usize });
        }
    }

    /// Takes what the source tells, up to a count.
    fn ticks(&mut self, count: usize) {
        let all: Vec<_> = (0..count).map_while(|_| self.source.next()).collect();
        if all.is_empty() {
            return;
        }
        let mut history = lock(&self.history);
        for told in all {
            history.counts.take(&told);
            let tick = history.end();
            if let Some(note) = told.message(tick) {
                history.push_note(note.to_string());
            } else if let Told::Row(row) = told {
                history.push_row(row);
            }
        }
        history.setpoint_limits = self.source.setpoint_limits();
        drop(history);
        self.tell.send_replace(());
    }

    fn note(&self, note: &Value) {
        lock(&self.history).push_note(note.to_string());
        self.tell.send_replace(());
    }

    /// Another scene for all who watch.
    fn open(&mut self, scene: Scene, at: Option<u32>) -> anyhow::Result<()> {
        let ticks = at.unwrap_or(0);
        ensure!(ticks as usize <= MOST_ROWS, Refused::Ticks(ticks));
        self.source.open(scene)?;
        let mut opened = self.source.opening();
        opened["name"] = json!(self.source.name());
        let mut history = lock(&self.history);
        history.begin(hello(&self.source), opened);
        history.setpoint_limits = self.source.setpoint_limits();
        drop(history);
        self.owed = 0.0;
        self.ticks(ticks as usize);
        if at.is_none() {
            self.skip();
        }
        self.tell.send_replace(());
        Ok(())
    }

    fn answer(&mut self, ask: Ask) -> anyhow::Result<Value> {
        match ask {
            Ask::Open(scene, at) => {
                self.open(scene, at)?;
                Ok(json!({ "type": "done" }))
            }
            Ask::Order(order) => {
                let told = json!(order);
                self.source.order(order)?;
                if !self.source.has_own_time() {
                    let tick = lock(&self.history).end();
                    self.note(&json!({ "type": "order", "tick": tick, "order": told }));
                }
                Ok(json!({ "type": "done" }))
            }
            Ask::Run(_) if self.source.has_own_time() => Err(Refused::OwnClock.into()),
            Ask::Run(speed) if (0.0..=FASTEST).contains(&speed) => {
                self.speed = speed;
                self.note(&json!({ "type": "running", "speed": speed }));
                Ok(json!({ "type": "done" }))
            }
            Ask::Run(speed) => Err(Refused::Speed(speed).into()),
            Ask::Skip => {
                self.source.scene().ok_or(Refused::NotSimulated)?;
                self.skip();
                Ok(json!({ "type": "done" }))
            }
            Ask::Scene => {
                let scene = self.source.scene().ok_or(Refused::NotSimulated)?;
                Ok(json!({ "type": "scene", "tick": lock(&self.history).end(), "scene": scene }))
            }
            Ask::Trace => {
                let lines = self.source.trace().ok_or(Refused::NotSimulated)?;
                let text: String = lines.into_iter().flat_map(|line| [line, "\n".into()]).collect();
                Ok(json!({ "type": "trace", "parts": [text] }))
            }
        }
    }

    /// On until it monitors, or heats no more; not forever, for it may never.
    fn skip(&mut self) {
        const WARMING: [f32; 2] = [1.0, 2.0];
        let mode = fdi_core::schema::field("mode").unwrap_or(0);
        for _ in 0..120 {
            self.ticks(50);
            if !lock(&self.history).last().is_some_and(|row| WARMING.contains(&row[mode])) {
                return;
            }
        }
    }
}
