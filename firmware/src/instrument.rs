//! What the thread-mode tasks share: the last tick, the settings, the history, and the way to the control half.

use core::cell::RefCell;
use core::sync::atomic::Ordering;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Timer, with_timeout};
use fdi_core::control::Controller;
use fdi_core::diagnosis::Diagnosis;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{Command, Config, Report};
use firmware_logic::console::{ApplyError, Board};
use firmware_logic::control_loop::{Denial, Order, Outcome, TickRecord};
use firmware_logic::history::{Entry, History};
use firmware_logic::led::Sign;
use firmware_logic::self_test::Progress;
use firmware_logic::settings::store::{SaveError, Store};
use firmware_logic::settings::stored::{Stored, check};
use firmware_logic::status::{Health, Status};
use firmware_logic::task_watchdog::Task;
use heapless::spsc::Producer;

use crate::hardware::settings_flash::SettingsFlash;
use crate::hardware::{heater, rtt, stack, supply};
use crate::{link, log};

/// How long an order may wait for its answer: three ticks, less than the deadline of the console.
const ANSWER_DEADLINE: Duration = Duration::from_millis(400);

/// Shared by the tasks of thread mode, of which one runs at a time; no borrow lives across an await.
pub(crate) struct Instrument {
    status: RefCell<Status>,
    history: RefCell<History>,
    settings: RefCell<Stored>,
    orders: RefCell<Producer<'static, Order>>,
    outcomes: Signal<NoopRawMutex, Outcome>,
    /// The diagnosis that new settings give, until the control half has taken over its own part of them.
    retuned: RefCell<Option<Diagnosis>>,
}

impl Instrument {
    /// Nothing has happened yet.
    pub(crate) fn new(settings: Stored, orders: Producer<'static, Order>) -> Self {
        Self {
            status: RefCell::default(),
            history: RefCell::default(),
            settings: RefCell::new(settings),
            orders: RefCell::new(orders),
            outcomes: Signal::new(),
            retuned: RefCell::new(None),
        }
    }

    /// Takes in a tick that has been diagnosed.
    pub(crate) fn ticked(&self, record: TickRecord, report: Report) {
        let mut status = self.status.borrow_mut();
        let jitter = &mut status.health.jitter;
        if !record.missed {
            jitter.count(&record.arrival);
        }
        if let Some(news) = record.news {
            status.check.note(news);
        }
        status.last = Some((record, report));
    }

    /// Takes in something that went wrong.
    pub(crate) fn note(&self, note: impl FnOnce(&mut History)) {
        note(&mut self.history.borrow_mut());
    }

    /// Takes in what became of an order.
    pub(crate) fn answered(&self, outcome: Outcome) {
        self.outcomes.signal(outcome);
    }

    /// The diagnosis for the settings that the control half has just taken over.
    pub(crate) fn take_retuned(&self) -> Option<Diagnosis> {
        self.retuned.borrow_mut().take()
    }

    /// Takes in what has been learnt.
    pub(crate) fn learnt(&self, baseline: Option<&Baseline>) {
        self.settings.borrow_mut().baseline = baseline.copied();
    }

    /// Ts in s.
    pub(crate) fn sample_time(&self) -> f32 {
        self.settings.borrow().config.sample_time.0
    }

    /// Whether the heater may be on.
    pub(crate) fn is_heating(&self) -> bool {
        self.status.borrow().is_heating()
    }

    /// Whether a self-test is under way.
    pub(crate) fn is_checking(&self) -> bool {
        self.status.borrow().check.stage.is_some()
    }

    /// Whether something holds the heater off.
    pub(crate) fn is_latched(&self) -> bool {
        self.status.borrow().is_latched()
    }

    /// What the LED should say.
    pub(crate) fn sign(&self) -> Sign {
        self.status.borrow().sign()
    }

