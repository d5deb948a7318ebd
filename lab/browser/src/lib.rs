//! A headless Chromium, driven by its WebDriver: as much of a client as tests of one page need. WebDriver is HTTP with JSON in it
//! (w3.org/TR/webdriver), to a program on this machine.

pub mod bridge;
pub mod port;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};
use base64::Engine;
use serde_json::{Value, json};

/// How long a script may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// Where lab.html lies that is tested: `LAB_PAGE`, or where `cargo lab` puts it.
///
/// # Panics
/// There is none.
pub fn page() -> PathBuf {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../lab.html");
    let page = std::env::var_os("LAB_PAGE").map_or(default, PathBuf::from);
    page.canonicalize()
        .unwrap_or_else(|error| panic!("{}: {error}; write it with `cargo lab`", page.display()))
}

/// The letters of a page, the same on every machine.
#[derive(Clone, Copy, Debug)]
pub enum Font {
    /// DejaVu Sans, the only one of a new Debian (package fonts-dejavu-core).
    Wide,
    /// Liberation Sans, as wide as Arial and Helvetica (package fonts-liberation).
    Narrow,
}

impl Font {
    fn settings(self) -> &'static str {
        match self {
            Self::Wide => concat!(env!("CARGO_MANIFEST_DIR"), "/fonts/wide.conf"),
            Self::Narrow => concat!(env!("CARGO_MANIFEST_DIR"), "/fonts/narrow.conf"),
        }
    }
}

/// A browser with one page. It ends with the value.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
}

impl Browser {
    /// Starts one with narrow letters.
    ///
    /// # Errors
    /// chromedriver or chromium is not there (Debian: packages chromium-driver and chromium), or does not start.
    pub fn start() -> anyhow::Result<Self> {
        Self::start_with(Font::Narrow)
    }

