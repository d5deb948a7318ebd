//! `pt326 board` as a process of its own, with a terminal or a pipe, beside a board that lives in this one.

use std::fs::OpenOptions;
use std::io::{Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, ChildStdin, Command, ExitCode, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use clap::Parser;
use pt326::commands::Cli;
use serialport::{SerialPort, TTYPort};

/// A machine that is busy needs its time; nothing here takes half of it.
const PATIENCE: Duration = Duration::from_secs(240);

/// This program as `pt326`, for the tests below, which run it in a process of its own: signals, terminals and exit codes are those of
/// a process.
#[test]
#[ignore = "called by the other tests"]
fn pt326() {
    if let Ok(arguments) = std::env::var("PT326_ARGUMENTS") {
        let code = Cli::parse_from(["pt326"].into_iter().chain(arguments.split('\n'))).carry_out();
        let number = (0..=2).find(|number| ExitCode::from(*number) == code);
        std::process::exit(number.map_or(99, i32::from));
    }
}

/// What its standard input is; a terminal takes what it says, too.
pub(crate) enum Input {
    Terminal,
    Pipe(&'static str),
}

/// `pt326 board` under way.
pub(crate) struct Process {
    child: Child,
    said: Arc<Mutex<String>>,
    /// Who reads its pipes.
    collectors: Vec<JoinHandle<()>>,
    /// Both ends of its terminal.
    terminal: Option<(TTYPort, TTYPort)>,
    /// Of a pipe, which stays open until it is closed.
    input: Option<ChildStdin>,
}

impl Process {
    /// Starts `pt326 board ..`.
    pub(crate) fn start(arguments: &[&str], input: Input) -> Self {
        let mut command = Command::new(std::env::current_exe().expect("a name"));
        command.args(["--ignored", "--exact", "process::pt326", "--nocapture", "--quiet"]);
        command.env("PT326_ARGUMENTS", [&["board"], arguments].concat().join("\n"));
        let said = Arc::new(Mutex::new(String::new()));
        let mut terminal = None;
        match input {
            Input::Pipe(_) => {
                command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
            }
            Input::Terminal => {
                let (mut near, far) = TTYPort::pair().expect("a pseudo-terminal");
                let name = far.name().expect("a name");
                stty(&name, &["sane", "ixon"]);
                let end = || OpenOptions::new().read(true).write(true).open(&name).expect("opens");
                command.stdin(end()).stdout(end()).stderr(end());
                near.set_timeout(Duration::ZERO).expect("a terminal");
                terminal = Some((near, far));
            }
        }
        let mut child = command.spawn().expect("starts");
        let mut collectors = Vec::new();
        let pipes = (child.stdout.take(), child.stderr.take());
        if let (Some(stdout), Some(stderr)) = pipes {
            collectors.push(collect(stdout, &said));
            collectors.push(collect(stderr, &said));
        }
        let mut pipe = child.stdin.take();
        if let (Input::Pipe(text), Some(pipe)) = (input, &mut pipe) {
            pipe.write_all(text.as_bytes()).expect("is read");
        }
        Self { child, said, collectors, terminal, input: pipe }
    }

    /// The mode of its terminal.
    pub(crate) fn mode(&self) -> String {
        let (_, far) = self.terminal.as_ref().expect("a terminal");
        stty(&far.name().expect("a name"), &["-a"])
    }

    /// All that it has said so far.
    pub(crate) fn said(&mut self) -> String {
        let mut said = self.said.lock().expect("no panic");
        if let Some((near, _)) = &mut self.terminal {
            let mut bytes = [0; 4096];
            while let Ok(n @ 1..) = near.read(&mut bytes) {
                said.push_str(&String::from_utf8_lossy(&bytes[..n]));
            }
        }
        said.clone()
    }

    /// Waits until it has said this.
    pub(crate) fn until(&mut self, word: &str) {
        self.wait_for(word, |process| process.said().contains(word));
    }

    /// Waits for something else.
    pub(crate) fn wait_for(&mut self, what: &str, mut is_there: impl FnMut(&mut Self) -> bool) {
        let begin = Instant::now();
        while !is_there(self) {
            let (ended, said) = (self.child.try_wait().expect("a process"), self.said());
            // It may have said it with its last words.
            assert!(ended.is_none() || is_there(self), "it ended ({ended:?}) before {what}:\n{said}");
            assert!(begin.elapsed() < PATIENCE, "no {what}:\n{said}");
            thread::yield_now();
        }
    }

    /// Nothing more comes through its pipe.
    pub(crate) fn close_input(&mut self) {
        self.input = None;
    }

    /// Presses keys on its terminal.
    pub(crate) fn press(&mut self, key: &[u8]) {
        let (near, _) = self.terminal.as_mut().expect("a terminal");
        near.write_all(key).expect("is typed");
    }

    /// Sends it a signal, such as `-TERM`.
    pub(crate) fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([name, &self.child.id().to_string()]).status().expect("kill");
        assert!(sent.success());
    }

    /// Its exit code, and all that it has said.
    pub(crate) fn end(&mut self) -> (i32, String) {
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a process") {
                break status;
            }
            let said = self.said(); // a terminal that nobody reads holds it
            assert!(begin.elapsed() < PATIENCE, "it does not end:\n{said}");
            thread::yield_now();
        };
        self.collectors.drain(..).for_each(|collector| collector.join().expect("reads to the end"));
        (status.code().unwrap_or_else(|| -status.signal().unwrap_or(0)), self.said())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn collect(mut from: impl Read + Send + 'static, into: &Arc<Mutex<String>>) -> JoinHandle<()> {
    let into = Arc::clone(into);
    thread::spawn(move || {
        let mut bytes = [0; 1024];
        while let Ok(n @ 1..) = from.read(&mut bytes) {
            into.lock().expect("no panic").push_str(&String::from_utf8_lossy(&bytes[..n]));
        }
    })
}

/// Asks a terminal, or changes it.
fn stty(name: &str, what: &[&str]) -> String {
    let said = Command::new("stty").args(["-F", name]).args(what).output().expect("stty");
    String::from_utf8_lossy(&said.stdout).into_owned()
}
