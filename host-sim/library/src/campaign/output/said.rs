//! What the likelihood diagnosis said, against the truth: as fields of the tables, as Markdown, and as printed.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::field::{Field, field};
use super::text::{counted, delays, label, line, seconds};
use crate::campaign::results::{CellResults, Results};
use crate::campaign::statistics::said::{Confidence, FaultSaid, SaidStatistics, Share, sum};
use crate::score::said::{BINS, Said};

/// Columns of a run.
pub(super) fn run_fields(said: &Said) -> Vec<Field> {
    let mut fields = vec![
        field("right_delay_s", said.right_delay_s),
        field("end_name", said.end_name.as_ref()),
        field("end_right", said.end_right),
        field("end_size", said.end_size),
        field("end_half_width", said.end_half_width),
        field("end_size_true", said.end_size_true),
        field("alarm_share", said.alarm_share),
        field("tail_s", said.tail_s),
        field("tail_open", said.tail_open),
        field("sure_wrong_s", said.sure_wrong_s),
        field("sure_wrong_late_s", said.sure_wrong_late_s),
        field("intervals", said.intervals),
        field("held", said.held),
    ];
    for (bin, from) in said.bins.iter().zip(std::iter::once(0.0).chain(BINS)) {
        fields
            .extend([field(format!("verdicts_{from}"), bin.said), field(format!("right_{from}"), bin.right)]);
    }
    prefixed(fields)
}

/// Columns of a cell.
pub(super) fn cell_fields(said: &SaidStatistics) -> Vec<Field> {
    let fault = said.fault.as_ref();
    let mut fields = Vec::new();
    for (name, quantiles) in
        [("right_delay_s", fault.map(|f| f.right_delay_s)), ("tail_s", fault.map(|f| f.tail_s))]
    {
        let q = quantiles.unwrap_or_default();
        let three = [("median", q.median), ("p95", q.p95), ("p99", q.p99)];
        fields.extend(three.map(|(share, x)| field(format!("{name}_{share}"), x)));
    }
    fields.extend([
        field("end_right_pct", fault.map(|f| f.end_right_pct)),
        field("end_names", fault.map(|f| counted(&f.end_names))),
        field("lasted_pct", fault.map(|f| f.lasted_pct)),
        field("alarm_share_pct", fault.and_then(|f| f.alarm_share_pct)),
        field("sure_wrong_pct", fault.map(|f| f.sure_wrong_pct)),
    ]);
    fields.push(field("names", named(&said.names)));
    fields.extend(share_fields("end_coverage", fault.and_then(|f| f.end_coverage)));
    fields.extend(share_fields("coverage", fault.and_then(|f| f.coverage)));
    for from in std::iter::once(0.0).chain(BINS) {
        let bin = said.confidence.iter().find(|bin| bin.from == from);
        fields.push(field(format!("confidence_{from}_mean_pct"), bin.map(|bin| bin.mean_pct)));
        fields.extend(share_fields(&format!("confidence_{from}_right"), bin.map(|bin| bin.right)));
    }
    prefixed(fields)
}

/// Names with their seconds, most first.
fn named(names: &BTreeMap<String, [u64; 2]>) -> String {
    let mut names: Vec<_> = names.iter().collect();
    names.sort_by_key(|(_, [seconds, _])| std::cmp::Reverse(*seconds));
    let names: Vec<String> =
        names.into_iter().map(|(name, [seconds, sure])| format!("{name} {seconds} ({sure})")).collect();
    names.join(", ")
}

fn share_fields(name: &str, share: Option<Share>) -> [Field; 4] {
    [
        field(format!("{name}_of"), share.map(|s| s.of)),
        field(format!("{name}_pct"), share.map(|s| s.pct)),
        field(format!("{name}_pct_low"), share.map(|s| s.pct_95[0])),
        field(format!("{name}_pct_high"), share.map(|s| s.pct_95[1])),
    ]
}

fn prefixed(fields: Vec<Field>) -> Vec<Field> {
    fields.into_iter().map(|(name, value)| (format!("said_{name}"), value)).collect()
}

const TITLE: &str = "What likelihood said. Delay of the first right name, s (median / 95 % / 99 %). Right at the end of the fault, % of \
    the runs; % of the intervals then that hold the size. The alarm lasts from the detection to the end, % of the runs, and outlives \
    the fault, s. Wrong, above 0.95, later than 5 s after the onset, % of the runs. Names at the end";

