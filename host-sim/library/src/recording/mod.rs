//! Recordings of heaters that others made, as samples on an even grid of time.

pub mod believed;
mod board_log;
mod cell;
mod clock;
mod date;
pub mod fit_rig;
pub mod format;
pub mod grid;
pub mod harness;
pub mod inject;
pub mod intervals;
pub mod leaps;
mod logs;
mod long;
pub mod map;
mod names;
mod normal;
mod pairs;
mod quirks;
pub mod report;
pub mod run;
pub mod score;
pub mod stamp;
pub mod table;
pub mod text;
pub mod training;
pub mod truth;
mod units;

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use fdi_core::likelihood::inputs::Inputs;
use fdi_core::{Observed, Units};

use crate::experiment::as_written;
use grid::Grid;
use map::{Map, Role};
use stamp::Stamps;
use table::Table;
pub use units::span;
use units::{celsius, full_power};

/// How a file is to be read; what is not said is guessed where it is obvious.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reading {
    /// `role=column` each; none: guessed from the header.
    pub map: Vec<String>,
    /// Sample time, s; none: by the time stamps.
    #[serde(rename = "ts")]
    pub sample_time: Option<f64>,
    /// The unit of times that are numbers; none: as the column's name says, or the numbers themselves.
    pub time_unit: Option<stamp::Unit>,
    /// Time stamps are brought to an even grid even where they lie on one.
    pub resample: bool,
    /// The power that is 100 %; none: as the format says, or the numbers themselves.
    pub full_power: Option<f64>,
    /// How many degC one unit of a temperature counts for.
    #[serde(rename = "degc")]
    pub celsius: Option<f64>,
    /// Whether a fan moves the air; none: as the format says, else yes.
    pub fan: Option<bool>,
    /// The power of a row is what drove the heater up to it, not from it on.
    pub power_before: bool,
    /// A power below zero cools: it is taken for a second input beside.
    pub cooling: bool,
    /// Each row is a sample, whatever its time says.
    #[serde(skip)]
    pub untimed: bool,
}

impl Reading {
    /// The same where each row is a sample, whatever its time says.
    pub fn untimed(mut self) -> Self {
        self.untimed = true;
        self
    }
}

/// One heater of a recording.
#[derive(Clone, Debug)]
pub struct Heater {
    /// Which column is what.
    pub map: Map,
    /// What is measured of it.
    pub inputs: Inputs,
    /// One sample each Ts.
    pub samples: Vec<Observed>,
    /// It is a rig of this project, of which the paper's signatures say something.
    pub is_ours: bool,
}

/// A recording.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its file.
    pub file: String,
    /// Ts, s.
    pub sample_time: f64,
    /// The samples of each session, in order: what was before one says nothing of what is in it. Between them samples are missing.
    pub sessions: Vec<Range<usize>>,
    /// What its units are.
    pub units: Units,
    /// Its heaters.
    pub heaters: Vec<Heater>,
    /// What whoever reads the results must know.
    pub remarks: Vec<String>,
    /// How its times are told; none where each row is a sample.
    pub stamps: Option<Stamps>,
    /// Samples from which a board has learnt what is normal, where its log says so.
    pub learnt: Option<Range<usize>>,
    /// What the file's clock showed when each session began, s since 1970; empty where it tells no dates.
    begins: Vec<f64>,
    /// The row of the file at each sample; none where it is missing.
    rows: Vec<Option<usize>>,
}

/// Samples of rest that are put before a recording which began at rest.
const REST: usize = 60;
/// Two sample times that differ by less are one.
const SAME: f64 = 0.02;

impl Recording {
    /// Reads a file; `-` is standard input.
    ///
    /// # Errors
    /// The file, line and column that are wrong, or what has to be said on top.
    pub fn read(path: &Path, how: &Reading) -> anyhow::Result<Self> {
        let (file, text) = text::text_of(path)?;
        Self::parse(file, &text, how)
    }

