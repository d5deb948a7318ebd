//! What the thread-mode tasks share: the diagnosis half, and the way to the control half.

use core::cell::RefCell;
use core::fmt::Display;
use core::pin::pin;
use core::sync::atomic::Ordering;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Timer, with_timeout};
use fdi_core::control::Controller;
use fdi_core::{Config, ConfigError};
use firmware_logic::cadence;
use firmware_logic::console::board::Chip;
use firmware_logic::control_loop::{Denial, Order, Outcome, TickRecord};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::log_line::{self, Image, LogLine};
use firmware_logic::reset_cause::{ResetCause, Restart};
use firmware_logic::retained::Retained;
use firmware_logic::status::{Health, Status};
use firmware_logic::stream::Stream;
use firmware_logic::task_watchdog::Task;
use heapless::spsc::Producer;

use crate::hardware::clock::{self, Source};
use crate::hardware::{board, cycles, heater, reset, retained, rtt, stack, supply};
use crate::{link, log, simulation};

/// How long an order may wait for its answer, besides a tick; and how long the console may wait before it checks in again.
const ANSWER_DEADLINE_MS: u32 = 290;
const WAIT_MS: u32 = 400;

/// Shared by the tasks of thread mode, of which one runs at a time; no borrow lives across an await.
pub(crate) struct Shared {
    diagnosis: RefCell<DiagnosisLoop>,
    orders: RefCell<Producer<'static, Order>>,
    outcomes: Signal<NoopRawMutex, Outcome>,
    stream: RefCell<Stream>,
    /// The stream has something to send.
    streaming: Signal<NoopRawMutex, ()>,
}

impl Shared {
    /// Nothing has happened yet.
    pub(crate) fn new(diagnosis: DiagnosisLoop, orders: Producer<'static, Order>) -> Self {
        Self {
            diagnosis: RefCell::new(diagnosis),
            orders: RefCell::new(orders),
            outcomes: Signal::new(),
            stream: RefCell::new(Stream::default()),
            streaming: Signal::new(),
        }
    }

    /// What a replay has to know before the first tick.
    pub(crate) fn begin(&self, cause: ResetCause, clock: Source) {
        self.stream.borrow_mut().switch(matches!(cause, ResetCause::Restarted(_)));
        self.line(LogLine::Start { version: log_line::VERSION });
        self.image();
        self.send(&format_args!("clock {} Hz from {}, {}", clock::core_hz(), clock.name(), cause.name()));
        log_line::settings(&self.diagnosis.borrow().settings().config, |line| self.line(line));
    }

    /// Which image this is, for whoever listens at the port.
    fn image(&self) {
        self.send(&LogLine::Image(Image {
            release: env!("CARGO_PKG_VERSION"),
            commit: env!("GIT_DESCRIBE"),
            board: board::NAME,
            format: log_line::VERSION,
        }));
    }

    /// A line that a program reads.
    pub(crate) fn line(&self, line: LogLine<'_>) {
        log::line(line);
        self.send(&line);
    }

    fn send(&self, line: &impl Display) {
        self.stream.borrow_mut().push(line);
        self.streaming.signal(());
    }

    /// Takes what the stream sends next, and waits while it has nothing to send.
    pub(crate) async fn take_streamed(&self, bytes: &mut [u8]) -> usize {
        loop {
            match self.stream.borrow_mut().take(bytes) {
                0 => {}
                n => return n,
            }
            self.streaming.wait().await;
        }
    }

    /// The second half of a tick.
    pub(crate) fn diagnose(&self, record: TickRecord) {
        let (begin, tick, control) = (cycles::now(), record.tick.index, record.cycles);
        let outcome = record.outcome;
        let mut diagnosis = self.diagnosis.borrow_mut();
        let sample_time = diagnosis.sample_time().0;
        diagnosis.step(record, |notice| {
            log::notice(&notice, sample_time);
            self.send(&notice.text(sample_time));
        });
        link::feed_back(diagnosis.feedback());
        self.send(&LogLine::Cycles { tick, control, diagnosis: cycles::now().wrapping_sub(begin) });
        if let Some(outcome) = outcome {
            self.outcomes.signal(outcome);
        }
    }

