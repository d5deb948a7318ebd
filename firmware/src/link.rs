//! What the two halves of the instrument tell each other. The control half never waits for the other: it pushes into a
//! queue of one producer and one consumer, and reads atomics.

use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::Poll;

use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::Instant;
use fdi_core::{Feedback, Percent};
use firmware_logic::control_loop::{Order, TickRecord};
use firmware_logic::task_watchdog::{Task, TaskWatchdog};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Who is alive.
pub(crate) static TASKS: TaskWatchdog = TaskWatchdog::new();
/// "Stop" needs no place in a queue.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);
/// What the diagnosis has found, for the control half, a word a field: no interrupt is masked for it. Control may come
/// between two of them and take one from a tick earlier; each means what it says by itself. NaN stands for "not known".
static LEARNED: AtomicU32 = AtomicU32::new(0);
static VIRTUAL_RISE: AtomicU32 = AtomicU32::new(f32::NAN.to_bits());
static AIR_FLOW: AtomicU32 = AtomicU32::new(f32::NAN.to_bits());
static T1_FAULTY: AtomicBool = AtomicBool::new(false);
static HEATER_FAULTY: AtomicBool = AtomicBool::new(false);
static HEATER_STUCK_ON: AtomicBool = AtomicBool::new(false);
/// Records that found the queue full, since the diagnosis was too slow.
pub(crate) static RECORDS_LOST: AtomicU32 = AtomicU32::new(0);

static RECORD_READY: AtomicWaker = AtomicWaker::new();
static RECORDS: ConstStaticCell<Queue<TickRecord, 8>> = ConstStaticCell::new(Queue::new());
static ORDERS: ConstStaticCell<Queue<Order, 2>> = ConstStaticCell::new(Queue::new());

/// Tells the control half what the diagnosis has found.
pub(crate) fn feed_back(feedback: Feedback) {
    let bits = |x: Option<f32>| x.unwrap_or(f32::NAN).to_bits();
    LEARNED.store(feedback.learned, Ordering::Relaxed);
    VIRTUAL_RISE.store(bits(feedback.virtual_rise), Ordering::Relaxed);
    HEATER_FAULTY.store(feedback.heater_faulty, Ordering::Relaxed);
    AIR_FLOW.store(bits(feedback.air_flow.map(|flow| flow.0)), Ordering::Relaxed);
    T1_FAULTY.store(feedback.t1_faulty, Ordering::Relaxed);
    HEATER_STUCK_ON.store(feedback.heater_stuck_on, Ordering::Relaxed);
}

/// What the diagnosis found last.
pub(crate) fn feedback() -> Feedback {
    let known = |bits: &AtomicU32| {
        let x = f32::from_bits(bits.load(Ordering::Relaxed));
        (!x.is_nan()).then_some(x)
    };
    Feedback {
        learned: LEARNED.load(Ordering::Relaxed),
        virtual_rise: known(&VIRTUAL_RISE),
        t1_faulty: T1_FAULTY.load(Ordering::Relaxed),
        heater_faulty: HEATER_FAULTY.load(Ordering::Relaxed),
        air_flow: known(&AIR_FLOW).map(Percent),
        heater_stuck_on: HEATER_STUCK_ON.load(Ordering::Relaxed),
    }
}

/// A task is alive.
pub(crate) fn check_in(task: Task) {
    TASKS.check_in(task, now_ms());
}

/// Milliseconds of the clock of the thread-mode tasks; wraps.
pub(crate) fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
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
