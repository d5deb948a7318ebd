//! What was found, for people and programs: tables, `isolability.csv`, a picture for each horizon.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;
use fdi_core::FaultClass;

use super::{Asked, From, Isolability, Isolable};
use crate::record::figure;
use crate::record::figure::matrix::{Cell, Group, Matrix};

const NAME: usize = 22;
const COLUMN: usize = 6;
const WIDTH: usize = 100;

/// A table for each horizon. What is told from each fault at any size, all the time, needs no column.
pub fn tables(found: &Isolability) -> String {
    let is_open =
        |j: &usize| found.told.iter().flatten().any(|row| !matches!(row[*j], Isolable::Any | Isolable::Same));
    let (open, told): (Vec<usize>, Vec<usize>) = (0..found.rivals.len()).partition(is_open);
    let tables = found.horizons.iter().enumerate().map(|(h, horizon)| table(found, h, *horizon, &open));
    let mut text: String = tables.collect();
    if !told.is_empty() {
        let names: Vec<&str> = told.into_iter().map(|j| rival_name(found.rivals[j])).collect();
        text += &paragraph(format!("From {}, each is told at any size, all the time.", names.join(", ")));
    }
    text
}

/// What is told from all at any size needs no row.
fn table(found: &Isolability, h: usize, horizon: f64, columns: &[usize]) -> String {
    let mut text = format!("Told within {horizon} s from\n");
    for line in 0..2 {
        let heads = columns.iter().map(|j| format!("{:>COLUMN$}", head(found.rivals[*j])[line]));
        text += format!("{:NAME$}{}", "", heads.collect::<String>()).trim_end();
        text.push('\n');
    }
    let mut any = Vec::new();
    for (asked, row) in found.faults.iter().zip(&found.told[h]) {
        if row.iter().all(|told| matches!(told, Isolable::Any | Isolable::Same)) {
            any.push(asked.name());
            continue;
        }
        let cells = columns.iter().map(|j| format!("{:>COLUMN$}", cell(row[*j])));
        let line = format!("{:NAME$}{}  {}", asked.name(), cells.collect::<String>(), unit(asked));
        text += line.trim_end();
        text.push('\n');
    }
    if !any.is_empty() {
        text += &paragraph(format!("From all at any size: {}.", any.join(", ")));
    }
    text + "\n"
}

fn paragraph(text: String) -> String {
    textwrap::fill(&text, WIDTH) + "\n"
}

fn unit(asked: &Asked) -> &'static str {
    if asked.fault.sized { asked.fault.class.unit() } else { "" }
}

/// Words of the names of classes that are too long for a column.
const ABBREVIATED: [(&str, &str); 6] = [
    ("nothing", "none"),
    ("offset", "off"),
    ("clogged", "clog"),
    ("detached", "out"),
    ("heater", "heat"),
    ("swapped", "swap"),
];

/// The head of a column, in two lines. All pairs that may be exchanged share one.
fn head(rival: From) -> [&'static str; 2] {
    let name = match rival {
        From::Class(FaultClass::Swapped(_)) => "swapped",
        other => rival_name(other),
    };
    let fit = |word: &'static str| {
        ABBREVIATED.iter().find(|(long, _)| *long == word).map_or(word, |(_, short)| short)
    };
    name.split_once('_').map_or(["", fit(name)], |(first, second)| [fit(first), fit(second)])
}

/// A size without its sign.
fn cell(told: Isolable) -> String {
    match told {
        Isolable::Same => String::new(),
        Isolable::Never => "-".into(),
        Isolable::Any => "any".into(),
        Isolable::Above(size) => {
            let size = size.abs();
            let decimals = if size < 1.0 { 2 } else { usize::from(size < 10.0) };
            format!("{size:.decimals$}")
        }
    }
}

fn rival_name(rival: From) -> &'static str {
    match rival {
        From::Nothing => "nothing",
        From::All => "all",
        From::Class(class) => class.name(),
    }
}

/// Writes `isolability.csv`.
///
/// # Errors
/// The file can't be written.
pub fn write_csv(found: &Isolability, path: &Path) -> anyhow::Result<()> {
    std::fs::write(path, csv(found)).with_context(|| format!("can't write {}", path.display()))
}

/// `isolability.csv`: a line for each fault, rival and horizon.
pub fn csv(found: &Isolability) -> String {
    let mut text = String::from("fault,which,sign,unit,from,within_s,told,size\n");
    for (h, horizon) in found.horizons.iter().enumerate() {
        for (asked, row) in found.faults.iter().zip(&found.told[h]) {
            for (rival, told) in found.rivals.iter().zip(row) {
                let (word, size) = match told {
                    Isolable::Same => continue,
                    Isolable::Never => ("never", String::new()),
                    Isolable::Any => ("any", String::new()),
                    Isolable::Above(size) => ("above", size.to_string()),
                };
                let (class, which) = (asked.fault.class.name(), asked.fault.which);
                let (sign, unit, from) = (asked.sign_in_unit(), unit(asked), rival_name(*rival));
                let _ = writeln!(text, "{class},{which},{sign},{unit},{from},{horizon},{word},{size}");
            }
        }
    }
    text
}

/// `isolability-10s.svg`, and so on for each horizon; gives their names.
///
/// # Errors
/// The file that can't be written.
pub fn draw(found: &Isolability, folder: &Path) -> anyhow::Result<Vec<String>> {
    let draw_one = |(h, horizon): (usize, &f64)| {
        let name = format!("isolability-{horizon}s");
        let label = format!("Which faults can be told apart within {horizon} s");
        figure::draw(&matrix(found, h, label.clone()), &label, folder, &name)?;
        Ok(name)
    };
    found.horizons.iter().enumerate().map(draw_one).collect()
}

fn matrix(found: &Isolability, h: usize, title: String) -> Matrix {
    let row = |i: usize, rivals: std::ops::Range<usize>| -> Vec<Cell> {
        rivals.map(|j| painted(&found.faults[i], found.told[h][i][j])).collect()
    };
    let group = |title: &str, rivals: std::ops::Range<usize>| Group {
        title: title.into(),
        columns: found.rivals[rivals.clone()].iter().map(|rival| rival_name(*rival).into()).collect(),
        cells: (0..found.faults.len()).map(|i| row(i, rivals.clone())).collect(),
    };
    Matrix {
        title,
        corner: "fault, its sign".into(),
        rows: found.faults.iter().map(Asked::name).collect(),
        groups: vec![group("told from", 0..2), group("told from each class, of any size", 2..found.rivals.len())],
        notes: vec![
            "The size from which on the fault in the row is told from what stands above the column, at odds of 20 to 1 in the mean. \
             In \u{b0}C; \u{b0}C a minute (drift); % (all others)."
                .into(),
            format!(
                "Darker: told when smaller. Never told at a size that it can have: \u{2013}. Median of {} onsets, from {:.0} s on.",
                found.onsets, found.armed_at
            ),
        ],
    }
}

fn painted(asked: &Asked, told: Isolable) -> Cell {
    let text = match told {
        Isolable::Never => "\u{2013}".into(),
        told => cell(told),
    };
    let shade = match told {
        Isolable::Same => 0.0,
        Isolable::Never => 0.2,
        Isolable::Any => 1.0,
        Isolable::Above(size) => {
            let spread = f64::from(asked.fault.in_unit(asked.fault.first.sd)).abs();
            1.0 / (1.0 + size.abs() / spread)
        }
    };
    Cell { shade, is_right: told != Isolable::Never, text }
}
