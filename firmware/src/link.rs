//! What the two halves of the instrument tell each other. The control half never waits for the other: it pushes into a
//! queue of one producer and one consumer, and reads atomics.

use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use core::task::Poll;

use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::Instant;
use fdi_core::{Feedback, Percent};
use firmware_logic::control_loop::{Order, TickRecord};
use firmware_logic::decimal::thousandth;
use firmware_logic::task_watchdog::{Task, TaskWatchdog};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Who is alive.
pub(crate) static TASKS: TaskWatchdog = TaskWatchdog::new();
/// "Stop" needs no place in a queue.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);
/// The button has stopped it, and nobody has said so yet.
pub(crate) static PRESSED: AtomicBool = AtomicBool::new(false);
/// What the diagnosis has found, for the control half: one slot is read while the other is written.
static FEEDBACK: [Slot; 2] = [const { Slot::new() }; 2];
/// Which of the two is read. Control interrupts the writer and never the other way round, so that it always reads one tick's
/// feedback, whole, and no interrupt is masked for it.
static CURRENT: AtomicUsize = AtomicUsize::new(0);
/// Records that found the queue full, since the diagnosis was too slow.
pub(crate) static RECORDS_LOST: AtomicU32 = AtomicU32::new(0);

static RECORD_READY: AtomicWaker = AtomicWaker::new();
static RECORDS: ConstStaticCell<Queue<TickRecord, 8>> = ConstStaticCell::new(Queue::new());
static ORDERS: ConstStaticCell<Queue<Order, 2>> = ConstStaticCell::new(Queue::new());

/// Tells the control half what the diagnosis has found.
pub(crate) fn feed_back(feedback: Feedback) {
    let other = 1 - CURRENT.load(Ordering::Relaxed);
    FEEDBACK[other].write(&feedback);
    CURRENT.store(other, Ordering::Release);
}

/// What the diagnosis found last.
pub(crate) fn feedback() -> Feedback {
    FEEDBACK[CURRENT.load(Ordering::Acquire)].read()
}

/// A task is alive.
pub(crate) fn check_in(task: Task) {
    TASKS.check_in(task, now_ms());
}

/// Milliseconds of the clock of the thread-mode tasks; wraps.
pub(crate) fn now_ms() -> u32 {
    const { assert!(embassy_time::TICK_HZ == 1_000_000) };
    thousandth(Instant::now().as_ticks())
}

/// Both ends of the records, control to diagnosis.
pub(crate) fn records() -> (Records, Producer<'static, TickRecord>) {
    let (producer, consumer) = RECORDS.take().split();
    (Records(consumer), producer)
}

/// Both ends of the orders, console to control.
pub(crate) fn orders() -> (Producer<'static, Order>, Consumer<'static, Order>) {
    ORDERS.take().split()
}

/// A [`Feedback`], a word a field. NaN stands for "not known".
struct Slot {
    learned: AtomicU32,
    virtual_rise: AtomicU32,
    air_flow: AtomicU32,
    t1_faulty: AtomicBool,
    t1_contradicted: AtomicBool,
    heater_faulty: AtomicBool,
    heater_stuck_on: AtomicBool,
    settings_damaged: AtomicBool,
}

impl Slot {
    const fn new() -> Self {
        Self {
            learned: AtomicU32::new(0),
            virtual_rise: AtomicU32::new(f32::NAN.to_bits()),
            air_flow: AtomicU32::new(f32::NAN.to_bits()),
            t1_faulty: AtomicBool::new(false),
            t1_contradicted: AtomicBool::new(false),
            heater_faulty: AtomicBool::new(false),
            heater_stuck_on: AtomicBool::new(false),
            settings_damaged: AtomicBool::new(false),
        }
    }

    fn write(&self, feedback: &Feedback) {
        let Feedback {
            learned,
            virtual_rise,
            t1_faulty,
            t1_contradicted,
            heater_faulty,
            air_flow,
            heater_stuck_on,
            settings_damaged,
        } = *feedback;
        let bits = |x: Option<f32>| x.unwrap_or(f32::NAN).to_bits();
        self.learned.store(learned, Ordering::Relaxed);
        self.virtual_rise.store(bits(virtual_rise), Ordering::Relaxed);
        self.air_flow.store(bits(air_flow.map(|flow| flow.0)), Ordering::Relaxed);
        self.t1_faulty.store(t1_faulty, Ordering::Relaxed);
        self.t1_contradicted.store(t1_contradicted, Ordering::Relaxed);
        self.heater_faulty.store(heater_faulty, Ordering::Relaxed);
        self.heater_stuck_on.store(heater_stuck_on, Ordering::Relaxed);
        self.settings_damaged.store(settings_damaged, Ordering::Relaxed);
    }

    fn read(&self) -> Feedback {
        let known = |bits: &AtomicU32| {
            let x = f32::from_bits(bits.load(Ordering::Relaxed));
            (!x.is_nan()).then_some(x)
        };
        Feedback {
            learned: self.learned.load(Ordering::Relaxed),
            virtual_rise: known(&self.virtual_rise),
            t1_faulty: self.t1_faulty.load(Ordering::Relaxed),
            t1_contradicted: self.t1_contradicted.load(Ordering::Relaxed),
            heater_faulty: self.heater_faulty.load(Ordering::Relaxed),
            air_flow: known(&self.air_flow).map(Percent),
            heater_stuck_on: self.heater_stuck_on.load(Ordering::Relaxed),
            settings_damaged: self.settings_damaged.load(Ordering::Relaxed),
        }
    }
}

/// Hands a record to the diagnosis.
pub(crate) fn send(records: &mut Producer<'static, TickRecord>, record: TickRecord) {
    if records.enqueue(record).is_err() {
        RECORDS_LOST.store(RECORDS_LOST.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
    }
    RECORD_READY.wake();
}

/// The diagnosis' end of the records.
pub(crate) struct Records(Consumer<'static, TickRecord>);

impl Records {
    /// Waits for the next record.
    pub(crate) async fn next(&mut self) -> TickRecord {
        poll_fn(|context| {
            RECORD_READY.register(context.waker());
            self.0.dequeue().map_or(Poll::Pending, Poll::Ready)
        })
        .await
    }
}
