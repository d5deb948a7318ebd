//! Several rigs on one page: a tile each, a stop for all of them. Each rig's own page is served beside it, as it would be alone.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, SystemTime};

use futures_util::future::join_all;
use pt326_lab::protocol;
use pt326_lab::scene::Order;
use serde_json::{Value, json};
use tokio::time::timeout;

use crate::clock::{Ask, Clock};
use crate::history::History;
use crate::metrics::Families;

/// So long a rig may take to answer to a stop: the answer says which were told, and must come while somebody still looks at it.
const PATIENCE: Duration = Duration::from_secs(5);

/// A rig that is served, or will be as soon as it is there.
pub struct Rig {
    name: String,
    clock: OnceLock<Clock>,
    /// Why it is not there yet.
    why: Mutex<String>,
    /// Pages that watch it.
    pub(crate) clients: AtomicUsize,
}

impl Rig {
    /// One that is not there yet. Its name stands in addresses: letters, digits, `-` and `_`.
    pub fn new(name: &str) -> Self {
        let why = Mutex::new("it has not answered yet".to_owned());
        Self { name: name.into(), clock: OnceLock::new(), why, clients: AtomicUsize::new(0) }
    }

    /// One that is there.
    pub fn of(name: &str, clock: Clock) -> Self {
        let rig = Self::new(name);
        rig.is_there(clock);
        rig
    }

    /// What it is called among the others.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// It is there from now on. Only the first time counts.
    pub fn is_there(&self, clock: Clock) {
        let _ = self.clock.set(clock);
    }

    /// It is not there yet; whether that is another reason than before.
    pub fn is_missing(&self, why: &str) -> bool {
        let mut before = self.why();
        let is_news = *before != why;
        why.clone_into(&mut before);
        is_news
    }

    pub(crate) fn clock(&self) -> Option<&Clock> {
        self.clock.get()
    }

    pub(crate) fn why(&self) -> MutexGuard<'_, String> {
        self.why.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has it stopped. Why it was not told, where it was not.
    async fn stop(&self) -> Value {
        let Some(clock) = self.clock() else {
            return json!(format!("the stop has NOT reached it: {}", self.why()));
        };
        match timeout(PATIENCE, clock.ask(Ask::Order(Order::Stop))).await {
            Ok(Ok(_)) => Value::Null,
            Ok(Err(refused)) => refused["why"].clone(),
            Err(_) => json!("no answer: whether the stop has reached it is NOT known"),
        }
    }

    /// What its tile shows.
    fn tile(&self) -> Value {
        let Some(clock) = self.clock() else {
            return json!({ "board": self.name, "why": *self.why() });
        };
        let history = clock.history();
        let mut tile = self.standing(&history);
        for key in ["name", "kind", "ts"] {
            tile[key] = history.about()[key].clone();
        }
        tile["preset"] = history.about()["scene"]["preset"].clone();
        tile
    }

    /// Its last tick, how long mode and alarm have been as they are, s, and since when nothing is heard of it, s.
    fn standing(&self, history: &History) -> Value {
        let counts = &history.counts;
        let ts = history.about()["ts"].as_f64().unwrap_or_default();
        let silent =
            counts.heard.and_then(|at| SystemTime::now().duration_since(at).ok()).unwrap_or_default();
        // NaN, which is what is not defined, is null in JSON.
        json!({
            "board": self.name,
            "row": history.last().map(|row| row.to_vec()),
            "mode_for": counts.mode_for as f64 * ts,
            "alarm_for": counts.alarm_for as f64 * ts,
            "lost": counts.lost.then_some(silent.as_secs_f64()),
        })
    }
}

/// What the page of a wall must know to read a tile, once for all of them.
pub(crate) fn key() -> Value {
    let mut hello = protocol::hello("wall", &[]);
    let mut key = json!({});
    for name in ["fields", "classes", "trips", "blockers", "readiness"] {
        key[name] = hello[name].take();
    }
    key
}

/// All tiles.
pub(crate) fn tiles<'a>(rigs: impl Iterator<Item = &'a Rig>) -> Value {
    rigs.map(Rig::tile).collect()
}

/// Has all rigs stopped, none later than any other; each name with why it was not told, or null.
pub(crate) async fn stop<'a>(rigs: impl Iterator<Item = &'a Rig>) -> Value {
    let told = join_all(rigs.map(async |rig| json!({ "board": rig.name, "why": rig.stop().await })));
    told.await.into()
}

/// The numbers of all rigs for Prometheus, each with its name as the label `board`.
pub(crate) fn metrics<'a>(rigs: impl Iterator<Item = &'a Rig>) -> String {
    let mut all = Families::default();
    for rig in rigs {
        all.of_board(&rig.name);
        match rig.clock() {
            Some(clock) => all.add(&clock.history(), rig.clients.load(Ordering::Relaxed)),
            None => all.add_missing(),
        }
    }
    all.text()
}
