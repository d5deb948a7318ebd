//! `pt326 live` with several boards, behind pseudo-terminals.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::symlink;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use fdi_core::schema::WORDS;
use firmware_logic::log_line::tick::TickLine;
use firmware_logic::stream::frame;
use serde_json::Value;
use serialport::{SerialPort, TTYPort};

use crate::{arg, command, folder, pt326, text};

/// Ctrl-C: what stops a board.
const STOP: u8 = 3;

/// The board's end of a pseudo-terminal, and the name of the other.
fn port() -> (TTYPort, TTYPort, String) {
    let (mut board, port) = TTYPort::pair().unwrap();
    board.set_timeout(Duration::from_secs(120)).unwrap();
    let name = port.name().unwrap();
    (board, port, name)
}

/// The record of tick 7.
fn tick() -> TickLine {
    let mut words = [0; WORDS];
    words[0] = 7;
    TickLine(words)
}

/// A board that answers and streams one tick; it tells of a stop, and is pulled out then.
fn answers() -> (TTYPort, String, Receiver<u8>) {
    let (mut board, port, name) = port();
    let (tell, told) = channel();
    std::thread::spawn(move || {
        let mut byte = [0];
        let mut line = Vec::new();
        while board.read_exact(&mut byte).is_ok() {
            board.write_all(&byte).unwrap();
            line.extend(byte);
            match byte {
                [STOP] => return tell.send(STOP).unwrap(),
                [0x15] => {}
                [b'\r'] if line.ends_with(b"stream on\r") => {
                    let mut framed = String::from("\nok\r\n> ");
                    frame::write(&tick(), &mut framed).unwrap();
                    board.write_all(framed.as_bytes()).unwrap();
                    continue;
                }
                [b'\r'] => {}
                _ => continue,
            }
            board.write_all(b"\nsetpoint = 36 degC\r\n> ").unwrap();
        }
    });
    (port, name, told)
}

/// A board that heats until it is stopped, as often as it is asked, or one that hears no stop; the stops that it has heard.
fn heats(hears: bool) -> (TTYPort, String, Receiver<u8>) {
    let (mut board, port, name) = port();
    let (tell, told) = channel();
    std::thread::spawn(move || {
        let mut byte = [0];
        while board.read_exact(&mut byte).is_ok() {
            let answer: &[u8] = match byte {
                [STOP] if hears => {
                    let _ = tell.send(STOP);
                    b"^C\r\nstopped\r\n> "
                }
                [b'\r' | 0x15] => b"\nsetpoint = 36 degC\r\n> ",
                [STOP] => b"",
                [echo] => &[echo],
            };
            let _ = board.write_all(answer); // while nobody has it open
        }
    });
    (port, name, told)
}

/// Something that is no board, and never falls silent.
fn babbles() -> (TTYPort, String) {
    let (mut board, port, name) = port();
    std::thread::spawn(move || while board.write_all(b"\x02\xffrubbish\n\x00> ok = ?\r").is_ok() {});
    (port, name)
}

/// `pt326 live`, its address and token; it ends with the value.
struct Served {
    child: Child,
    address: String,
    token: String,
}

impl Served {
    fn start(args: &[&str]) -> Self {
        Self::with_token(args, "")
    }

    /// With a token in the environment, which counts with `--listen` only.
    fn with_token(args: &[&str], token: &str) -> Self {
        let mut live = command(&[&["live", "--port", "0", "--no-open"], args].concat());
        let mut child = live.env("PT326_TOKEN", token).spawn().unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        while !line.contains(" is at http://") {
            line.clear();
            assert!(said.read_line(&mut line).unwrap() > 0, "no address");
        }
        // What it says later is read, too, so that it can say it.
        std::thread::spawn(move || said.lines().map_while(Result::ok).for_each(drop));
        let link = line.trim().split_once("http://").unwrap().1;
        let (address, token) = link.split_once("/?token=").expect("a link with a token");
        Self { child, address: address.into(), token: token.into() }
    }

