//! Every Ts: sample, decide, drive. Then tell the diagnosis. Where Ts is long, looks between two ticks, for what must not wait.

use core::sync::atomic::Ordering;

use core::num::NonZeroU32;

use firmware_logic::cadence::Cadence;
use firmware_logic::control_loop::{ControlLoop, Order, TickRecord, next_order};
use firmware_logic::interlock::Lockout;
use firmware_logic::stream::codes::Codes;
use firmware_logic::task_watchdog::Task;
use heapless::spsc::{Consumer, Producer};

use crate::hardware::cycles;
use crate::hardware::heater::HeaterOutput;
use crate::hardware::inputs::Inputs;
use crate::hardware::{memory, slow_clock, tick_timer};
use crate::{link, simulation};

/// The control half of the instrument.
#[embassy_executor::task]
pub(crate) async fn control(
    period: NonZeroU32,
    mut control: ControlLoop,
    mut heater: HeaterOutput,
    mut inputs: Inputs,
    mut records: Producer<'static, TickRecord>,
    mut orders: Consumer<'static, Order>,
    mut codes: Consumer<'static, Codes>,
) {
    let mut cadence = Cadence::new(period, tick_timer::now().wrapping_add(period.get()));
    let mut next = 0;
    loop {
        let look = cadence.look(tick_timer::now());
        let due = look.unwrap_or(cadence.due());
        tick_timer::until(due).await;
        let arrival = look.is_none().then(|| cadence.arrive(tick_timer::now()));
        if let Some(arrival) = arrival {
            for _ in 0..arrival.missed_ticks() {
                let record = control.missed(arrival, &mut heater);
                next = record.tick.index.wrapping_add(1);
                link::send(&mut records, record);
            }
        }
        slow_clock::begin(); // over before the sample is, which takes 1.25 ms
        let raw = inputs.sample().await;
        if !slow_clock::is_right() {
            control.lock_out(Lockout::WrongClock, &mut heater);
        }
        if !memory::holds() {
            control.lock_out(Lockout::Memory, &mut heater);
        }
        if heater.is_stuck_high() {
            control.lock_out(Lockout::Output, &mut heater);
        }
        let Some(arrival) = arrival else {
            // A look at what is simulated shows nothing that its ticks do not.
            if !simulation::is_on() {
                control.look(raw, &mut heater);
            }
            done(cadence.deadline(due));
            continue;
        };
        let order = next_order(link::STOP.swap(false, Ordering::Relaxed), &mut orders);
        let begin = cycles::now();
        let raw = simulation::seen(next, raw, &mut codes);
        let mut record = control.tick(raw, arrival, order, link::feedback(), &mut heater);
        record.cycles = cycles::now().wrapping_sub(begin);
        next = record.tick.index.wrapping_add(1);
        done(cadence.deadline(arrival.due));
        link::send(&mut records, record);
    }
}

/// A look or a tick is done; the next must be by `deadline`, in µs.
fn done(deadline: u32) {
    tick_timer::set_deadline(deadline);
    link::check_in(Task::Control);
}
