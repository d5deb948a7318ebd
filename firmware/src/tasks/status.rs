//! A line for people, each second.

use embassy_time::{Duration, Ticker};
use firmware_logic::task_watchdog::Task;

use crate::link::check_in;
use crate::log;
use crate::shared::Shared;

/// The status line.
#[embassy_executor::task]
pub(crate) async fn status(shared: &'static Shared) {
    let mut second = Ticker::every(Duration::from_secs(1));
    loop {
        check_in(Task::Status);
        log::status(&shared.status());
        second.next().await;
    }
}