    fn ask(&self, what: &str) -> Value {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let (address, token) = (&self.address, &self.token);
        let head =
            format!("{what} HTTP/1.1\r\nHost: {address}\r\nX-Lab-Token: {token}\r\nContent-Length: 0\r\n");
        write!(stream, "{head}Connection: close\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        serde_json::from_str(answer.split_once("\r\n\r\n").unwrap().1).expect(&answer)
    }

    /// By the names of the boards, one key of each.
    fn of_each(&self, what: &str, key: &str) -> HashMap<String, Value> {
        let all = self.ask(what);
        let each = all.as_array().unwrap().iter();
        each.map(|one| (one["board"].as_str().unwrap().into(), one[key].clone())).collect()
    }

    /// Waits until a tile is as it should be.
    fn until(&self, wanted: impl Fn(&Value) -> bool) {
        while !self.ask("GET /tiles").as_array().unwrap().iter().any(&wanted) {}
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// One that is well, one that is no board, one that is not plugged in: a stop for all reaches the first at once, and is said of the others not
/// to have reached them. Pulled out, the first says so. There is a log of it alone. Each is plugged in after the start: a program that is
/// started inherits what is open.
#[test]
fn each_board_of_a_wall_keeps_to_its_own_tile() {
    let dir = folder("wall");
    let [well, rubbish, missing, logs] = ["well", "rubbish", "missing", "logs"].map(|name| dir.join(name));
    let boards = [&well, &rubbish, &missing].map(|link| ["--board", arg(link)]).concat();
    let served = Served::start(&[&boards[..], &["--record", arg(&logs)]].concat());
    let (_well, name, stopped) = answers();
    symlink(name, &well).unwrap();
    let (_rubbish, name) = babbles();
    symlink(name, &rubbish).unwrap();
    let says = |board: &str, why: &str| {
        served.until(|tile| {
            tile["board"] == board && tile["why"].as_str().is_some_and(|said| said.contains(why))
        });
    };
    says("missing", "cannot be opened");
    says("rubbish", "no answer");
    served.until(|tile| tile["board"] == "well" && tile["row"].is_array());
    let why = served.of_each("POST /stop", "why");
    assert_eq!(stopped.recv().unwrap(), STOP);
    assert_eq!(why["well"], Value::Null);
    for name in ["rubbish", "missing"] {
        assert!(why[name].as_str().unwrap().starts_with("the stop has NOT reached it"), "{why:?}");
    }
    let gone = |why: &Value| why.as_str().is_some_and(|why| why.contains("has NOT reached the board"));
    while !gone(&served.of_each("POST /stop", "why")["well"]) {}
    served.until(|tile| tile["board"] == "well" && tile["lost"].is_number());
    let files: Vec<_> = std::fs::read_dir(&logs).unwrap().map(|file| file.unwrap().path()).collect();
    let [log] = &files[..] else { panic!("{files:?}") };
    assert!(log.file_name().unwrap().to_str().unwrap().starts_with("well-"), "{log:?}");
    assert_eq!(std::fs::read_to_string(log).unwrap(), format!("{}\n# the port has gone\n", tick()));
}

/// A program that ends leaves no board heating, or says that it may.
#[test]
fn ctrl_c_stops_every_board_and_says_of_each_whether_it_has_said_so() {
    let dir = folder("leaving");
    for (signal, hears, code) in [("-INT", [true, true], 0), ("-TERM", [true, false], 2)] {
        let links = ["one", "two"].map(|name| dir.join(format!("{name}{code}")));
        let mut served = Served::start(&["--board", arg(&links[0]), "--board", arg(&links[1])]);
        let boards: Vec<_> = std::iter::zip(hears, &links)
            .map(|(hears, link)| {
                let (port, name, stopped) = heats(hears);
                symlink(name, link).unwrap();
                (port, stopped)
            })
            .collect();
        served.until(|_| served.of_each("GET /tiles", "why").values().all(Value::is_null));
        let pid = served.child.id().to_string();
        assert!(Command::new("kill").args([signal, &pid]).status().unwrap().success());
        let mut said = String::new();
        served.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(served.child.wait().unwrap().code(), Some(code), "{said}");
        for ((hears, (_, stopped)), link) in hears.into_iter().zip(&boards).zip(&links) {
            let name = link.file_name().unwrap().to_str().unwrap();
            let told = match hears {
                true => format!("{name}: the board says that its heater is off\n"),
                false => format!("{name}: the board does NOT say that its heater is off: "),
            };
            assert!(said.contains(&told), "{told}: {said}");
            assert_eq!(stopped.try_recv().is_ok(), hears);
        }
    }
}

/// It may heat already, and nobody has asked it yet.
#[test]
fn ctrl_c_while_the_only_board_is_being_opened_is_no_word_of_its_heater() {
    let (mut board, _open, name) = port();
    let mut child =
        command(&["live", "--port", "0", "--board", &name]).stderr(Stdio::piped()).spawn().unwrap();
    // The first byte that it asks: the board never answers.
    board.read_exact(&mut [0]).unwrap();
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(said.contains("the board does NOT say that its heater is off"), "{said}");
    assert_eq!(child.wait().unwrap().code(), Some(2), "{said}");
}

#[test]
fn boards_of_a_wall_are_told_apart() {
    for (boards, why) in [
        (&["--board", "a=/dev/x", "--board", "a=/dev/y"][..], "two boards are called a"),
        (&["--board", "a=/dev/x", "--board", "b=/dev/x"], "/dev/x is given twice"),
        (&["--board", "a=/dev/x", "--board"], "several boards need their ports"),
        (&["--board", "a/b=/dev/x"], "expected letters, digits, - and _"),
        (&["--board", "a="], "names no port, expected such as a=/dev/ttyACM0"),
        (&["--board", "a=/dev/x", "--rigs", "2"], "cannot be used with"),
        (&["--rigs", "65"], "1..=64"),
        (&["--record", "x"], "--board"),
    ] {
        let out = pt326(&[&["live", "--port", "0"], boards].concat());
        let error = text(&out.stderr);
        assert!(out.status.code() == Some(2) && error.contains(why), "{boards:?}: {error}");
    }
}

/// Every user of a machine can read its command lines.
#[test]
fn a_token_comes_from_a_file_or_from_the_environment() {
    let dir = folder("token");
    let file = dir.join("token");
    std::fs::write(&file, "0123456789abcdefFile\n").unwrap();
    let listen = ["--listen", "127.0.0.1"];
    let named =
        Served::with_token(&[&listen[..], &["--token-file", arg(&file)]].concat(), "0123456789abcdefEnv");
    assert_eq!(named.token, "0123456789abcdefFile");
    assert_eq!(Served::with_token(&listen, "0123456789abcdefEnv").token, "0123456789abcdefEnv");
    let refused = |more: &[&str]| {
        let output = command(&[&["live"], more].concat()).env_remove("PT326_TOKEN").output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        text(&output.stderr)
    };
    assert!(refused(&listen).contains("put one into PT326_TOKEN, or name a file by --token-file"));
    assert!(refused(&["--listen", "127.0.0.1", "--token-file", "nowhere"]).contains("can't read nowhere"));
}

#[test]
fn simulated_rigs_have_no_log_of_a_board() {
    let output = pt326(&["live", "--rigs", "2", "--record", "logs"]);
    assert_eq!(output.status.code(), Some(2));
    let said = text(&output.stderr);
    assert!(said.contains("cannot be used with") && said.contains("--record <FOLDER>"), "{said}");
}
