//! Actions for scripts: one question, one answer, and whether it is yes.

use std::fs::OpenOptions;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use fdi_core::Mode;
use firmware_logic::console::ANSWER;

use super::attend::Attendant;
use crate::commands::terminal::{print, progress};
use pt326_host::board::{Heard, Session, check_ended, refusal, settings, take_lines};
use pt326_host::settings::{commented_toml_of, read};

/// No stage of a check takes as long.
const SILENCE: Duration = Duration::from_secs(600);
/// Most characters of a check: a dozen stages, and what it finds, which fit into an answer several times.
const MOST_TOLD: usize = 4 * ANSWER;

/// Runs the self-test and shows how it goes; whether it has passed. Whatever else ends it stops the board.
pub(super) fn check(mut session: Session) -> anyhow::Result<bool> {
    let attendant = Attendant::new(&session)?;
    attendant.greet()?;
    let answer = session.ask("check").map_err(|error| session.stopped_after(&error))?;
    if let Some(error) = refusal(&answer) {
        bail!("the board says to `check`: {error}"); // which may be heating for another reason
    }
    follow_check(&mut session, answer).map_err(|error| session.stopped_after(&error))
}

fn follow_check(session: &mut Session, mut told: String) -> anyhow::Result<bool> {
    let (mut last, mut count) = (Instant::now(), 0);
    loop {
        ensure!(last.elapsed() < SILENCE, "nothing of the check for {} s: see `status`", SILENCE.as_secs());
        for line in take_lines(&mut told) {
            print(&format!("{line}\n"))?;
            (last, count) = (Instant::now(), count + line.len());
            ensure!(count < MOST_TOLD, "cut after {count} characters: no check says as much");
            if let Some(passed) = check_ended(&line) {
                session.gate().check()?; // whoever has stopped it has no answer
                return Ok(passed);
            }
        }
        for heard in session.hear_alive()? {
            if let Heard::Text(text) = heard {
                told += &text;
            }
        }
    }
}

/// Prints how it is; whether nothing is latched.
pub(super) fn status(mut session: Session) -> anyhow::Result<bool> {
    let answer = session.order("status")?;
    print(&answer)?;
    is_well(&answer)
}

/// Whether nothing is latched, by the answer to `status`, which tells the mode in its first line or, of a simulated board, in its second.
fn is_well(answer: &str) -> anyhow::Result<bool> {
    let told = answer.lines().find_map(|line| line.strip_prefix("mode "));
    let mode = told.and_then(|told| told.split([' ', ',', ':']).next());
    let Some(mode) = mode.filter(|mode| Mode::NAMES.contains(mode)) else {
        bail!(
            "no answer to `status` as a board gives it, expected `mode` and one of {}",
            Mode::NAMES.join(", ")
        );
    };
    Ok(mode != "tripped" && !answer.contains("heater locked out"))
}

/// Prints what went wrong; whether nothing did.
pub(super) fn faults(mut session: Session) -> anyhow::Result<bool> {
    let answer = session.order("faults")?;
    print(&answer)?;
    Ok(answer.trim() == "none")
}

/// Leads through the commissioning, and writes its report; whether every step that was asked for went well.
pub(super) fn commission(mut session: Session, file: &Path) -> anyhow::Result<bool> {
    let log = file.with_extension("log");
    can_be_written(&[file, &log])?;
    let mut attendant = Attendant::new(&session)?;
    attendant.greet()?;
    let done = super::commission(&mut session, &mut attendant);
    write(file, &done.report)?;
    write(&log, &done.log)?;
    if done.error.is_none() {
        print(&format!("\nwritten to {}, and the board's log to {}\n", file.display(), log.display()))?;
    }
    match done.error {
        Some(error) => Err(error),
        None => Ok(done.passed),
    }
}

/// Before anything heats or takes its time: what is found out then must not be lost for want of a folder.
fn can_be_written(files: &[&Path]) -> anyhow::Result<()> {
    files.iter().try_for_each(|path| {
        let opened = OpenOptions::new().write(true).create(true).truncate(false).open(path);
        opened.map(drop).with_context(|| format!("{} cannot be written", path.display()))
    })
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))
}

/// Runs the paper's experiment on the board by itself, and writes what was found; whether all is as it should be.
pub(super) fn verify(mut session: Session, file: &Path, seconds: Option<f64>) -> anyhow::Result<bool> {
    let log = file.with_extension("log");
    can_be_written(&[file, &log])?;
    let attendant = Attendant::new(&session)?;
    attendant.greet()?;
    let bar = progress(0, "ticks");
    let found = super::verify(&mut session, seconds, |ticks, of| {
        bar.set_length(of);
        bar.set_position(ticks);
    });
    bar.finish_and_clear();
    let found = found.map_err(|error| match session.gate().is_closed() {
        true => session.stopped_after(&error),
        false => error,
    })?;
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

/// Gives the board the settings of a file, and has it keep them, or leaves it as it was.
pub(super) fn load(mut session: Session, file: &Path) -> anyhow::Result<bool> {
    let wanted = read(Some(file))?;
    let status = session.order("status")?;
    ensure!(
        settings::can_be_kept(&status),
        "{}: settings are loaded with the heater off, without a check or a simulation, expected `stop` first; nothing was changed",
        status.lines().next().unwrap_or_default()
    );
    let before = settings::read(&mut session)?;
    let written = settings::write(&mut session, &wanted);
    let kept = written.and_then(|changed| session.order("save").map(|_| changed));
    let changed = kept.or_else(|error| {
        settings::write(&mut session, &before).with_context(|| {
            format!("{error:#}; some settings are in force until the next start, and not kept")
        })?;
        Err(error.context("nothing was changed"))
    })?;
    for name in &changed {
        print(&session.order(&format!("get {name}"))?)?;
    }
    print(&format!("{} settings changed, all kept\n", changed.len()))?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_mode_that_there_is_is_well() {
        for answer in
            ["mode off\nT1 22 degC\n", "mode off, check under way\n", "SIMULATED: x\nmode tune: at rest\n"]
        {
            assert!(is_well(answer).unwrap(), "{answer}");
        }
        for answer in ["mode tripped (T1 is above the limit)\n", "mode off, heater locked out: the clock\n"] {
            assert!(!is_well(answer).unwrap(), "{answer}");
        }
        for answer in ["", "\n", "mode", "mode \n", "mode RED\n", "RED\n", "no tick yet\n"] {
            let error = is_well(answer).unwrap_err().to_string();
            assert!(error.contains("expected `mode` and one of off, settle"), "{answer}: {error}");
        }
    }
}
