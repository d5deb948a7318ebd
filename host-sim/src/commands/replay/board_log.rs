//! The log of a board as text: the record of each tick, orders, settings, holds. Everything else is passed over.

use anyhow::{Context, bail, ensure};
use fdi_core::schema::WORDS;
use fdi_core::{Config, Report, Tick};
use firmware_logic::log_line::LogLine;
use firmware_logic::log_line::tick::TickLine;
use pt326_lab::board::log::{Start, again};

use super::{Recorded, Recording, Said};

/// Reads a log; of several starts in it, the longest.
///
/// # Errors
/// A broken line, by number; a log without a record, or without its beginning.
pub(super) fn read(text: &str, config: Config) -> anyhow::Result<Recording> {
    let starts = starts(text, &config)?;
    let count = starts.len();
    let longest = starts.into_iter().max_by_key(|start| start.records.len());
    let Some(start) = longest.filter(|start| !start.records.is_empty()) else {
        bail!(
            "no record of a tick in it, expected lines with \"tick \" and {WORDS} hexadecimal words: build with DEFMT_LOG=debug"
        )
    };
    let first = start.records[0].tick();
    ensure!(
        first == 0,
        "the log begins at tick {first}, expected 0: reset the board while its log is being read"
    );
    let mut remarks = Vec::new();
    if count > 1 {
        remarks.push(format!("{count} starts of the board in the log; this is the longest"));
    }
    let whole = start.records.iter().zip(0..).take_while(|(record, k)| record.tick() == *k).count();
    if whole < start.records.len() {
        let after = start.records.len() - whole;
        remarks.push(format!(
            "records are missing from tick {whole} on: the {after} records behind are not replayed"
        ));
    }
    if start.dropped > 0 {
        remarks.push(format!("{} lines are missing that the port had no room for", start.dropped));
    }
    let (mut start, mut ticks) = (start, Vec::with_capacity(whole));
    while let Some((orders, record)) = start.take().filter(|_| ticks.len() < whole) {
        ticks.push(Recorded {
            orders,
            raw: record.raw(),
            applied: Some(record.applied()),
            truth: 0,
            said: Said::Bits(Box::new(record)),
        });
    }
    Ok(Recording { config: start.config, baseline: start.baseline, ticks, faults: Vec::new(), remarks })
}

fn starts(text: &str, config: &Config) -> anyhow::Result<Vec<Start>> {
    let fresh = || Start::new(config.clone());
    let mut starts = vec![fresh()];
    for (line, number) in text.lines().zip(1..) {
        let parsed = LogLine::find(line).map_err(|error| anyhow::anyhow!("line {number}: {error}"))?;
        let (Some(start), Some(parsed)) = (starts.last_mut(), parsed) else { continue };
        let begins = match parsed {
            LogLine::Start { .. } => true,
            LogLine::Tick(record) => record.tick() == 0 && start.heard > 0,
            _ => false,
        };
        if begins && start.heard > 0 {
            starts.push(fresh());
        } else if begins {
            *start = fresh();
        }
        let Some(start) = starts.last_mut() else { continue };
        start.line(parsed).with_context(|| format!("line {number}"))?;
    }
    Ok(starts)
}

