//! What the two halves of the instrument tell each other. The control half never waits for the other: it pushes into a
//! queue of one producer and one consumer, and reads atomics.

use core::cell::Cell;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::Poll;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::Instant;
use fdi_core::Feedback;
use firmware_logic::checkin::{Roll, Task};
use firmware_logic::control_loop::{Beat, Order};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

/// Who is alive.
pub(crate) static ROLL: Roll = Roll::new();
/// "Stop" needs no place in a queue.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);
/// What the diagnosis has found, for the control half. Whole or not at all: a copy takes some 20 cycles.
static FEEDBACK: Mutex<CriticalSectionRawMutex, Cell<Option<Feedback>>> = Mutex::new(Cell::new(None));
/// Beats that found the queue full, since the diagnosis was too slow.
pub(crate) static BEATS_LOST: AtomicU32 = AtomicU32::new(0);

static BEAT_READY: AtomicWaker = AtomicWaker::new();
static BEATS: ConstStaticCell<Queue<Beat, 8>> = ConstStaticCell::new(Queue::new());
static ORDERS: ConstStaticCell<Queue<Order, 2>> = ConstStaticCell::new(Queue::new());

/// Tells the control half what the diagnosis has found.
pub(crate) fn feed_back(feedback: Feedback) {
    FEEDBACK.lock(|cell| cell.set(Some(feedback)));
}

/// What the diagnosis found last.
pub(crate) fn feedback() -> Feedback {
    FEEDBACK.lock(Cell::get).unwrap_or_default()
}

/// A task is alive.
pub(crate) fn check_in(task: Task) {
    ROLL.check_in(task, now_ms());
}

/// Milliseconds of the clock of the thread-mode tasks; wraps.
pub(crate) fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
}

/// Both ends of the beats, control to diagnosis.
pub(crate) fn beats() -> (Beats, Producer<'static, Beat>) {
    let (producer, consumer) = BEATS.take().split();
    (Beats(consumer), producer)
}

/// Both ends of the orders, console to control.
pub(crate) fn orders() -> (Producer<'static, Order>, Consumer<'static, Order>) {
    ORDERS.take().split()
}

/// Hands a beat to the diagnosis.
pub(crate) fn send(beats: &mut Producer<'static, Beat>, beat: Beat) {
    if beats.enqueue(beat).is_err() {
        BEATS_LOST.store(BEATS_LOST.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
    }
    BEAT_READY.wake();
}

/// The diagnosis' end of the beats.
pub(crate) struct Beats(Consumer<'static, Beat>);

impl Beats {
    /// Waits for the next beat.
    pub(crate) async fn next(&mut self) -> Beat {
        poll_fn(|context| {
            BEAT_READY.register(context.waker());
            self.0.dequeue().map_or(Poll::Pending, Poll::Ready)
        })
        .await
    }
}