    /// How it is, health included.
    pub(crate) fn status(&self) -> Status {
        let mut status = self.status.borrow().clone();
        status.health = Health {
            records_lost: link::RECORDS_LOST.load(Ordering::Relaxed),
            log_dropped: rtt::dropped(),
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

    /// Posts an order and waits for what becomes of it: until the next tick, and not so long that the watchdog takes a
    /// console that waits for one that hangs.
    async fn order(&self, order: Order) -> Result<(), Denial> {
        link::check_in(Task::Console);
        let answer = with_timeout(ANSWER_DEADLINE, self.order_and_wait(order)).await;
        link::check_in(Task::Console);
        answer.unwrap_or(Err(Denial::NoAnswer))
    }

    async fn order_and_wait(&self, order: Order) -> Result<(), Denial> {
        let asked = order.asked();
        self.outcomes.reset(); // of an order that nobody waits for any more
        while !self.post(order.clone()) {
            Timer::after_millis(10).await; // the button's order is before it
        }
        loop {
            let outcome = self.outcomes.wait().await;
            if outcome.asked == asked {
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

/// What the console works on.
pub(crate) struct ConsoleBoard {
    /// The instrument.
    pub(crate) instrument: &'static Instrument,
    /// Where settings are kept.
    pub(crate) store: Store<SettingsFlash>,
    /// The flash has the mark that tells the next start of a power failure.
    pub(crate) marked: bool,
}

impl ConsoleBoard {
    /// Takes the mark away once the heater is off and nothing is latched. Called while there is nothing else to do.
    pub(crate) async fn settle(&mut self) {
        if self.marked && !self.instrument.is_latched() && !self.may_heat() {
            let _ = self.mark(false).await; // tried again
        }
    }

    /// Also in a check, whose next pulse may come while the flash stalls the core.
    fn may_heat(&self) -> bool {
        self.instrument.is_heating() || self.instrument.is_checking() || heater::is_enabled()
    }

    async fn mark(&mut self, stands: bool) -> Result<(), SaveError> {
        let result = self.store.mark(stands).await;
        after_stall();
        if result.is_ok() {
            self.marked = stands;
        }
        result
    }
}

/// A stall that was planned is nobody's fault.
fn after_stall() {
    link::TASKS.check_all_in(link::now_ms());
}

impl Board for ConsoleBoard {
    async fn command(&mut self, command: Command) -> Result<(), Denial> {
        if command == Command::Arm && !self.marked && !self.may_heat() {
            self.mark(true).await.map_err(|_| Denial::NoMark)?;
        }
        self.instrument.order(Order::Command(command)).await
    }

    async fn check(&mut self) -> Result<(), Denial> {
        self.instrument.order(Order::Check).await
    }

    fn progress(&self) -> Progress {
        self.instrument.status.borrow().check.clone()
    }

    fn stop(&mut self) {
        stop();
    }

    fn status(&self) -> Status {
        self.instrument.status()
    }

    fn config(&self) -> Config {
        self.instrument.settings.borrow().config.clone()
    }

    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError> {
        check(config)?;
        let controller = Controller::new(config)?;
        let diagnosis = Diagnosis::new(config)?;
        *self.instrument.retuned.borrow_mut() = Some(diagnosis);
        log::settings(config); // a replay needs them before the order that puts them in force
        self.instrument.order(Order::Retune(controller)).await?;
        self.instrument.settings.borrow_mut().config = config.clone();
        Ok(())
    }

    async fn save(&mut self) -> Result<(), SaveError> {
        // After a `stop` the output is off at once, and the control half says so on its next tick.
        while self.instrument.is_heating() && !heater::is_enabled() {
            Timer::after_millis(10).await;
        }
        if self.may_heat() {
            return Err(SaveError::Heating);
        }
        let settings = self.instrument.settings.borrow().clone();
        let result = self.store.save(&settings).await;
        after_stall();
        result
    }

    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {
        if self.may_heat() {
            return Err(SaveError::Heating);
        }
        let done = supply::set_brown_out_level();
        after_stall();
        done.then_some(()).ok_or(SaveError::Flash)
    }

    fn baseline(&self) -> Option<Baseline> {
        self.instrument.settings.borrow().baseline
    }

    fn fault(&self, index: usize) -> Option<Entry> {
        self.instrument.history.borrow().get(index).copied()
    }
}
