//! A board that is watched: its ticks as rows for the lab's page, orders to it, and whether it is there.
//!
//! A thread holds the conversation. Stop does not wait for it: it goes out by a second handle of the same port, and takes with it whatever
//! was ordered before and not yet sent.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use fdi_core::Config;
use pt326_lab::board::{Conversation, STOP, Standing, line, stops};
use pt326_lab::scene::Order;
use pt326_lab::told::Told;
use serialport::{ClearBuffer, SerialPort};

use super::{Session, port};

/// Between two attempts to open a port that has gone.
const ANOTHER: Duration = Duration::from_millis(300);
/// So long it is tried to ask a board that was left whether it has stopped.
const LEAVING: Duration = Duration::from_secs(3);
/// What a board has told and nobody has taken yet: a port that floods waits.
const UNTAKEN: usize = 1024;

/// A board that is watched.
pub struct Watch {
    name: String,
    sample_time: f64,
    told: Receiver<Told>,
    orders: Sender<Given>,
    hand: Hand,
    /// Lowest and highest set-point, degC, by the settings that it has told.
    setpoint_limits: [f32; 2],
}

/// An order for the board, and how often it had been stopped before: a later stop voids it.
struct Given {
    order: Order,
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
    /// Nobody is to watch any more.
    left: bool,
}

impl Hand {
    fn grip(&self) -> MutexGuard<'_, Grip> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Stops a board that is watched, for a program that ends.
#[derive(Clone)]
pub struct Leaver {
    name: String,
    hand: Hand,
}

impl Leaver {
    /// For a board at a port that is still being opened: whether it heats is not known yet.
    pub fn of(port: &str) -> Self {
        Self { name: port.to_owned(), hand: Hand::default() }
    }

    /// Heater off, at once, and nothing more is typed; whether the board says that it is off.
    pub fn stops(&self) -> bool {
        {
            let mut grip = self.hand.grip();
            (grip.stops, grip.left) = (grip.stops + 1, true);
            if let Some(mut port) = grip.port.take() {
                let _ = port.write_all(&[STOP]); // asked below
            }
        }
        // Whoever talks with the board lets go of its port within a moment. A stop twice is one stop.
        let begin = Instant::now();
        loop {
            match Session::open(&self.name) {
                Ok(mut session) => return session.stops(),
                Err(_) if begin.elapsed() < LEAVING => std::thread::sleep(ANOTHER),
                Err(_) => return false,
            }
        }
    }
}

impl Watch {
    /// Opens a port and has the board stream. The heater stays as it is.
    ///
    /// # Errors
    /// No port, no board on it, or one of another release.
    pub fn open(name: &str) -> anyhow::Result<Self> {
        Self::open_recorded(name, || Ok(None))
    }

    /// The same, and writes the lines of the board's log into a file, which `pt326 replay` reads. It is asked for once the board is known.
    ///
    /// # Errors
    /// As [`Self::open`], or there is no such file.
    pub fn open_recorded(
        name: &str,
        log: impl FnOnce() -> anyhow::Result<Option<File>>,
    ) -> anyhow::Result<Self> {
        let (tell, told) = sync_channel(UNTAKEN);
        let (orders, given) = channel();
        let hand = Hand::default();
        let mut keeper = Keeper::open(name.to_owned(), tell, hand.clone())?;
        keeper.log = log()?;
        let sample_time = keeper.conversation.sample_time();
        std::thread::spawn(move || keeper.run(&given));
        let name = name.to_owned();
        let supervisor = Config::default().supervisor; // what is told of settings begins with the defaults
        let setpoint_limits = [supervisor.setpoint_min.0, supervisor.setpoint_max.0];
        Ok(Self { name, sample_time, told, orders, hand, setpoint_limits })
    }

