//! `pt326 replay`: runs the core again on the codes of a recording, and says whether it comes to what the recording says.
//!
//! A recording is the log of a board, as `probe-rs run` or `defmt-print` prints it, or a `trace.csv`. The board's log
//! carries bits, and bits are compared; a trace carries numbers that read back to the same bits.

mod board_log;
mod trace_file;

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::likelihood::taught::Responses;
use fdi_core::schema::{self, Entry};
use fdi_core::{Config, Instrument, Percent, RawSample, Report, Tick};

use super::results::Folder;
use super::run;
use super::terminal::{BAD, GOOD, progress, styled};
use pt326_host::experiment::{Origin, Record, Row, as_written, tick_time, truth, with_prbs_phase};
use pt326_host::isolability::{Isolability, Onsets, Question};
use pt326_host::settings;
use pt326_lab::board::log::Change;
use pt326_lab::change::Settings;
use pt326_lab::names::Names;
use pt326_lab::recording;
use pt326_rig::fault::Fault;

/// Arguments of `replay`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
A board's log tells the board's settings. It must begin with the start of the board; where ticks are missing the replay \
ends, since the state behind a gap is unknown.

A trace.csv tells its settings, changes in the middle of the run and all, in its column `settings`; one without that \
column was made with the default ones or by an older release: name those, if they were others.

The exit code is 2 if a single bit differs.

Examples:
  cargo fw-run | tee board.log              watch a board and keep its log, then
  pt326 replay board.log
  pt326 replay out/trace.csv")]
pub struct ReplayArgs {
    /// The recording: a board's log as text, or a trace.csv.
    pub file: PathBuf,
    /// Settings that the recording was made with, TOML; on a board's log its own settings come on top.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Seed of the run that made a trace.csv: it moves the start of the excitation. Default: that of the
    /// summary.json beside it, else 1.
    #[arg(long)]
    pub seed: Option<u64>,
    /// Folder for the replayed trace.csv, summary.json, figures and report.html; made if need be.
    #[arg(long, value_name = "DIR", default_value = "replayed")]
    pub out: PathBuf,
}

/// A recording, whatever its form.
struct Recording {
    /// Settings at the start.
    config: Config,
    /// A baseline that it began with.
    baseline: Option<Baseline>,
    /// Ticks without a gap, from the first on.
    ticks: Vec<Recorded>,
    /// What was done to the rig, where the recording knows.
    faults: Vec<Fault>,
    /// What is worth telling: gaps, other starts in the same file.
    remarks: Vec<String>,
}

/// One recorded tick.
struct Recorded {
    /// What was asked for just before it.
    orders: Vec<Change>,
    /// Codes.
    raw: RawSample,
    /// What the heater got; `None`: the drive.
    applied: Option<Percent>,
    /// Number of the true fault, where the recording knows it.
    truth: u8,
    /// What the recording says of it.
    said: Said,
}

/// The outputs, in the form of the recording.
enum Said {
    /// Bits of the board.
    Bits(Box<firmware_logic::log_line::tick::TickLine>),
    /// Cells of a trace by column, without the truth.
    Cells(Vec<(&'static Entry, String)>),
}

/// What was compared.
#[derive(Debug, Default)]
struct Agreement {
    ticks: usize,
    differing: usize,
    /// Time of the first tick that differs, s.
    first: Option<f64>,
    /// The first few differences, in words.
    examples: Vec<String>,
}

/// Differences that are told one by one.
const EXAMPLES: usize = 5;
/// Another seed or other settings show within the first so many s.
const START: f64 = 60.0;

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ticks, differing, examples, .. } = self;
        let Some(first) = self.first else {
            let agrees = styled(GOOD, "agrees with the recording");
            return writeln!(f, "The core {agrees} on all {ticks} ticks, bit for bit.");
        };
        let differs = styled(BAD, "differs from the recording");
        writeln!(f, "The core {differs} on {differing} of {ticks} ticks, first at {first:.2} s:")?;
        examples.iter().try_for_each(|example| writeln!(f, "  {example}"))?;
        if first < START {
            writeln!(
                f,
                "A difference so early means another seed or other settings than those of the recording, which \
                 --seed and\n--config name, or another version of this program. What follows is then not what was recorded."
            )?;
        }
        Ok(())
    }
}

