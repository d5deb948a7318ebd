//! A day of virtual time, heating: no tick is missed, none is late, the grid does not drift, no counter overflows. It takes
//! ten minutes of
//! computing: `cargo test -p virtual-board -- --ignored --nocapture`.

use virtual_board::board::load;
use virtual_board::closed_loop::TICK;
use virtual_board::rtt::Line;
use virtual_board::scene::Scene;
use virtual_board::time::{Ps, SECOND};

/// What is known of the ticks so far.
#[derive(Default)]
struct Grid {
    ticks: u64,
    first: Option<f64>,
    /// Latest begin of a tick after its due time, us.
    latest_us: u32,
    /// Farthest that a line of the log was from its place on the grid of the first, s.
    off_grid: f64,
}

impl Grid {
    /// Follows the lines of the log.
    fn check(&mut self, lines: &[Line]) {
        for line in lines {
            let Some(record) = line.tick() else {
                let expected = ["isolated", "commissioned"].iter().any(|word| line.text.contains(word));
                assert!(line.level == "info" || line.level == "warn" || expected, "{line}");
                continue;
            };
            assert_eq!(u64::from(record.tick()), self.ticks, "a tick is missing");
            assert!(!record.missed() && record.late_us() <= 5, "{line}");
            let told: f64 = line.timestamp.parse().expect("seconds");
            let first = *self.first.get_or_insert(told);
            let due = first + self.ticks as f64 * TICK as f64 / SECOND as f64;
            self.latest_us = self.latest_us.max(record.late_us());
            self.off_grid = self.off_grid.max((told - due).abs());
            assert!(self.off_grid < 0.002, "tick {} at {told} s, due at {due} s", self.ticks);
            self.ticks += 1;
        }
    }
}

fn run(time: Ps) {
    let mut scene = Scene::powered_up(load(None).expect("an image")).expect("powers up");
    scene.board.run_for(SECOND).expect("boots");
    scene.arm().expect("arms");
    let mut grid = Grid::default();
    let mut begin = None;
    while scene.board.now() < time {
        scene.board.run_for(60 * SECOND).expect("runs on");
        grid.check(&std::mem::take(&mut scene.board.log));
        begin.get_or_insert((scene.board.now(), grid.ticks));
        scene.rig.0.borrow_mut().power.clear();
        scene.board.cpu.touch(|chip, _| {
            let done = chip.heater_log.len() - 1;
            chip.heater_log.drain(..done);
        });
    }
    let (start, ticks) = begin.expect("more than a minute");
    let (elapsed, ticks) = (scene.board.now() - start, grid.ticks - ticks);
    assert!(elapsed.abs_diff(ticks * TICK) <= TICK, "{ticks} ticks in {} s", elapsed / SECOND);
    let status = scene.board.command("status").expect("answers");
    println!(
        "{} s, {} ticks, latest {} us, log at most {:.6} s off the grid; {} instructions\n{status}",
        scene.board.now() / SECOND,
        grid.ticks,
        grid.latest_us,
        grid.off_grid,
        scene.board.cpu.instructions()
    );
    assert!(status.contains("missed 0 worst"), "{status}");
    assert!(status.contains("diagnosis lost 0, log dropped 0"), "{status}");
    // In a day the room drifts past the set-point, and the controller is right to turn the heater down.
    assert!(status.starts_with("mode monitor"), "{status}");
    assert_eq!(scene.board.resets, []);
}

#[test]
fn a_quarter_of_an_hour() {
    run(900 * SECOND);
}

#[test]
#[ignore = "ten minutes of computing"]
fn a_day() {
    run(24 * 3600 * SECOND);
}
