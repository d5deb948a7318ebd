//! What a campaign writes: `campaign.json`, `cells.csv`, `runs.csv`, `tables.md`, `runaway.md`, `rigs.md`, `vary.md` and pictures.

pub mod field;
mod markdown;
mod pictures;
mod rigs;
mod runaway;
mod said;
pub mod table;
mod text;
mod variations;

use std::io::Write;
use std::path::Path;

use anyhow::Context;

use super::by::By;
use super::cell::Cell;
use super::results::{CellResults, Results};
use super::run::heat::Heat;
use super::run::{Observation, RunRow};
use super::statistics::heat::HeatStatistics;
use super::statistics::quantiles::Quantiles;
use crate::score::expectation::Expectation;
use field::{Field, field};
use text::counted;

/// Writes them all, and the pictures; gives their names.
///
/// # Errors
/// The file that can't be written.
pub fn write(results: &Results, cells: &[Cell], rows: &[RunRow], out: &Path) -> anyhow::Result<String> {
    let mut json = serde_json::to_vec_pretty(results)?;
    writeln!(json)?;
    write_file(out, "campaign.json", &json)?;
    write_file(out, "tables.md", markdown::of(results).as_bytes())?;
    write_file(out, "cells.csv", &csv(results.cells.iter().map(cell_fields))?)?;
    write_file(out, "runs.csv", &runs_csv(cells, rows)?)?;
    let mut names = String::from("campaign.json, cells.csv, runs.csv, tables.md");
    if let Some(runaway) = runaway::of(results) {
        write_file(out, "runaway.md", runaway.as_bytes())?;
        names += ", runaway.md";
    }
    if let Some(rigs) = rigs::of(results) {
        write_file(out, "rigs.md", rigs.as_bytes())?;
        names += ", rigs.md";
    }
    let plain = rows.iter().map(|row| &cells[row.cell]).filter(|cell| cell.setting.is_empty());
    let hours = plain.map(|cell| cell.scenario.duration).sum::<f64>() / 3600.0;
    if let Some(vary) = variations::of(&results.variations, &results.campaign, hours) {
        write_file(out, "vary.md", vary.as_bytes())?;
        names += ", vary.md";
    }
    Ok(names + &pictures::draw(results, cells, rows, out)?)
}

/// `runs.csv`: a row for each run.
///
/// # Errors
/// None that is known of.
pub fn runs_csv(cells: &[Cell], rows: &[RunRow]) -> anyhow::Result<Vec<u8>> {
    csv(rows.iter().map(|row| run_fields(&cells[row.cell], row)))
}

fn write_file(out: &Path, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let path = out.join(name);
    std::fs::write(&path, bytes).with_context(|| format!("can't write {}", path.display()))
}

/// A table whose header is made of the names of the first row.
fn csv(rows: impl Iterator<Item = Vec<Field>>) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.enumerate() {
        if i == 0 {
            writer.write_record(row.iter().map(|(name, _)| name))?;
        }
        writer.write_record(row.iter().map(|(_, value)| value.to_string()))?;
    }
    Ok(writer.into_inner()?)
}

/// The columns of runs.csv and of runs.parquet, for a run.
pub fn run_fields(cell: &Cell, row: &RunRow) -> Vec<Field> {
    let expected = cell.fault().map(Expectation::of);
    let mut fields = vec![
        field("cell", &cell.name),
        field("setting", &cell.setting),
        field("run", row.run),
        field("seed", row.seed),
        field("class", expected.and_then(|e| e.class).map(|c| c.name())),
        field("magnitude_true", expected.and_then(|e| e.magnitude)),
        field("onset_s", row.onset_s),
    ];
    fields.extend(heat_fields(&row.heat));
    for by in By::BOTH {
        fields.extend(observation_fields(by, row.by(by)));
    }
    fields.extend(said::run_fields(&row.said));
    fields
}

fn heat_fields(heat: &Heat) -> [Field; 8] {
    [
        field("air_max_c", heat.air_max_c),
        field("overshoot_max_c", heat.overshoot_max_c),
        field("trip", heat.trip.map(|reason| reason.name())),
        field("tripped_s", heat.tripped_s),
        field("off_delay_s", heat.off_delay_s),
        field("off_after_visible_s", heat.off_after_visible_s),
        field("saturated_s", heat.saturated_s),
        field("overpower_s", heat.overpower_s),
    ]
}

