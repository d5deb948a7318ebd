//! The pictures of a campaign, each drawn where there are results for it: delays against fault sizes, what a sweep trades,
//! and which fault was taken for which.

use crate::score::expectation::Expectation;
use std::path::Path;

use fdi_core::FaultClass;

use crate::campaign::by::By;
use crate::campaign::cell::Cell;
use crate::campaign::results::Results;
use crate::campaign::run::RunRow;
use crate::campaign::statistics::quantiles::{Quantiles, quantile};
use crate::campaign::statistics::trade::Trade;
use crate::record::figure::chart::{Axis, Chart, Dot, Log, Panel};
use crate::record::figure::matrix::{self, Group, Matrix};
use crate::record::figure::{self, BLUE, Colour, VERMILLION};
use pt326_rig::Disturbance;
use pt326_rig::fault::Sensor;

/// Draws what can be drawn; gives the names of the files.
///
/// # Errors
/// The file that can't be written.
pub(super) fn draw(results: &Results, cells: &[Cell], rows: &[RunRow], out: &Path) -> anyhow::Result<String> {
    let mut names = String::new();
    if let Some(chart) = delays(results, cells, rows) {
        figure::draw(&chart, "Detection delay against fault size", out, "delays")?;
        names += ", delays";
    }
    if let Some(chart) = trade(&results.trade) {
        figure::draw(&chart, "Detection delay against false alarms", out, "trade")?;
        names += ", trade";
    }
    if let Some(matrix) = confusion(results) {
        figure::draw(&matrix, "Confusion matrix", out, "confusion")?;
        names += ", confusion";
    }
    Ok(if names.is_empty() { names } else { format!("{names} (.svg)") })
}

fn colour(by: By) -> Colour {
    match by {
        By::Likelihood => BLUE,
        By::Signature => VERMILLION,
    }
}

fn legend() -> Vec<(String, Colour)> {
    vec![("likelihood diagnosis".into(), BLUE), ("the paper's signatures".into(), VERMILLION)]
}

/// Cells of one fault that differ in its size.
struct Family<'a> {
    title: String,
    /// With their numbers.
    cells: Vec<(usize, &'a Cell)>,
}

/// A number with its sign.
fn signed(x: f64) -> String {
    let x = (x * 100.0).round() / 100.0;
    if x < 0.0 { format!("\u{2212}{}", -x) } else { format!("+{x}") }
}

fn families(cells: &[Cell]) -> Vec<Family<'_>> {
    let mut families: Vec<Family> = Vec::new();
    let first_setting = cells.first().map_or("", |cell| cell.setting.as_str());
    for (number, cell) in cells.iter().enumerate() {
        let is_reference = cell.plant.is_empty() && cell.setting == first_setting;
        let Some(fault) =
            cell.fault().filter(|_| is_reference && cell.scenario.disturbance == Disturbance::Lively)
        else {
            continue;
        };
        let expected = Expectation::of(fault);
        let (Some(class), Some(_)) = (expected.class, expected.magnitude) else { continue };
        let title = title(class, fault.sensor);
        match families.iter_mut().find(|family| family.title == title) {
            Some(family) => family.cells.push((number, cell)),
            None => families.push(Family { title, cells: vec![(number, cell)] }),
        }
    }
    families.retain(|family| family.cells.len() > 1);
    for family in &mut families {
        let size = |cell: &Cell| {
            let fault = cell.fault();
            let magnitude = fault.and_then(|f| Expectation::of(f).magnitude).unwrap_or_default();
            (magnitude, fault.and_then(|f| f.lag).unwrap_or_default())
        };
        family.cells.sort_by(|a, b| size(a.1).partial_cmp(&size(b.1)).unwrap_or(std::cmp::Ordering::Equal));
    }
    families
}

fn title(class: FaultClass, sensor: Option<Sensor>) -> String {
    let what = class.axis();
    sensor.map_or(what.to_owned(), |sensor| format!("{sensor:?} {what}"))
}

/// 5th percentile, median, 95th percentile of the delay, and the share of the runs that missed the fault.
fn spread(by: By, rows: &[&RunRow]) -> ([f64; 3], f64) {
    let delay = |row: &&RunRow| row.by(by).detection_delay_s.unwrap_or(f64::INFINITY);
    let mut delays: Vec<f64> = rows.iter().map(delay).collect();
    delays.sort_by(f64::total_cmp);
    let missed = delays.iter().filter(|d| d.is_infinite()).count() as f64 / delays.len().max(1) as f64;
    ([0.05, 0.5, 0.95].map(|share| quantile(&delays, share).unwrap_or(f64::INFINITY)), missed)
}

