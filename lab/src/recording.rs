//! A trace.csv as a recording: codes are found again from temperatures, commands from what changed, settings from what is told of them.

use anyhow::{Context, ensure};
use fdi_core::schema::{self, Entry, Moment};
use fdi_core::sense::plausibility::PlausibilityConfig;
use fdi_core::sense::supply::{Supply, SupplyState};
use fdi_core::sense::thermistor::Thermistor;
use fdi_core::{AdcCode, Celsius, Command, Config, Instrument, Percent, RawSample, Report, Seconds, Tick};

use crate::change;
use crate::time::{as_written, tick_time};
use crate::trace::{SETTINGS, TRUTH, cell, instrument_columns};

/// A recording.
pub struct Recording<'a> {
    /// Settings at the start.
    pub config: Config,
    /// Columns of a trace that it lacks, which can't be compared.
    pub lacks: Vec<&'static str>,
    /// Ticks without a gap, from the first on.
    pub rows: Vec<Recorded<'a>>,
    /// Columns that the core must come to again, with their places.
    compared: Vec<(&'static Entry, usize)>,
}

/// One recorded tick.
pub struct Recorded<'a> {
    /// What was asked for just before it.
    pub asked: Vec<Asked>,
    /// Codes.
    pub raw: RawSample,
    /// Number of the true fault, where the trace knows it.
    pub truth: u8,
    line: &'a str,
}

/// Something that changed the instrument before a tick.
pub enum Asked {
    /// A command.
    Command(Command),
    /// Other settings.
    Settings(Box<Config>),
}

impl<'a> Recording<'a> {
    /// Reads a trace. Its columns may stand in any order; those that it lacks are not compared. `config` is what it was made with, as
    /// far as it does not tell that itself.
    ///
    /// # Errors
    /// A column without which it can't be replayed, or a bad cell, by line and column.
    pub fn read(text: &'a str, config: &Config) -> anyhow::Result<Self> {
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let place = |column: &'static Entry| Some((column, position(&header, column.name)?));
        let compared: Vec<_> = instrument_columns().filter_map(place).collect();
        let lacks =
            instrument_columns().map(|c| c.name).filter(|name| position(&header, name).is_none()).collect();
        let mut config = config.clone();
        let inputs = InputColumns::find(&header).context("line 1")?;
        let first = text.lines().nth(1).unwrap_or_default();
        let told = inputs.settings.and_then(|i| first.split(',').nth(i)).unwrap_or_default();
        let start = told.split('|').next().unwrap_or_default();
        change::apply(&mut config, start).context("line 2")?;
        let senses = Senses::new(&config)?;
        let mut reader = Reader { senses, config: config.clone(), inputs, width: header.len(), before: None };
        let rows =
            lines.zip(2..).map(|(line, number)| reader.row(line).with_context(|| format!("line {number}")));
        let rows = rows.collect::<anyhow::Result<_>>()?;
        Ok(Self { config, lacks, rows, compared })
    }

    /// Runs the core on it again: the numbers of all ticks, in the order of [`FIELDS`](schema::FIELDS), with what the trace does not tell.
    ///
    /// # Errors
    /// The core comes to something else than what was recorded.
    pub fn numbers(&self) -> anyhow::Result<Vec<schema::Numbers>> {
        let mut instrument = Instrument::new(&self.config)?;
        let mut sigma_factor = self.config.diagnosis.sigma_factor;
        let sample_time = as_written(self.config.sample_time.0);
        let mut all = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            for asked in &row.asked {
                match asked {
                    Asked::Command(command) => drop(instrument.command(*command)), // what is refused now was refused then
                    Asked::Settings(config) => {
                        instrument.retune(config)?;
                        sigma_factor = config.diagnosis.sigma_factor;
                    }
                }
            }
            let tick = instrument.control(row.raw);
            let report = instrument.diagnose(&tick, tick.drive);
            let differs = differences(self.cells(row), &tick, &report, sample_time).into_iter().next();
            let at = tick_time(tick.index, sample_time);
            ensure!(differs.is_none(), "{at} s, {}", differs.unwrap_or_default());
            all.push(schema::row(&Moment {
                truth: row.truth,
                explained: schema::explained(&instrument, &report).as_ref(),
                normal: instrument.baseline().map(|baseline| &baseline.filtered),
                sigma_factor,
                ..Moment::new(&tick, &report)
            }));
        }
        Ok(all)
    }

    /// The cells of a row that the core must come to again.
    pub fn cells(&self, row: &Recorded<'a>) -> impl Iterator<Item = (&'static Entry, &'a str)> {
        let cells: Vec<&str> = row.line.split(',').collect();
        self.compared.iter().map(move |(column, i)| (*column, cells[*i]))
    }
}

