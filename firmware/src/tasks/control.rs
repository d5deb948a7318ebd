//! Every 110 ms: sample, decide, drive. Then tell the diagnosis.

use core::num::NonZeroU32;
use core::sync::atomic::Ordering;

use firmware_logic::cadence::Cadence;
use firmware_logic::control_loop::{ControlLoop, Order, TickRecord, next_order};
use firmware_logic::task_watchdog::Task;
use heapless::spsc::{Consumer, Producer};

use crate::hardware::heater::HeaterOutput;
use crate::hardware::thermistors::Thermistors;
use crate::hardware::tick_timer;
use crate::link;

/// Ts: 110 ms, exactly, in µs.
const PERIOD: NonZeroU32 = NonZeroU32::new(110_000).expect("not zero");
const PERIOD_US: u32 = PERIOD.get();
/// The heater is cut when no tick has been completed for this long after the last was due: three are missed then and
/// the fourth has not come either.
const DEADLINE_US: u32 = 4 * PERIOD_US;
/// Missed ticks that are told to the core one by one. The heater is off before there can be more.
const MAX_MISSED: u32 = 4;

/// The control half of the instrument.
#[embassy_executor::task]
pub(crate) async fn control(
    mut control: ControlLoop,
    mut heater: HeaterOutput,
    mut thermistors: Thermistors,
    mut records: Producer<'static, TickRecord>,
    mut orders: Consumer<'static, Order>,
) {
    let mut cadence = Cadence::new(PERIOD, tick_timer::now().wrapping_add(PERIOD_US));
    loop {
        tick_timer::until(cadence.due()).await;
        let arrival = cadence.arrive(tick_timer::now());
        for _ in 0..arrival.missed.min(MAX_MISSED) {
            link::send(&mut records, control.missed(arrival, &mut heater));
        }
        let raw = thermistors.sample(tick_timer::now()).await;
        let order = next_order(link::STOP.swap(false, Ordering::Relaxed), &mut orders);
        let record = control.tick(raw, arrival, order, link::feedback(), &mut heater);
        tick_timer::set_deadline(arrival.due.wrapping_add(DEADLINE_US));
        link::check_in(Task::Control);
        link::send(&mut records, record);
    }
}