    /// The same of a text.
    ///
    /// # Errors
    /// The same.
    pub fn parse(file: String, text: &str, how: &Reading) -> anyhow::Result<Self> {
        let board = board_log::table(text).with_context(|| file.clone())?;
        let made = logs::klipper(text).or_else(|| long::table(text)).or_else(|| pairs::table(text));
        let text = match &board {
            Some(log) => &log.table,
            None => made.as_deref().or_else(|| logs::artisan(text)).unwrap_or(text),
        };
        let table = Table::parse(file, text)?;
        // What columns are called says nothing where somebody says what they are; a layout that is known does.
        let guess = format::guess(&table).filter(|guess| how.map.is_empty() || guess.name.is_some());
        let maps = match &guess {
            _ if !how.map.is_empty() => vec![Map::parse(how.map.iter().map(String::as_str))?],
            Some(guess) => guess.heaters.clone(),
            None => bail!(
                "{}: its columns are none of a known recording's: say which is what, by name or number, with --map t1=COLUMN --map power=COLUMN --map time=COLUMN; {}",
                table.file(),
                table.columns()
            ),
        };
        let fan = how.fan.or(guess.as_ref().map(|guess| guess.fan)).unwrap_or(true);
        let mut grid = Grid::new(&table, &maps[0], how)?;
        let mut remarks = grid.remarks.clone();
        remarks.extend(board.as_ref().and_then(|log| log.remark).map(str::to_owned));
        remarks.extend(table.left_out());
        let is_ours = board.is_some() || guess.as_ref().is_some_and(|guess| guess.is_ours);
        let mut heaters = Vec::new();
        for map in maps {
            let (mut heater, said) = heater(&table, map, &grid, fan)?;
            heater.is_ours = is_ours;
            heaters.push(heater);
            remarks.extend(said);
        }
        for heater in heaters.iter_mut().filter(|_| how.cooling) {
            cooled(heater)?;
        }
        let known_power = how.full_power.or(guess.as_ref().and_then(|guess| guess.full_power));
        let full_power = known_power.unwrap_or_else(|| as_written(full_power(&heaters) as f32));
        for heater in heaters.iter_mut().filter(|_| how.power_before) {
            grid.sessions.iter().for_each(|session| drive_from_here(&mut heater.samples[session.clone()]));
        }
        let known = how.celsius.or(board.as_ref().map(|_| 1.0));
        let celsius = known.unwrap_or_else(|| celsius(&heaters));
        for heater in &mut heaters {
            let (full_power, celsius) = (full_power as f32, celsius as f32);
            remarks.extend(quirks::take_out(&mut heater.samples, &grid.sessions, full_power, celsius));
            remarks.extend(quirks::constant_fan(&mut heater.samples));
        }
        // What was taken out of all heaters is as good as never written.
        let is_empty = |k: usize| {
            heaters.iter().all(|heater| heater.samples[k].t[1].is_none() && heater.samples[k].power.is_none())
        };
        for (k, row) in grid.rows.iter_mut().enumerate() {
            *row = row.filter(|_| !is_empty(k));
        }
        let learnt = board.as_ref().and_then(|log| log.learnt.clone()).and_then(|rows| {
            let mut within =
                (0..grid.rows.len()).filter(|&k| grid.rows[k].is_some_and(|row| rows.contains(&row)));
            within.next().map(|first| first..within.next_back().unwrap_or(first) + 1)
        });
        if celsius != 1.0 {
            remarks.push(format!("One unit of T1 counts for {celsius} °C, since the diagnosis was made for rises of some 30; --degc says otherwise."));
        }
        if let Some(guess) = guess.filter(|_| how.map.is_empty()) {
            let maps: Vec<String> = heaters.iter().map(|heater| heater.map.arguments()).collect();
            let taken = guess.name.map_or("Columns are taken for what they are called".into(), |name| {
                format!("Taken for {name}")
            });
            remarks.insert(
                0,
                format!("{taken}; the same: {} --full-power {full_power} --fan {fan}", maps.join(", or ")),
            );
        } else if known_power.is_none() && full_power != 100.0 {
            remarks.push(format!("A power of {full_power} is taken for 100 %; --full-power says otherwise."));
        }
        remarks.dedup();
        Ok(Self {
            file: table.file().to_owned(),
            sample_time: grid.sample_time,
            sessions: grid.sessions,
            begins: grid.begins,
            units: Units { celsius: celsius as f32, full_power: full_power as f32 },
            heaters,
            remarks,
            stamps: grid.stamps,
            learnt,
            rows: grid.rows,
        })
    }