/// In what the core's row differs from the trace's.
pub fn differences<'a>(
    said: impl Iterator<Item = (&'static Entry, &'a str)>,
    tick: &Tick,
    report: &Report,
    sample_time: f64,
) -> Vec<String> {
    let on = Moment::new(tick, report);
    let difference = |(column, theirs): (&'static Entry, &str)| {
        let ours = cell(column, &on, sample_time).to_string();
        (ours != theirs).then(|| format!("{}: trace {theirs:?}, core {ours:?}", column.name))
    };
    said.filter_map(difference).collect()
}

fn position(header: &[&str], name: &str) -> Option<usize> {
    header.iter().position(|column| *column == name)
}

/// Where the columns stand from which codes and commands are found again.
struct InputColumns {
    celsius: [usize; 3],
    setpoint: usize,
    prbs: usize,
    y1: usize,
    y2: usize,
    mode: usize,
    /// Columns that not every trace has.
    supply: Option<usize>,
    fan: Option<usize>,
    shelve: Option<usize>,
    truth: Option<usize>,
    settings: Option<usize>,
}

impl InputColumns {
    fn find(header: &[&str]) -> anyhow::Result<Self> {
        let place = |name: &str| {
            position(header, name)
                .with_context(|| format!("expected the header of a trace.csv, with a column {name}"))
        };
        Ok(Self {
            celsius: [place("t0_c")?, place("t1_c")?, place("t2_c")?],
            setpoint: place("setpoint_c")?,
            prbs: place("prbs_pct")?,
            y1: place("y1_c")?,
            y2: place("y2_c")?,
            mode: place("mode")?,
            supply: position(header, "supply"),
            fan: position(header, "fan_pct"),
            shelve: position(header, "shelve"),
            truth: position(header, TRUTH),
            settings: position(header, SETTINGS),
        })
    }
}

/// The cells of a row that the next one is compared with.
struct Before {
    celsius: [f32; 3],
    setpoint: f32,
    fan: Option<f32>,
    excited: bool,
    heating: bool,
    tuning: bool,
    monitoring: bool,
    tripped: bool,
}

/// How codes become readings.
struct Senses {
    thermistors: [Thermistor; 3],
    supply: Supply,
    limits: PlausibilityConfig,
}

impl Senses {
    fn new(config: &Config) -> anyhow::Result<Self> {
        let s = &config.sensors;
        Ok(Self {
            thermistors: [Thermistor::new(&s.t0, 0)?, Thermistor::new(&s.t1, 1)?, Thermistor::new(&s.t2, 2)?],
            supply: Supply::new(&config.supply)?,
            limits: config.plausibility,
        })
    }
}

struct Reader {
    /// Settings in force.
    config: Config,
    senses: Senses,
    inputs: InputColumns,
    /// Number of columns.
    width: usize,
    before: Option<Before>,
}

