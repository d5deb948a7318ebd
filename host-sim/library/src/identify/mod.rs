//! The core's identification on a recorded file: an ARX model, what it says, how far it may be trusted.

pub mod detrend;
pub mod estimate;
pub mod findings;
pub mod model;
pub mod poles;
pub mod report;
pub mod stamps;
pub mod warning;

use std::ops::Range;

use anyhow::{Context, ensure};

use crate::recording::table::Table;
use detrend::{Detrend, Detrended, detrended};
use findings::{Findings, Fits};
use model::{Model, Order, Signals};
use report::{Question, Report, Validation};
use stamps::Stamps;
use warning::{Warning, warnings};

/// What is to be identified from a table.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The column of the input: its name or, if none has that name, its number, counted from 1.
    pub u: String,
    /// The column of the output, likewise.
    pub y: String,
    /// Orders of the model.
    pub order: Order,
    /// Sample time, s; none: the usual step in the column of times.
    pub ts: Option<f64>,
    /// Forgetting factor, 0.5 to 1.
    pub lambda: f64,
    /// What to do about the values that u and y have at rest.
    pub detrend: Detrend,
    /// First row to estimate from, counted from 0.
    pub from: usize,
    /// The row after the last one to estimate from; none: the number of rows.
    pub to: Option<usize>,
    /// Rows to test the model on.
    pub validate: Option<Range<usize>>,
}

/// Identifies a model from `table`, judges it and tests it.
///
/// # Errors
/// What is wrong in the table or in what was asked, by name.
pub fn identify(asked: &Asked, table: &Table) -> anyhow::Result<Report> {
    let columns = (table.column(&asked.u)?, table.column(&asked.y)?);
    let range = asked.from..asked.to.unwrap_or(table.rows());
    let recorded = signals(table, columns, &range)?;
    let stamps = Stamps::find(table, columns, &range);
    let ts = asked
        .ts
        .or(stamps.as_ref().map(|stamps| stamps.usual))
        .context("no sample time: expected --ts, or a column of times that rise (named t, time, t_s, ...)")?;
    let Detrended { detrend, offsets, estimate } =
        detrended(&recorded, asked.detrend, asked.order, asked.lambda)?;
    let used = recorded.minus(offsets.0, offsets.1);

    let mut doubts: Vec<Warning> = stamps
        .map(|stamps| stamps.warnings(ts))
        .into_iter()
        .flatten()
        .chain(warnings(&used, &estimate))
        .collect();
    let mut validation = None;
    if let Some(rows) = &asked.validate {
        let unseen = signals(table, columns, rows)?.minus(offsets.0, offsets.1);
        validation = Some(validate(&estimate.model, &unseen, rows)?);
        if rows.start < range.end && range.start < rows.end {
            doubts.push(Warning::ValidationOverlaps);
        }
    }
    Ok(Report {
        question: Question {
            file: table.file().to_owned(),
            rows: table.rows(),
            from: range.start,
            to: range.end,
            u: table.name(columns.0),
            y: table.name(columns.1),
            order: asked.order,
            ts_s: ts,
            lambda: asked.lambda,
            detrend,
            detrend_chosen: asked.detrend == Detrend::Auto,
        },
        findings: Findings::new(&estimate, ts),
        fits: Fits::new(&estimate.model, &used),
        initial_state: initial_state(asked.order),
        validation,
        warnings: doubts,
    })
}

/// The columns u and y in `rows`.
fn signals(table: &Table, (u, y): (usize, usize), rows: &Range<usize>) -> anyhow::Result<Signals> {
    Ok(Signals { u: table.values(u, rows.clone())?, y: table.values(y, rows.clone())? })
}

fn validate(model: &Model, unseen: &Signals, rows: &Range<usize>) -> anyhow::Result<Validation> {
    let least = model.order.memory() + 2;
    ensure!(rows.len() >= least, "--validate: {} rows are too few, expected {least} or more", rows.len());
    Ok(Validation { from: rows.start, to: rows.end, fits: Fits::new(model, unseen) })
}

fn initial_state(order: Order) -> String {
    match order.memory() {
        1 => "from the first measured row of the range".into(),
        n => format!("from the first {n} measured rows of the range"),
    }
}
