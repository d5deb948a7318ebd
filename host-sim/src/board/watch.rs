//! A board that is watched: its ticks as rows for the lab's page, orders to it, and whether it is there.
//!
//! A thread holds the conversation. Stop does not wait for it: it goes out by a second handle of the same port, and takes with it whatever
//! was ordered before and not yet sent.

use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use fdi_core::Config;
use fdi_core::settings::Value;
use firmware_logic::console::line::is_stop_key;
use pt326_lab::names::Names;
use pt326_lab::scene::Order;
use pt326_lab::told::Told;
use serialport::SerialPort;

use super::rows::Rows;
use super::session::{PATIENCE, STOP};
use super::text::persists;
use super::{Heard, Session, refusal, settings, take_lines};
use crate::experiment::as_written;

/// So long without a line, beyond a tick, and the board is called silent; its stream is asked for once more.
const SILENCE: Duration = Duration::from_secs(2);
/// Between two attempts to open a port that has gone.
const ANOTHER: Duration = Duration::from_millis(300);
/// What a board has told and nobody has taken yet: a port that floods waits.
const UNTAKEN: usize = 1024;
/// Bytes of a console's line that may come without an end before they are told as they are.
const UNENDED: usize = 4096;

/// A board that is watched.
pub struct Watch {
    name: String,
    sample_time: f64,
    told: Receiver<Told>,
    orders: Sender<Given>,
    hand: Hand,
}

/// An order for the board, and how often it had been stopped before: a later stop voids it.
struct Given {
    line: String,
    stops: u64,
}

/// The second handle of the port.
#[derive(Clone, Default)]
struct Hand(Arc<Mutex<Grip>>);

#[derive(Default)]
struct Grip {
    /// None while the port has gone.
    port: Option<Box<dyn SerialPort>>,
    stops: u64,
}

impl Hand {
    fn grip(&self) -> MutexGuard<'_, Grip> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Watch {
    /// Opens a port and has the board stream. The heater stays as it is.
    ///
    /// # Errors
    /// No port, no board on it, or one of another release.
    pub fn open(name: &str) -> anyhow::Result<Self> {
        let (tell, told) = sync_channel(UNTAKEN);
        let (orders, given) = channel();
        let hand = Hand::default();
        let mut keeper = Keeper::open(name.to_owned(), tell, hand.clone())?;
        let sample_time = keeper.sample_time;
        std::thread::spawn(move || keeper.run(&given));
        Ok(Self { name: name.to_owned(), sample_time, told, orders, hand })
    }

    /// Its port.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Ts in s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// What it has told next; `None` where nothing has come.
    pub fn take(&mut self) -> Option<Told> {
        self.told.try_recv().ok()
    }

    /// Has an order carried out; what becomes of it is told. Stop goes out before this returns.
    ///
    /// # Errors
    /// The port has gone, or a board has nothing that does this.
    pub fn order(&mut self, order: &Order) -> anyhow::Result<()> {
        // Typed, too, a stop does not wait for its turn.
        let typed = |line: &str| line.trim_start().starts_with("stop") || line.bytes().any(is_stop_key);
        if *order == Order::Stop || matches!(order, Order::Console { line } if typed(line)) {
            return self.stop();
        }
        let line = line(order)?;
        let grip = self.hand.grip();
        if grip.port.is_none() {
            bail!("the port has gone, so the board was not told");
        }
        self.orders
            .send(Given { line, stops: grip.stops })
            .context("the conversation with the board has ended")
    }

    fn stop(&mut self) -> anyhow::Result<()> {
        const GONE: &str = "the stop has NOT reached the board, which goes on by itself: press its button";
        let mut grip = self.hand.grip();
        grip.stops += 1;
        grip.port.as_mut().context(GONE)?.write_all(&[STOP]).context(GONE)
    }
}

/// What is typed for an order.
fn line(order: &Order) -> anyhow::Result<String> {
    Ok(match order {
        Order::Arm => "arm".into(),
        Order::Tune => "tune start".into(),
        Order::Stop => "stop".into(),
        Order::Acknowledge => "ack".into(),
        Order::Relearn => "baseline learn".into(),
        Order::Setpoint { celsius } => format!("set setpoint {celsius}"),
        Order::Fan { percent } => format!("fan {percent}"),
        Order::Set { name, value } => format!("set {name} {value}"),
        Order::Console { line } => line.clone(),
        Order::Excite { .. } => bail!("a board's excitation is not switched from here"),
        Order::Break { .. } | Order::Mend => bail!("a real rig is broken and mended by hand"),
    })
}