/// Columns of both tables.
const HEAD: [&str; 7] = ["right name", "end right", "holds", "lasts", "outlives", "wrong", "at the end"];

fn entries(fault: &FaultSaid) -> [String; 7] {
    let percent = |x: f64| format!("{x:.1}");
    [
        delays(&fault.right_delay_s),
        percent(fault.end_right_pct),
        fault.end_coverage.map_or("-".into(), |share| percent(share.pct)),
        percent(fault.lasted_pct),
        outlives(fault),
        percent(fault.sure_wrong_pct),
        counted(&fault.end_names),
    ]
}

fn outlives(fault: &FaultSaid) -> String {
    let q = &fault.tail_s;
    [q.median, q.p95, q.p99].map(seconds).join(" / ")
}

/// Cells with a fault, as a table of Markdown; empty without one.
pub(super) fn markdown(cells: &[&CellResults]) -> String {
    let mut text =
        format!("\n{TITLE}\n\n| cell | {} |\n|{}", HEAD.join(" | "), "---|".repeat(HEAD.len() + 1));
    text.push('\n');
    for (cell, fault) in cells.iter().filter_map(|cell| Some((cell, cell.said.fault.as_ref()?))) {
        let _ = writeln!(text, "| {} | {} |", label(cell), entries(fault).join(" | "));
    }
    text
}

/// What was said where each name, or each of some, was right, as a table of Markdown.
pub(super) fn names_markdown(results: &Results) -> String {
    let mut classes: BTreeMap<String, Vec<&CellResults>> = BTreeMap::new();
    for cell in &results.cells {
        let right = cell.class.map_or("no fault".into(), |_| cell.right.join(" or "));
        classes.entry(right).or_default().push(cell);
    }
    let mut text = String::from(
        "\nSeconds on which each name was said (and above 0.95)\n\n| right | said |\n|---|---|\n",
    );
    for (class, cells) in classes {
        let names = sum(cells.iter().map(|cell| &cell.said.names));
        let _ = writeln!(text, "| {class} | {} |", named(&names));
    }
    text
}

/// Confidence against truth, as a table of Markdown; empty without a verdict.
pub(super) fn confidence_markdown(results: &Results) -> String {
    if results.confidence.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "\nVerdicts of likelihood, one a second, by confidence: right in % [95 % interval as if they were independent] of how many\n\n\
         | rig | confidence from | mean, % | right, % | of |\n|---|---|---|---|---|\n",
    );
    for (rig, bins) in &results.confidence {
        for bin in bins {
            let _ = writeln!(
                text,
                "| {rig} | {} | {:.1} | {} | {} |",
                bin.from,
                bin.mean_pct,
                right(bin),
                bin.right.of
            );
        }
    }
    text
}

fn right(bin: &Confidence) -> String {
    let [low, high] = bin.right.pct_95;
    format!("{:.1} [{low:.1}, {high:.1}]", bin.right.pct)
}

fn columns([delay, right, holds, lasts, outlives, sure, names]: [&str; 7]) -> String {
    format!("{delay:<21} {right:>9} {holds:>5} {lasts:>5}  {outlives:<22} {sure:>5}  {names}")
}

/// The same as printed.
pub(super) fn print(text: &mut String, results: &Results, cells: &[&CellResults]) {
    let told: Vec<_> = cells.iter().filter_map(|cell| Some((cell, cell.said.fault.as_ref()?))).collect();
    if told.is_empty() {
        return;
    }
    text.push('\n');
    line(text, TITLE, "");
    let _ = writeln!(text, "\n  {}", columns(HEAD));
    for (cell, fault) in told {
        let _ = writeln!(text, "{}", label(cell));
        let entries = entries(fault);
        line(text, &format!("  {}", columns(entries.each_ref().map(String::as_str))), &" ".repeat(80));
    }
    if let Some((_, bins)) = results.confidence.first() {
        let bins =
            bins.iter().map(|bin| format!("from {} {:.1} of {}", bin.from, bin.right.pct, bin.right.of));
        let bins: Vec<String> = bins.collect();
        text.push('\n');
        line(
            text,
            &format!("Verdicts, one a second, by confidence, right in %: {}", bins.join(", ")),
            "    ",
        );
    }
}
