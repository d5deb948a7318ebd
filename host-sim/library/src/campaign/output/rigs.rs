//! `rigs.md`: what the likelihood diagnosis made of each case on each rig, a table for each kind of case.

use std::fmt::Write;

use super::runaway::distinct;
use super::table::short;
use super::text::seconds;
use crate::campaign::results::{CellResults, Results};

/// The tables, with a line end; none where no kind of case was tried on two rigs.
pub(super) fn of(results: &Results) -> Option<String> {
    let cells: Vec<&CellResults> =
        results.cells.iter().filter(|c| !c.is_runaway() && !c.plant.is_empty()).collect();
    let mut text = String::from(
        "With a fault: % of the runs that were named rightly at its end; median delay of the detection, s. \
         Without: % of the time in alarm; alarms an hour.\n",
    );
    let kinds = distinct(cells.iter().map(|cell| kind(cell).to_owned()));
    let tables: Vec<String> = kinds.iter().filter_map(|kind| table(kind, &cells)).collect();
    text += &tables.concat();
    (!tables.is_empty()).then_some(text)
}

/// What stands before the first slash of its name.
fn kind(cell: &CellResults) -> &str {
    cell.name.split('/').next().unwrap_or_default()
}

/// What stands behind it, without the rig.
fn case(cell: &CellResults) -> String {
    let name = cell.name.strip_prefix(kind(cell)).unwrap_or(&cell.name).trim_start_matches('/');
    let name = name.strip_suffix(&format!(" @ {}", cell.plant)).unwrap_or(name);
    if cell.setting.is_empty() { name.into() } else { format!("{name} `{}`", cell.setting) }
}

fn table(which: &str, cells: &[&CellResults]) -> Option<String> {
    let cells: Vec<&CellResults> = cells.iter().copied().filter(|cell| kind(cell) == which).collect();
    let rigs = distinct(cells.iter().map(|cell| cell.plant.clone()));
    let cases = distinct(cells.iter().map(|cell| case(cell)));
    let mut text =
        format!("\n## {which}\n\n| rig | {} |\n|{}\n", cases.join(" | "), "---|".repeat(cases.len() + 1));
    for rig in &rigs {
        let of = |name: &String| cells.iter().find(|cell| cell.plant == *rig && case(cell) == *name);
        let entries: Vec<String> =
            cases.iter().map(|name| of(name).map_or("".into(), |c| entry(c))).collect();
        let _ = writeln!(text, "| {rig} | {} |", entries.join(" | "));
    }
    (rigs.len() > 1).then_some(text)
}

fn entry(cell: &CellResults) -> String {
    let alarms = &cell.likelihood.alarms;
    match (&cell.said.fault, &cell.likelihood.fault) {
        (Some(said), Some(fault)) => {
            format!("{:.0} %; {}", said.end_right_pct, seconds(fault.detection_delay_s.median))
        }
        _ => match (alarms.share_of_time, alarms.per_hour) {
            (Some(share), Some(rate)) => format!("{} %; {}", short(100.0 * share), short(rate)),
            _ => "never watched".into(),
        },
    }
}
