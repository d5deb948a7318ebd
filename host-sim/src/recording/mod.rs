//! Recordings of heaters that others made, as samples on an even grid of time.

pub mod format;
pub mod harness;
pub mod inject;
pub mod run;
pub mod score;
pub mod table;
pub mod training;
pub mod truth;

use std::path::Path;

use anyhow::{Context, bail, ensure};
use fdi_core::likelihood::inputs::Inputs;
use fdi_core::{Observed, Units};

use format::{Map, Role};
use table::Table;

/// How a file is to be read; what is not said is guessed where it is obvious.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reading {
    /// `role=column` each; none: guessed from the header.
    pub map: Vec<String>,
    /// Sample time, s; none: by the time stamps.
    #[serde(rename = "ts")]
    pub sample_time: Option<f64>,
    /// Uneven time stamps are brought to an even grid.
    pub resample: bool,
    /// The power that is 100 %; none: 100, or as the format says.
    pub full_power: Option<f64>,
    /// How many degC one unit of a temperature counts for.
    #[serde(rename = "degc")]
    pub celsius: Option<f64>,
    /// Whether a fan moves the air; none: as the format says, else yes.
    pub fan: Option<bool>,
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
}

/// A recording.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its file.
    pub file: String,
    /// What it was taken for.
    pub format: &'static str,
    /// Ts, s.
    pub sample_time: f64,
    /// What its units are.
    pub units: Units,
    /// Its heaters.
    pub heaters: Vec<Heater>,
    /// What whoever reads the results must know.
    pub remarks: Vec<String>,
    /// The row of the file at each sample; none where it is missing.
    rows: Vec<Option<usize>>,
}

/// A T1 that moves by so much is in degC; one that does not is made to move by so much.
const SPANS: (f64, f64) = (5.0, 1000.0);
const TYPICAL_SPAN: f64 = 30.0;
/// Samples of rest that are put before a recording which began at rest.
const REST: usize = 60;
/// Stamps may be off the grid by so much of Ts.
const UNEVEN: f64 = 0.2;
/// A sample that is older than so many Ts is missing, where uneven ones are brought to a grid.
const STALE: f64 = 2.0;
/// Samples of a grid that a typing error in a stamp may ask for.
const MOST: f64 = 5e6;

impl Recording {
    /// Reads a file; `-` is standard input.
    ///
    /// # Errors
    /// The file, line and column that are wrong, or what has to be said on top.
    pub fn read(path: &Path, how: &Reading) -> anyhow::Result<Self> {
        let (file, text) = table::text_of(path)?;
        Self::parse(file, &text, how)
    }

