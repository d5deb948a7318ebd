//! The board behind a serial port, against a clock that runs: what programs see that open the port.

use std::io::Read;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use virtual_board::board::load;
use virtual_board::live::Live;
use virtual_board::port::Port;
use virtual_board::time::SECOND;

/// A board that lives in a thread of its own, 20 times as fast as the clock on the wall.
pub(crate) struct LiveBoard {
    desk: Sender<String>,
    told: Receiver<String>,
    /// Name of its port.
    pub(crate) name: String,
    thread: Option<JoinHandle<()>>,
}

impl LiveBoard {
    /// Powers it up.
    pub(crate) fn new() -> Self {
        let (desk, lines) = mpsc::channel();
        let (tell, told) = mpsc::channel();
        let thread = thread::spawn(move || {
            let link = std::env::temp_dir().join(format!(
                "pt326-{:?}-{}",
                thread::current().id(),
                std::process::id()
            ));
            let port = Port::new(Some(&link)).expect("a pseudo-terminal");
            let name = port.name();
            let mut live = Live::new(load(None).expect("an image"), port, 20.0).expect("powers up");
            // What comes while the board starts is lost, as on any board.
            live.scene.board.run_for(SECOND).expect("starts");
            tell.send(name).expect("somebody waits");
            live.run(&lines, |text| drop(tell.send(text.to_owned()))).expect("lives");
        });
        let name = told.recv().expect("a port");
        Self { desk, told, name, thread: Some(thread) }
    }

    /// Something happens at the desk, and has happened when this returns: what cannot happen is complained about after it.
    pub(crate) fn desk(&self, line: &str) {
        for line in [line, "nothing"] {
            self.desk.send(line.to_owned()).expect("it lives");
        }
        // A busy machine loses time, and says so: the board does not mind.
        let mut told = self.told.iter().filter(|text| !text.contains("too slow"));
        let told = told.next().expect("it lives");
        assert!(told.contains("\"nothing\" given, expected one of"), "{told}");
    }
}

impl LiveBoard {
    /// What the heater is given now, %.
    pub(crate) fn heater(&self) -> f64 {
        self.desk.send("heater".to_owned()).expect("it lives");
        let power = self.told.iter().find_map(|text| text.strip_prefix("heater ")?.parse().ok());
        power.expect("it lives")
    }
}

impl Drop for LiveBoard {
    fn drop(&mut self) {
        let _ = self.desk.send("quit".to_owned());
        let failed = self.thread.take().is_some_and(|thread| thread.join().is_err());
        assert!(!failed || thread::panicking(), "the board's thread failed");
    }
}

fn open(name: &str) -> Box<dyn serialport::SerialPort> {
    serialport::new(name, 115_200).timeout(Duration::from_secs(20)).open().expect("opens")
}

/// Types a line, and reads up to the prompt.
fn answer(port: &mut dyn serialport::SerialPort, line: &str) -> String {
    port.write_all(format!("{line}\r").as_bytes()).expect("writes");
    let mut text = String::new();
    let mut byte = [0];
    while !text.ends_with("\n> ") {
        port.read_exact(&mut byte).expect("reads");
        text.push(byte[0].into());
    }
    text
}

#[test]
fn programs_open_the_port_and_are_hung_up_on_when_it_is_unplugged() {
    let board = LiveBoard::new();
    let mut port = open(&board.name);
    assert!(answer(&mut *port, "status").contains("mode off"));
    board.desk("unplug");
    let error = port.read_exact(&mut [0]).expect_err("nothing is there");
    assert_eq!(error.kind(), std::io::ErrorKind::BrokenPipe);
    board.desk("plug");
    let mut port = open(&board.name);
    assert!(answer(&mut *port, "faults").contains("none"));
}

#[test]
fn what_happens_at_the_desk_happens_to_the_board() {
    let board = LiveBoard::new();
    let mut port = open(&board.name);
    board.desk("interlock open");
    answer(&mut *port, "set supervisor.check_before_arming false");
    assert!(answer(&mut *port, "arm").contains("interlock on the break input is open"));
    board.desk("wire open t1");
    answer(&mut *port, "baseline"); // a tick or two
    let open = (0..50).any(|_| answer(&mut *port, "status").contains("(Open)"));
    assert!(open, "a tick has seen it");
}
