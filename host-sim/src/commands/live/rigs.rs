//! What `live` serves: one rig, or a wall of several.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
use pt326_live::mqtt::{self, Broker};
use pt326_live::source::{Recording, Source, Told};
use pt326_live::{Rig, clock};

use super::LiveArgs;
use crate::commands::replay::{self, ReplayArgs};
use crate::commands::terminal::print;
use pt326_host::board::watch::{Leaver, Watch};
use pt326_host::board::{ALONE, find};
use pt326_host::record::numbers;

/// Between two attempts to find a board of a wall that is not there.
const ANOTHER: Duration = Duration::from_secs(2);
/// Longest name of a board, characters.
const LONGEST: usize = 32;

/// A board as it is asked for: its port, and what it is called.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardAt {
    name: Option<String>,
    /// None: the only ST-LINK that is plugged in.
    port: Option<String>,
}

impl FromStr for BoardAt {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        let (name, port) = text.split_once('=').map_or((None, text), |(name, port)| (Some(name), port));
        if let Some(name) = name {
            let plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_');
            let expected = "expected letters, digits, - and _";
            ensure!(
                plain && (1..=LONGEST).contains(&name.len()),
                "name \"{name}\", {expected}, at most {LONGEST}"
            );
            ensure!(!port.is_empty(), "\"{text}\" names no port, expected such as {name}=/dev/ttyACM0");
        }
        let port = Some(port).filter(|port| !port.is_empty()).map(str::to_owned);
        Ok(Self { name: name.map(str::to_owned), port })
    }
}

impl BoardAt {
    /// Its name; without one, the end of its port's.
    fn called(&self) -> String {
        let port = self.port.as_deref().unwrap_or("board");
        let end = port.rsplit(['/', '\\']).next().unwrap_or(port);
        let plain = end.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' });
        self.name.clone().unwrap_or_else(|| plain.collect())
    }
}

/// Boards that are there, with the names by which they are called.
#[derive(Clone, Default)]
pub(super) struct Boards(Arc<Mutex<Vec<(String, Leaver)>>>);

impl Boards {
    fn all(&self) -> MutexGuard<'_, Vec<(String, Leaver)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One is being opened.
    fn expected(&self, name: &str, port: &str) {
        self.all().push((name.to_owned(), Leaver::of(port)));
    }

    /// One is there.
    fn watched(&self, name: &str, watch: Watch) -> Board {
        let mut all = self.all();
        all.retain(|(known, _)| known != name);
        all.push((name.to_owned(), watch.leaver()));
        Board(watch)
    }

    /// Stops all of them, and says of each whether it says so; whether all do.
    pub(super) fn leave(&self) -> bool {
        let all = std::mem::take(&mut *self.all());
        let asked: Vec<_> =
            all.into_iter().map(|(name, leaver)| (name, thread::spawn(move || leaver.stops()))).collect();
        let told = |(name, stops): (String, thread::JoinHandle<bool>)| {
            let stopped = stops.join().unwrap_or(false);
            // A terminal that was closed shows nothing.
            let _ = match stopped {
                true => writeln!(std::io::stderr(), "{name}: the board says that its heater is off"),
                false => writeln!(
                    std::io::stderr(),
                    "{name}: the board does NOT say that its heater is off: {ALONE}"
                ),
            };
            stopped
        };
        asked.into_iter().map(told).filter(|stopped| !stopped).count() == 0
    }
}

/// All that is to be served. Boards of a wall need not be there yet.
///
/// # Errors
/// A bad file or value; a board that is alone, and not there.
pub(super) fn all(
    args: &LiveArgs,
    boards: &Boards,
    broker: Option<&Broker>,
) -> anyhow::Result<Vec<Arc<Rig>>> {
    match (&args.board[..], &args.recording) {
        ([], Some(file)) => one(recording(args, file)?, args.speed, broker),
        ([], None) => simulated(args, broker),
        ([board], _) => {
            let log = || log_in(args.record.as_deref(), &board.called());
            let port = find(board.port.as_deref())?;
            boards.expected(&board.called(), &port);
            let watch = Watch::open_recorded(&port, log)?;
            one(boards.watched(&board.called(), watch), 1.0, broker)
        }
        (wall, _) => several(wall, args.record.as_deref(), boards, broker),
    }
}

/// One rig alone needs no name.
fn one(source: impl Source, speed: f64, broker: Option<&Broker>) -> anyhow::Result<Vec<Arc<Rig>>> {
    let rig = Rig::new("rig");
    begin(&rig, source, speed, broker.cloned())?;
    Ok(vec![Arc::new(rig)])
}

/// A rig is there: its time begins, and the broker is told of it.
fn begin(rig: &Rig, source: impl Source, speed: f64, broker: Option<Broker>) -> anyhow::Result<()> {
    let clock = clock::start(source, speed)?;
    if let Some(broker) = broker {
        mqtt::start(clock.clone(), broker, |said| drop(print(&format!("{said}\n"))))?;
    }
    rig.is_there(clock);
    Ok(())
}

