//! What a campaign prints.

use std::fmt::Write;

use crate::campaign::by::By;
use crate::campaign::definition::Expect;
use crate::campaign::results::{CellResults, Results};
use crate::campaign::statistics::heat::HeatStatistics;
use crate::campaign::statistics::quantiles::Quantiles;
use crate::campaign::statistics::target::Outcome;
use crate::campaign::statistics::{AlarmStatistics, FaultStatistics};

/// Everything, with a line end.
pub fn of(results: &Results) -> String {
    let mut text = String::new();
    let c = &results.campaign;
    let runs: usize = results.cells.iter().map(|cell| cell.runs).sum();
    let _ = writeln!(text, "{runs} runs in {} cells, seeds from {}", results.cells.len(), c.seeds_from);
    let (faults, silent): (Vec<_>, Vec<_>) =
        results.cells.iter().partition(|cell| cell.expect == Expect::Fault);
    let (runaways, faults): (Vec<_>, Vec<_>) = faults.into_iter().partition(|cell| cell.is_runaway());
    fault_cells(&mut text, &faults);
    runaway_cells(&mut text, &runaways);
    silent_cells(&mut text, &silent);
    confusion(&mut text, results);
    targets(&mut text, &results.targets);
    text
}

pub(super) fn label(cell: &CellResults) -> String {
    let calm = if cell.disturbance == pt326_rig::Disturbance::Lively {
        String::new()
    } else {
        format!(", {}", cell.disturbance)
    };
    let setting = if cell.setting.is_empty() { String::new() } else { format!(" [{}]", cell.setting) };
    format!("{}{calm}{setting}", cell.name)
}

fn fault_cells(text: &mut String, cells: &[&CellResults]) {
    if cells.is_empty() {
        return;
    }
    let width = cells.iter().map(|cell| label(cell).chars().count()).max().unwrap_or(0).max(20);
    let _ = writeln!(
        text,
        "\nFaults: delays in s as median / 95 % / 99 %, misses counted as infinitely late; P likelihood, S signatures\n\n\
         {:width$}  runs     detection           missed  isolation           never   first   settled duration      magnitude        interval\n\
         {:width$}                                  %                       %       right % right % error 95 % s  error 50/95 %    holds %",
        "cell", ""
    );
    for cell in cells {
        for by in By::BOTH {
            let (name, runs) = match by {
                By::Likelihood => (label(cell), cell.runs.to_string()),
                By::Signature => (String::new(), String::new()),
            };
            let letter = if by == By::Likelihood { 'P' } else { 'S' };
            let seen = match &cell.by(by).fault {
                None => "blind".into(),
                Some(fault) => fault_line(fault, cell.runs),
            };
            let unarmed = match cell.by(by).unarmed {
                0 => String::new(),
                n => format!("   not armed in {n} runs"),
            };
            let line = format!("{name:width$}  {runs:>5} {letter} {seen}{unarmed}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
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
    format!(
        "{:<19} {:>6}  {:<19} {:>6}  {:>6.1}  {:>6.1}  {:>8}     {:>10}       {:>6}",
        delays(&f.detection_delay_s),
        share(f.missed),
        delays(&f.isolation_delay_s),
        share(f.not_isolated),
        f.first_right_pct,
        f.settled_right_pct,
        seconds(f.duration_error_s.p95),
        magnitude,
        f.magnitude_coverage_pct.map_or("-".into(), |x| format!("{x:.1}"))
    )
}

/// Each name with its count.
pub(super) fn counted(counts: &[(String, usize)]) -> String {
    let counts: Vec<String> = counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
    counts.join(", ")
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
    let width = cells.iter().map(|cell| label(cell).chars().count()).max().unwrap_or(0).max(20);
    let _ = writeln!(
        text,
        "\nHeat without effect, the worst of the runs: true air over the set-point, onset and visible to heater off, longest\n\
         time at full power and above 1.8 times the power needed; why it tripped (runs); what likelihood settled on\n\n\
         {:width$}  runs    over    off, s  visible  full, s  above, s  trips",
        "cell"
    );
    for cell in cells {
        let heat = &cell.heat;
        let _ = writeln!(
            text,
            "{:width$} {:>5} {:>+7.1} {:>9} {:>8} {:>8} {:>9}  {}; {}",
            label(cell),
            cell.runs,
            heat.overshoot_max_c.unwrap_or(f64::NAN),
            seconds(heat.off_delay_max_s),
            seconds(heat.off_after_visible_max_s),
            seconds(heat.saturated_max_s),
            seconds(heat.overpower_max_s),
            trips(heat),
            cell.settled.as_deref().unwrap_or("not named")
        );
    }
}

pub(super) fn delays(q: &Quantiles) -> String {
    if *q == Quantiles::default() {
        return "never".into();
    }
    [q.median, q.p95, q.p99].map(seconds).join(" / ")
}

pub(super) fn seconds(x: Option<f64>) -> String {
    x.map_or("-".into(), |x| format!("{x:.2}"))
}

fn silent_cells(text: &mut String, cells: &[&CellResults]) {
    if cells.is_empty() {
        return;
    }
    let width = cells.iter().map(|cell| label(cell).chars().count()).max().unwrap_or(0).max(20);
    let _ = writeln!(
        text,
        "\nNothing to be reported: runs with an alarm, alarms an hour [exact 95 % interval] in the hours watched\n\
         (the interval takes alarms to be independent: where they come in bursts it is too narrow)\n\n\
         {:width$}  runs   likelihood                                              signatures",
        "cell"
    );
    for cell in cells {
        let unarmed = match cell.likelihood.unarmed {
            0 => String::new(),
            n => format!("   likelihood not armed in {n} runs"),
        };
        let tripped = match cell.heat.reasons.as_slice() {
            [] => String::new(),
            reasons => format!("   tripped: {}", counted(reasons)),
        };
        let line = format!(
            "{:width$} {:>5}   {:<50}  {}{tripped}{unarmed}",
            label(cell),
            cell.runs,
            alarms(&cell.likelihood.alarms),
            alarms(&cell.signature.alarms)
        );
        let _ = writeln!(text, "{}", line.trim_end());
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
                let _ = writeln!(text, "{:<13} {}", row[0].class, cells.join(", "));
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
        let _ = writeln!(
            text,
            "{}  {:<10} {:<22} {:<15} {measured:>9}  {place}{setting} ({} runs)",
            if o.met { "met   " } else { "MISSED" },
            t.judged(),
            t.measure.name(),
            bounds.join(", "),
            o.runs
        );
    }
}
