//! The unmodified image on a modelled board, for tests of pages that talk to it.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};

/// The virtual board behind a pseudo-terminal. `LAB_BOARD` names the program; without it, that of the workspace's debug build.
pub(crate) struct Board {
    process: Child,
    /// Name of its port.
    pub(crate) link: String,
}

impl Board {
    /// Powers it up; `more` are arguments of the program.
    pub(crate) fn start(more: &[&str]) -> Self {
        let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/debug/virtual-board");
        let program = std::env::var_os("LAB_BOARD").unwrap_or_else(|| default.into());
        let link = std::env::temp_dir()
            .join(format!("pt326-lab-{}-{:?}", std::process::id(), std::thread::current().id()))
            .display()
            .to_string();
        let mut process = Command::new(program)
            .args(["--pty", &link])
            .args(more)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("virtual-board, built with `cargo build -p virtual-board`");
        let mut line = String::new();
        BufReader::new(process.stdout.as_mut().expect("its output")).read_line(&mut line).expect("a line");
        Self { process, link }
    }

    /// Something happens at the desk.
    pub(crate) fn desk(&mut self, line: &str) {
        writeln!(self.process.stdin.as_mut().expect("its input"), "{line}").expect("it lives");
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