/// Replays a recording.
///
/// # Errors
/// A file that is no recording, by line; outputs that differ from what was recorded.
pub fn run(args: &ReplayArgs) -> anyhow::Result<()> {
    let text =
        std::fs::read_to_string(&args.file).with_context(|| format!("can't read {}", args.file.display()))?;
    let recording = read(&text, args).with_context(|| args.file.display().to_string())?;
    let folder = Folder::open(&args.out)?;
    let (record, agreement) = rerun(&recording, &args.file, |_, _, _| ())?;
    run::tell(&record, &folder, &format!("{}\n", recording.told(&agreement)))?;
    let Agreement { ticks, differing, .. } = agreement;
    ensure!(differing == 0, "the core differs from the recording on {differing} of {ticks} ticks");
    Ok(())
}

/// A recording that was run through the core again, for other commands.
pub(super) struct Again {
    /// What came of it.
    pub record: Record,
    /// The settings in force at its end.
    pub config: Config,
    /// What is worth telling of it.
    pub told: String,
    /// Whether every bit agrees.
    pub agrees: bool,
}

/// Runs a recording through the core again; with `taught`, as if these faults had been taught from its start on. `look` sees the core after each tick.
///
/// # Errors
/// A file that is no recording, by line.
pub(super) fn again(
    args: &ReplayArgs,
    taught: Option<&Responses>,
    look: impl FnMut(&Instrument, &Tick, &Report),
) -> anyhow::Result<Again> {
    let file = &args.file;
    let text = std::fs::read_to_string(file).with_context(|| format!("can't read {}", file.display()))?;
    let mut recording = read(&text, args).with_context(|| file.display().to_string())?;
    if let Some(taught) = taught {
        recording.teach(taught);
    }
    let (record, agreement) = rerun(&recording, file, look)?;
    let told = recording.told(&agreement);
    // The seed's shift of the excitation is no setting.
    let asked =
        if is_trace(&text) { settings::read(args.config.as_deref())? } else { recording.config.clone() };
    let mut changed =
        recording.ticks.into_iter().flat_map(|tick| tick.orders).filter_map(|order| match order {
            Change::Settings(config) => Some(*config),
            _ => None,
        });
    Ok(Again { record, config: changed.next_back().unwrap_or(asked), told, agrees: agreement.differing == 0 })
}

/// What became of a board's log that was run through the core again: whether every bit agrees, and that in words.
///
/// # Errors
/// It is no log of a board, or does not begin with its start.
pub fn agreement(log: &str) -> anyhow::Result<(bool, String)> {
    let recording = board_log::read(log, Config::default())?;
    let (_, agreement) = rerun(&recording, Path::new("the board"), |_, _, _| ())?;
    Ok((agreement.differing == 0 && recording.remarks.is_empty(), recording.told(&agreement)))
}

/// Which faults could have been told apart in a board's log.
///
/// # Errors
/// It is no log of a board, or does not begin with its start; the board has learnt nothing in it, or it ends too soon after.
pub fn isolability(log: &str, question: &Question) -> anyhow::Result<Isolability> {
    let recording = board_log::read(log, Config::default())?;
    let mut onsets = Onsets::new(as_written(recording.config.sample_time.0), &question.horizons);
    rerun(&recording, Path::new("the board"), |instrument, tick, report| {
        onsets.look(instrument, tick, report)
    })?;
    onsets.found(question)
}

fn read(text: &str, args: &ReplayArgs) -> anyhow::Result<Recording> {
    let config = settings::read(args.config.as_deref())?;
    if is_trace(text) {
        let seed = args.seed.or_else(|| seed_beside(&args.file)).unwrap_or(1);
        let mut recording = trace_file::read(text, &with_prbs_phase(&config, seed))?;
        trace_file::use_summary(&mut recording, &args.file);
        Ok(recording)
    } else {
        board_log::read(text, config)
    }
}