impl Reader {
    fn row<'a>(&mut self, line: &'a str) -> anyhow::Result<Recorded<'a>> {
        let cells: Vec<&str> = line.split(',').collect();
        ensure!(cells.len() >= self.width, "{} cells, expected {}", cells.len(), self.width);
        let mut asked = self.settings(&cells)?;
        let number = |i: usize| -> anyhow::Result<f32> {
            cells[i]
                .parse()
                .ok()
                .with_context(|| format!("cell {} is {:?}, expected a number", i + 1, cells[i]))
        };
        let at = &self.inputs;
        let celsius = [number(at.celsius[0])?, number(at.celsius[1])?, number(at.celsius[2])?];
        let heating = !matches!(cells[at.mode], "off" | "tripped");
        let [tuning, monitoring, tripped] = ["tune", "monitor", "tripped"].map(|mode| cells[at.mode] == mode);
        let excited = match (self.config.prbs.amplitude.0 == 0.0, &self.before) {
            (true, Some(before)) => before.excited, // it can't be seen
            (no_amplitude, _) => no_amplitude || number(at.prbs)? != 0.0,
        };
        let known = |at: Option<usize>| at.filter(|i| !cells[*i].is_empty()).map(number).transpose();
        let (supply, fan) = (known(at.supply)?, known(at.fan)?);
        let now = Before {
            celsius,
            setpoint: number(at.setpoint)?,
            fan,
            excited,
            heating,
            tuning,
            monitoring,
            tripped,
        };
        let (no_y1, no_y2) = (cells[at.y1].is_empty(), cells[at.y2].is_empty());
        let Senses { thermistors, limits, .. } = &self.senses;
        let [t0, t1, t2] = std::array::from_fn(|i| {
            // A sample that went missing repeats the temperature before, and has no rise.
            let repeats = self.before.as_ref().is_some_and(|b| b.celsius[i] == celsius[i]);
            let blank = match i {
                0 => no_y1 && no_y2,
                1 => no_y1,
                _ => no_y2,
            };
            let code = code(&thermistors[i], celsius[i]);
            // A broken wire, or wires that touch, read the same from tick to tick, and are no missing sample.
            let connected = code > limits.short_code.0 && code < limits.open_code.0;
            AdcCode(if repeats && blank && connected { f32::NAN } else { code })
        });
        let supply = AdcCode(supply.map_or(0.0, |share| supply_code(&self.senses.supply, share)));
        asked.extend(commands(self.before.as_ref(), &now).into_iter().map(Asked::Command));
        asked.extend(known(at.shelve)?.map(|ticks| Asked::Command(shelving(ticks, self.config.sample_time))));
        let truth = at.truth.and_then(|i| cells[i].trim().parse().ok()).unwrap_or(0);
        self.before = Some(now);
        Ok(Recorded { asked, raw: RawSample { t0, t1, t2, supply }, truth, line })
    }

    /// What is told of the settings: the change after each `|`, and where it is not the first row, the one before the first.
    fn settings(&mut self, cells: &[&str]) -> anyhow::Result<Vec<Asked>> {
        let told = self.inputs.settings.map_or("", |i| cells[i]);
        let known = usize::from(self.before.is_none()); // with what it began
        let mut asked = Vec::new();
        for change in told.split('|').skip(known).filter(|_| !told.is_empty()) {
            change::apply(&mut self.config, change)?;
            asked.push(Asked::Settings(Box::new(self.config.clone())));
        }
        if !asked.is_empty() {
            self.senses = Senses::new(&self.config)?;
        }
        Ok(asked)
    }
}

/// The code that reads as exactly this temperature.
fn code(thermistor: &Thermistor, celsius: f32) -> f32 {
    let about = thermistor.code(Celsius(celsius)).0;
    exact(about, |code| thermistor.celsius(AdcCode(code)).0 == celsius)
}

/// The code that reads as exactly this share of the nominal voltage.
fn supply_code(supply: &Supply, share: f32) -> f32 {
    exact(supply.code(share).0, |code| {
        let mut state = SupplyState::default();
        supply.step(&mut state, AdcCode(code));
        state.share() == Some(share)
    })
}

/// Of the codes near `about`, whole ones and means of 16 conversions, the one that reads as it should.
fn exact(about: f32, reads: impl Fn(f32) -> bool) -> f32 {
    let near = |steps: f32| [0.0, -1.0, 1.0].map(|d| ((about * steps).round() + d) / steps);
    [near(1.0), near(16.0)].concat().into_iter().find(|&code| reads(code)).unwrap_or(about)
}

/// What was said of an alarm, from the number of ticks that a row has.
fn shelving(ticks: f32, ts: Seconds) -> Command {
    // In the middle of the last tick, so that rounding up gives as many again.
    if ticks < 0.0 { Command::Acknowledge } else { Command::Shelve(Seconds((ticks - 0.5).max(0.0) * ts.0)) }
}

/// What must have been asked for between two rows.
fn commands(before: Option<&Before>, now: &Before) -> Vec<Command> {
    let mut commands = Vec::new();
    let (was_heating, was_tripped) = before.map_or((false, false), |b| (b.heating, b.tripped));
    if before.is_some_and(|b| now.setpoint != b.setpoint) {
        commands.push(Command::SetPoint(Celsius(now.setpoint)));
    }
    if was_tripped && !now.tripped {
        commands.push(Command::Acknowledge);
    }
    if now.heating && !was_heating {
        commands.push(if now.tuning { Command::Tune } else { Command::Arm });
    } else if was_heating && !now.heating && !now.tripped {
        commands.push(Command::Stop);
    }
    if let Some(level) = now.fan.filter(|level| before.and_then(|b| b.fan) != Some(*level)) {
        commands.push(Command::Fan(Percent(level)));
    }
    if now.heating && !now.monitoring && before.is_some_and(|b| b.monitoring) {
        commands.push(Command::Relearn); // nothing else leads from monitoring back to learning
    }
    let excited = before.is_none_or(|b| b.excited || !b.heating || b.tuning);
    if now.heating && !now.tuning && now.excited != excited {
        commands.push(Command::Excite(now.excited));
    }
    commands
}
