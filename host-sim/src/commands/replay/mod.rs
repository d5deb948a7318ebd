//! `host-sim replay`: runs the core again on the codes of a recording, and says whether it comes to what the recording says.
//!
//! A recording is the log of a board, as `probe-rs run` or `defmt-print` prints it, or a `trace.csv`. The board's log
//! carries bits, and bits are compared; a trace carries numbers that read back to the same bits.

mod board_log;
mod trace_file;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{Command, Config, Instrument, Percent, RawSample, Report, Tick};

use crate::commands::run;
use crate::experiment::{Origin, Record, Row, as_written, truth};
use crate::record::trace::Column;
use pt326_rig::fault::Fault;

/// Arguments of `replay`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  cargo fw-run | tee board.log          watch a board and keep its log
  host-sim replay board.log --out replayed
  host-sim replay out/trace.csv

Settings that the board's log tells are taken from it. The log must hold the board from its start on; where records
are missing, the replay ends, since the state behind a gap is unknown.")]
pub struct ReplayArgs {
    /// The recording: a board's log as text, or a trace.csv.
    pub file: PathBuf,
    /// Settings that the recording was made with, TOML; on a board's log its own settings come on top.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Seed of the run that made a trace.csv: it moves the start of the excitation.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the replayed trace.csv, summary.json, figures and report.html.
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
    orders: Vec<Order>,
    /// Codes.
    raw: RawSample,
    /// What the heater got; `None`: the drive.
    applied: Option<Percent>,
    /// What the recording says of it.
    said: Said,
}

/// Something that changed the instrument before a tick.
enum Order {
    Command(Command),
    Settings(Box<Config>),
}