fn heat_statistics(heat: &HeatStatistics) -> [Field; 9] {
    [
        field("tripped_pct", heat.tripped_pct),
        field("tripped_otherwise_pct", heat.tripped_otherwise_pct),
        field("tripped_early", heat.tripped_early),
        field("trips", counted(&heat.reasons)),
        field("overshoot_max_c", heat.overshoot_max_c),
        field("off_delay_max_s", heat.off_delay_max_s),
        field("off_after_visible_max_s", heat.off_after_visible_max_s),
        field("saturated_max_s", heat.saturated_max_s),
        field("overpower_max_s", heat.overpower_max_s),
    ]
}

fn observation_fields(by: By, observed: &Observation) -> Vec<Field> {
    let fields = [
        field("armed", observed.armed),
        field("early", observed.early),
        field("detection_delay_s", observed.detection_delay_s),
        field("isolation_delay_s", observed.isolation_delay_s),
        field("indicated_duration_s", observed.indicated_duration_s),
        field("isolated_share", observed.isolated_share),
        field("first", observed.first.as_ref()),
        field("settled", observed.settled.as_ref()),
        field("magnitude", observed.magnitude),
        field("half_width", observed.half_width),
        field("onset_error_s", observed.onset_error_s),
        field("confidence", observed.confidence),
        field("alarms", observed.alarms),
        field("advices", observed.advices),
        field("watched_ticks", observed.watched_ticks),
        field("alarm_ticks", observed.alarm_ticks),
        field("advice_ticks", observed.advice_ticks),
        field("first_alarm_s", observed.first_alarm_s),
        field("first_alarm_as", observed.first_alarm_as.as_ref()),
    ];
    fields.into_iter().map(|(name, value)| (format!("{}_{name}", by.name()), value)).collect()
}

fn cell_fields(cell: &CellResults) -> Vec<Field> {
    let mut fields = vec![
        field("cell", &cell.name),
        field("plant", &cell.plant),
        field("setting", &cell.setting),
        field("disturbance", cell.disturbance.to_string()),
        field("class", cell.class),
        field("magnitude_true", cell.magnitude),
        field("runs", cell.runs),
    ];
    fields.extend(heat_statistics(&cell.heat));
    for by in By::BOTH {
        let statistics = cell.by(by);
        let fault = statistics.fault.as_ref();
        let mut these = vec![field("unarmed", statistics.unarmed)];
        for (name, quantiles) in [
            ("detection_delay_s", fault.map(|f| f.detection_delay_s)),
            ("isolation_delay_s", fault.map(|f| f.isolation_delay_s)),
            ("duration_error_s", fault.map(|f| f.duration_error_s)),
            ("magnitude_error", fault.map(|f| f.magnitude_error)),
            ("onset_error_s", fault.map(|f| f.onset_error_s)),
        ] {
            let Quantiles { median, p95, p99 } = quantiles.unwrap_or_default();
            these.extend(
                [("median", median), ("p95", p95), ("p99", p99)]
                    .map(|(q, x)| field(format!("{name}_{q}"), x)),
            );
        }
        let alarms = &statistics.alarms;
        these.extend([
            field("missed", fault.map(|f| f.missed)),
            field("early", fault.map(|f| f.early)),
            field("not_isolated", fault.map(|f| f.not_isolated)),
            field("first_right_pct", fault.map(|f| f.first_right_pct)),
            field("settled_right_pct", fault.map(|f| f.settled_right_pct)),
            field("magnitude_coverage_pct", fault.and_then(|f| f.magnitude_coverage_pct)),
            field("alarms", alarms.alarms),
            field("runs_with_alarm", alarms.runs_with),
            field("hours", alarms.hours),
            field("alarms_per_hour", alarms.per_hour),
            field("alarms_per_hour_low", alarms.per_hour_95.map(|i| i[0])),
            field("alarms_per_hour_high", alarms.per_hour_95.map(|i| i[1])),
            field("alarms_dispersion", alarms.dispersion),
            field("alarm_share_of_time", alarms.share_of_time),
            field("told_share_of_time", alarms.told_share_of_time),
        ]);
        fields.extend(these.into_iter().map(|(name, value)| (format!("{}_{name}", by.name()), value)));
    }
    fields.extend(said::cell_fields(&cell.said));
    fields
}
