//! The tables of a campaign as Markdown, to be put into a document: those of the cells but the runaway ones, or of a
//! sweep the trade.

use std::fmt::Write;

use super::said;
use super::table::alarms;
use super::text::{delays, label, seconds};
use crate::campaign::by::By;
use crate::campaign::definition::Expect;
use crate::campaign::results::{CellResults, Results};
use crate::campaign::statistics::FaultStatistics;
use crate::campaign::statistics::quantiles::Quantiles;
use crate::campaign::statistics::target::Outcome;
use crate::campaign::statistics::trade::Trade;

/// All tables, with a line end.
pub(super) fn of(results: &Results) -> String {
    let mut text = String::new();
    let runs: usize = results.cells.iter().map(|cell| cell.runs).sum();
    let _ = writeln!(
        text,
        "{runs} runs in {} cells, seeds from {}.",
        results.cells.len(),
        results.campaign.seeds_from
    );
    if !results.trade.is_empty() {
        By::BOTH.iter().for_each(|by| trade(&mut text, *by, &results.trade));
        return text;
    }
    let (faults, silent): (Vec<_>, Vec<_>) =
        results.cells.iter().filter(|c| !c.is_runaway()).partition(|c| c.expect == Expect::Fault);
    targets(&mut text, &results.targets);
    if !faults.is_empty() {
        detection(&mut text, &faults);
        estimates(&mut text, &faults);
        text += &said::markdown(&faults);
    }
    text += &said::names_markdown(results);
    text += &said::confidence_markdown(results);
    if !silent.is_empty() {
        silence(&mut text, &silent);
    }
    text
}