/// The outputs, in the form of the recording.
enum Said {
    /// Bits of the board.
    Bits(Box<firmware_logic::log_line::tick::TickLine>),
    /// Cells of a trace by column, without the truth.
    Cells(Vec<(&'static Column, String)>),
}

/// What was compared.
#[derive(Debug, Default)]
struct Agreement {
    ticks: usize,
    differing: usize,
    /// The first few differences, in words.
    examples: Vec<String>,
}

/// Differences that are told one by one.
const EXAMPLES: usize = 5;

/// Replays a recording.
///
/// # Errors
/// A file that is no recording, by line; outputs that differ from what was recorded.
pub fn run(args: &ReplayArgs) -> anyhow::Result<()> {
    let config = crate::settings::read(args.config.as_deref())?;
    let text =
        std::fs::read_to_string(&args.file).with_context(|| format!("can't read {}", args.file.display()))?;
    let mut recording = read(&text, config, args.seed).with_context(|| args.file.display().to_string())?;
    trace_file::use_summary(&mut recording, &text, &args.file);
    let (record, agreement) = rerun(&recording, &args.file)?;
    for remark in &recording.remarks {
        println!("note: {remark}");
    }
    run::tell(&record, &args.out)?;
    let Agreement { ticks, differing, examples } = agreement;
    if differing == 0 {
        println!("The core agrees with the recording on all {ticks} ticks, bit for bit.");
        return Ok(());
    }
    examples.iter().for_each(|example| println!("  {example}"));
    bail!("the core differs from the recording on {differing} of {ticks} ticks")
}

fn read(text: &str, config: Config, seed: u64) -> anyhow::Result<Recording> {
    let header = text.lines().next().unwrap_or_default();
    if header.starts_with("t_s,") {
        trace_file::read(text, &crate::experiment::with_prbs_phase(&config, seed))
    } else {
        board_log::read(text, config)
    }
}

/// Runs the core on the recorded inputs.
fn rerun(recording: &Recording, file: &Path) -> anyhow::Result<(Record, Agreement)> {
    let config = &recording.config;
    let mut instrument = Instrument::new(config)?;
    if let Some(baseline) = &recording.baseline {
        instrument.restore(baseline)?;
    }
    let sample_time = as_written(config.sample_time.0);
    let mut rows = Vec::with_capacity(recording.ticks.len());
    let mut agreement = Agreement::default();
    for recorded in &recording.ticks {
        for order in &recorded.orders {
            match order {
                // The board logs what it carried out, and an `ack` that released its own interlock means nothing here.
                Order::Command(command) => drop(instrument.command(*command)),
                Order::Settings(config) => instrument.retune(config)?,
            }
        }
        let tick = instrument.control(recorded.raw);
        let report = instrument.diagnose(&tick, recorded.applied.unwrap_or(tick.drive));
        agreement.compare(recorded, &tick, &report, sample_time);
        let now = f64::from(tick.index) * sample_time;
        rows.push(Row { truth: truth(&recording.faults, now), tick, report });
    }
    let origin = Origin::Recorded { file: file.display().to_string() };
    let record = Record::new(origin, config, &recording.faults, rows, instrument.baseline().copied());
    Ok((record, agreement))
}

impl Agreement {
    fn compare(&mut self, recorded: &Recorded, tick: &Tick, report: &Report, sample_time: f64) {
        self.ticks += 1;
        let differences = match &recorded.said {
            Said::Bits(bits) => board_log::differences(bits, recorded, tick, report),
            Said::Cells(cells) => trace_file::differences(cells, tick, report, sample_time),
        };
        self.differing += usize::from(!differences.is_empty());
        let ambient = EXAMPLES.saturating_sub(self.examples.len());
        let told = differences.into_iter().map(|d| format!("tick {}: {d}", tick.index));
        self.examples.extend(told.take(ambient));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::scenario::{Action, Scenario};
    use crate::record::trace::write_trace;

    fn traced(scenario: &Scenario, seed: u64) -> String {
        let record = crate::experiment::run(&Config::default(), scenario, seed).unwrap();
        let mut trace = Vec::new();
        write_trace(&record, &mut trace).unwrap();
        String::from_utf8(trace).unwrap()
    }

    fn agreement(text: &str, seed: u64) -> Agreement {
        let recording = read(text, Config::default(), seed).unwrap();
        rerun(&recording, Path::new("test")).unwrap().1
    }

    #[test]
    fn a_trace_replays_to_the_same_bits() {
        let action = |at, setpoint, excite| Action { at, setpoint, excite, ..Action::default() };
        let scenario = Scenario {
            duration: 450.0,
            actions: vec![
                action(420.0, Some(38.0), None),
                Action { at: 430.0, relearn: true, ..Action::default() },
                action(440.0, None, Some(false)),
            ],
            ..Scenario::default()
        };
        for seed in [1, 9] {
            let agreement = agreement(&traced(&scenario, seed), seed);
            assert_eq!(
                (agreement.ticks, agreement.differing),
                (4090, 0),
                "seed {seed}: {:?}",
                agreement.examples
            );
        }
    }

    #[test]
    fn columns_are_found_by_name() {
        let trace = traced(&Scenario { duration: 20.0, ..Scenario::default() }, 1);
        let turned = |line: &str| {
            let (first, rest) = line.split_once(',').unwrap();
            let rest: Vec<&str> = rest.split(',').rev().collect();
            format!("{first},{},7\n", rest.join(","))
        };
        let turned: String = trace.lines().map(turned).collect();
        let agreement = agreement(&turned, 1);
        assert_eq!((agreement.ticks, agreement.differing), (181, 0), "{:?}", agreement.examples);
        let Err(error) = read(&trace.replace("mode", "node"), Config::default(), 1) else {
            panic!("no mode")
        };
        assert!(format!("{error:#}").contains("column mode"), "{error:#}");
    }

    #[test]
    fn one_changed_number_is_found_and_told() {
        let scenario = Scenario { duration: 60.0, ..Scenario::default() };
        let trace = traced(&scenario, 1);
        let line = trace.lines().nth(400).unwrap();
        let drive = line.split(',').nth(7).unwrap();
        let changed = line.replacen(drive, "12.5", 1);
        let agreement = agreement(&trace.replacen(line, &changed, 1), 1);
        assert_eq!(agreement.differing, 1);
        assert!(agreement.examples[0].contains("pa_pct") && agreement.examples[0].contains("12.5"));
    }

    #[test]
    fn an_older_trace_replays_without_the_likelihood_columns_and_a_changed_one_is_found() {
        let scenario = Scenario { duration: 20.0, ..Scenario::default() };
        let trace = traced(&scenario, 1);
        let older: Vec<String> =
            trace.lines().map(|line| line.split(',').take(40).collect::<Vec<_>>().join(",")).collect();
        let replayed = agreement(&older.join("\n"), 1);
        assert_eq!((replayed.ticks, replayed.differing), (181, 0), "{:?}", replayed.examples);
        let remarks = read(&older.join("\n"), Config::default(), 1).unwrap().remarks;
        assert!(remarks[0].contains("alarm, verdict") && remarks[0].contains("not compared"), "{remarks:?}");
        let line = trace.lines().nth(100).unwrap();
        let changed = line.strip_suffix(",0,,,,,").map(|head| format!("{head},1,,,,,")).unwrap();
        let replayed = agreement(&trace.replacen(line, &changed, 1), 1);
        assert_eq!(replayed.differing, 1);
        assert!(replayed.examples[0].contains("alarm"), "{:?}", replayed.examples);
    }

    /// A log as the board writes it: made from a run, with what a terminal puts around each line.
    #[test]
    fn a_board_log_replays_to_the_same_bits_and_shows_gaps() {
        let log = board_log::tests::log_of(&Config::default(), 60.0);
        let whole = agreement(&log, 1);
        assert_eq!((whole.ticks, whole.differing), (545, 0), "{:?}", whole.examples);
        let gapped: Vec<&str> = log.lines().filter(|line| !line.contains(" tick 64 ")).collect(); // tick 100
        let recording = read(&gapped.join("\n"), Config::default(), 1).unwrap();
        assert_eq!(recording.ticks.len(), 100);
        assert!(recording.remarks[0].contains("100"), "{:?}", recording.remarks);
        assert!(read("no log at all\n", Config::default(), 1).is_err());
    }
}
