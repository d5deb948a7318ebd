//! `mutants`: takes the firmware's safety mechanisms out one at a time, and says which test fails.
//!
//! A test that passes with and without a mechanism says nothing about it. Each mutant is one change of the sources in a
//! copy of the tree; its image is built there and runs under the tests of this tree's virtual board that should notice. What no test of
//! the virtual board can reach is seen by tests on the host, which are built in the copy.

mod bench;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};
use clap::Parser;

use bench::{Bench, Verdict};
use table::{Mutant, TABLE};

/// Changes one thing in the firmware, builds it, says which test fails: for each mutant of the
/// table. Exits with 1 if one survives that should not.
#[derive(Debug, Parser)]
#[command(name = "mutants-board", version)]
struct Cli {
    /// Only the mutants whose name contains this; may be repeated.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Names the mutants and what each breaks, and does nothing else.
    #[arg(long)]
    list: bool,
    /// Ends with the table as Markdown.
    #[arg(long)]
    markdown: bool,
}

fn main() -> ExitCode {
    virtual_board::exit_code(carry_out(&Cli::parse()))
}

/// Whether every mutant that should be seen was.
fn carry_out(cli: &Cli) -> anyhow::Result<bool> {
    let wanted =
        |m: &&Mutant| cli.only.is_empty() || cli.only.iter().any(|name| m.name.contains(name.as_str()));
    let mutants: Vec<&Mutant> = TABLE.iter().copied().flatten().filter(wanted).collect();
    ensure!(!mutants.is_empty(), "no mutant is called {}; see --list", cli.only.join(" or "));
    let mut out = std::io::stdout().lock();
    if cli.list {
        for m in mutants {
            writeln!(out, "{:<28} {}", m.name, m.breaks)?;
        }
        return Ok(true);
    }
    let bench = Bench::set_up()?;
    whole_tree_passes(&bench, &mutants)?;
    let mut results = Vec::new();
    for (i, m) in mutants.iter().enumerate() {
        let verdict =
            bench.judge(m).unwrap_or_else(|error| Verdict { killed_by: Vec::new(), error: Some(error) });
        writeln!(out, "{:>3}/{} {:<28} {}", i + 1, mutants.len(), m.name, told(m, &verdict))?;
        out.flush()?;
        results.push((*m, verdict));
    }
    if cli.markdown {
        writeln!(out, "\n{}", markdown(&results))?;
    }
    let survivors: Vec<&str> = results.iter().filter(|(m, v)| survives(m, v)).map(|(m, _)| m.name).collect();
    writeln!(
        out,
        "{} mutants, {} survived unexpectedly or were not judged: {}",
        results.len(),
        survivors.len(),
        survivors.join(" ")
    )?;
    Ok(survivors.is_empty())
}

/// Whether no test has seen a mutant that one should.
fn survives(m: &Mutant, verdict: &Verdict) -> bool {
    verdict.error.is_some() || verdict.killed_by.is_empty() && m.unseen.is_none()
}

/// A test that fails on the whole tree would seem to kill every mutant.
fn whole_tree_passes(bench: &Bench, mutants: &[&Mutant]) -> anyhow::Result<()> {
    let mut tests: BTreeMap<&[&str], BTreeSet<&str>> = BTreeMap::new();
    for m in mutants {
        tests.entry(m.host).or_default().extend(m.seen_by);
    }
    for (host, tests) in tests {
        let tests: Vec<&str> = tests.into_iter().collect();
        let verdict = bench.run(host, &tests).context("without any mutant")?;
        if !verdict.killed_by.is_empty() {
            bail!("without any mutant these tests fail: {}", verdict.killed_by.join(", "));
        }
    }
    Ok(())
}

fn told(m: &Mutant, verdict: &Verdict) -> String {
    if let Some(error) = &verdict.error {
        return format!("NOT JUDGED: {error:#}");
    }
    match (verdict.killed_by.as_slice(), m.unseen) {
        ([], Some(why)) => format!("survives, as expected: {why}"),
        ([], None) => "SURVIVED".into(),
        (killers, _) => format!("killed by {}", killers.join(", ")),
    }
}

/// The table as docs/evidence/safety-evidence.md has it: at most two tests a mutant.
fn markdown(results: &[(&Mutant, Verdict)]) -> String {
    let mut text = String::from("| taken out or changed | so that | seen by |\n|---|---|---|\n");
    for (m, verdict) in results {
        let killers = &verdict.killed_by;
        let seen = match (killers.len(), m.unseen) {
            (0, Some(why)) => format!("not seen: {why}"),
            (0, None) => "**survives**".into(),
            (n, _) => {
                let first: Vec<String> = killers.iter().take(2).map(|test| format!("`{test}`")).collect();
                let more = if n > 2 { format!(" and {} more", n - 2) } else { String::new() };
                first.join(", ") + &more
            }
        };
        text += &format!("| {} | {} | {seen} |\n", m.name.replace('-', " "), m.breaks);
    }
    text
}