    /// The same of a text.
    ///
    /// # Errors
    /// The same.
    pub fn parse(file: String, text: &str, how: &Reading) -> anyhow::Result<Self> {
        let klipper = format::klipper(text);
        let text = klipper.as_deref().or_else(|| format::artisan(text)).unwrap_or(text);
        let table = Table::parse(file, text)?;
        let guess = format::guess(&table);
        let maps = match &guess {
            _ if !how.map.is_empty() => vec![Map::parse(how.map.iter().map(String::as_str))?],
            Some(guess) => guess.heaters.clone(),
            None => bail!(
                "{}: its columns are none of a known recording's: say which is what with --map t1=COLUMN --map power=COLUMN; {}",
                table.file(),
                table.columns()
            ),
        };
        let full_power = how.full_power.or(guess.as_ref().map(|guess| guess.full_power)).unwrap_or(100.0);
        let fan = how.fan.or(guess.as_ref().map(|guess| guess.fan)).unwrap_or(true);
        let grid = Grid::new(&table, &maps[0], how)?;
        let heaters = maps
            .into_iter()
            .map(|map| heater(&table, map, &grid, fan))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let mut remarks = grid.remarks.clone();
        let celsius = how.celsius.unwrap_or_else(|| celsius(&heaters));
        if celsius != 1.0 {
            remarks.push(format!("One unit of T1 counts for {celsius} °C, since the diagnosis was made for rises of some 30; --degc says otherwise."));
        }
        let format = guess.filter(|_| how.map.is_empty()).map_or("as told", |guess| guess.name);
        if format != "as told" {
            remarks.push(format!("Taken for {format}; --map says otherwise."));
        }
        Ok(Self {
            file: table.file().to_owned(),
            format,
            sample_time: grid.sample_time,
            units: Units { celsius: celsius as f32, full_power: full_power as f32 },
            heaters,
            remarks,
            rows: grid.rows,
        })
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
        self.rows.splice(0..0, std::iter::repeat_n(None, REST));
        REST as f64 * self.sample_time
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The sample at or after a time since the first, s.
    pub fn at(&self, time: f64) -> usize {
        (time / self.sample_time - 1e-6).ceil().max(0.0) as usize
    }
}

/// Which row stands at each place of an even grid of time.
struct Grid {
    sample_time: f64,
    rows: Vec<Option<usize>>,
    remarks: Vec<String>,
}

impl Grid {
    fn new(table: &Table, map: &Map, how: &Reading) -> anyhow::Result<Self> {
        let Some(column) = map.column(Role::Time).filter(|_| !how.untimed) else {
            let Some(sample_time) = how.sample_time else {
                bail!(
                    "{}: no column is said to be the time: add --map time=COLUMN, or --ts with the sample time in s",
                    table.file()
                )
            };
            let rows = (0..table.rows()).map(Some).collect();
            return Ok(Self { sample_time, rows, remarks: Vec::new() });
        };
        let column = table.column(column)?;
        let stamps = table.values_or_gaps(column)?;
        let stamps: Vec<(usize, f64)> =
            stamps.into_iter().enumerate().filter_map(|(i, t)| Some((i, t?))).collect();
        let line = |row: usize| format!("{}, line {}", table.file(), table.line_of(row));
        for pair in stamps.windows(2) {
            ensure!(
                pair[1].1 > pair[0].1,
                "{}, column {}: time {} comes after {}, expected a later one",
                line(pair[1].0),
                column + 1,
                pair[1].1,
                pair[0].1
            );
        }
        ensure!(stamps.len() > 1, "{}: fewer than two rows have a time", table.file());
        let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
        steps.sort_by(f64::total_cmp);
        let sample_time = how.sample_time.unwrap_or(tidy(steps[steps.len() / 2]));
        let (start, end) = (stamps[0].1, stamps[stamps.len() - 1].1);
        let count = (end - start) / sample_time;
        ensure!(
            count < MOST,
            "{}: {start} to {end} s at {sample_time} s are {count:.0} samples",
            table.file()
        );
        let mut rows = vec![None; count.round() as usize + 1];
        if how.resample {
            let mut next = 0;
            for (k, place) in rows.iter_mut().enumerate() {
                let t = start + k as f64 * sample_time;
                while next + 1 < stamps.len() && stamps[next + 1].1 <= t + 1e-9 {
                    next += 1;
                }
                *place = (t - stamps[next].1 <= STALE * sample_time).then_some(stamps[next].0);
            }
        } else {
            for (row, t) in &stamps {
                let k = (t - start) / sample_time;
                ensure!(
                    (k - k.round()).abs() <= UNEVEN,
                    "{}: time {t} is not on a grid of {sample_time} s from {start} s: say --ts, or --resample to take the last row at \
                     each of its points",
                    line(*row)
                );
                rows[k.round() as usize] = Some(*row);
            }
        }
        let gaps = rows.iter().filter(|row| row.is_none()).count();
        let remarks =
            if gaps > 0 { vec![format!("{gaps} of {} samples are missing.", rows.len())] } else { vec![] };
        Ok(Self { sample_time, rows, remarks })
    }
}

/// How many degC one unit of a temperature should count for: 1, but where T1 moves by so little or so much that its unit is no degC.
fn celsius(heaters: &[Heater]) -> f64 {
    let t1 = heaters.iter().flat_map(|heater| &heater.samples).filter_map(|sample| sample.t[1]);
    let (low, high) = span(t1);
    let span = high - low;
    if !(span > 0.0) || (SPANS.0..SPANS.1).contains(&span) {
        return 1.0;
    }
    let exact = TYPICAL_SPAN / span;
    let decade = 10f64.powf(exact.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    steps.into_iter().min_by(|a, b| (a / exact).ln().abs().total_cmp(&(b / exact).ln().abs())).unwrap_or(1.0)
}

/// The lowest and the highest of some values, but for those that are so far from all others that no rig has been there: one odd row must not
/// say what the unit is, or what the gain.
pub fn span(values: impl Iterator<Item = f32>) -> (f64, f64) {
    /// What lies beyond the middle 98 % by so many times their spread.
    const FAR: f32 = 20.0;
    let mut values: Vec<f32> = values.filter(|x| x.is_finite()).collect();
    let mut quantile = |share: f64| {
        let place = (share * values.len().saturating_sub(1) as f64).round() as usize;
        let all = !values.is_empty();
        if all { *values.select_nth_unstable_by(place, f32::total_cmp).1 } else { f32::NAN }
    };
    let [low, high] = [0.01, 0.99].map(&mut quantile);
    let far = FAR * (high - low);
    let near = |x: &f32| !(far > 0.0) || (low - far..=high + far).contains(x);
    let kept = values.into_iter().filter(near).map(f64::from);
    kept.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
}

/// A sample time as someone would write it: stamps are rounded.
fn tidy(step: f64) -> f64 {
    let rounded = (step * 1e4).round() / 1e4;
    if rounded > 0.0 { rounded } else { step }
}

fn heater(table: &Table, map: Map, grid: &Grid, fan: bool) -> anyhow::Result<Heater> {
    let values = |role: Role| -> anyhow::Result<Option<Vec<Option<f32>>>> {
        let Some(column) = map.column(role) else { return Ok(None) };
        let column = table.column(column)?;
        let values = table.values_or_gaps(column)?;
        Ok(Some(grid.rows.iter().map(|row| values[(*row)?].map(|value| value as f32)).collect()))
    };
    let all = |roles: [Role; 3]| -> anyhow::Result<Vec<_>> { roles.into_iter().map(values).collect() };
    let temperatures = all([Role::T0, Role::T1, Role::T2])?;
    let power = values(Role::Power)?.context("no column is said to be the power")?;
    let others = all([Role::Known, Role::Fan, Role::Supply])?;
    let at = |column: &Option<Vec<Option<f32>>>, k: usize| column.as_ref().and_then(|column| column[k]);
    let samples = (0..grid.rows.len()).map(|k| Observed {
        t: [0, 1, 2].map(|which| at(&temperatures[which], k)),
        power: power[k],
        beside: at(&others[0], k),
        fan: at(&others[1], k),
        supply: at(&others[2], k),
        learn: false,
    });
    let samples = samples.collect();
    let inputs =
        Inputs { t0: map.column(Role::T0).is_some(), t2: map.column(Role::T2).is_some(), fan, ..Inputs::ALL };
    Ok(Heater { map, inputs, samples })
}
