//! Two faults of a user's own, shown to the image three times each, told by their names by both diagnoses, and kept over a power cycle.

use pt326_rig::fault::{Fault, Sensor, Verb};
use virtual_board::board::load;
use virtual_board::scene::{Scene, WAIVE_CHECK};
use virtual_board::time::SECOND;

/// T2 reads too low, or T1 too high: the paper's tables know neither.
const KINDS: [(&str, Sensor, f64); 2] = [("T2-low", Sensor::T2, -1.5), ("T1-high", Sensor::T1, 1.5)];
/// Which comes when: three of each to teach, and one of each to be told.
const ORDER: [usize; 8] = [0, 0, 0, 1, 1, 1, 0, 1];
/// When the first one comes, how far one is from the next, and how long each lasts, s.
const FIRST: u64 = 400;
const APART: u64 = 60;
const LASTS: u64 = 24;

fn faults() -> Vec<Fault> {
    let at = (0..).map(|i| (FIRST + APART * i) as f64);
    let fault = |(kind, at): (&usize, f64)| {
        let (_, sensor, size) = KINDS[*kind];
        Fault::new(Verb::Offset, Some(sensor), Some(size), at, LASTS as f64)
    };
    ORDER.iter().zip(at).map(fault).collect()
}

fn say(scene: &mut Scene, line: &str) -> String {
    scene.board.command(line).expect(line)
}

fn wait(scene: &mut Scene, seconds: u64) {
    scene.board.run_for(seconds * SECOND).expect("runs on");
}

/// From the begin of a fault to that of the next: somebody is a little late with the first word, and early with the last.
fn show(scene: &mut Scene, name: &str) {
    wait(scene, 1);
    let begun = say(scene, &format!("teach {name}"));
    assert!(begun.contains("make it now"), "{begun}");
    wait(scene, LASTS - 3);
    let ended = say(scene, "teach end");
    assert!(ended.starts_with("repetition "), "{ended}");
    wait(scene, APART + 2 - LASTS);
}

#[test]
fn two_faults_are_taught_told_by_their_names_and_kept() {
    let mut scene = Scene::at_rest(load(None).expect("an image")).expect("powers up");
    say(&mut scene, WAIVE_CHECK);
    assert_eq!(say(&mut scene, "teach low"), "error: only while it monitors, see `status`");
    scene.connect(&faults());
    assert!(say(&mut scene, "arm").starts_with("ok"));
    wait(&mut scene, FIRST);
    for (number, (name, ..)) in (4..).zip(KINDS) {
        (0..3).for_each(|_| show(&mut scene, name));
        let saved = say(&mut scene, "teach save");
        let row = format!("in force\nrow: {number} ");
        assert!(saved.starts_with(&row) && saved.contains(name) && saved.contains("it heats"), "{saved}");
        assert!(saved.contains("\nlikelihood: ") && !saved.contains("NOT"), "{saved}");
    }
    for (number, (name, ..)) in (4..).zip(KINDS) {
        wait(&mut scene, LASTS / 2);
        let status = say(&mut scene, "status");
        assert!(status.contains(&format!("fdv {number} fiv {number} ({name})")), "{status}");
        let likelihood = status.lines().find(|line| line.starts_with("likelihood"));
        assert!(likelihood.is_some_and(|line| line.contains(&format!("offset ({name})"))), "{status}");
        wait(&mut scene, APART - LASTS / 2);
    }
    say(&mut scene, "stop");
    wait(&mut scene, 1);
    let faults = say(&mut scene, "faults");
    assert!(KINDS.iter().all(|(name, ..)| faults.contains(&format!("({name})"))), "{faults}");
    assert!(KINDS.iter().all(|(name, ..)| faults.contains(&format!("as taught: {name},"))), "{faults}");
    assert_eq!(say(&mut scene, "save"), "ok");
    scene.board.power_cycle().expect("comes back");
    wait(&mut scene, 1);
    for (number, (name, ..)) in (4..).zip(KINDS) {
        let row = say(&mut scene, &format!("get diagnosis.isolation.{number}"));
        assert!(row.ends_with(name), "{row}");
        let taught = say(&mut scene, &format!("get likelihood.taught.{}", number - 3));
        assert!(taught.contains(&format!(" = {name} ")), "{taught}");
    }
}
