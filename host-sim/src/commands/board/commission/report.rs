//! The report of a commissioning, for the file: what was done, what was left out, what the board said, which settings are its own.

use std::fmt::Write;

use fdi_core::Config;
use firmware_logic::settings::schema::{Name, Valued};

use pt326_host::record::report::escape;

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// As it should.
    Done,
    /// Nobody wanted it.
    LeftOut,
    /// Otherwise.
    Failed,
}

impl Outcome {
    fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::LeftOut => "left out",
            Self::Failed => "FAILED",
        }
    }
}

/// A step.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// Its title.
    pub(super) title: &'static str,
    /// How it ended.
    pub(super) outcome: Outcome,
    /// What was said in it.
    pub(super) lines: Vec<String>,
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:56rem;margin:2rem auto;padding:0 1rem;color:#1a1f26;background:#fff}\
h1,h2{line-height:1.2}table{border-collapse:collapse}td{padding:.2rem 1.2rem .2rem 0;vertical-align:top}\
pre{font:13px/1.45 ui-monospace,monospace;background:#f4f5f7;padding:.8rem;overflow-x:auto;white-space:pre-wrap}\
.FAILED{color:#b00020;font-weight:600}@media print{pre{background:none;border:1px solid #ccc}}";

/// The report; `now` are the board's settings, where they could be read in the end.
pub(super) fn html(sections: &[Section], now: Option<&Config>) -> String {
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>Commissioning of a PT-326</title><style>{STYLE}</style>\n<h1>Commissioning of a PT-326</h1>\n<table>"
    );
    for Section { title, outcome, .. } in sections {
        let word = outcome.word();
        let class = word.replace(' ', "-");
        let _ = writeln!(out, "<tr><td>{}<td class=\"{class}\">{word}", escape(title));
    }
    out += "</table>\n";
    for Section { title, lines, .. } in sections {
        let _ = writeln!(out, "<h2>{}</h2>\n<pre>{}</pre>", escape(title), escape(&lines.join("\n")));
    }
    let _ = writeln!(
        out,
        "<h2>Settings that are not the default</h2>\n<pre>{}</pre>",
        escape(&now.map_or("they could not be read".into(), own))
    );
    let wider = |now: &Config| {
        let lines: Vec<String> = Valued::wider_than_default(now).map(|limit| limit.to_string()).collect();
        if lines.is_empty() { "none".into() } else { lines.join("\n") }
    };
    let _ = writeln!(
        out,
        "<h2>Limits that are wider than the default</h2>\n<pre>{}</pre>",
        escape(&now.map_or("they could not be read".into(), wider))
    );
    let _ = writeln!(out, "<p>Written by pt326 {} from what the board said.", env!("CARGO_PKG_VERSION"));
    out
}

/// The settings that differ from the defaults, a line each.
fn own(now: &Config) -> String {
    let usual = Config::default();
    let lines = Name::all(now)
        .filter(|name| !name.same(now, &usual))
        .map(|name| format!("{name} = {}", name.value(now)));
    let lines: Vec<String> = lines.collect();
    if lines.is_empty() { "none".into() } else { lines.join("\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tells_what_was_left_out_and_escapes_what_was_said() {
        let section = |title, outcome, line: &str| Section { title, outcome, lines: vec![line.to_owned()] };
        let mut config = Config::default();
        config.pid.kp = 3.5;
        config.supervisor.signal_timeout.0 = 2.0;
        let said = html(
            &[section("Wires", Outcome::Failed, "T1 <b>"), section("Rest", Outcome::LeftOut, "")],
            Some(&config),
        );
        assert!(html(&[], None).contains("could not be read"));
        for word in [
            "class=\"FAILED\">FAILED",
            "left out",
            "T1 &lt;b&gt;",
            "pid.kp = 3.5 %/degC",
            "default</h2>\n<pre>supervisor.signal_timeout = 2 s</pre>",
        ] {
            assert!(said.contains(word), "{word} in {said}");
        }
    }
}
