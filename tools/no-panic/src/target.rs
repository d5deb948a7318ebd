//! The calls of one tick.

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use fdi_core::{Percent, RawSample};
use firmware_logic::cadence::{Arrival, Cadence};
use firmware_logic::control_loop::{ControlLoop, Heater, Order, TickRecord, next_order};
use firmware_logic::diagnosis_loop::DiagnosisLoop;
use firmware_logic::duty;
use firmware_logic::interlock::Lockout;
use firmware_logic::sampling::Mean;
use firmware_logic::task_watchdog::{Task, TaskWatchdog};
use heapless::spsc::Queue;

unsafe extern "C" {
    /// Exists nowhere.
    fn something_in_the_tick_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never linked, let alone called.
    unsafe { something_in_the_tick_can_panic() }
}

/// An output that answers anything.
struct Output;

impl Heater for Output {
    fn drive(&mut self, power: Percent) {
        black_box(duty::compare(power, black_box(5000)));
    }
    fn contactor(&mut self, closed: bool) {
        black_box(closed);
    }
    fn enable(&mut self) {
        black_box(());
    }
    fn disable(&mut self) {
        black_box(());
    }
    fn is_enabled(&self) -> bool {
        black_box(true)
    }
    fn break_is_open(&self) -> bool {
        black_box(false)
    }
    fn cut_by(&self) -> Lockout {
        black_box(Lockout::BreakInput)
    }
    fn test_break(&mut self) -> bool {
        black_box(true)
    }
}

/// Something of type `T` that the compiler knows nothing of.
fn unknown<T>(memory: &mut MaybeUninit<T>) -> &mut T {
    // SAFETY: this image is linked and never run; no value is ever read.
    black_box(unsafe { memory.assume_init_mut() })
}

/// All that happens in a tick, in its order.
#[unsafe(no_mangle)]
extern "C" fn every_tick() {
    let mut memory = (
        MaybeUninit::<ControlLoop>::uninit(),
        MaybeUninit::<DiagnosisLoop>::uninit(),
        MaybeUninit::<Cadence>::uninit(),
    );
    let control = unknown(&mut memory.0);
    let diagnosis = unknown(&mut memory.1);
    let cadence = unknown(&mut memory.2);
    black_box(cadence.look(black_box(1)));
    let arrival: Arrival = cadence.arrive(black_box(1));
    black_box(cadence.deadline(arrival.due));

    let mut mean = black_box(Mean::default());
    mean.push(black_box(Some(1)));
    let raw = black_box(RawSample { t0: mean.code(), ..RawSample::default() });
    control.look(raw, &mut Output);
    black_box(control.missed(arrival, &mut Output));
    let mut waiting: Queue<Order, 2> = Queue::new();
    let (mut give, mut orders) = waiting.split();
    let _ = give.enqueue(black_box(Order::Check));
    let record: TickRecord = control.tick(
        raw,
        arrival,
        next_order(black_box(false), &mut orders),
        black_box(fdi_core::Feedback::default()),
        &mut Output,
    );
    static TASKS: TaskWatchdog = TaskWatchdog::new();
    TASKS.check_in(black_box(Task::Control), black_box(1));

    diagnosis.step(black_box(record), |notice| {
        black_box(notice);
    });
    black_box(diagnosis.feedback());
    black_box(TASKS.overdue(black_box(2)));
    #[cfg(feature = "negative-control")]
    black_box([1, 2, 3][black_box(3)]);
}