fn recording(args: &LiveArgs, file: &Path) -> anyhow::Result<Recording> {
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let replayed =
        ReplayArgs { file: file.into(), config: args.config.clone(), seed: None, out: Default::default() };
    let record = replay::again(&replayed, None, |_, _, _| ())?.record;
    let rows = numbers::of(&record);
    Ok(Recording::new(name, record.sample_time, record.names, rows))
}

/// As many simulated rigs as are asked for, each with a seed of its own; presets go round.
fn simulated(args: &LiveArgs, broker: Option<&Broker>) -> anyhow::Result<Vec<Arc<Rig>>> {
    let count = usize::from(args.rigs).max(args.preset.len());
    let sessions = args.preset.iter().cycle().zip(args.seed..).take(count).map(|(preset, seed)| {
        let disturbance = args.disturbance;
        Session::new(Scene { seed, preset: preset.clone(), disturbance, ..Scene::default() })
    });
    let mut sessions: Vec<_> = sessions.collect::<Result<_, _>>()?;
    if count == 1 {
        return one(sessions.remove(0), args.speed, broker);
    }
    let named = sessions.into_iter().zip(1..).map(|(session, number)| {
        let rig = Rig::new(&format!("rig-{number}"));
        begin(&rig, session, args.speed, broker.map(|broker| broker.of(rig.name())))?;
        Ok(Arc::new(rig))
    });
    named.collect()
}

/// A wall of boards, each with a thread that waits for it.
fn several(
    wall: &[BoardAt],
    record: Option<&Path>,
    boards: &Boards,
    broker: Option<&Broker>,
) -> anyhow::Result<Vec<Arc<Rig>>> {
    let (mut names, mut ports) = (HashSet::new(), HashSet::new());
    for board in wall {
        let Some(port) = &board.port else {
            bail!("several boards need their ports: --board lab1=/dev/ttyACM0 --board lab2=/dev/ttyACM1");
        };
        let is_new = ports.insert(fs::canonicalize(port).unwrap_or_else(|_| port.into()));
        ensure!(is_new, "{port} is given twice");
        ensure!(
            names.insert(board.called()),
            "two boards are called {}, expected a name each",
            board.called()
        );
    }
    let wait = |board: &BoardAt| {
        let rig = Arc::new(Rig::new(&board.called()));
        let awaited = Awaited {
            rig: rig.clone(),
            port: board.port.clone().unwrap_or_default(),
            record: record.map(Path::to_owned),
            boards: boards.clone(),
            broker: broker.map(|broker| broker.of(rig.name())),
        };
        thread::Builder::new().name(rig.name().into()).spawn(move || awaited.wait())?;
        Ok(rig)
    };
    wall.iter().map(wait).collect()
}

/// A board that is waited for.
struct Awaited {
    rig: Arc<Rig>,
    port: String,
    record: Option<PathBuf>,
    boards: Boards,
    broker: Option<Broker>,
}

impl Awaited {
    /// Until it is there. What is in its way is said whenever that changes.
    fn wait(self) {
        while let Err(error) = self.open() {
            let why = format!("{error:#}");
            if self.rig.is_missing(&why) {
                let _ = print(&format!("{}: {why}; it is tried again and again\n", self.rig.name()));
            }
            thread::sleep(ANOTHER);
        }
        let _ = print(&format!("{}: there, at {}\n", self.rig.name(), self.port));
    }

    fn open(&self) -> anyhow::Result<()> {
        let log = || log_in(self.record.as_deref(), self.rig.name());
        let watch = self.boards.watched(self.rig.name(), Watch::open_recorded(&self.port, log)?);
        begin(&self.rig, watch, 1.0, self.broker.clone())
    }
}

/// A new file for the log of a board, where a folder for it is named.
fn log_in(folder: Option<&Path>, name: &str) -> anyhow::Result<Option<File>> {
    let Some(folder) = folder else { return Ok(None) };
    fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    let now = jiff::Timestamp::now().strftime("%Y%m%dT%H%M%SZ");
    let file = folder.join(format!("{name}-{now}.log"));
    Ok(Some(File::create_new(&file).with_context(|| format!("{} cannot be written", file.display()))?))
}

/// A board at a serial port.
struct Board(Watch);

impl Source for Board {
    fn name(&self) -> String {
        self.0.name().to_owned()
    }

    fn kind(&self) -> &'static str {
        "board"
    }

    fn can(&self) -> &'static [&'static str] {
        &["order"]
    }

    fn sample_time(&self) -> f64 {
        self.0.sample_time()
    }

    fn has_own_time(&self) -> bool {
        true
    }

    fn next(&mut self) -> Option<Told> {
        self.0.take()
    }

    fn order(&mut self, order: Order) -> anyhow::Result<()> {
        self.0.order(&order)
    }

    fn setpoint_limits(&self) -> Option<[f32; 2]> {
        Some(self.0.setpoint_limits())
    }
}