    /// What stops it when the program ends.
    pub fn leaver(&self) -> Leaver {
        Leaver { name: self.name.clone(), hand: self.hand.clone() }
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
        let told = self.told.try_recv().ok();
        if let Some(Told::Order(Order::Set { name, value })) = &told {
            match name.as_str() {
                "supervisor.setpoint_min" => self.setpoint_limits[0] = *value,
                "supervisor.setpoint_max" => self.setpoint_limits[1] = *value,
                _ => {}
            }
        }
        told
    }

    /// Lowest and highest set-point that it takes, degC.
    pub fn setpoint_limits(&self) -> [f32; 2] {
        self.setpoint_limits
    }

    /// Has an order carried out; what becomes of it is told. Stop goes out before this returns.
    ///
    /// # Errors
    /// The port has gone, or a board has nothing that does this.
    pub fn order(&mut self, order: &Order) -> anyhow::Result<()> {
        if stops(order) {
            return self.stop();
        }
        line(order)?;
        let grip = self.hand.grip();
        if grip.port.is_none() {
            bail!("the port has gone, so the board was not told");
        }
        self.orders
            .send(Given { order: order.clone(), stops: grip.stops })
            .context("the conversation with the board has ended")
    }

    fn stop(&mut self) -> anyhow::Result<()> {
        const GONE: &str = "the stop has NOT reached the board, which goes on by itself: press its button";
        let mut grip = self.hand.grip();
        grip.stops += 1;
        grip.port.as_mut().context(GONE)?.write_all(&[STOP]).context(GONE)
    }
}

/// The thread that talks with the board.
struct Keeper {
    name: String,
    port: Box<dyn SerialPort>,
    conversation: Conversation,
    begun: Instant,
    /// How often it was stopped before what is typed now.
    stops: u64,
    tell: SyncSender<Told>,
    hand: Hand,
    /// Where its log is written to.
    log: Option<File>,
}

/// Nobody watches any more.
struct Unwatched;

impl Keeper {
    fn open(name: String, tell: SyncSender<Told>, hand: Hand) -> anyhow::Result<Self> {
        let port = open(&name, &hand)?;
        let conversation = Conversation::new(0.0);
        let mut keeper =
            Self { name, port, conversation, begun: Instant::now(), stops: 0, tell, hand, log: None };
        loop {
            keeper.send().and_then(|()| keeper.hear()).with_context(|| format!("on {}", keeper.name))?;
            match keeper.conversation.standing() {
                Standing::Meets => {}
                Standing::Speaks => return Ok(keeper),
                Standing::Ended(why) => bail!("on {}: {why}", keeper.name),
            }
        }
    }

    fn now(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn run(&mut self, given: &Receiver<Given>) {
        while self.beat(given).is_ok() {}
    }

    fn beat(&mut self, given: &Receiver<Given>) -> Result<(), Unwatched> {
        if self.hand.grip().left {
            return Err(Unwatched);
        }
        self.take_orders(given)?;
        if self.send().and_then(|()| self.hear()).is_err() {
            return self.reopen(given);
        }
        self.tell_all()
    }

    fn take_orders(&mut self, given: &Receiver<Given>) -> Result<(), Unwatched> {
        while let Ok(Given { order, stops }) = given.try_recv() {
            let now = self.now();
            let done = match stops == self.hand.grip().stops {
                true => self.conversation.order(&order, now),
                false => line(&order).and_then(|line| bail!("`{line}` was stopped before it was sent")),
            };
            if let Err(error) = done {
                self.tell.send(Told::refused(format!("{error:#}"))).map_err(|_| Unwatched)?;
            }
        }
        Ok(())
    }

    fn tell_all(&mut self) -> Result<(), Unwatched> {
        self.log_all()?;
        while let Some(told) = self.conversation.take_told() {
            self.tell.send(told).map_err(|_| Unwatched)?;
        }
        Ok(())
    }

    /// Takes what the conversation has for the log, also where nobody keeps it: it would grow for ever.
    fn log_all(&mut self) -> Result<(), Unwatched> {
        let (_, lines) = self.conversation.take_log();
        self.keep(&lines)
    }

    /// Writes to the log. A full disk ends the log, and nothing else.
    fn keep(&mut self, lines: &[u8]) -> Result<(), Unwatched> {
        let Some(log) = &mut self.log else { return Ok(()) };
        if let Err(error) = log.write_all(lines) {
            self.log = None;
            let why = format!("its log is not written any more: {error}");
            self.tell.send(Told::refused(why)).map_err(|_| Unwatched)?;
        }
        Ok(())
    }

    /// Types what is to be typed.
    fn send(&mut self) -> std::io::Result<()> {
        let hand = self.hand.clone();
        // While this is held nobody can stop in between: a stop is later than these bytes, or voids them.
        let grip = hand.grip();
        if std::mem::replace(&mut self.stops, grip.stops) != grip.stops {
            self.conversation.stopped();
        }
        self.port.write_all(&self.conversation.take_bytes())
    }

    /// Hears what has come, and what comes while it waits a moment.
    fn hear(&mut self) -> std::io::Result<()> {
        let mut bytes = [0; 1024];
        let n = match self.port.read(&mut bytes) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(n) => n,
            Err(error) if port::has_gone(&error) => return Err(error),
            Err(_) => 0,
        };
        let now = self.now();
        self.conversation.hear(&bytes[..n], now);
        self.conversation.pass(now);
        Ok(())
    }

