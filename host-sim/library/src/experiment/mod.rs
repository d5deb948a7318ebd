//! One run of an instrument against the rig.

mod fault_size;
pub mod scenario;

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::schema::{self, Explained};
use fdi_core::{Command, Config, Instrument, Percent, RawSample, Report, Tick};

pub use fault_size::{FaultSize, paper_sequence};
use pt326_lab::change::Settings;
use pt326_lab::names::Names;
pub use pt326_lab::preset::with_prbs_phase;
pub use pt326_lab::session::{sample, truth};
pub use pt326_lab::time::{as_written, tick_time};
use pt326_rig::fault::Fault;
use pt326_rig::{Disturbance, Rig, RigConfig};
use scenario::{Scenario, commands};

/// Something that can stand in for the board: it takes codes and gives a drive and a report.
pub trait Backend {
    /// First half of a tick.
    fn control(&mut self, raw: RawSample) -> Tick;
    /// Second half of a tick; `tick` is what the first half gave.
    fn diagnose(&mut self, tick: &Tick) -> Report;
    /// A command of the user; what is refused is returned as text.
    fn command(&mut self, command: Command) -> Result<(), String>;
    /// What has been learnt.
    fn baseline(&self) -> Option<Baseline>;
    /// What each hypothesis explains of an alarm, where that can be asked.
    fn explained(&self, report: &Report) -> Option<Explained> {
        let _ = report;
        None
    }
}

impl Backend for Instrument {
    fn control(&mut self, raw: RawSample) -> Tick {
        Instrument::control(self, raw)
    }

    fn diagnose(&mut self, tick: &Tick) -> Report {
        Instrument::diagnose(self, tick, tick.drive)
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        Instrument::command(self, command).map_err(|refusal| refusal.to_string())
    }

    fn baseline(&self) -> Option<Baseline> {
        Instrument::baseline(self).copied()
    }

    fn explained(&self, report: &Report) -> Option<Explained> {
        schema::explained(self, report)
    }
}

/// One tick of a run.
#[derive(Clone, Debug)]
pub struct Row {
    /// First half.
    pub tick: Tick,
    /// Second half.
    pub report: Report,
    /// What the heater got from this tick to the next, %.
    pub applied: Percent,
    /// Number of the fault that acts at this tick, 0 for none; the latest onset if several do.
    pub truth: u8,
}

/// Where a run comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// The simulated rig.
    Simulated {
        /// Seed of the rig's noise.
        seed: u64,
        /// How the surroundings moved.
        disturbance: Disturbance,
    },
    /// A recording, run through the core again.
    Recorded {
        /// Its file.
        file: String,
    },
    /// A recording of a rig that something else controlled, only looked at.
    Watched {
        /// Its file.
        file: String,
    },
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Simulated { seed, disturbance } => {
                write!(f, "on the simulated rig, seed {seed}, disturbance {disturbance}")
            }
            Self::Recorded { file } => write!(f, "recorded in {file}, replayed"),
            Self::Watched { file } => write!(f, "recorded in {file}"),
        }
    }
}

/// A run, whole.
#[derive(Clone, Debug)]
pub struct Record {
    /// Where it comes from.
    pub origin: Origin,
    /// Ts in s.
    pub sample_time: f64,
    /// Set-point of the configuration, degC.
    pub setpoint: f64,
    /// Set-point bounds of the nominal window in which the control error is judged, s.
    pub nominal_window: (f64, f64),
    /// Thresholds lie this many standard deviations from the mean.
    pub sigma_factor: f64,
    /// What a user calls faults of his own.
    pub names: Names,
    /// What happened to the rig.
    pub faults: Vec<Fault>,
    /// Every tick.
    pub rows: Vec<Row>,
    /// What the trace tells of the settings, each on its row; of a recording that was only looked at, nothing.
    pub settings: Vec<(usize, String)>,
    /// What each hypothesis explains on the rows with an alarm, where that was asked.
    pub explained: Vec<(usize, Explained)>,
    /// What was learnt.
    pub baseline: Option<Baseline>,
    /// Commands that were refused, with the time and the reason.
    pub refused: Vec<(f64, String)>,
    /// Times of the actions that were to come after the end, s.
    pub actions_after_end: Vec<f64>,
    /// It is the paper's own experiment, so that the paper's results may stand beside it.
    pub is_papers: bool,
}

