//! What a campaign prints.

use std::fmt::Write;

use super::said;
use super::text::{counted, delays, label, line, seconds};
use crate::campaign::by::By;
use crate::campaign::definition::Expect;
use crate::campaign::results::{CellResults, Results};
use crate::campaign::statistics::heat::HeatStatistics;
use crate::campaign::statistics::target::Outcome;
use crate::campaign::statistics::{AlarmStatistics, FaultStatistics};

/// Everything, with a line end; of what is varied the cells as they are (`vary.md` and `cells.csv` have the others).
pub fn of(results: &Results) -> String {
    let mut text = String::new();
    let c = &results.campaign;
    let runs: usize = results.cells.iter().map(|cell| cell.runs).sum();
    let _ = writeln!(text, "{runs} runs in {} cells, seeds from {}", results.cells.len(), c.seeds_from);
    let is_told = |cell: &&CellResults| results.variations.is_empty() || cell.setting.is_empty();
    let (faults, silent): (Vec<_>, Vec<_>) =
        results.cells.iter().filter(is_told).partition(|cell| cell.expect == Expect::Fault);
    let (runaways, faults): (Vec<_>, Vec<_>) = faults.into_iter().partition(|cell| cell.is_runaway());
    fault_cells(&mut text, &faults);
    said::print(&mut text, results, &faults);
    runaway_cells(&mut text, &runaways);
    silent_cells(&mut text, &silent);
    confusion(&mut text, results);
    targets(&mut text, &results.targets);
    text
}

/// A cell's name on a line of its own, since the numbers need the rest of it.
fn heading(text: &mut String, cell: &CellResults, remarks: &[String]) {
    let remarks: String = remarks.iter().map(|remark| format!("; {remark}")).collect();
    line(text, &format!("{}: {} runs{remarks}", label(cell), cell.runs), "    ");
}

fn fault_cells(text: &mut String, cells: &[&CellResults]) {
    if cells.is_empty() {
        return;
    }
    *text += "\nFaults, by the likelihood diagnosis (L) and the signatures (S). Delays in s: median / 95 % / 99 %,\n\
              misses counted as infinitely late. Right: % of the runs whose first, whose last name was. Errors of\n\
              duration (95 %) and of size (50 / 95 %); % of the intervals that hold the true size.\n\n";
    let units = ["", "%", "", "%", "right", "right", "error, s", "error, %", "%"];
    for head in
        [["detection", "miss", "isolation", "never", "first", "last", "duration", "size", "holds"], units]
    {
        let _ = writeln!(text, "  {}", columns(head));
    }
    for cell in cells {
        let unarmed = By::BOTH.iter().filter(|by| cell.by(**by).unarmed > 0);
        let remarks: Vec<String> =
            unarmed.map(|by| format!("{} not armed in {}", by.name(), cell.by(*by).unarmed)).collect();
        heading(text, cell, &remarks);
        for by in By::BOTH {
            let line = cell.by(by).fault.as_ref().map_or("blind".into(), |f| fault_line(f, cell.runs));
            let _ = writeln!(text, "{} {}", letter(by), line.trim_end());
        }
    }
}

fn letter(by: By) -> char {
    match by {
        By::Likelihood => 'L',
        By::Signature => 'S',
    }
}

fn fault_line(f: &FaultStatistics, runs: usize) -> String {
    let share = |count: usize| format!("{:.1}", 100.0 * count as f64 / runs as f64);
    let percent = |x: Option<f64>| x.map_or("-".into(), |x| format!("{:.0}", 100.0 * x));
    let magnitude = &f.magnitude_error;
    let magnitude = if f.magnitude_coverage_pct.is_none() {
        "-".into()
    } else {
        format!("{} / {}", percent(magnitude.median), percent(magnitude.p95))
    };
    columns([
        &delays(&f.detection_delay_s),
        &share(f.missed),
        &delays(&f.isolation_delay_s),
        &share(f.not_isolated),
        &format!("{:.1}", f.first_right_pct),
        &format!("{:.1}", f.settled_right_pct),
        &seconds(f.duration_error_s.p95),
        &magnitude,
        &f.magnitude_coverage_pct.map_or("-".into(), |x| format!("{x:.1}")),
    ])
}

fn columns([detection, missed, isolation, never, first, last, duration, size, holds]: [&str; 9]) -> String {
    format!(
        "{detection:<20} {missed:>5}  {isolation:<21} {never:>5}  {first:>5}  {last:>5}  {duration:>8}  {size:>8}  {holds:>5}"
    )
}

/// The trips after the onset, and how many runs tripped before.
fn trips(heat: &HeatStatistics) -> String {
    match (heat.reasons.as_slice(), heat.tripped_early) {
        ([], 0) => "none".into(),
        (reasons, 0) => counted(reasons),
        (reasons, early) => format!("{} (before the fault {early})", counted(reasons)).trim_start().into(),
    }
}