/// The thread that talks with the board.
struct Keeper {
    name: String,
    session: Session,
    sample_time: f64,
    rows: Rows,
    tell: SyncSender<Told>,
    hand: Hand,
    /// Its settings as they were last told; a page begins with the defaults.
    known: Config,
    /// What its console has said of a line that is not whole.
    text: String,
    last: Instant,
    silent: bool,
}

/// Nobody watches any more.
struct Unwatched;

impl Keeper {
    fn open(name: String, tell: SyncSender<Told>, hand: Hand) -> anyhow::Result<Self> {
        let mut session = Session::open(&name)?;
        let config = settings::read(&mut session)?;
        let sample_time = as_written(config.sample_time.0);
        let (rows, last) = (Rows::new(&config)?, Instant::now());
        let (known, text) = (Config::default(), String::new());
        let mut keeper =
            Self { name, session, sample_time, rows, tell, hand, known, text, last, silent: false };
        keeper.greet(&config)?;
        Ok(keeper)
    }

    /// What is to be known of a board that is there.
    fn greet(&mut self, config: &Config) -> anyhow::Result<()> {
        self.session.order("stream on")?;
        self.hand.grip().port = Some(self.session.other_hand()?);
        (self.last, self.silent) = (Instant::now(), false);
        let _ = self.tell.send(Told::Link(true));
        self.settings(config);
        Ok(())
    }

    /// The settings that are not as they were last told.
    fn settings(&mut self, config: &Config) {
        for setting in Config::settings() {
            if let (Value::Number(value), before) = (config.get(setting), self.known.get(setting))
                && before != Value::Number(value)
            {
                let _ = self.tell.send(Told::Order(Order::Set { name: setting.name.into(), value }));
            }
        }
        let names = Names::of(config);
        if names != Names::of(&self.known) {
            let _ = self.tell.send(Told::Names(names));
        }
        self.known = config.clone();
    }

    /// What the console says by itself, line by line.
    fn say(&mut self, text: &str) -> Result<(), Unwatched> {
        self.text += text;
        if self.text.len() > UNENDED {
            self.text.push('\n');
        }
        take_lines(&mut self.text).into_iter().try_for_each(|line| self.tell(Told::Said(line)))
    }

    fn run(&mut self, given: &Receiver<Given>) {
        while self.beat(given).is_ok() {}
    }

    fn beat(&mut self, given: &Receiver<Given>) -> Result<(), Unwatched> {
        while let Ok(order) = given.try_recv() {
            if let Err(error) = self.carry_out(&order) {
                let why = format!("{error:#}");
                self.tell(Told::Refused { persists: persists(&why), why })?;
            }
        }
        let Ok(heard) = self.session.hear() else { return self.reopen(given) };
        for heard in heard {
            match heard {
                Heard::Line(line) => self.line(&line)?,
                Heard::Text(text) => self.say(&text)?,
                Heard::Broken => {}
            }
        }
        self.watch_silence()
    }

    fn tell(&self, told: Told) -> Result<(), Unwatched> {
        self.tell.send(told).map_err(|_| Unwatched)
    }

    fn carry_out(&mut self, given: &Given) -> anyhow::Result<()> {
        let Given { line, stops } = given;
        let hand = self.hand.clone();
        {
            // While this is held nobody can stop in between: a stop is later than this line, or voids it.
            let grip = hand.grip();
            if grip.stops != *stops {
                bail!("`{line}` was stopped before it was sent");
            }
            self.session.begin(line)?;
        }
        let answer = self.session.answer(line, self.patience(line))?;
        let _ = self.tell.send(Told::Said(format!("> {line}\n{}", answer.trim_end())));
        match refusal(&answer) {
            Some(error) => bail!("the board says to `{line}`: {error}"),
            None => Ok(()),
        }
    }

    /// Whoever watches is to hear soon that a board has fallen silent; what erases flash or searches takes its time.
    fn patience(&self, line: &str) -> Duration {
        let is_slow =
            ["save", "brownout", "tune", "teach", "commission"].iter().any(|word| line.starts_with(word));
        if is_slow { PATIENCE } else { SILENCE + Duration::from_secs_f64(2.0 * self.sample_time) }
    }