/// How soon a fault is seen, over its size.
fn delays(results: &Results, cells: &[Cell], rows: &[RunRow]) -> Option<Chart> {
    let families = families(cells);
    families.first()?;
    let panels: Vec<Panel> = families.iter().map(|family| family_panel(family, rows)).collect();
    let values =
        panels.iter().flat_map(|p| &p.dots).flat_map(|d| d.y.into_iter().chain(d.y_bar.map(|b| b.0)));
    let longest = panels.iter().flat_map(|p| &p.dots).filter_map(|d| d.y_bar).map(|b| b.1);
    let y = Log {
        never: Some("missed, %"),
        ..Log::over("delay from the true onset to the first alarm (s)", values.chain(longest))
    };
    let counts = families.iter().flat_map(|f| &f.cells).map(|(_, cell)| cell.runs);
    let (least, most) = (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0));
    let count = if least == most { format!("{most}") } else { format!("{least} to {most}") };
    let notes = vec![
        format!(
            "Dot: median of {count} runs a size, lively surroundings. Bar: from the 5th to the 95th percentile of the runs; \
             a missed fault counts as infinitely late. Horizontal: true size."
        ),
        format!("Seeds of the campaign from {} on.", results.campaign.seeds_from),
    ];
    let title = "How soon a fault is detected, over its size".into();
    Some(Chart { title, legend: legend(), columns: 3, panels, y, notes })
}

fn family_panel(family: &Family, rows: &[RunRow]) -> Panel {
    let mut dots = Vec::new();
    let mut strip = Vec::new();
    let mut blind = false;
    let mut names = Vec::new();
    for (i, (number, cell)) in family.cells.iter().enumerate() {
        let fault = cell.fault();
        let size = fault.and_then(|f| Expectation::of(f).magnitude).unwrap_or_default();
        let lag = fault.and_then(|f| f.lag).map_or(String::new(), |lag| format!("\n{lag}"));
        names.push(signed(size) + &lag);
        let of_cell: Vec<&RunRow> = rows.iter().filter(|row| row.cell == *number).collect();
        for (by, aside) in [(By::Likelihood, -8.0), (By::Signature, 8.0)] {
            if by == By::Signature && fault.is_some_and(|f| Expectation::of(f).fdv.is_none()) {
                blind = true;
                continue;
            }
            let ([low, median, high], missed) = spread(by, &of_cell);
            dots.push(Dot {
                colour: colour(by),
                aside,
                x: i as f64,
                y: Some(median).filter(|m| m.is_finite()),
                x_bar: None,
                y_bar: Some((low, high)).filter(|(low, _)| low.is_finite()),
                label: String::new(),
            });
            if missed > 0.0 {
                let percent = 100.0 * missed;
                let text = if percent < 1.0 { format!("{percent:.1}") } else { format!("{percent:.0}") };
                strip.push((i as f64, 1.6 * aside, text, colour(by)));
            }
        }
    }
    let remark = blind.then(|| ("not in the signatures' tables".to_owned(), VERMILLION));
    Panel { title: family.title.clone(), x: Axis::Names(names), dots, strip, remark }
}

/// Medians that differ by less than this share can't be distinguished in the picture.
const ALIKE: f64 = 0.02;

/// What the settings of a sweep trade.
fn trade(trades: &[Trade]) -> Option<Chart> {
    let first = trades.first()?;
    if first.faults.is_empty() || first.undisturbed.per_hour.is_none() {
        return None;
    }
    let mut settings: Vec<&str> = trades.iter().map(|t| t.setting.as_str()).collect();
    settings.dedup();
    let number = |t: &Trade| settings.iter().position(|s| *s == t.setting).unwrap_or(0) + 1;
    let panels: Vec<Panel> = (0..first.faults.len())
        .map(|i| {
            let mut dots: Vec<Dot> = Vec::new();
            for t in trades {
                let Quantiles { median, p95, .. } = t.faults[i].detection_delay_s;
                let [median, p95] = [median, p95].map(|q| q.unwrap_or(f64::INFINITY));
                let rate = t.undisturbed.per_hour.unwrap_or_default();
                let new = Dot {
                    colour: colour(t.by),
                    aside: 0.0,
                    x: rate,
                    y: Some(median),
                    x_bar: t.undisturbed.per_hour_95.map(|[low, high]| (low, high)),
                    y_bar: Some((median, p95)),
                    label: number(t).to_string(),
                };
                let near = |a: f64, b: f64| a == b || (a - b).abs() < ALIKE * b.abs();
                let same =
                    |d: &Dot| d.colour == new.colour && d.x == new.x && near(d.y.unwrap_or(median), median);
                if !dots.iter().any(same) {
                    dots.push(new);
                }
            }
            Panel {
                title: first.faults[i].name.clone(),
                x: Axis::Log(rates(trades)),
                dots,
                strip: Vec::new(),
                remark: None,
            }
        })
        .collect();
    let dots = || panels.iter().flat_map(|p| &p.dots);
    let values = dots().filter_map(|d| d.y).chain(dots().filter_map(|d| d.y_bar).map(|b| b.1));
    let never = values.clone().any(f64::is_infinite).then_some("never");
    let y = Log { never, ..Log::over("delay from the true onset to the first alarm (s)", values) };
    let hours = first.undisturbed.hours;
    let mut notes = vec![format!(
        "Dot: median delay; bar upwards: to the 95th percentile of the runs; bar sideways: exact 95 % interval of the rate in {hours:.0} h a setting, lively surroundings."
    )];
    notes.push("Settings; one without a dot of its own changes nothing there against an earlier one:".into());
    notes.extend(lines(settings.iter().zip(1..).map(|(s, n)| {
        let name = if s.is_empty() { "as delivered" } else { s };
        format!("{n}  {name}")
    })));
    let title = "What a setting buys and what it costs".into();
    Some(Chart { title, legend: legend(), columns: 3, panels, y, notes })
}

