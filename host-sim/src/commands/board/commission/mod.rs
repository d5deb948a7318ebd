//! `pt326 board commission`: from a board that is wired to a rig that is watched, step by step. The board does each step, and its
//! console can do each alone; what leads here only asks, waits and writes down. Nothing heats without a yes.

mod guide;
mod report;

use std::io::{Read, Write};

use anyhow::ensure;
use fdi_core::Config;

use crate::commands::replay::isolability;
use guide::Guide;
pub use guide::Person;
use pt326_host::board::{Session, check_ended, refusal, settings};
use pt326_host::isolability::{Question, output};
use report::Outcome;

/// Times within which faults are to be told apart, s; so long it watches after it has learnt, and a little more.
const HORIZONS: [f64; 3] = [1.0, 10.0, 60.0];
const WATCHED: f64 = 120.0;
/// Ticks after which a thermistor that is at rest has been so for long enough.
const REST: usize = 80;

/// What came of it.
pub struct Commissioning {
    /// Every step that was asked for went well.
    pub passed: bool,
    /// The report, HTML.
    pub report: String,
    /// The board's stream, for `pt326 replay`.
    pub log: String,
    /// What ended it early: the port has gone, nobody listens any more, somebody has stopped it.
    pub error: Option<anyhow::Error>,
}

/// Leads a person through it. The board is restarted first, so that its log is whole, and is off in the end, whatever ends it; where
/// it cannot be stopped any more the error says so.
pub fn commission<P: Read + Write>(session: &mut Session<P>, person: &mut dyn Person) -> Commissioning {
    let mut guide = Guide::new(session, person);
    let led = lead(&mut guide);
    let (now, error) = match led {
        Ok(now) => (Some(now), None),
        Err(error) => {
            let error = guide.session.stopped_after(&error);
            guide.note(&format!("{error:#}"));
            (None, Some(error))
        }
    };
    Commissioning {
        passed: !guide.sections.iter().any(|section| section.outcome == Outcome::Failed),
        report: report::html(&guide.sections, now.as_ref()),
        log: guide.log,
        error,
    }
}

/// The steps; gives the settings that the board has in the end.
fn lead<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<Config> {
    begin(guide)?;
    calibrate(guide)?;
    if check(guide)? {
        tune(guide)?;
        if learn(guide)? {
            tell_apart(guide)?;
        }
    }
    keep(guide)?;
    settings::read(guide.session)
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
    guide.session.order("restart")?;
    guide.end(Outcome::Done);
    Ok(())
}

fn calibrate<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section(
        "The thermistors",
        "At rest, against a thermometer that you trust. `22.4`: all three are at 22.4 degC now; `t1 0.0`: T1 alone is, in ice water. \
         Two temperatures give the gain, too. `back`: the last one was wrong. Nothing: go on.",
    )?;
    let mut taken = 0u32;
    while let Some(given) = guide.ask("Temperature: ")? {
        if given == "back" {
            let answer = guide.session.ask("calibrate back")?;
            taken = taken.saturating_sub(u32::from(refusal(&answer).is_none()));
            guide.say(&answer)?;
            continue;
        }
        let line = match given.split_once(' ') {
            Some((which, celsius)) => format!("calibrate {which} {celsius}"),
            None => format!("calibrate all {given}"),
        };
        let mut answer = guide.session.ask(&line)?;
        if answer.contains("does not stand still") {
            guide.pass(REST)?;
            answer = guide.session.ask(&line)?;
        }
        taken += u32::from(answer.contains(" reads "));
        guide.say(&answer)?;
    }
    if taken == 0 {
        return Ok(());
    }
    if guide.yes("Put that in force?")? {
        let applied = guide.try_order("calibrate apply")?.is_some();
        guide.end(if applied { Outcome::Done } else { Outcome::Failed });
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
    if guide.try_order("check")?.is_none() {
        return Ok(false);
    }
    let passed = guide.follow(check_ended)?;
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
    if guide.try_order("tune start")?.is_none() {
        return Ok(());
    }
    let done = guide.follow(|line| {
        line.starts_with("tune: done").then_some(true).or(line.starts_with("tune: ended").then_some(false))
    })?;
    guide.end(if done { Outcome::Done } else { Outcome::Failed });
    if !done {
        return Ok(());
    }
    guide.try_order("tune")?;
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
    if guide.try_order("arm")?.is_none() {
        return Ok(false);
    }
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
    let ticks = |seconds: f64| (seconds / f64::from(config.sample_time.0)) as u32;
    let (enough, patience) =
        (ticks(WATCHED), ticks(4.0 * (f64::from(config.supervisor.learn_end.0) + WATCHED)));
    let (mut watched, mut before, mut began, mut waited) = (0, None, false, 0);
    while watched < enough {
        if waited > patience {
            let told = before
                .map_or_else(|| "nothing has begun".to_owned(), |(mode, blocked)| standing(mode, blocked));
            guide.say(&told)?;
            if !guide.yes("That takes long. Go on waiting, while it goes on heating?")? {
                return Ok(false);
            }
            waited = 0;
        }
        let ticks_now = guide.ticks()?;
        guide.news()?;
        for tick in ticks_now {
            waited += 1;
            let mode = tick.mode().unwrap_or("one that is not known here");
            let blocked = tick.blocked();
            // What came before it was armed may still be on the wire.
            began |= mode != "off";
            if !began {
                continue;
            }
            watched = if mode == "monitor" && tick.readiness() == Some("armed") { watched + 1 } else { 0 };
            if before.replace((mode, blocked)) != Some((mode, blocked)) {
                guide.say(&format!("tick {}: {}", tick.tick(), standing(mode, blocked)))?;
            }
            if ["off", "tripped"].contains(&mode) {
                guide.pass(1)?; // its console says by then who has stopped it
                guide.news()?;
                let status = guide.order("status")?;
                guide.say(&status)?;
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// How far it has come, in words.
fn standing(mode: &str, blocked: Option<&str>) -> String {
    let waits = blocked.map(|why| format!(", not learning: {why}")).unwrap_or_default();
    format!("mode {mode}{waits}")
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
        Err(error) => {
            guide.say(&format!("It could not be worked out: {error:#}"))?;
            guide.end(Outcome::Failed);
        }
    }
    Ok(())
}

fn keep<P: Read + Write>(guide: &mut Guide<P>) -> anyhow::Result<()> {
    guide.section("What the board keeps", "")?;
    if guide.yes("Have the board keep its settings, and what it has learnt?")? {
        if guide.try_order("save")?.is_some() {
            guide.say("Kept.")?;
            guide.end(Outcome::Done);
        }
    } else {
        guide.say("Not kept: what has changed is forgotten at the next start.")?;
    }
    guide.order("stream off")?;
    Ok(())
}
