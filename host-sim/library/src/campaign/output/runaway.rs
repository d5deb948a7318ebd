//! `runaway.md`: heat without effect, as tables with a row for each case and a column for each rig.

use std::fmt::Write;

use super::text::seconds;
use crate::campaign::results::{CellResults, RUNAWAY, Results};

/// The tables, with a line end; none without such a cell.
pub(super) fn of(results: &Results) -> Option<String> {
    let cells: Vec<&CellResults> = results.cells.iter().filter(|c| c.name.starts_with(RUNAWAY)).collect();
    let first = cells.first()?;
    let mut text = format!(
        "{} runs, {} a case and rig, seeds from {}. The worst of them:\n",
        cells.iter().map(|c| c.runs).sum::<usize>(),
        first.runs,
        results.campaign.seeds_from
    );
    table(&mut text, "True air over the set-point, °C; onset to heater off, s; why", &cells, heat);
    table(
        &mut text,
        "Named by the likelihood diagnosis: 95 % of the runs, s; what most of them settled on",
        &cells,
        named,
    );
    Some(text)
}

fn table(text: &mut String, title: &str, cells: &[&CellResults], entry: fn(&CellResults) -> String) {
    let rigs = distinct(cells.iter().map(|cell| cell.plant.clone()));
    let _ =
        writeln!(text, "\n{title}\n\n| case | {} |\n|{}", rigs.join(" | "), "---|".repeat(rigs.len() + 1));
    for name in distinct(cells.iter().map(|cell| case(cell))) {
        let of = |rig: &String| cells.iter().find(|cell| cell.plant == *rig && case(cell) == name);
        let entries: Vec<String> = rigs.iter().map(|rig| of(rig).map_or("-".into(), |c| entry(c))).collect();
        let _ = writeln!(text, "| {name} | {} |", entries.join(" | "));
    }
}

/// Each once, in the order in which they come.
pub(super) fn distinct(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut distinct = Vec::new();
    for one in all {
        if !distinct.contains(&one) {
            distinct.push(one);
        }
    }
    distinct
}

/// Name of a cell without that of its rig, and its setting.
fn case(cell: &CellResults) -> String {
    let name = cell.name.trim_start_matches(RUNAWAY);
    let name = name.split(" @ ").next().unwrap_or(name);
    if cell.setting.is_empty() { name.into() } else { format!("{name} `{}`", cell.setting) }
}

fn heat(cell: &CellResults) -> String {
    let heat = &cell.heat;
    let over = heat.overshoot_max_c.map_or("-".into(), |x| format!("{x:+.1}"));
    let off = heat.off_delay_max_s.map_or("not always off".into(), |s| format!("{s:.1} s"));
    let mut parts = vec![over, if heat.reasons.is_empty() { "never off".into() } else { off }];
    if !heat.reasons.is_empty() {
        let reasons: Vec<&str> = heat.reasons.iter().map(|(name, _)| name.as_str()).collect();
        parts.push(reasons.join(", "));
    }
    if heat.tripped_early > 0 {
        parts.push(format!("({} tripped before)", heat.tripped_early));
    }
    parts.join("; ")
}

fn named(cell: &CellResults) -> String {
    let delay = cell.likelihood.fault.as_ref().and_then(|f| f.isolation_delay_s.p95);
    let settled = cell.settled.as_deref().unwrap_or("not named");
    match delay {
        Some(_) => format!("{} s; {settled}", seconds(delay)),
        None => settled.to_owned(),
    }
}