    /// Reads how it is, without the health of the board.
    pub(crate) fn read<R>(&self, read: impl FnOnce(&Status) -> R) -> R {
        read(self.diagnosis.borrow().status())
    }

    /// How it is, the health of the board included.
    pub(crate) fn status(&self) -> Status {
        let mut status = self.read(Status::clone);
        status.simulated = simulation::is_on();
        status.health = Health {
            records_lost: link::RECORDS_LOST.load(Ordering::Relaxed),
            log_dropped: rtt::dropped(),
            stream_dropped: self.stream.borrow().dropped(),
            stack_used: stack::high_water() as u32,
            stack_size: stack::size() as u32,
            ..status.health
        };
        status
    }

    /// Posts an order without waiting for what becomes of it; `false` if another one is still on its way.
    pub(crate) fn post(&self, order: Order) -> bool {
        self.orders.borrow_mut().enqueue(order).is_ok()
    }

    async fn order_and_wait(&self, order: Order) -> Result<(), Denial> {
        let kind = order.kind();
        self.outcomes.reset(); // of an order that nobody waits for any more
        while !self.post(order.clone()) {
            Timer::after_millis(10).await; // the button's order is before it
        }
        loop {
            let outcome = self.outcomes.wait().await;
            if outcome.order == kind {
                return outcome.result;
            }
        }
    }
}

/// Heater off, at once. First said and then done, so that the control task knows whose hand it was.
pub(crate) fn stop() {
    link::STOP.store(true, Ordering::Relaxed);
    heater::cut();
}

impl Chip for &'static Shared {
    fn diagnosis<R>(&self, look: impl FnOnce(&DiagnosisLoop) -> R) -> R {
        look(&self.diagnosis.borrow())
    }

    fn change<R>(&mut self, change: impl FnOnce(&mut DiagnosisLoop) -> R) -> R {
        change(&mut self.diagnosis.borrow_mut())
    }

    fn propose(&mut self, config: &Config) -> Result<Controller, ConfigError> {
        let mut diagnosis = self.diagnosis.borrow_mut();
        let controller = diagnosis.propose(config)?;
        // A replay needs them before the order that puts them in force.
        log_line::settings(&diagnosis.in_force(config), |line| self.line(line));
        Ok(controller)
    }

    /// Until the next tick, and not so long that the watchdog takes a console that waits for one that hangs.
    async fn order(&mut self, order: Order) -> Result<(), Denial> {
        let period_ms = cadence::period(self.diagnosis.borrow().sample_time()).get() / 1000;
        let mut answer = pin!(self.order_and_wait(order));
        for _ in 0..(period_ms + ANSWER_DEADLINE_MS).div_ceil(WAIT_MS) {
            link::check_in(Task::Console);
            let told = with_timeout(Duration::from_millis(WAIT_MS.into()), answer.as_mut()).await;
            link::check_in(Task::Console);
            if let Ok(result) = told {
                return result;
            }
        }
        Err(Denial::NoAnswer)
    }

    fn stop(&mut self) {
        stop();
    }

    fn is_output_enabled(&self) -> bool {
        heater::is_enabled()
    }

    async fn pause(&mut self) {
        link::check_in(Task::Console);
        Timer::after_millis(10).await;
    }

    fn stalled(&mut self) {
        link::TASKS.check_all_in(link::now_ms());
    }

    fn status(&self) -> Status {
        Shared::status(self)
    }

    fn stream(&mut self, on: bool) -> bool {
        self.stream.borrow_mut().switch(on);
        self.image();
        true
    }

    fn restart(&mut self, how: Restart) {
        heater::cut();
        retained::store(&Retained { restart: Some(how), ..Retained::EMPTY });
        reset::reset()
    }

    fn is_simulated(&self) -> bool {
        simulation::is_on()
    }

    fn program_brown_out_level(&mut self) -> bool {
        supply::set_brown_out_level()
    }
}
