//! The paper's experiment on the image: it must say what the simulation says.

use std::sync::LazyLock;

use fdi_core::Mode;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::record::summary::Summary;
use virtual_board::board::load;
use virtual_board::rtt::Line;
use virtual_board::time::SECOND;
use virtual_board::{experiment, twin};

struct Run {
    record: pt326_host::experiment::Record,
    differences: Vec<virtual_board::recording::Difference>,
    power: Vec<f64>,
    idle_ticks: usize,
    /// What `status` says after a stop, and after the power was off.
    statuses: [String; 2],
    /// Its log, as docs/board-reference.md shows it.
    shown: String,
}

/// The run of seed 1, once for all tests.
static RUN: LazyLock<Run> = LazyLock::new(|| run(1));

fn run(seed: u64) -> Run {
    let mut done = experiment::run(load(None).expect("an image"), &Scenario::default(), seed).expect("runs");
    let power = done.rig.0.borrow().power.clone();
    let shown = shown(&done.board.log);
    let mut statuses = || -> anyhow::Result<[String; 2]> {
        let board = &mut done.board;
        board.command("stop")?;
        board.run_for(SECOND)?;
        let stopped = board.command("status")?;
        board.power_cycle()?;
        board.run_for(SECOND)?;
        Ok([stopped, board.command("status")?])
    };
    let statuses = statuses().expect("answers");
    let (record, differences, idle_ticks) = (done.record, done.differences, done.idle_ticks);
    Run { record, differences, power, idle_ticks, statuses, shown }
}

/// The log until the first fault is over. Any change of the image moves its microseconds, and each commit its name, so neither is shown.
/// Of what comes with each tick, and with each second, only the first is.
fn shown(log: &[Line]) -> String {
    let (mut ticks, mut seconds) = (0, 0);
    let lines = log.iter().filter(|line| {
        let (is_tick, is_status) = (line.tick().is_some(), line.text.contains(" degC, heater "));
        ticks += u32::from(is_tick);
        seconds += u32::from(is_status);
        !(is_tick && ticks > 1 || is_status && seconds > 1)
    });
    let lines = lines.map(|line| {
        let time = &line.timestamp[..line.timestamp.len().saturating_sub(4)];
        let text = match line.text.split_once(" (").zip(line.text.split_once(") on ")) {
            Some(((release, _), (_, board))) => format!("{release} (COMMIT) on {board}"),
            None => line.text.clone(),
        };
        let short: String = text.chars().take(110).collect();
        let more = if short == text { "" } else { " .." };
        format!("{time:>6} {:<5} {short}{more}\n", line.level)
    });
    let mut over = false;
    let lines = lines.take_while(|line| !std::mem::replace(&mut over, line.contains(" ended: ")));
    lines.collect()
}

/// Ts, and a little for rounding.
const ONE_TICK: f64 = 0.1101;

#[test]
fn every_word_of_the_log_comes_out_of_the_core_on_the_host() {
    assert_eq!(RUN.record.rows.len(), 7727);
    assert_eq!(RUN.differences, []);
}

#[test]
fn drives_and_features_are_those_of_the_simulation_bit_for_bit() {
    for (run, seed) in [(&*RUN, 1), (&run(7), 7)] {
        let twin = twin::run(&Scenario::default(), seed, run.idle_ticks).expect("simulates");
        for (i, (board, twin)) in run.record.rows.iter().zip(&twin.rows).enumerate() {
            // Debug text of a float is the shortest that gives the same bits.
            let tick = fdi_core::Tick { drive: board.tick.drive, index: board.tick.index, ..twin.tick };
            assert_eq!(format!("{:?}", board.tick), format!("{tick:?}"), "tick {i}, seed {seed}");
            let mut report = twin.report.clone();
            report.tick = board.report.tick;
            if let Some(finding) = &mut report.likelihood.finding {
                finding.onset -= run.idle_ticks as u32; // the record begins when the board was armed
            }
            report.events = board.report.events.clone(); // they carry the number of the tick
            assert_eq!(format!("{:?}", board.report), format!("{report:?}"), "tick {i}, seed {seed}");
            if let Some(power) = run.power.get(i) {
                assert_eq!((100.0 * power) as f32, twin.tick.drive.0, "the pin at tick {i}, seed {seed}");
            }
        }
    }
}

#[test]
fn reaches_the_set_point_learns_and_monitors() {
    let t1 = |i: usize| RUN.record.rows[i].tick.sample.t1.celsius.0;
    assert!((22.0..24.0).contains(&t1(0)), "cold at first: {}", t1(0));
    let mean = (200..1600).map(t1).sum::<f32>() / 1400.0;
    assert!((mean - 35.0).abs() < 0.05, "{mean}");
    assert!(RUN.record.baseline.is_some());
    assert_eq!(RUN.record.rows.last().map(|row| row.tick.mode), Some(Mode::Monitor));
}

/// Kept in flash once the heater is off.
#[test]
fn the_first_models_are_the_commissioning_and_outlive_a_power_cycle() {
    let [stopped, restarted] = &RUN.statuses;
    assert!(
        stopped.contains("commissioning 1") && restarted.contains("commissioning 1"),
        "{stopped}\n{restarted}"
    );
}

#[test]
fn faults_are_seen_within_one_tick_of_the_simulation() {
    let scenario = Scenario::default();
    let simulated =
        pt326_host::experiment::run(&fdi_core::Config::default(), &scenario, 1).expect("simulates");
    let (board, host) = (Summary::new(&RUN.record), Summary::new(&simulated));
    assert_eq!(board.false_alarms, host.false_alarms);
    for (board, host) in board.faults.iter().zip(&host.faults) {
        let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() <= ONE_TICK,
            (a, b) => a == b,
        };
        assert!(near(board.signature.detected_s, host.signature.detected_s), "{}", board.name);
        assert!(near(board.signature.isolated_s, host.signature.isolated_s), "{}", board.name);
        assert!(near(board.likelihood.onset_error_s, host.likelihood.onset_error_s), "{}", board.name);
        assert!(
            board.signature.detected_s.is_some() && board.signature.isolated_s.is_some(),
            "{}",
            board.name
        );
    }
}

#[test]
fn the_page_shows_this_log() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/board-reference.md");
    let page = std::fs::read_to_string(path).expect("the page");
    let mark = "<!-- made by: cargo test -p virtual-board --test board the_page -->\n```text\n";
    let (before, rest) = page.split_once(mark).expect("the mark");
    let (_, after) = rest.split_once("```").expect("the end of the block");
    let new = format!("{before}{mark}{}```{after}", RUN.shown);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, new).expect("written");
    } else {
        let again = "stale: UPDATE_DOCS=1 cargo test -p virtual-board --test board the_page";
        assert!(page == new, "{again}\n{}", RUN.shown);
    }
}
