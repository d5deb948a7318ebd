//! A free-running 32-bit counter of microseconds: the clock of the control tick (compare 1) and the deadline
//! watchdog (compare 2); channel 4 captures the oscillator of the watchdog. It is another timer than the one that runs
//! the rest, so that each can notice the other's death.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Poll;

use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::timer::regs::SrGp16;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::{Peri, interrupt, rcc};
use embassy_sync::waitqueue::AtomicWaker;
use firmware_logic::interlock::Lockout;

use super::board::{self, TICK_TIMER, TickTimer};
use super::{halt, heater, slow_clock};

const WAKE: usize = 0;
const DEADLINE: usize = 1;

static CONTROL: AtomicWaker = AtomicWaker::new();
/// What the log has last seen of the counter, and how often it has wrapped.
static SEEN: AtomicU32 = AtomicU32::new(0);
static WRAPS: AtomicU32 = AtomicU32::new(0);

/// Starts counting; nothing interrupts yet.
pub(crate) fn start(_timer: Peri<'static, TickTimer>) {
    count(rcc::frequency::<TickTimer>().0 / 1_000_000);
}

/// Starts counting microseconds of a clock of so many MHz, for the start before it has clocks, too.
pub(crate) fn count(per_microsecond: u32) {
    rcc::enable_and_reset::<TickTimer>();
    slow_clock::connect();
    TICK_TIMER.psc().write_value((per_microsecond - 1) as u16);
    TICK_TIMER.arr().write_value(u32::MAX);
    TICK_TIMER.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
    TICK_TIMER.egr().write(|w| w.set_ug(true)); // takes over the prescaler
    TICK_TIMER.cr1().modify(|w| w.set_cen(true));
}

/// Begins to wake the control task and to watch it. The deadline watchdog is armed by its first feeding. To be called
/// with the heater's output set up, which the interrupt may cut.
pub(crate) fn enable_interrupt() {
    halt::start();
    TICK_TIMER.sr().write_value(SrGp16(0));
    TICK_TIMER.dier().write(|w| {
        w.set_ccie(WAKE, true);
        w.set_ccie(DEADLINE, true);
        w.set_ccie(board::SLOW_CHANNEL, true);
    });
    // SAFETY: the handler is below and touches only timers, an atomic waker and the heater's enable.
    unsafe { board::TICK_INTERRUPT.enable() };
}

/// Microseconds; wraps every 71.6 minutes.
pub(crate) fn now() -> u32 {
    TICK_TIMER.cnt().read()
}

/// Microseconds since [`start`], for the log, whose line of each second sees every wrap.
pub(crate) fn uptime_us() -> u64 {
    let now = now();
    let before = SEEN.swap(now, Ordering::Relaxed);
    if before > now && before - now > u32::MAX / 2 {
        WRAPS.fetch_add(1, Ordering::Relaxed);
    }
    u64::from(WRAPS.load(Ordering::Relaxed)) << 32 | u64::from(now)
}

/// Waits until the counter has reached `at`, at most half a wrap ahead. For the control task alone.
pub(crate) async fn until(at: u32) {
    let reached = || now().wrapping_sub(at) <= u32::MAX / 2;
    poll_fn(|context| {
        if reached() {
            return Poll::Ready(());
        }
        CONTROL.register(context.waker());
        TICK_TIMER.ccr(WAKE).write_value(at);
        // The counter may have passed while the compare value was on its way; then no interrupt comes.
        if reached() { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
}

/// Puts off the deadline watchdog to `at`. When the counter gets there, the heater is cut by the highest interrupt,
/// though the control task or anything else should spin for ever.
pub(crate) fn set_deadline(at: u32) {
    TICK_TIMER.ccr(DEADLINE).write_value(at);
}

board::on_tick_interrupt!(interrupted);

fn interrupted() {
    let status = TICK_TIMER.sr().read();
    TICK_TIMER.sr().write_value(SrGp16(!status.0)); // writing 0 clears, writing 1 leaves alone
    if halt::was_halted() {
        heater::cut_because(Lockout::Halted);
    }
    if status.ccif(board::SLOW_CHANNEL) {
        slow_clock::captured(status.ccof(board::SLOW_CHANNEL));
    }
    if status.ccif(DEADLINE) {
        heater::cut_because(Lockout::MissedDeadline);
    }
    if status.ccif(WAKE) {
        CONTROL.wake();
    }
}
