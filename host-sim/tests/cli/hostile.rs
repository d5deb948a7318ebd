//! What claims to be a board and is none: nothing that it says reaches the terminal as anything but text, and nothing that it says goes on
//! for ever.

use std::io::{Read, Write};
use std::thread;
use std::time::Duration;

use firmware_logic::stream::frame;
use serialport::{SerialPort, TTYPort};

use super::{arg, folder, pt326, pt326_reading, text};

/// Escapes, a window's title, the clipboard (OSC 52), C1 controls as bytes and as letters, a bell, an override of direction.
const POISON: &[u8] =
    b"\x1b[2J\x1b]0;x\x07\x1b]52;c;cm0gLXJm\x07\x9b31m\xc2\x9b2J\x90q\x9c\x08\x0b\x0c\x7f\r\xe2\x80\xae|";

/// Answers each line by `answer`, and greets with a prompt; its name.
fn board(answer: impl Fn(&str) -> Vec<u8> + Send + 'static) -> (String, TTYPort) {
    let (mut near, far) = TTYPort::pair().expect("a pseudo-terminal");
    near.set_timeout(Duration::from_secs(20)).expect("a terminal");
    let name = far.name().expect("a name");
    thread::spawn(move || {
        let (mut line, mut byte) = (String::new(), [0]);
        while near.read_exact(&mut byte).is_ok() {
            let said = match byte[0] {
                0x15 => b"\r\n> ".to_vec(),
                b'\r' => {
                    let said = [b"\r\n", &*answer(&line), b"\r\n> "].concat();
                    line.clear();
                    said
                }
                typed => {
                    line.push(typed.into());
                    vec![typed]
                }
            };
            if near.write_all(&said).is_err() {
                return;
            }
        }
    });
    (name, far) // the far end stays open as long as that
}

/// All that it printed, which must be text and no more.
fn harmless(arguments: &[&str], input: &str) -> (Option<i32>, String) {
    let output = match input {
        "" => pt326(arguments),
        input => pt326_reading(arguments, input),
    };
    let said = text(&output.stdout) + &text(&output.stderr);
    let bad = said.chars().find(|c| !matches!(c, '\n' | '\t' | ' '..='~'));
    assert_eq!(bad, None, "{said:?}");
    assert!(said.len() < 100_000, "{} bytes", said.len());
    (output.status.code(), said)
}

fn poisoned(before: &str) -> Vec<u8> {
    [before.as_bytes(), POISON].concat()
}

#[test]
fn nothing_that_a_board_says_is_obeyed_by_a_terminal() {
    let (name, _far) = board(|line| poisoned(&format!("{line}: ")));
    let (code, said) = harmless(&["board", &name, "status"], "");
    assert!(code == Some(2) && said.contains("\\u{1b}]52;c;cm0gLXJm\\u{7}"), "{code:?} {said}");
    assert!(said.contains("\\u{9b}31m"), "{said}");
    harmless(&["board", &name, "faults"], "");

    // What it refuses, what it calls its settings, what it streams, whole and with false sums.
    let (name, _far) = board(|line| {
        let framed = |text: &str| {
            let mut frame = String::new();
            frame::write(&text, &mut frame).expect("a string");
            frame
        };
        let evil = String::from_utf8_lossy(POISON).replace('\r', "");
        let mut said = poisoned("error: ");
        said.extend(framed(&evil).bytes().chain(framed("trip: \x1b[31m").replace("trip", "trap").bytes()));
        if line.starts_with("get") {
            said.extend(b"\r\npid.kp = \x1b[5m2 x\r\n");
        }
        said
    });
    let (code, said) = harmless(&["board", &name, "check"], "");
    assert!(code == Some(2) && said.contains("the board says to `check`: \\u{1b}[2J"), "{code:?} {said}");
    let (code, said) = harmless(&["board", &name], "status\nwait 0.2\nset x 1\n");
    assert!(code == Some(2) && said.contains("`status` was refused"), "{code:?} {said}");
    let dir = folder("hostile");
    let (code, _) = harmless(&["board", &name, "settings", "save", arg(&dir.join("evil.toml"))], "");
    assert_eq!(code, Some(2));
}

#[test]
fn a_report_holds_text_only() {
    let (name, _far) = board(|line| poisoned(&format!("mode tripped {line} ")));
    let dir = folder("hostile-report");
    let file = dir.join("report.html");
    let (code, _) = harmless(&["board", &name, "commission", arg(&file)], "x\nn\n");
    assert_eq!(code, Some(2));
    for file in [file.with_extension("log"), file] {
        let written = std::fs::read_to_string(file).expect("a report");
        assert!(!written.chars().any(|c| c.is_control() && c != '\n'), "{written:?}");
    }
}

#[test]
fn an_answer_without_end_is_cut_and_told() {
    let floods: [fn() -> Vec<u8>; 3] = [
        || vec![b'x'; 4 << 20],
        || b"mode off\r\n".repeat(400_000),
        || b"\x02tick 1 2 3*00000000\r\n".repeat(200_000),
    ];
    for flood in floods {
        let (name, _far) = board(move |_| flood());
        let (code, said) = harmless(&["board", &name, "status"], "");
        assert!(code == Some(2) && said.contains("cut after"), "{code:?} {said}");
    }
    // A check that tells and tells.
    for flood in [floods[0], floods[1]] {
        let (name, _far) = board(move |line| match line {
            "check" => [&b"ok\r\n> "[..], &flood()].concat(),
            _ => b"stopped".to_vec(),
        });
        let (code, said) = harmless(&["board", &name, "check"], "");
        assert!(code == Some(2) && said.contains("cut after"), "{code:?} {said}");
    }
}
