//! `pt326 live` itself, for tests of its pages.
#![allow(dead_code)] // each of them uses a part of it

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use pt326_lab_browser::Browser;
use serde_json::Value;

/// What scripts of these tests use.
pub(crate) const HELPERS: &str = r##"
const $ = (selector) => document.querySelector(selector);
const frame = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
const until = async (what) => { while (!(await what())) await frame(); };
const click = (selector) => $(selector).dispatchEvent(new MouseEvent("click", { bubbles: true }));
"##;

/// `pt326 live`; it ends with the value.
pub(crate) struct Server {
    process: Child,
    /// Address of its page.
    pub(crate) address: String,
}

/// What those must know who open a page that others can reach, by `--listen`.
pub(crate) const TOKEN: &str = "0123456789abcdef";

impl Server {
    /// `LAB_LIVE` names the program, built with the feature `live`; without it, that of the workspace's debug build.
    pub(crate) fn start(port: u16) -> Self {
        Self::with(port, &[])
    }

    /// With more arguments.
    pub(crate) fn with(port: u16, more: &[&str]) -> Self {
        let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/debug/pt326");
        let program = std::env::var_os("LAB_LIVE").unwrap_or_else(|| default.into());
        let mut process = Command::new(program)
            .args(["live", "--no-open", "--port", &port.to_string()])
            .args(more)
            .env("PT326_TOKEN", TOKEN)
            .stdout(Stdio::piped())
            .spawn()
            .expect("pt326, built with `cargo build -p pt326 --features live`");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
        let address = line.trim().split_once(" is at ").expect(&line).1.to_owned();
        Self { process, address }
    }

    pub(crate) fn port(&self) -> u16 {
        self.address
            .trim_end_matches('/')
            .rsplit(':')
            .next()
            .and_then(|port| port.parse().ok())
            .expect("a port")
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// What a script says that may use the helpers.
pub(crate) fn on(browser: &Browser, script: &str) -> Value {
    browser.run(&format!("{HELPERS}{script}"), &[]).unwrap_or_else(|error| panic!("{error:#}"))
}
