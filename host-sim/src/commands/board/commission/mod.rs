//! `pt326 board commission`: from a board that is wired to a rig that is watched, step by step. The board does each step, and its
//! console can do each alone; what leads here only asks, waits and writes down. Nothing heats without a yes.

mod guide;
mod report;

use std::io::{Read, Write};

use anyhow::ensure;
use fdi_core::Config;
use firmware_logic::log_line::tick::TickLine;

use crate::board::{Session, settings};
use crate::commands::replay::isolability;
use crate::isolability::{Question, output};
use guide::Guide;
pub use guide::Person;
use report::Outcome;

/// Times within which faults are to be told apart, s; so long it watches after it has learnt, and a little more.
const HORIZONS: [f64; 3] = [1.0, 10.0, 60.0];
const WATCHED: f64 = 120.0;
/// Ticks after which a thermistor that is at rest has been so for long enough.
const REST: usize = 80;
/// Modes as the log numbers them, and the readiness of the second diagnosis.
const MONITOR: u32 = 3;
const TRIPPED: u32 = 4;
const ARMED: u32 = 2;

/// What came of it.
pub struct Commissioning {
    /// Every step that was asked for went well.
    pub passed: bool,
    /// The report, HTML.
    pub report: String,
    /// The board's stream, for `pt326 replay`.
    pub log: String,
}

/// Leads a person through it. The board is restarted first, so that its log is whole, and is off in the end.
///
/// # Errors
/// The port has gone, or the board is heating.
pub fn commission<P: Read + Write>(
    session: &mut Session<P>,
    person: &mut dyn Person,
) -> anyhow::Result<Commissioning> {
    let mut guide = Guide::new(session, person);
    begin(&mut guide)?;
    calibrate(&mut guide)?;
    let ready = check(&mut guide)?;
    if ready {
        tune(&mut guide)?;
        if learn(&mut guide)? {
            tell_apart(&mut guide)?;
        }
    }
    keep(&mut guide)?;
    let now = settings::read(guide.session)?;
    Ok(Commissioning {
        passed: !guide.sections.iter().any(|section| section.outcome == Outcome::Failed),
        report: report::html(&guide.sections, &now),
        log: guide.log,
    })
}

/// Who is there, and nothing latched.
fn begin<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section("The board", "")?;
    if let Some(who) = guide.ask("Who commissions which rig, and when? It goes into the report: ")? {
        guide.say(&who)?;
    }
    let status = guide.order("status")?;
    guide.say(&status)?;
    if status.contains("mode tripped") || status.contains("locked out") {
        ensure!(
            guide.yes("Something is latched. Acknowledge it?")?,
            "nothing goes on while something is latched"
        );
        guide.order("ack")?;
    }
    guide.session.restart("restart")?;
    guide.end(Outcome::Done);
    Ok(())
}

fn calibrate<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section(
        "The thermistors",
        "At rest, against a thermometer that you trust. `22.4`: all three are at 22.4 degC now; `t1 0.0`: T1 alone is, in ice water. \
         Two temperatures give the gain, too. Nothing: go on.",
    )?;
    let mut taken = false;
    while let Some(given) = guide.ask("Temperature: ")? {
        let line = match given.split_once(' ') {
            Some((which, celsius)) => format!("calibrate {which} {celsius}"),
            None => format!("calibrate all {given}"),
        };
        let mut answer = guide.session.ask(&line)?;
        if answer.contains("does not stand still") {
            guide.pass(REST)?;
            answer = guide.session.ask(&line)?;
        }
        taken |= answer.contains(" reads ");
        guide.say(&answer)?;
    }
    if !taken {
        return Ok(());
    }
    if guide.yes("Put that in force?")? {
        let answer = guide.order("calibrate apply")?;
        guide.say(&answer)?;
        guide.end(Outcome::Done);
    } else {
        guide.order("calibrate clear")?;
    }
    Ok(())
}

/// Whether what heats may go on.
fn check<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<bool> {
    guide.section(
        "The wiring",
        "The self-test of the board looks at the thermistors, then heats a little for a minute or so.",
    )?;
    if !guide.yes("Is the fan on, and somebody beside the rig? Then the self-test may begin.")? {
        guide.say("Without it nothing more heats.")?;
        return Ok(false);
    }
    let begun = guide.order("check")?;
    let passed = guide.follow(&begun, |line| {
        let over = line.starts_with("check failed") || line.starts_with("check ended");
        line.starts_with("check passed").then_some(true).or(over.then_some(false))
    })?;
    guide.end(if passed { Outcome::Done } else { Outcome::Failed });
    if !passed {
        guide.say("Mend that, and begin again: what was kept before is still there.")?;
    }
    Ok(passed)
}

