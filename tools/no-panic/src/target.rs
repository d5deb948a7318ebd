//! The calls of one tick.

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use fdi_core::diagnosis::{Diagnosis, DiagnosisState};
use fdi_core::{Percent, RawSample};
use firmware_logic::cadence::{Arrival, Cadence, Punctuality};
use firmware_logic::checkin::{Roll, Task};
use firmware_logic::control_loop::{Beat, ControlLoop, Heater, Order};
use firmware_logic::duty;
use firmware_logic::interlock::Hold;
use firmware_logic::record::Record;
use firmware_logic::sampling::Mean;

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
    fn cut_by(&self) -> Hold {
        black_box(Hold::BreakInput)
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
        MaybeUninit::<Diagnosis>::uninit(),
        MaybeUninit::<DiagnosisState>::uninit(),
        MaybeUninit::<Cadence>::uninit(),
    );
    let control = unknown(&mut memory.0);
    let diagnosis: &Diagnosis = unknown(&mut memory.1);
    let state = unknown(&mut memory.2);
    let arrival: Arrival = unknown(&mut memory.3).arrive(black_box(1));

    let mut mean = black_box(Mean::default());
    mean.push(black_box(Some(1)));
    let raw = black_box(RawSample { t0: mean.code(), ..RawSample::default() });
    black_box(control.missed(arrival, &mut Output));
    let beat: Beat = control.tick(
        raw,
        arrival,
        black_box(None::<Order>),
        black_box(fdi_core::Feedback::default()),
        &mut Output,
    );
    static ROLL: Roll = Roll::new();
    ROLL.check_in(black_box(Task::Control), black_box(1));

    let report = diagnosis.step(state, black_box(&beat.tick), black_box(beat.applied));
    black_box(Record::new(&beat, black_box(&report)));
    black_box(Punctuality::default()).count(&arrival);
    black_box(ROLL.overdue(black_box(2)));
    #[cfg(feature = "negative-control")]
    black_box([1, 2, 3][black_box(3)]);
}