fn runaway_cells(text: &mut String, cells: &[&CellResults]) {
    if cells.is_empty() {
        return;
    }
    *text += "\nHeat without effect, the worst of the runs: true air over the set-point, °C; heater off after the\n\
              onset, and after it could be seen, s; longest at full power, and above 1.8 times the power\n\
              needed, s; why it tripped (runs), and what likelihood settled on\n\n    \
              over       off   visible      full     above  trips; name\n";
    for cell in cells {
        heading(text, cell, &[]);
        let heat = &cell.heat;
        let numbers = format!(
            "{:>8} {:>9} {:>9} {:>9} {:>9}  {}; {}",
            heat.overshoot_max_c.map_or("-".into(), |x| format!("{x:+.1}")),
            seconds(heat.off_delay_max_s),
            seconds(heat.off_after_visible_max_s),
            seconds(heat.saturated_max_s),
            seconds(heat.overpower_max_s),
            trips(heat),
            cell.settled.as_deref().unwrap_or("not named")
        );
        line(text, &numbers, &" ".repeat(50));
    }
}

fn silent_cells(text: &mut String, cells: &[&CellResults]) {
    if cells.is_empty() {
        return;
    }
    *text += "\nNothing to be reported: runs with an alarm of the likelihood diagnosis (L) and of the signatures (S)\n\
              and alarms an hour [exact 95 % interval] in the hours watched. The interval takes alarms to be\n\
              independent: where they come in bursts it is too narrow.\n\n";
    for cell in cells {
        let mut remarks = Vec::new();
        if !cell.heat.reasons.is_empty() {
            remarks.push(format!("tripped: {}", counted(&cell.heat.reasons)));
        }
        if cell.likelihood.unarmed > 0 {
            remarks.push(format!("likelihood not armed in {}", cell.likelihood.unarmed));
        }
        heading(text, cell, &remarks);
        for by in By::BOTH {
            let _ = writeln!(text, "{} {}", letter(by), alarms(&cell.by(by).alarms));
        }
    }
}

pub(super) fn alarms(a: &AlarmStatistics) -> String {
    let rate = a.per_hour.zip(a.per_hour_95);
    let rate = rate.map_or("never watched".into(), |(rate, [low, high])| {
        let bursts = if a.dispersion.is_some_and(|d| d > BURSTS) { ", in bursts" } else { "" };
        format!("{} [{}, {}] an hour in {:.1} h{bursts}", short(rate), short(low), short(high), a.hours)
    });
    format!("{:>4}: {rate}", a.runs_with)
}

/// Above this dispersion alarms are said to come in bursts.
const BURSTS: f64 = 3.0;

/// Three digits.
pub(super) fn short(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if x < 0.1 => format!("{x:.4}"),
        x if x < 10.0 => format!("{x:.2}"),
        x => format!("{x:.0}"),
    }
}

fn confusion(text: &mut String, results: &Results) {
    for by in By::BOTH {
        let mut settings: Vec<&str> = results.confusion.iter().map(|c| c.setting.as_str()).collect();
        settings.dedup();
        for setting in settings {
            let entries: Vec<_> =
                results.confusion.iter().filter(|c| c.by == by && c.setting == setting).collect();
            if entries.is_empty() {
                continue;
            }
            let behind = if setting.is_empty() { String::new() } else { format!(" [{setting}]") };
            let _ = writeln!(
                text,
                "\nTrue class, and what {} settled on (reference rig, runs){behind}\n",
                if by == By::Likelihood { "likelihood" } else { "the signatures" }
            );
            for row in entries.chunk_by(|a, b| a.class == b.class) {
                let mut row = row.to_vec();
                row.sort_by_key(|c| std::cmp::Reverse(c.runs));
                let cells: Vec<String> = row.iter().map(|c| format!("{} {}", c.verdict, c.runs)).collect();
                line(text, &format!("{:<13} {}", row[0].class, cells.join(", ")), &" ".repeat(14));
            }
        }
    }
}

fn targets(text: &mut String, outcomes: &[Outcome]) {
    if outcomes.is_empty() {
        return;
    }
    let met = outcomes.iter().filter(|o| o.met).count();
    let _ = writeln!(text, "\nTargets: {met} of {} met\n", outcomes.len());
    for o in outcomes {
        let t = &o.target;
        let bounds = [t.at_most.map(|x| format!("at most {x}")), t.at_least.map(|x| format!("at least {x}"))];
        let bounds: Vec<String> = bounds.into_iter().flatten().collect();
        let measured = o.measured.map_or("never".into(), |x| format!("{x:.4}"));
        let measured = measured.trim_end_matches('0').trim_end_matches('.');
        let place = if t.each { format!("{}, worst: {}", t.cells, o.judged) } else { t.cells.clone() };
        let setting = if o.setting.is_empty() { String::new() } else { format!(" [{}]", o.setting) };
        let target = format!(
            "{}  {:<10} {:<22} {:<15} {measured:>9}  {place}{setting} ({} runs)",
            if o.met { "met   " } else { "MISSED" },
            t.judged(),
            t.measure.name(),
            bounds.join(", "),
            o.runs
        );
        line(text, &target, &" ".repeat(16));
    }
}