    /// Says that the port has gone, and waits for it. What was ordered meanwhile is not carried out later.
    fn reopen(&mut self, given: &Receiver<Given>) -> Result<(), Unwatched> {
        self.hand.grip().port = None;
        self.conversation.lost();
        self.log_all()?;
        self.keep(b"# the port has gone\n")?;
        self.tell_all()?;
        loop {
            if Arc::strong_count(&self.hand.0) == 1 || self.hand.grip().left {
                return Err(Unwatched);
            }
            std::thread::sleep(ANOTHER);
            if let Ok(port) = open(&self.name, &self.hand) {
                self.port = port;
                while given.try_recv().is_ok() {}
                self.conversation.found(self.now());
                return Ok(());
            }
        }
    }
}

/// Opens a port, for the hand that stops, too.
fn open(name: &str, hand: &Hand) -> anyhow::Result<Box<dyn SerialPort>> {
    let port = port::open(name)?;
    port.clear(ClearBuffer::All)?;
    hand.grip().port = Some(port.try_clone()?);
    Ok(port)
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::{Read, Write};
    use std::sync::atomic::{AtomicUsize, Ordering};

    use serialport::TTYPort;

    use super::*;

    /// Bytes of a piece in which a line without an end is told.
    const PIECE: usize = 4096;
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
                board.write_all(&byte).unwrap();
                if matches!(byte, [b'\r' | 0x15]) {
                    let settings = b"\nsetpoint = 36 degC\r\nsupervisor.setpoint_max = 50 degC\r\n> ";
                    board.write_all(settings).unwrap();
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
                assert!(text.len() <= 2 * PIECE, "{} bytes at once", text.len());
                told += text.len();
            }
            assert!(begin.elapsed() < Duration::from_secs(60), "{told} bytes were told");
        }
    }

    #[test]
    fn the_limits_of_the_set_point_are_the_boards() {
        let (mut watch, _) = babbles();
        let begin = Instant::now();
        while watch.setpoint_limits() != [20.0, 50.0] {
            watch.take();
            assert!(begin.elapsed() < Duration::from_secs(60), "{:?}", watch.setpoint_limits());
        }
    }

    /// While nobody takes what it says the port waits, and nothing grows.
    #[test]
    fn a_board_that_floods_is_read_no_faster_than_it_is_told() {
        let (watch, said) = babbles();
        let mut before = usize::MAX;
        while before != said.load(Ordering::Relaxed) {
            before = said.load(Ordering::Relaxed);
            std::thread::sleep(Duration::from_secs(2));
        }
        assert!(before < ENDLESS, "{before} bytes were read");
        drop(watch);
    }
}