    /// A text, and another of the same rig in the same units and at the same sample time, as far as nobody says them; of each what to call
    /// its file comes first, as [`text::text_of`] gives them.
    ///
    /// # Errors
    /// Those of either.
    pub fn with_other(
        (file, text): (String, &str),
        other: Option<(String, String)>,
        how: &Reading,
    ) -> anyhow::Result<(Self, Option<Self>)> {
        let mut this = Self::parse(file.clone(), text, how)?;
        let Some((other_file, other_text)) = other else { return Ok((this, None)) };
        let mut that = Self::parse(other_file.clone(), &other_text, how)?;
        let full_power = this.units.full_power.max(that.units.full_power);
        let sample_time = that.sample_time;
        let is_near = (this.sample_time - sample_time).abs() <= SAME * sample_time;
        let how = Reading {
            full_power: Some(full_power.into()),
            celsius: Some(that.units.celsius.into()),
            fan: Some(that.has_fan()),
            sample_time: how.sample_time.or(is_near.then_some(sample_time)),
            ..how.clone()
        };
        let units = Units { celsius: that.units.celsius, full_power };
        if this.units != units || this.sample_time != sample_time || this.has_fan() != that.has_fan() {
            this = Self::parse(file, text, &how)?;
        }
        if that.units != units {
            that = Self::parse(other_file, &other_text, &how)?;
        }
        Ok((this, Some(that)))
    }

    /// How many samples it has.
    pub fn len(&self) -> usize {
        self.heaters.first().map_or(0, |heater| heater.samples.len())
    }

    /// The rig was cold and its heater off before the first sample, which then says how warm the room is. Returns for how long, s.
    pub fn put_rest_before(&mut self) -> f64 {
        for heater in &mut self.heaters {
            let room = heater.samples.iter().find_map(|sample| sample.t[1]);
            heater.inputs.t0 = true;
            heater.samples.iter_mut().for_each(|sample| sample.t[0] = sample.t[0].or(room));
            let mut rest = heater.samples[0];
            rest.power = Some(0.0);
            rest.beside = rest.beside.map(|_| 0.0);
            rest.t = rest.t.map(|t| t.and(room));
            heater.samples.splice(0..0, std::iter::repeat_n(rest, REST));
        }
        let first = self.rows.iter().copied().flatten().next();
        self.rows.splice(0..0, std::iter::repeat_n(first, REST));
        self.learnt = self.learnt.take().map(|learnt| learnt.start + REST..learnt.end + REST);
        if let Some(begin) = self.begins.first_mut() {
            *begin -= REST as f64 * self.sample_time;
        }
        for (i, session) in self.sessions.iter_mut().enumerate() {
            *session = if i == 0 { 0 } else { session.start + REST }..session.end + REST;
        }
        REST as f64 * self.sample_time
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn has_fan(&self) -> bool {
        self.heaters.first().is_some_and(|heater| heater.inputs.fan)
    }

    /// The samples between gaps of more than [`pt326_fit::stretches::GAP`]: those of a session, or less.
    pub fn stretches(&self) -> Vec<Range<usize>> {
        pt326_fit::stretches::stretches(self.rows.iter().map(Option::is_some))
    }

    /// What a temperature of a heater is in: without a word in the header, degC where it moves as one does.
    pub fn unit(&self, heater: &Heater) -> &'static str {
        let words = heater.map.column(Role::T1).map(names::words).unwrap_or_default();
        let says = words.last().is_some_and(|word| names::DEGREES.contains(&word.as_str()));
        if says || self.units.celsius == 1.0 { "°C" } else { "units" }
    }

