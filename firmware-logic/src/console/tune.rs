//! `tune`: the experiment, what its rules propose, and which of it is put in force.

use core::fmt::Write;

use fdi_core::control::pid::PidConfig;
use fdi_core::tune::{Lag, Standing};
use fdi_core::{Command, Config};

use super::{Asked, Board, fail, say};
use crate::tuning::{InForce, Rule, TuningText};

/// What `tune` is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// How far it has come, and what is proposed.
    Show,
    /// Begin.
    Start,
    /// Put a proposal in force.
    Apply(Rule),
    /// What was in force before.
    Undo,
}

/// What follows `tune`.
pub const EXPECTED: &str = "start, apply relay, apply model, apply quick, undo, or nothing";

impl Wanted {
    /// Reads it; `None` where it is none.
    pub(super) fn parse(text: &str) -> Option<Self> {
        match text {
            "" => Some(Self::Show),
            "start" => Some(Self::Start),
            "undo" => Some(Self::Undo),
            other => {
                let name = other.strip_prefix("apply ")?.trim_matches(' ');
                Rule::ALL.into_iter().find(|rule| rule.name() == name).map(Self::Apply)
            }
        }
    }
}

/// What `tune start` is, and says.
pub(super) const START: Asked =
    (Command::Tune, "ok, see below; it heats, `stop` ends it, and so does all that trips\n");

/// Carries it out.
pub(super) async fn carry_out(wanted: Wanted, board: &mut impl Board, out: &mut dyn Write) {
    match (wanted, board.tuning()) {
        (Wanted::Start, _) => {} // a command, which waits with the others
        (Wanted::Show, Some(Standing::Over(Ok(lag)))) => show(&lag, board, out).await,
        (Wanted::Show, Some(standing)) => drop(writeln!(out, "{}", TuningText(&standing))),
        (Wanted::Show, None) => {
            say(
                out,
                "nothing yet: `tune start` heats the rig for some minutes, by 9 degC or so, and regulates nothing meanwhile\n",
            );
        }
        (Wanted::Apply(rule), Some(Standing::Over(Ok(lag)))) => apply(rule, &lag, board, out).await,
        (Wanted::Apply(_), _) => {
            say(out, "error: there is no result, expected `tune start` and its end first\n")
        }
        (Wanted::Undo, _) => {
            let config = board.config();
            match board.tuner().undone(&config) {
                Some(old) => put_in_force(&old, None, board, out).await,
                None => say(out, "error: there is nothing to take back, expected `tune apply` first\n"),
            }
        }
    }
}

async fn show(lag: &Lag, board: &mut impl Board, out: &mut dyn Write) {
    search(lag, board).await;
    let ts = board.sample_time();
    let _ = writeln!(out, "{}", TuningText(&Standing::Over(Ok(*lag))));
    for rule in Rule::ALL {
        let _ = match board.tuner().proposal(rule, lag, ts) {
            Some(proposal) => writeln!(out, "{proposal}"),
            None => writeln!(out, "{}: too slow to settle in 20 time constants", rule.name()),
        };
    }
    let _ = writeln!(
        out,
        "{}; `tune apply relay`, `model` or `quick` changes that",
        InForce(&board.config().pid)
    );
}

async fn search(lag: &Lag, board: &mut impl Board) {
    let ts = board.sample_time();
    while !board.tuner().search(lag, ts) {
        board.pause().await;
    }
}

async fn apply(rule: Rule, lag: &Lag, board: &mut impl Board, out: &mut dyn Write) {
    search(lag, board).await;
    let (ts, config) = (board.sample_time(), board.config());
    let Some(proposal) = board.tuner().proposal(rule, lag, ts) else {
        return say(out, "error: by this rule it does not settle, expected another one\n");
    };
    let new = board.tuner().applied(&proposal, &config);
    put_in_force(&new, Some(config.pid), board, out).await;
}

async fn put_in_force(
    config: &Config,
    before: Option<PidConfig>,
    board: &mut impl Board,
    out: &mut dyn Write,
) {
    if let Err(error) = board.apply(config).await {
        return fail(out, &error);
    }
    board.tuner().keep(before);
    // What has just come back is not kept twice.
    let undo = if before.is_some() { ", `tune undo` takes it back" } else { "" };
    let _ = writeln!(out, "{}; `save` keeps it{undo}", InForce(&config.pid));
}