impl Record {
    /// Rows with what is needed to judge them.
    pub fn new(
        origin: Origin,
        config: &Config,
        faults: &[Fault],
        rows: Vec<Row>,
        baseline: Option<Baseline>,
    ) -> Self {
        let mut settings = Settings::new(config);
        let tells = settings.tell() && !matches!(origin, Origin::Watched { .. });
        let window = [config.supervisor.learn_start, config.supervisor.learn_end].map(|t| as_written(t.0));
        Self {
            origin,
            sample_time: as_written(config.sample_time.0),
            setpoint: as_written(config.setpoint.0),
            nominal_window: window.into(),
            sigma_factor: f64::from(config.diagnosis.sigma_factor),
            names: Names::of(config),
            faults: faults.to_vec(),
            rows,
            settings: if tells { vec![(0, settings.take())] } else { Vec::new() },
            explained: Vec::new(),
            baseline,
            refused: Vec::new(),
            actions_after_end: Vec::new(),
            is_papers: false,
        }
    }

    /// The end of the run, s.
    pub fn end(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| self.time(row.tick.index + 1))
    }

    /// From the first tick to the end, s.
    pub fn duration(&self) -> f64 {
        self.end() - self.rows.first().map_or(0.0, |row| self.time(row.tick.index))
    }

    /// Time of a tick, s.
    pub fn time(&self, tick: u32) -> f64 {
        tick_time(tick, self.sample_time)
    }
}

/// How much slower than the default an instrument samples: an experiment takes as many samples on every plant.
pub fn slowness(config: &Config) -> f64 {
    as_written(config.sample_time.0) / as_written(Config::default().sample_time.0)
}

/// The same experiment on the rig of a preset, in other surroundings (`None`: the scenario's), with faults of another size.
///
/// # Errors
/// There is no such preset; the key of the scenario that is out of bounds.
pub fn on_rig(
    mut scenario: Scenario,
    config: &Config,
    preset: Option<&str>,
    disturbance: Option<Disturbance>,
    size: FaultSize,
) -> anyhow::Result<Scenario> {
    if let Some(name) = preset {
        scenario = Scenario { rig: RigConfig::preset(name)?, ..scenario }.slowed(slowness(config));
    }
    scenario.disturbance = disturbance.unwrap_or(scenario.disturbance);
    scenario.faults = scenario.faults.iter().map(|fault| size.apply(fault)).collect();
    scenario.validate()?;
    Ok(scenario)
}

/// Runs a scenario on an instrument of our own, its excitation begun where the seed says.
///
/// # Errors
/// The parameter of `config` that is out of bounds.
pub fn run(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Record> {
    let config = with_prbs_phase(config, seed);
    let mut instrument = Instrument::new(&config)?;
    Ok(run_on(&mut instrument, &config, scenario, seed))
}

/// Runs a scenario on any backend.
pub fn run_on(backend: &mut impl Backend, config: &Config, scenario: &Scenario, seed: u64) -> Record {
    let mut rows = Vec::new();
    let mut explained = Vec::new();
    let refused = drive(backend, config, scenario, seed, |row, _, backend| {
        explained.extend(backend.explained(&row.report).map(|shares| (rows.len(), shares)));
        rows.push(row);
    });
    let origin = Origin::Simulated { seed, disturbance: scenario.disturbance };
    let record = Record::new(origin, config, &scenario.faults, rows, backend.baseline());
    let after_end = |at: &f64| *at >= record.end();
    let actions_after_end = scenario.actions.iter().map(|action| action.at).filter(after_end).collect();
    let is_papers = scenario.is_papers() && config.setpoint == Config::default().setpoint;
    Record { explained, refused, actions_after_end, is_papers, ..record }
}

/// The same without a record: `observe` gets each tick, so that a run may be of any length, and for scores the rig that
/// gave it, which moves on only then. Returns the commands that were refused, with the time and the reason.
pub fn drive<B: Backend>(
    backend: &mut B,
    config: &Config,
    scenario: &Scenario,
    seed: u64,
    mut observe: impl FnMut(Row, &Rig, &B),
) -> Vec<(f64, String)> {
    let sample_time = as_written(config.sample_time.0);
    let ticks = (scenario.duration / sample_time).floor() as u32;
    let mut rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, seed, &scenario.faults);
    let mut refused = Vec::new();
    let mut commands = commands(&scenario.actions, config.setpoint.0).into_iter().peekable();
    let mut obey = |backend: &mut B, command, t| {
        if let Err(reason) = Backend::command(backend, command) {
            refused.push((t, reason));
        }
    };
    let mut armed = false;
    for index in 0..ticks {
        let t = f64::from(index) * sample_time;
        if !armed && t >= scenario.arm_at {
            armed = true;
            obey(backend, Command::Arm, t);
        }
        while let Some((_, command)) = commands.next_if(|(at, _)| *at <= t) {
            if let Command::Fan(level) = command {
                rig.set_fan(f64::from(level.0) / 100.0);
            }
            obey(backend, command, t);
        }
        let tick = backend.control(sample(&mut rig));
        let report = backend.diagnose(&tick);
        let applied = tick.drive;
        observe(Row { tick, report, applied, truth: truth(&scenario.faults, t) }, &rig, backend);
        rig.advance(f64::from(applied.0));
    }
    refused
}