/// A heading and the head of a table.
fn head(text: &mut String, title: &str, columns: &[&str]) {
    let _ = writeln!(text, "\n{title}\n\n| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

fn row(text: &mut String, cells: &[String]) {
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

fn percent(count: usize, of: usize) -> String {
    format!("{:.1}", 100.0 * count as f64 / of.max(1) as f64)
}

fn targets(text: &mut String, outcomes: &[Outcome]) {
    if outcomes.is_empty() {
        return;
    }
    let met = outcomes.iter().filter(|o| o.met).count();
    let title = format!("Targets: {met} of {} met", outcomes.len());
    head(text, &title, &["", "cells", "measure", "bound", "measured", "runs"]);
    for o in outcomes {
        let t = &o.target;
        let bounds = [t.at_most.map(|x| format!("at most {x}")), t.at_least.map(|x| format!("at least {x}"))];
        let bounds: Vec<String> = bounds.into_iter().flatten().collect();
        let measured = o.measured.map_or("never".into(), |x| format!("{}", (x * 1e4).round() / 1e4));
        let place = if t.each { format!("{}, worst: {}", t.cells, o.judged) } else { t.cells.clone() };
        let verdict = if o.met { "met" } else { "**missed**" };
        let measure = format!("{} ({})", t.measure.name(), t.judged());
        row(text, &[verdict.into(), place, measure, bounds.join(", "), measured, o.runs.to_string()]);
    }
}

/// When each fault was seen, by both diagnoses.
fn detection(text: &mut String, cells: &[&CellResults]) {
    head(
        text,
        "Delays in s: median / 95 % / 99 % of the runs; a miss counts as infinitely late (-)",
        &[
            "cell",
            "runs",
            "likelihood: detected",
            "missed %",
            "isolated",
            "signatures: detected",
            "missed %",
            "isolated",
        ],
    );
    for cell in cells {
        let mut line = vec![label(cell), cell.runs.to_string()];
        for by in By::BOTH {
            line.extend(match &cell.by(by).fault {
                None => ["blind".into(), String::new(), String::new()],
                Some(f) => {
                    [delays(&f.detection_delay_s), percent(f.missed, f.runs), delays(&f.isolation_delay_s)]
                }
            });
        }
        row(text, &line);
    }
}

/// What each fault was called, and how well it was measured.
fn estimates(text: &mut String, cells: &[&CellResults]) {
    head(
        text,
        "Names and estimates: right in % of the runs; errors as median / 95 %",
        &[
            "cell",
            "likelihood: first right",
            "settled right",
            "duration error, s",
            "magnitude error, %",
            "interval holds, %",
            "onset error, s",
            "signatures: first right",
            "settled right",
            "duration error, s",
        ],
    );
    for cell in cells {
        let pair = |q: &Quantiles| format!("{} / {}", seconds(q.median), seconds(q.p95));
        let of_100 = |x: Option<f64>| x.map_or("-".into(), |x| format!("{:.1}", 100.0 * x));
        let mut line = vec![label(cell)];
        let names = |f: &FaultStatistics| {
            [format!("{:.1}", f.first_right_pct), format!("{:.1}", f.settled_right_pct)]
        };
        match &cell.likelihood.fault {
            None => line.extend(vec!["-".to_owned(); 6]),
            Some(f) => {
                line.extend(names(f));
                line.push(pair(&f.duration_error_s));
                line.push(match f.magnitude_coverage_pct {
                    None => "-".into(),
                    Some(_) => {
                        format!("{} / {}", of_100(f.magnitude_error.median), of_100(f.magnitude_error.p95))
                    }
                });
                line.push(f.magnitude_coverage_pct.map_or("-".into(), |x| format!("{x:.1}")));
                line.push(pair(&f.onset_error_s));
            }
        }
        match &cell.signature.fault {
            None => line.extend(["blind".to_owned(), String::new(), String::new()]),
            Some(f) => {
                line.extend(names(f));
                line.push(pair(&f.duration_error_s));
            }
        }
        row(text, &line);
    }
}

fn silence(text: &mut String, cells: &[&CellResults]) {
    head(
        text,
        "Nothing to be reported: runs with an alarm, and alarms an hour with their exact 95 % interval",
        &["cell", "runs", "likelihood", "signatures", "likelihood not armed", "tripped, %"],
    );
    for cell in cells {
        let by = |by| alarms(&cell.by(by).alarms).trim().to_owned();
        let unarmed = cell.likelihood.unarmed.to_string();
        let tripped = format!("{:.1}", cell.heat.tripped_pct);
        row(
            text,
            &[label(cell), cell.runs.to_string(), by(By::Likelihood), by(By::Signature), unarmed, tripped],
        );
    }
}

/// What each setting buys and costs one diagnosis.
fn trade(text: &mut String, by: By, all: &[Trade]) {
    let trades: Vec<&Trade> = all.iter().filter(|t| t.by == by).collect();
    let Some(first) = trades.first() else { return };
    let same = |t: &&Trade| Trade { setting: first.setting.clone(), ..(**t).clone() } == **first;
    if trades.iter().all(same) {
        return; // the settings are the other diagnosis's
    }
    let names: Vec<String> = first.faults.iter().map(|f| format!("{}, s", f.name)).collect();
    let mut columns = vec!["setting", "false alarms an hour, lively", "alarms where none may be, runs"];
    columns.extend(names.iter().map(String::as_str));
    columns.extend(["missed, all classes, %", "first right, all classes, %"]);
    let who = if by == By::Likelihood { "likelihood diagnosis" } else { "signatures" };
    head(text, &format!("Settings of the {who}: detection as median / 95 % / 99 %"), &columns);
    let (idle, telling): (Vec<&Trade>, Vec<&Trade>) =
        trades.iter().partition(|t| !t.setting.is_empty() && same(t));
    for t in telling {
        let name = if t.setting.is_empty() { "as delivered".into() } else { format!("`{}`", t.setting) };
        let rate = alarms(&t.undisturbed);
        let rate = rate.split_once(": ").map_or("-".to_owned(), |(_, rate)| rate.replace(" an hour", ""));
        let mut line = vec![name, rate, format!("{} of {}", t.disturbed_with_alarm, t.disturbed_runs)];
        line.extend(t.faults.iter().map(|f| delays(&f.detection_delay_s)));
        line.extend([t.missed_pct, t.first_right_pct].map(|x| x.map_or("-".into(), |x| format!("{x:.1}"))));
        row(text, &line);
    }
    let idle: Vec<String> = idle.iter().map(|t| format!("`{}`", t.setting)).collect();
    if !idle.is_empty() {
        let _ = writeln!(text, "\nNothing of this is changed by {}.", idle.join(", "));
    }
}
