//! Actions for scripts: one question, one answer, and whether it is yes.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};

use super::Person;
use crate::board::{Heard, STOP, Session, check_ended, settings, take_lines};
use crate::commands::terminal::{print, progress};
use crate::settings::{commented_toml_of, read};

/// No stage of a check takes as long.
const SILENCE: Duration = Duration::from_secs(600);

/// Runs the self-test and shows how it goes; whether it has passed.
pub(super) fn check(mut session: Session) -> anyhow::Result<bool> {
    let mut told = session.order("check")?;
    let mut last = Instant::now();
    loop {
        ensure!(last.elapsed() < SILENCE, "nothing of the check for {} s: see `status`", SILENCE.as_secs());
        for line in take_lines(&mut told) {
            print(&format!("{line}\n"))?;
            last = Instant::now();
            if let Some(passed) = check_ended(&line) {
                return Ok(passed);
            }
        }
        let heard = session.hear().context("the port has gone; the board ends the check by itself")?;
        let texts = heard.into_iter().filter_map(|heard| match heard {
            Heard::Text(text) => Some(text.replace('\r', "")),
            _ => None,
        });
        told.extend(texts);
    }
}

/// Prints how it is; whether nothing is latched.
pub(super) fn status(mut session: Session) -> anyhow::Result<bool> {
    let answer = session.order("status")?;
    print(&answer)?;
    Ok(!answer.starts_with("mode tripped") && !answer.contains("heater locked out"))
}

/// Prints what went wrong; whether nothing did.
pub(super) fn faults(mut session: Session) -> anyhow::Result<bool> {
    let answer = session.order("faults")?;
    print(&answer)?;
    Ok(answer.trim() == "none")
}

/// A question waits for its answer.
static ASKING: AtomicBool = AtomicBool::new(false);

/// Somebody at a terminal, or a pipe that answers for him.
struct Terminal;

impl Person for Terminal {
    fn tell(&mut self, line: &str) -> anyhow::Result<()> {
        print(&format!("{line}\n"))
    }

    fn ask(&mut self, question: &str) -> anyhow::Result<Option<String>> {
        print(question)?;
        let mut line = String::new();
        ASKING.store(true, Ordering::Relaxed);
        let read = std::io::stdin().read_line(&mut line);
        ASKING.store(false, Ordering::Relaxed);
        let ended = read? == 0;
        if ended || !std::io::stdin().is_terminal() {
            print(&format!("{}\n", line.trim()))?; // nobody has typed it here
        }
        Ok((!ended).then_some(line))
    }
}

/// Leads through the commissioning, and writes its report; whether every step that was asked for went well.
pub(super) fn commission(mut session: Session, file: &Path) -> anyhow::Result<bool> {
    let (mut other_hand, gate) = (session.other_hand()?, session.gate());
    ctrlc::set_handler(move || {
        let sent = gate.close(|| other_hand.write_all(&[STOP]).and_then(|()| other_hand.flush()));
        let told = match sent {
            Ok(()) => "stopped",
            Err(_) => "NOT stopped: the port has gone. The board's button stops it.",
        };
        let _ = writeln!(std::io::stderr(), "\n{told}"); // a terminal that was closed shows nothing
        // A question would wait on; else the step ends by the stop, and what was done is written.
        if ASKING.load(Ordering::Relaxed) {
            std::process::exit(2);
        }
    })?;
    let done = super::commission(&mut session, &mut Terminal);
    let log = file.with_extension("log");
    write(file, &done.report)?;
    write(&log, &done.log)?;
    print(&format!("\nwritten to {}, and the board's log to {}\n", file.display(), log.display()))?;
    match done.error {
        Some(error) => Err(error),
        None => Ok(done.passed),
    }
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))
}

/// Runs the paper's experiment on the board by itself, and writes what was found; whether all is as it should be.
pub(super) fn verify(mut session: Session, file: &Path, seconds: Option<f64>) -> anyhow::Result<bool> {
    let bar = progress(0, "ticks");
    let found = super::verify(&mut session, seconds, |ticks, of| {
        bar.set_length(of);
        bar.set_position(ticks);
    })?;
    bar.finish_and_clear();
    let log = file.with_extension("log");
    write(file, &found.report)?;
    write(&log, &found.log)?;
    print(&format!(
        "{}\nwritten to {}, and its stream to {}\n",
        found.report,
        file.display(),
        log.display()
    ))?;
    Ok(found.passed)
}

/// Writes the board's settings into a file.
pub(super) fn save(mut session: Session, name: &str, file: &Path) -> anyhow::Result<bool> {
    let head =
        format!("# The settings of the board on {name}: `pt326 board settings load` gives them back.\n");
    let text = head + &commented_toml_of(&settings::read(&mut session)?);
    write(file, &text)?;
    print(&format!("written to {}\n", file.display()))?;
    Ok(true)
}

/// Gives the board the settings of a file, and has it keep them.
pub(super) fn load(mut session: Session, file: &Path) -> anyhow::Result<bool> {
    let changed = settings::write(&mut session, &read(Some(file))?)?;
    for name in &changed {
        print(&session.order(&format!("get {name}"))?)?;
    }
    if let Err(error) = session.order("save") {
        bail!("{} settings are in force until the next start, and not kept: {error:#}", changed.len());
    }
    print(&format!("{} settings changed, all kept\n", changed.len()))?;
    Ok(true)
}