/// In what the core's bits differ from the board's.
pub(super) fn differences(said: &TickLine, tick: &Tick, report: &Report) -> Vec<String> {
    let ours = again(said, tick, report);
    let number = |bits: u32| format!("{bits:#010x} ({})", f32::from_bits(bits));
    said.differences(&ours)
        .map(|(name, board, core)| format!("{name}: board {}, core {}", number(board), number(core)))
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use fdi_core::{Command, Instrument};
    use firmware_logic::control_loop::TickRecord;
    use pt326_host::experiment::sample;
    use pt326_lab::board::log::Change;
    use pt326_rig::{Disturbance, Rig, RigConfig};

    /// What a board would log of a run on the rig: armed before tick 3, another gain before tick 200.
    pub(crate) fn log_of(config: &Config, seconds: f64) -> String {
        let mut instrument = Instrument::new(config).unwrap();
        let mut rig = Rig::new(&RigConfig::default(), Disturbance::Calm, 0.11, 1, &[]);
        let mut log = String::from("0.000000 [INFO ] log format 5 (firmware log.rs:1)\n");
        for k in 0..(seconds / 0.11) as u32 {
            if k == 3 {
                instrument.command(Command::Arm).unwrap();
                log += "0.33 [INFO ] order 3 arm (firmware log.rs:77)\n";
            }
            if k == 150 {
                log += "16.5 [INFO ] setting pid.ti = 9 s\n16.5 [WARN ] denied 150 no (firmware log.rs:77)\n";
            }
            if k == 200 {
                let mut config = config.clone();
                config.pid.kp = 3.0;
                instrument.retune(&config).unwrap();
                log += "22.0 [INFO ] setting pid.kp = 3 %/degC\n22.0 [INFO ] order 200 settings (firmware log.rs:77)\n";
            }
            let raw = sample(&mut rig);
            let tick = instrument.control(raw);
            let report = instrument.diagnose(&tick, tick.drive);
            rig.advance(f64::from(tick.drive.0));
            let record = TickRecord::new(raw, tick, tick.drive);
            log +=
                &format!("{}.0 [DEBUG] {} (firmware diagnosis.rs:40)\n", k, TickLine::new(&record, &report));
            log += "1.0 [WARN ] 2 ticks missed before tick 5\n";
        }
        log
    }

    #[test]
    fn broken_lines_are_named() {
        let record = format!("tick {}", ["1f"; WORDS - 1].join(" "));
        let error = format!("{:#}", read(&format!("boot\n{record}\n"), Config::default()).err().unwrap());
        assert!(error.contains("line 2") && error.contains("31 words, expected 32"), "{error}");
        let error = format!("{:#}", read("order 5 explode\n", Config::default()).err().unwrap());
        assert!(error.contains("line 1") && error.contains("explode"), "{error}");
        let error = format!("{:#}", read("log format 3\n", Config::default()).err().unwrap());
        assert!(error.contains("line 1: log format 3, expected 5"), "{error}");
        let late = format!("tick 7 {}", ["0"; WORDS - 1].join(" "));
        let error = format!("{:#}", read(&late, Config::default()).err().unwrap());
        assert!(error.contains("begins at tick 7"), "{error}");
    }

    #[test]
    fn a_commissioning_counts_from_the_tick_that_follows_it() {
        let kept = |number: u32| format!("[DEBUG] commissioned {number}{}\n", " 3e99999a".repeat(16));
        let log = log_of(&Config::default(), 1.0);
        let (head, rest) = log.split_at(log.find("5.0 [DEBUG] tick").unwrap());
        let text = format!("{}{head}{}{rest}", kept(1), kept(2)).replace("log format 5", "");
        let recording = read(&text, Config::default()).unwrap();
        let commissioned = |tick: &Recorded| {
            tick.orders
                .iter()
                .any(|order| matches!(order, Change::Commission(Some(models)) if models.validate().is_ok()))
        };
        let at: Vec<usize> =
            (0..recording.ticks.len()).filter(|&k| commissioned(&recording.ticks[k])).collect();
        assert_eq!(at, [0, 5]);
    }

    #[test]
    fn a_restored_baseline_is_read_with_its_bits() {
        let row = |from: u32| {
            (0..7).map(|i| format!(" {:x}", (from as f32 + i as f32).to_bits())).collect::<String>()
        };
        let lines = format!(
            "[INFO] baseline samples 1636\nbaseline raw.mean{}\nbaseline raw.sigma{}\nbaseline filtered.mean{}\n\
             baseline filtered.sigma{}\n",
            row(1),
            row(10),
            row(20),
            row(30)
        );
        let recording = read(
            &format!("{lines}{}", log_of(&Config::default(), 1.0).replace("log format 5", "")),
            Config::default(),
        );
        let baseline = recording.unwrap().baseline.unwrap();
        assert_eq!((baseline.samples, baseline.raw.mean[0], baseline.filtered.sigma[6]), (1636, 1.0, 36.0));
        let error = format!("{:#}", read("baseline raw.mean 1 2\n", Config::default()).err().unwrap());
        assert!(error.contains("line 1") && error.contains("2 words, expected 7"), "{error}");
    }
}
