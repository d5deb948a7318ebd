//! What a recording takes in the page, counted.

use fdi_core::{Command, Config, Instrument};
use firmware_logic::control_loop::TickRecord;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::log_line::{LogLine, VERSION};
use firmware_logic::stream::frame;
use pt326_host::experiment::sample;
use pt326_lab_browser::Browser;
use pt326_lab_browser::port::PORT;
use pt326_rig::{Disturbance, Rig, RigConfig};
use serde_json::{Value, json};

use crate::{address, assert_untroubled, script_on};

/// Ticks in a day.
const DAY: u32 = 785_454;
/// Ticks that the page is given at once.
const PIECE: u32 = 4096;

/// The stream of a board that is armed before tick 3, on the simulated rig.
struct Board {
    instrument: Instrument,
    rig: Rig,
    ticks: u32,
}

impl Board {
    fn new() -> Self {
        let instrument = Instrument::new(&Config::default()).expect("defaults");
        let rig = Rig::new(&RigConfig::default(), Disturbance::Calm, 0.11, 1, &[]);
        Self { instrument, rig, ticks: 0 }
    }

    /// So many ticks more, as they come over the port.
    fn says(&mut self, ticks: u32) -> String {
        let mut text = String::new();
        if self.ticks == 0 {
            frame::write(&LogLine::Start { version: VERSION }, &mut text).expect("text");
        }
        for tick in self.ticks..self.ticks + ticks {
            if tick == 3 {
                frame::write(&"order 3 arm", &mut text).expect("text");
                self.instrument.command(Command::Arm).expect("it arms");
            }
            let raw = sample(&mut self.rig);
            let given = self.instrument.control(raw);
            let report = self.instrument.diagnose(&given, given.drive);
            self.rig.advance(f64::from(given.drive.0));
            let line = TickLine::new(&TickRecord::new(raw, given, given.drive), &report);
            frame::write(&line, &mut text).expect("text");
            frame::write(
                &LogLine::Cycles { tick, control: 40_000 + tick % 977, diagnosis: 900_000 + tick % 9973 },
                &mut text,
            )
            .expect("text");
        }
        self.ticks += ticks;
        text
    }
}

/// Bytes that the page keeps of so many ticks, packed, and as the file that it saves; MB of memory of the page's own thread.
fn kept(ticks: u32) -> (f64, f64, f64) {
    let browser = Browser::start().expect("a browser");
    browser.open(&address()).expect("lab.html");
    let connect = r##"await monitoring(); window.board = new Port(BOARD); offer(board); click("#connect");
        await until(() => lab.lab.hello.kind === "board" && lab.lab.settings["pid.kp"] === 2.5); return 1"##;
    script_on(&browser, &format!("{PORT}{connect}"), &[]);
    let mut board = Board::new();
    // A start of the board asks for its settings again: they are answered before the ticks come.
    while board.ticks < ticks {
        let piece = board.says(PIECE.min(ticks - board.ticks));
        let taken = "board.says(args[0]); await until(() => lab.lab.store?.end >= args[1]); return 1";
        script_on(
            &browser,
            &format!("const board = window.board; {taken}"),
            &[json!(piece), json!(board.ticks)],
        );
    }
    let count = r##"for (lab.lab.kept = null; !lab.lab.kept; ) await frame();
        const { parts } = await lab.ask({ command: "log" }); const size = new Blob(parts).size;
        return [lab.lab.kept.bytes, size, lab.lab.agrees.ticks]"##;
    let [packed, text, same] = serde_json::from_value::<[Value; 3]>(script_on(&browser, count, &[]))
        .expect("three")
        .map(|v| v.as_f64().expect("a number"));
    assert!(same > f64::from(ticks) * 0.9, "a core ran beside it: {same} of {ticks} ticks");
    assert_untroubled(&browser);
    (packed, text, browser.memory().expect("its memory"))
}

/// A quarter of an hour, and as long again: the log grows by the tick, and nothing else of the page does.
#[test]
fn a_recording_takes_less_than_a_hundred_bytes_a_tick() {
    let (packed, text, memory) = kept(2 * PIECE);
    let [packed, text] = [packed, text].map(|bytes| bytes / f64::from(2 * PIECE));
    assert!(packed < 100.0 && text > 250.0, "{packed} bytes a tick, {text} as text");
    let (_, _, twice) = kept(4 * PIECE);
    assert!(twice < memory + 5.0, "{memory} MB after {} ticks, {twice} after {}", 2 * PIECE, 4 * PIECE);
}

/// `cargo test --features pt326/live -p pt326 -p pt326-lab-browser --test page a_day -- --ignored --nocapture`
#[test]
#[ignore = "takes some minutes"]
fn what_a_day_takes() {
    let (packed, text, memory) = kept(DAY);
    println!(
        "24 h, {DAY} ticks: {:.1} MB packed, {:.1} MB as text; the page's thread uses {memory:.1} MB",
        packed / 1e6,
        text / 1e6
    );
}