    /// What the file's clock showed at a time since the first sample, s; none where it tells no dates.
    pub fn date(&self, time: f64) -> Option<String> {
        let behind = self.sessions.partition_point(|session| self.at(time) >= session.start);
        let which = behind.saturating_sub(1);
        let start = self.sessions.get(which)?.start as f64 * self.sample_time;
        Some(date::shown(self.begins.get(which)? + time - start))
    }

    /// The sample at or after a time since the first, s.
    pub fn at(&self, time: f64) -> usize {
        (time / self.sample_time - 1e-6).ceil().max(0.0) as usize
    }
}

/// What a power below zero takes away is the power of a heater beside, which is never above zero.
fn cooled(heater: &mut Heater) -> anyhow::Result<()> {
    for role in [Role::Known, Role::T2] {
        let column = heater.map.column(role);
        ensure!(column.is_none(), "--cooling: not with a {role:?}, for which it stands");
    }
    for sample in &mut heater.samples {
        sample.beside = sample.power.map(|power| power.min(0.0));
        sample.power = sample.power.map(|power| power.max(0.0));
    }
    Ok(())
}

/// A heater, and what whoever reads the results must know of its columns.
fn heater(table: &Table, map: Map, grid: &Grid, fan: bool) -> anyhow::Result<(Heater, Vec<String>)> {
    let remarks = std::cell::RefCell::new(Vec::new());
    let values = |role: Role| -> anyhow::Result<Option<Vec<Option<f64>>>> {
        let Some(column) = map.column(role) else { return Ok(None) };
        let column = table.values_or_gaps(table.column(column)?)?;
        remarks.borrow_mut().extend(column.remarks);
        Ok(Some(column.values))
    };
    let levels = |role: Role| -> anyhow::Result<Option<Vec<Option<f32>>>> {
        let at = |values: Vec<Option<f64>>| {
            grid.rows.iter().map(|row| values[(*row)?].map(|x| x as f32)).collect()
        };
        Ok(values(role)?.map(at))
    };
    let temperatures = |role: Role| -> anyhow::Result<Option<Vec<Option<f32>>>> {
        let unit = map.column(role).and_then(names::to_celsius).unwrap_or(|x| x);
        let between = |values: Vec<Option<f64>>| {
            let at = |(k, row): (usize, &Option<usize>)| {
                let before = values[(*row)?];
                let next = grid.next.get(k).copied().flatten();
                let next = next.and_then(|(row, share)| Some((values[row]?, share)));
                Some(unit(before.map(|x| next.map_or(x, |(y, share)| x + share * (y - x)))?) as f32)
            };
            grid.rows.iter().enumerate().map(at).collect()
        };
        Ok(values(role)?.map(between))
    };
    let t = [temperatures(Role::T0)?, temperatures(Role::T1)?, temperatures(Role::T2)?];
    let power = levels(Role::Power)?.context("no column is said to be the power")?;
    let others = [levels(Role::Known)?, levels(Role::Fan)?, levels(Role::Supply)?];
    let at = |column: &Option<Vec<Option<f32>>>, k: usize| column.as_ref().and_then(|column| column[k]);
    let samples = (0..grid.rows.len()).map(|k| Observed {
        t: [0, 1, 2].map(|which| at(&t[which], k)),
        power: power[k],
        beside: at(&others[0], k),
        fan: at(&others[1], k),
        supply: at(&others[2], k),
        learn: false,
    });
    let samples = samples.collect();
    let inputs =
        Inputs { t0: map.column(Role::T0).is_some(), t2: map.column(Role::T2).is_some(), fan, ..Inputs::ALL };
    Ok((Heater { map, inputs, samples, is_ours: false }, remarks.into_inner()))
}

/// Of samples whose power drove the heater up to each of them makes such whose power drives it from each of them on.
pub fn drive_from_here(samples: &mut [Observed]) {
    for k in 1..samples.len() {
        let Observed { power, beside, .. } = samples[k];
        let before = &mut samples[k - 1];
        (before.power, before.beside) = (power.or(before.power), beside.or(before.beside));
    }
}