    fn line(&mut self, line: &str) -> Result<(), Unwatched> {
        self.last = Instant::now();
        if std::mem::take(&mut self.silent) {
            self.tell(Told::Link(true))?;
        }
        let news = self.rows.line(line);
        if news.settings
            && let Ok(config) = settings::read(&mut self.session)
        {
            let _ = self.rows.retune(&config);
            self.settings(&config);
        }
        news.told.into_iter().try_for_each(|told| self.tell(told))
    }

    /// A board that says nothing may have been reset, or another program has switched its stream off.
    fn watch_silence(&mut self) -> Result<(), Unwatched> {
        if self.last.elapsed() <= SILENCE + Duration::from_secs_f64(self.sample_time) {
            return Ok(());
        }
        self.last = Instant::now();
        let _ = self.session.send(b"\x15stream on\r");
        match std::mem::replace(&mut self.silent, true) {
            true => Ok(()),
            false => self.tell(Told::Link(false)),
        }
    }

    /// Says that the port has gone, and waits for it. What was ordered meanwhile is not carried out later.
    fn reopen(&mut self, given: &Receiver<Given>) -> Result<(), Unwatched> {
        self.hand.grip().port = None;
        self.tell(Told::Link(false))?;
        loop {
            if Arc::strong_count(&self.hand.0) == 1 {
                return Err(Unwatched);
            }
            std::thread::sleep(ANOTHER);
            if let Ok(session) = Session::open(&self.name) {
                self.session = session;
                let known = settings::read(&mut self.session).and_then(|config| {
                    self.rows.retune(&config)?;
                    while given.try_recv().is_ok() {}
                    self.greet(&config)
                });
                if known.is_ok() {
                    return Ok(());
                }
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::{Read, Write};
    use std::sync::atomic::{AtomicUsize, Ordering};

    use serialport::TTYPort;

    use super::*;

    /// What a hostile board may say before it is believed that it may say anything.
    const ENDLESS: usize = 16 << 20;

    /// A board that answers as one does until it is watched; then it says one line that never ends. What it has got rid of, bytes.
    fn babbles() -> (Watch, Arc<AtomicUsize>) {
        let (mut board, port) = TTYPort::pair().unwrap();
        board.set_timeout(Duration::from_secs(60)).unwrap();
        let said = Arc::new(AtomicUsize::new(0));
        let count = said.clone();
        let name = port.name().unwrap();
        let (begin, begun) = channel();
        std::thread::spawn(move || {
            let mut heard = Vec::new();
            while !heard.ends_with(b"stream on\r") {
                let mut byte = [0; 1];
                board.read_exact(&mut byte).unwrap();
                heard.extend(byte);
                if matches!(byte, [b'\r' | 0x15]) {
                    board.write_all(b"\r\n> ").unwrap();
                }
            }
            begun.recv().unwrap();
            while count.load(Ordering::Relaxed) < ENDLESS && board.write_all(&[b'x'; 1024]).is_ok() {
                count.fetch_add(1024, Ordering::Relaxed);
            }
        });
        let watch = Watch::open(&name).unwrap();
        begin.send(()).unwrap();
        (watch, said)
    }

    #[test]
    fn a_line_that_never_ends_is_told_in_pieces() {
        let (mut watch, _) = babbles();
        let begin = Instant::now();
        let mut told = 0;
        while told < 100_000 {
            if let Some(Told::Said(text)) = watch.take() {
                assert!(text.len() <= 2 * UNENDED, "{} bytes at once", text.len());
                told += text.len();
            }
            assert!(begin.elapsed() < Duration::from_secs(60), "{told} bytes were told");
        }
    }

    /// While nobody takes what it says the port waits, and nothing grows.
    #[test]
    fn a_board_that_floods_is_read_no_faster_than_it_is_told() {
        let (watch, said) = babbles();
        let mut before = usize::MAX;
        while before != said.load(Ordering::Relaxed) {
            before = said.load(Ordering::Relaxed);
            std::thread::sleep(SILENCE);
        }
        assert!(before < ENDLESS, "{before} bytes were read");
        drop(watch);
    }
}
