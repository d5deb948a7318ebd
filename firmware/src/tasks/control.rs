//! Every 110 ms: sample, decide, drive. Then tell the diagnosis.

use core::sync::atomic::Ordering;

use firmware_logic::cadence::{Cadence, PERIOD};
use firmware_logic::control_loop::{ControlLoop, Order, TickRecord, next_order};
use firmware_logic::task_watchdog::Task;
use heapless::spsc::{Consumer, Producer};

use crate::hardware::heater::HeaterOutput;
use crate::hardware::inputs::Inputs;
use crate::hardware::tick_timer;
use crate::link;

/// The control half of the instrument.
#[embassy_executor::task]
pub(crate) async fn control(
    mut control: ControlLoop,
    mut heater: HeaterOutput,
    mut inputs: Inputs,
    mut records: Producer<'static, TickRecord>,
    mut orders: Consumer<'static, Order>,
) {
    let mut cadence = Cadence::new(PERIOD, tick_timer::now().wrapping_add(PERIOD.get()));
    loop {
        tick_timer::until(cadence.due()).await;
        let arrival = cadence.arrive(tick_timer::now());
        for _ in 0..arrival.missed_ticks() {
            link::send(&mut records, control.missed(arrival, &mut heater));
        }
        let raw = inputs.sample(tick_timer::now()).await;
        let order = next_order(link::STOP.swap(false, Ordering::Relaxed), &mut orders);
        let record = control.tick(raw, arrival, order, link::feedback(), &mut heater);
        tick_timer::set_deadline(arrival.deadline());
        link::check_in(Task::Control);
        link::send(&mut records, record);
    }
}