/// Lower ends of the intervals may lie beyond: they would stretch the scale.
fn rates(trades: &[Trade]) -> Log {
    let highest = trades.iter().filter_map(|t| t.undisturbed.per_hour_95).map(|[_, high]| high);
    let values = trades.iter().filter_map(|t| t.undisturbed.per_hour).chain(highest);
    Log { zero: Some("none"), ..Log::over("false alarms an hour", values) }
}

/// Texts put together to lines of a bearable length.
fn lines(texts: impl Iterator<Item = String>) -> Vec<String> {
    const LONGEST: usize = 140;
    let mut lines: Vec<String> = Vec::new();
    for text in texts {
        match lines.last_mut() {
            Some(line) if line.chars().count() + text.chars().count() < LONGEST => {
                *line += &format!("     {text}")
            }
            _ => lines.push(text),
        }
    }
    lines
}

/// What each class was settled on as; of a sweep, with its first setting.
fn confusion(results: &Results) -> Option<Matrix> {
    let setting = &results.cells.first()?.setting;
    let entries: Vec<_> = results.confusion.iter().filter(|c| c.setting == *setting).collect();
    let mut classes: Vec<&str> = Vec::new();
    for cell in &results.cells {
        if let Some(class) = cell.class.filter(|class| entries.iter().any(|e| e.class == *class))
            && !classes.contains(&class)
        {
            classes.push(class);
        }
    }
    if classes.len() < 2 {
        return None;
    }
    let runs = |by: By, class: &str, verdict: Option<&str>| -> u32 {
        let of = entries.iter().filter(|e| e.by == by && e.class == class);
        of.filter(|e| verdict.is_none_or(|v| v == e.verdict)).map(|e| e.runs).sum()
    };
    let group = |by: By, title: &str| {
        let said: Vec<&str> = entries.iter().filter(|e| e.by == by).map(|e| e.verdict.as_str()).collect();
        let mut columns: Vec<&str> = classes.iter().copied().filter(|c| said.contains(c)).collect();
        for verdict in said {
            if !columns.contains(&verdict) && verdict != "none" {
                columns.push(verdict);
            }
        }
        columns.push("none");
        let share = |class: &str, verdict: &str| {
            let all = runs(by, class, None).max(1);
            matrix::Cell::share(f64::from(runs(by, class, Some(verdict))) / f64::from(all), class == verdict)
        };
        let row = |class: &&str| columns.iter().map(|verdict| share(class, verdict)).collect();
        let cells = classes.iter().map(row).collect();
        Group { title: title.into(), columns: columns.iter().map(ToString::to_string).collect(), cells }
    };
    let groups = vec![group(By::Likelihood, "likelihood diagnosis"), group(By::Signature, "signatures")];
    let rows =
        classes.iter().map(|class| format!("{class} ({})", runs(By::Likelihood, class, None))).collect();
    let notes = vec![
        "Share of the runs in %, reference rig, all sizes: the class named on most ticks of the fault. Blue: the right one; \
         orange: another; none: nothing was named."
            .into(),
        "The signatures have rows for t2_offset, t1_clogged and air_flow alone.".into(),
    ];
    let corner = "true class (runs)".into();
    Some(Matrix { title: "Which fault was taken for which".into(), corner, rows, groups, notes })
}
