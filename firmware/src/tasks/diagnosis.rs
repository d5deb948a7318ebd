//! The second half of each tick: identify, diagnose, log. It has almost the whole period for it.

use firmware_logic::task_watchdog::Task;

use crate::link::{self, Records};
use crate::shared::Shared;

/// The diagnosis half of the instrument.
#[embassy_executor::task]
pub(crate) async fn diagnosis(mut records: Records, shared: &'static Shared) {
    loop {
        let record = records.next().await;
        link::check_in(Task::Diagnosis);
        shared.diagnose(record);
    }
}