/// A trace.csv; anything else is a board's log.
fn is_trace(text: &str) -> bool {
    text.starts_with("t_s,")
}

/// The seed in the summary.json beside a trace, if there is one.
fn seed_beside(trace: &Path) -> Option<u64> {
    let summary = std::fs::read_to_string(trace.with_file_name("summary.json")).ok()?;
    serde_json::from_str::<serde_json::Value>(&summary).ok()?.get("seed")?.as_u64()
}

/// Runs the core on the recorded inputs; `look` sees it after each tick.
fn rerun(
    recording: &Recording,
    file: &Path,
    mut look: impl FnMut(&Instrument, &Tick, &Report),
) -> anyhow::Result<(Record, Agreement)> {
    let config = &recording.config;
    let mut instrument = Instrument::new(config)?;
    if let Some(baseline) = &recording.baseline {
        instrument.restore(baseline)?;
    }
    let sample_time = as_written(config.sample_time.0);
    let mut rows = Vec::with_capacity(recording.ticks.len());
    let mut settings = Settings::new(config);
    let mut told = Vec::new();
    let mut explained = Vec::new();
    let mut agreement = Agreement::default();
    let bar = progress(recording.ticks.len() as u64, "ticks");
    for recorded in &recording.ticks {
        for order in &recorded.orders {
            order.carry_out(&mut instrument)?;
            if let Change::Settings(config) = order {
                settings.change((**config).clone());
            }
        }
        let change = settings.take();
        if !change.is_empty() {
            told.push((rows.len(), change));
        }
        let tick = instrument.control(recorded.raw);
        let applied = recorded.applied.unwrap_or(tick.drive);
        let report = instrument.diagnose(&tick, applied);
        agreement.compare(recorded, &tick, &report, sample_time);
        look(&instrument, &tick, &report);
        explained.extend(schema::explained(&instrument, &report).map(|shares| (rows.len(), shares)));
        let now = f64::from(tick.index) * sample_time;
        rows.push(Row { tick, report, applied, truth: truth(&recording.faults, now) });
        bar.inc(1);
    }
    bar.finish_and_clear();
    let origin = Origin::Recorded { file: file.display().to_string() };
    let record = Record::new(origin, config, &recording.faults, rows, instrument.baseline().copied());
    // What was taught in the middle of it has a name from there on.
    let names = Names::of(settings.in_force());
    Ok((Record { names, settings: told, explained, ..record }, agreement))
}

impl Recording {
    fn teach(&mut self, taught: &Responses) {
        let later = self.ticks.iter_mut().flat_map(|tick| &mut tick.orders).filter_map(|order| match order {
            Change::Settings(config) => Some(&mut **config),
            _ => None,
        });
        [&mut self.config].into_iter().chain(later).for_each(|config| {
            config.likelihood.taught = taught.clone();
        });
    }

    /// Its remarks, and how it agrees with the core.
    fn told(&self, agreement: &Agreement) -> String {
        let remarks: String = self.remarks.iter().map(|remark| format!("note: {remark}\n")).collect();
        format!("{remarks}{agreement}")
    }
}

impl Agreement {
    fn compare(&mut self, recorded: &Recorded, tick: &Tick, report: &Report, sample_time: f64) {
        self.ticks += 1;
        let differences = match &recorded.said {
            Said::Bits(bits) => board_log::differences(bits, tick, report),
            Said::Cells(cells) => {
                let cells = cells.iter().map(|(column, cell)| (*column, cell.as_str()));
                recording::differences(cells, tick, report, sample_time)
            }
        };
        if differences.is_empty() {
            return;
        }
        self.differing += 1;
        self.first.get_or_insert(tick_time(tick.index, sample_time));
        let room = EXAMPLES.saturating_sub(self.examples.len());
        let told = differences.into_iter().map(|d| format!("tick {}: {d}", tick.index));
        self.examples.extend(told.take(room));
    }
}

#[cfg(test)]
mod tests;