    /// Starts one with the letters of `font`.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_with(font: Font) -> anyhow::Result<Self> {
        // It chooses its port by itself: one that was free a moment ago may be another test's by now.
        // A browser that is shared lives as long as the tests: its group ends when nobody holds the other end of its input.
        let driver = Command::new("sh")
            .args(["-c", "chromedriver --port=0 & cat >/dev/null; kill 0"])
            .process_group(0)
            .env("FONTCONFIG_FILE", font.settings())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .context("sh can't be run")?;
        let mut browser = Self { driver, port: 0, session: String::new() };
        browser.port = browser.told_port()?;
        let arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"];
        let options = json!({ "args": arguments });
        let wanted = json!({ "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": { "browser": "ALL" } });
        let session =
            browser.ask("POST", "/session", &json!({ "capabilities": { "alwaysMatch": wanted } }))?;
        browser.session = format!("/session/{}", session["sessionId"].as_str().context("no session")?);
        let timeouts = json!({ "script": PATIENCE.as_millis() as u64 });
        browser.order("/timeouts", &timeouts)?;
        Ok(browser)
    }

    /// The port that it listens at, which it tells when it does. The rest of what it says stays in the pipe.
    fn told_port(&mut self) -> anyhow::Result<u16> {
        let said = BufReader::new(self.driver.stdout.as_mut().context("no pipe")?);
        for line in said.lines() {
            if let Some((_, port)) = line?.split_once("started successfully on port ") {
                return port.trim_end_matches('.').parse().context("chromedriver tells no port");
            }
        }
        bail!("chromedriver has told no port: install chromium-driver")
    }

    /// Opens an address and waits until the page has loaded, and its modules run (begin.js).
    ///
    /// # Errors
    /// Those of the driver.
    pub fn open(&self, address: &str) -> anyhow::Result<()> {
        self.order("/url", &json!({ "url": address }))?;
        let runs = "while (document.getElementById('modules')) await new Promise(requestAnimationFrame);";
        self.run(runs, &[]).map(drop)
    }

    /// Leaves the page, and forgets what it has kept: the next is as in a new browser.
    ///
    /// # Errors
    /// Those of the driver.
    pub fn forget(&self) -> anyhow::Result<()> {
        // A page beside a board asks whether it may be left.
        let kept = "window.lab?.lab.can.clear(); localStorage.clear(); sessionStorage.clear(); for (const { name } of await indexedDB.databases()) indexedDB.deleteDatabase(name);";
        self.run(kept, &[])?;
        self.tools("Emulation.clearDeviceMetricsOverride", json!({}))?;
        self.open("about:blank")
    }

    /// What a script, the body of an asynchronous function, returns; `arguments` are its arguments.
    ///
    /// # Errors
    /// What it throws.
    pub fn run(&self, script: &str, arguments: &[Value]) -> anyhow::Result<Value> {
        let script = format!(
            "const arguments_ = [...arguments].slice(0, -1), done = arguments[arguments.length - 1];\n\
             (async (...args) => {{ {script} }})(...arguments_).then(value => done({{ value }}), error => done({{ error: String(error.stack ?? error) }}));"
        );
        let answer = self.order("/execute/async", &json!({ "script": script, "args": arguments }))?;
        if let Some(error) = answer["error"].as_str() {
            bail!("{error}");
        }
        Ok(answer["value"].clone())
    }

    /// Makes the page so wide and high, px; narrower than any window may be.
    ///
    /// # Errors
    /// Those of the driver.
    pub fn resize(&self, width: u32, height: u32) -> anyhow::Result<()> {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.tools("Emulation.setDeviceMetricsOverride", size).map(drop)
    }

    /// Writes what can be seen as a PNG.
    ///
    /// # Errors
    /// Those of the driver or of the file.
    pub fn picture(&self, file: &Path) -> anyhow::Result<()> {
        let picture = self.tools("Page.captureScreenshot", json!({ "format": "png" }))?;
        let data = picture["data"].as_str().context("no picture")?;
        Ok(std::fs::write(file, base64::engine::general_purpose::STANDARD.decode(data)?)?)
    }

    /// Chooses a file in the input that `selector` finds.
    ///
    /// # Errors
    /// There is no such input.
    pub fn choose(&self, selector: &str, file: &Path) -> anyhow::Result<()> {
        let found = self.order("/element", &json!({ "using": "css selector", "value": selector }))?;
        let id = found.as_object().and_then(|o| o.values().next()?.as_str()).context("no such element")?;
        let text = json!({ "text": file.to_str().context("no UTF-8")? });
        self.order(&format!("/element/{id}/value"), &text).map(drop)
    }

    /// What stands in the console since this was asked last: warnings and errors of scripts, and requests that failed.
    ///
    /// # Errors
    /// Those of the driver.
    pub fn complaints(&self) -> anyhow::Result<Vec<String>> {
        let log = self.order("/se/log", &json!({ "type": "browser" }))?;
        Ok(log.as_array().into_iter().flatten().map(|entry| entry["message"].to_string()).collect())
    }

    /// MB of the page's own thread that are in use, once nothing more can be collected.
    ///
    /// # Errors
    /// Those of the driver.
    pub fn memory(&self) -> anyhow::Result<f64> {
        self.tools("HeapProfiler.collectGarbage", json!({}))?;
        let used = self.tools("Runtime.getHeapUsage", json!({}))?;
        let bytes = |of: &str| used[of].as_f64().unwrap_or(0.0);
        Ok((bytes("usedSize") + bytes("backingStorageSize")) / 1e6)
    }

    fn tools(&self, command: &str, parameters: Value) -> anyhow::Result<Value> {
        self.order("/goog/cdp/execute", &json!({ "cmd": command, "params": parameters }))
    }

    fn order(&self, path: &str, body: &Value) -> anyhow::Result<Value> {
        self.ask("POST", &format!("{}{path}", self.session), body)
    }

    fn ask(&self, method: &str, path: &str, body: &Value) -> anyhow::Result<Value> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port))?;
        let body = body.to_string();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
            self.port,
            body.len()
        )?;
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        let mut line = String::new();
        while reader.read_line(&mut line)? > 0 && line.trim() != "" {
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse()?;
            }
            line.clear();
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer)?;
        let mut answer: Value = serde_json::from_slice(&answer)?;
        let value = answer["value"].take();
        match value["error"].as_str() {
            Some(error) if value.get("message").is_some() => bail!("{error}: {}", value["message"]),
            _ => Ok(value),
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.ask("DELETE", &self.session, &json!({}));
        drop(self.driver.stdin.take());
        let _ = self.driver.wait();
    }
}