fn tune<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section(
        "The controller",
        "An experiment: constant power until T1 stands still, then power switched up and down. T1 rises by 9 degC or so; everything that \
         trips goes on tripping.",
    )?;
    if !guide.yes("Tune the controller?")? {
        return Ok(());
    }
    let begun = guide.order("tune start")?;
    let done = guide.follow(&begun, |line| {
        line.starts_with("tune: done").then_some(true).or(line.starts_with("tune: ended").then_some(false))
    })?;
    guide.end(if done { Outcome::Done } else { Outcome::Failed });
    if !done {
        return Ok(());
    }
    let proposed = guide.order("tune")?;
    guide.say(&proposed)?;
    while let Some(rule) = guide.ask("Put in force (relay, model, quick; nothing: none): ")? {
        let answer = guide.session.ask(&format!("tune apply {rule}"))?;
        guide.say(&answer)?;
        if answer.contains("in force") {
            break;
        }
    }
    Ok(())
}

/// Learns, and watches a little longer; whether both models are there.
fn learn<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<bool> {
    let config = settings::read(guide.session)?;
    let minutes = (f64::from(config.supervisor.learn_end.0) + WATCHED) / 60.0;
    guide.section(
        "What is normal",
        &format!(
            "It regulates to {} degC and learns, {minutes:.0} min or more. Leave the rig alone meanwhile.",
            config.setpoint.0
        ),
    )?;
    if !guide.yes("Begin?")? {
        return Ok(false);
    }
    guide.order("arm")?;
    let learnt = watch(guide, &config)?;
    guide.end(if learnt { Outcome::Done } else { Outcome::Failed });
    guide.order("stop")?;
    // Nobody reads it while the computer works out what can be told apart.
    guide.order("stream off")?;
    let baseline = guide.order("baseline")?;
    guide.say(&baseline)?;
    Ok(learnt)
}

/// Until it has watched for long enough.
fn watch<P: Read + Write>(guide: &mut Guide<P>, config: &Config) -> anyhow::Result<bool> {
    let enough = (WATCHED / f64::from(config.sample_time.0)) as u32;
    let (mut watched, mut before, mut began) = (0, None, false);
    while watched < enough {
        for tick in guide.ticks()? {
            let [state, likelihood] = ["state", "likelihood"].map(|name| tick.word(name));
            let (mode, blocked, readiness) = (state & 0xF, state >> 17 & 7, likelihood & 0xF);
            // What came before it was armed may still be on the wire.
            began |= mode != 0;
            if !began {
                continue;
            }
            watched = if mode == MONITOR && readiness == ARMED { watched + 1 } else { 0 };
            if before.replace((mode, blocked)) != Some((mode, blocked)) {
                let status = standing(&tick);
                guide.say(&status)?;
            }
            if mode == 0 || mode == TRIPPED {
                let status = guide.order("status")?;
                guide.say(&status)?;
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// How far it has come, in words.
fn standing(tick: &TickLine) -> String {
    const MODES: [&str; 6] = ["off", "settling", "learning", "monitoring", "tripped", "tuning"];
    let state = tick.word("state");
    let mode = MODES.get((state & 0xF) as usize).copied().unwrap_or("in a mode that is not known here");
    let blocker = (state >> 17 & 7).checked_sub(1).and_then(|i| pt326_lab::fields::BLOCKERS.get(i as usize));
    let waits = blocker.map(|blocker| format!(", not learning: {}", blocker.words())).unwrap_or_default();
    format!("tick {}: {mode}{waits}", tick.tick())
}

fn tell_apart<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section("What can be told apart on this rig", "")?;
    let question = Question { seed: 1, horizons: HORIZONS.to_vec(), equal_odds: false };
    match isolability(&guide.log, &question) {
        Ok(found) => {
            guide.say(&output::tables(&found))?;
            guide.say(&format!("Median of {} onsets, assumed while it watched.", found.onsets))?;
            guide.end(Outcome::Done);
        }
        Err(error) => guide.say(&format!("It could not be worked out: {error:#}"))?,
    }
    Ok(())
}

fn keep<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section("What the board keeps", "")?;
    if guide.yes("Have the board keep its settings, and what it has learnt?")? {
        guide.order("save")?;
        guide.say("Kept.")?;
        guide.end(Outcome::Done);
    } else {
        guide.say("Not kept: what has changed is forgotten at the next start.")?;
    }
    guide.order("stream off")?;
    Ok(())
}
