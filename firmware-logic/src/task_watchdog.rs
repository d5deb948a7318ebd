//! The software half of the watchdog, asked before the hardware is fed: every task must have checked in within its deadline.

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};

/// The tasks that are watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Task {
    /// Samples, decides, drives; looks at the rig every 110 ms at least.
    Control,
    /// Identifies and diagnoses each tick.
    Diagnosis,
    /// Reads lines, answers them.
    Console,
    /// Status line of the log, each second.
    Status,
    /// Watches the button.
    Panel,
}

/// All tasks with the longest time in ms that each may be silent, the diagnosis besides the period of the tick. Control and diagnosis
/// may each lose one; a save of the settings, which stalls everything, is followed by checking all in.
pub const DEADLINES: [(Task, u32); 5] = [
    (Task::Control, 250),
    (Task::Diagnosis, 140),
    (Task::Console, 500),
    (Task::Status, 1500),
    (Task::Panel, 250),
];

/// When each task last checked in, in ms of a wrapping clock. Any interrupt level may check in: there is no lock.
#[derive(Debug)]
pub struct TaskWatchdog {
    last: [AtomicU32; DEADLINES.len()],
    /// Period of the tick, ms.
    period: AtomicU32,
}

impl TaskWatchdog {
    /// All tasks count as checked in at time 0, and ticks come every 110 ms.
    pub const fn new() -> Self {
        Self { last: [const { AtomicU32::new(0) }; DEADLINES.len()], period: AtomicU32::new(110) }
    }

    /// Ticks come every so many ms.
    pub fn set_period(&self, period_ms: u32) {
        self.period.store(period_ms, Ordering::Relaxed);
    }

    /// For how long, in ms, a task of this row may be silent.
    fn deadline(&self, (task, deadline_ms): (Task, u32)) -> u32 {
        let period = if task == Task::Diagnosis { self.period.load(Ordering::Relaxed) } else { 0 };
        deadline_ms + period
    }

    /// The task is alive.
    pub fn check_in(&self, task: Task, now_ms: u32) {
        self.last[task as usize].store(now_ms, Ordering::Relaxed);
    }

    /// All tasks get their full deadline again: at start, and after a stall that was planned.
    pub fn check_all_in(&self, now_ms: u32) {
        for last in &self.last {
            last.store(now_ms, Ordering::Relaxed);
        }
    }

    /// The first task that has been silent for longer than it may; the watchdog must not be fed then.
    pub fn overdue(&self, now_ms: u32) -> Option<Overdue> {
        DEADLINES.iter().find_map(|&row| {
            let (task, deadline_ms) = (row.0, self.deadline(row));
            let silent_ms = now_ms.wrapping_sub(self.last[task as usize].load(Ordering::Relaxed));
            // A check-in from a higher priority between reading the clock and here lies in the future: not silent.
            let late = silent_ms > deadline_ms && silent_ms <= u32::MAX / 2;
            late.then_some(Overdue { task, silent_ms, deadline_ms })
        })
    }
}

impl Default for TaskWatchdog {
    fn default() -> Self {
        Self::new()
    }
}

/// A task that has missed its deadline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Overdue {
    /// Which.
    pub task: Task,
    /// For how long it has been silent.
    pub silent_ms: u32,
    /// How long it may be.
    pub deadline_ms: u32,
}

impl fmt::Display for Overdue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { task, silent_ms, deadline_ms } = self;
        write!(f, "task {task:?} silent for {silent_ms} ms, expected at most {deadline_ms} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (i, (task, _)) in DEADLINES.iter().enumerate() {
            assert_eq!(*task as usize, i, "{task:?} would be looked up in another row");
        }
    }

    #[test]
    fn each_task_alone_can_stop_the_feeding() {
        for (row, period) in DEADLINES.into_iter().zip([110, 5000, 110, 110, 50]) {
            let tasks = TaskWatchdog::new();
            tasks.set_period(period);
            let (silent, deadline) = (row.0, tasks.deadline(row));
            let start = u32::MAX - 20; // the clock wraps meanwhile
            tasks.check_all_in(start);
            let late = start.wrapping_add(deadline + 1);
            for (task, _) in DEADLINES.iter().filter(|(task, _)| *task != silent) {
                tasks.check_in(*task, late);
            }
            assert_eq!(tasks.overdue(start.wrapping_add(deadline)), None, "{silent:?}: on its deadline");
            let overdue = tasks.overdue(late).expect("past its deadline");
            assert_eq!((overdue.task, overdue.silent_ms), (silent, deadline + 1));
        }
    }

    #[test]
    fn the_diagnosis_may_lose_a_tick_of_any_period_and_control_waits_no_longer_for_it() {
        let tasks = TaskWatchdog::new();
        let deadlines = || {
            [DEADLINES[Task::Control as usize], DEADLINES[Task::Diagnosis as usize]]
                .map(|row| tasks.deadline(row))
        };
        assert_eq!(deadlines(), [250, 250]);
        tasks.set_period(5000);
        assert_eq!(deadlines(), [250, 5140]);
    }

    #[test]
    fn a_check_in_from_the_future_is_no_silence() {
        let tasks = TaskWatchdog::new();
        tasks.check_all_in(1001);
        assert_eq!(tasks.overdue(1000), None);
    }

    #[test]
    fn says_who_and_how_long() {
        let overdue = Overdue { task: Task::Console, silent_ms: 501, deadline_ms: 500 };
        assert_eq!(overdue.to_string(), "task Console silent for 501 ms, expected at most 500 ms");
    }
}
