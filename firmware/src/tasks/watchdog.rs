//! Feeds the hardware watchdog, but only while every task checks in, and tests a part of the memory. The lowest of all in rank: whoever
//! starves this task starves the watchdog, too.

use embassy_time::Timer;

use crate::hardware::memory;
use crate::hardware::watchdog::{self, Deadline};
use crate::link::{TASKS, now_ms};

/// Every 50 ms, an eighth of the watchdog's deadline.
const PERIOD_MS: u64 = 50;

/// Feeds the watchdog while all tasks check in.
#[embassy_executor::task]
pub(crate) async fn watchdog() {
    TASKS.check_all_in(now_ms());
    watchdog::set(Deadline::Running);
    let mut overdue_before = false;
    loop {
        let overdue = TASKS.overdue(now_ms());
        match overdue {
            None => watchdog::feed(),
            Some(late) if !overdue_before => {
                defmt::error!("{}, reset follows", late);
            }
            Some(_) => {}
        }
        overdue_before = overdue.is_some();
        memory::test();
        Timer::after_millis(PERIOD_MS).await;
    }
}
