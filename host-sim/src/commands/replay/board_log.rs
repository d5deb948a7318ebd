//! The log of a board as text: the record of each tick, orders, settings, holds. Everything else is passed over.

use anyhow::{Context, bail, ensure};
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::{Celsius, Command, Config, Report, Tick};
use firmware_logic::cadence::Arrival;
use firmware_logic::control_loop::TickRecord;
use firmware_logic::log_line::tick::{TickLine, WORDS};
use firmware_logic::settings::schema::Name;

use super::{Order, Recorded, Recording, Said};

/// What one line of the log says to a replay.
enum Line {
    Tick(Box<TickLine>),
    Order(u32, Option<Command>),
    Setting(String, String),
    /// An order was not carried out: settings told before it are not in force.
    Denied,
    /// A part of a baseline that was restored.
    Baseline(String, Vec<u32>),
    /// The interlock stopped the heater before this tick.
    Lockout(u32),
    Boot,
    Other,
}

/// One start of the board: its records, and what was asked for before a tick.
struct Start {
    config: Config,
    /// Settings told since the last order for some: all that are not at their default. The order comes after them.
    told: Config,
    baseline: Option<Baseline>,
    records: Vec<TickLine>,
    orders: Vec<(u32, Order)>,
}

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
    let mut orders = start.orders;
    let ticks = start.records.into_iter().take(whole).map(|record| {
        let now = orders.extract_if(.., |(tick, _)| *tick == record.tick()).map(|(_, order)| order).collect();
        Recorded {
            orders: now,
            raw: record.raw(),
            applied: Some(record.applied()),
            said: Said::Bits(Box::new(record)),
        }
    });
    Ok(Recording {
        config: start.config,
        baseline: start.baseline,
        ticks: ticks.collect(),
        faults: Vec::new(),
        remarks,
    })
}

fn starts(text: &str, config: &Config) -> anyhow::Result<Vec<Start>> {
    let fresh = || Start {
        config: config.clone(),
        told: Config::default(),
        baseline: None,
        records: Vec::new(),
        orders: Vec::new(),
    };
    let mut starts = vec![fresh()];
    for (line, number) in text.lines().zip(1..) {
        let parsed = parse(line).with_context(|| format!("line {number}"))?;
        let Some(start) = starts.last_mut() else { break };
        match parsed {
            Line::Boot if start.records.is_empty() => *start = fresh(),
            Line::Boot => starts.push(fresh()),
            Line::Tick(record) if record.tick() == 0 && !start.records.is_empty() => {
                starts.push(Start { records: vec![*record], ..fresh() });
            }
            Line::Tick(record) => start.records.push(*record),
            Line::Order(tick, Some(command)) => start.orders.push((tick, Order::Command(command))),
            Line::Order(tick, None) => {
                let settings = std::mem::take(&mut start.told);
                start.orders.push((tick, Order::Settings(Box::new(settings))));
            }
            Line::Denied => start.told = Config::default(),
            Line::Lockout(tick) => start.orders.insert(0, (tick, Order::Command(Command::Stop))),
            Line::Setting(name, value) => {
                let config = if start.records.is_empty() { &mut start.config } else { &mut start.told };
                set(config, &name, &value).with_context(|| format!("line {number}"))?;
            }
            Line::Baseline(part, words) => {
                restore(start.baseline.get_or_insert_default(), &part, &words)
                    .with_context(|| format!("line {number}"))?;
            }
            Line::Other => {}
        }
    }
    Ok(starts)
}

/// Fills in a part of a baseline.
fn restore(baseline: &mut Baseline, part: &str, words: &[u32]) -> anyhow::Result<()> {
    let row = match part {
        "samples" => {
            baseline.samples = *words.first().context("baseline samples: expected a number")?;
            return Ok(());
        }
        "raw.mean" => &mut baseline.raw.mean,
        "raw.sigma" => &mut baseline.raw.sigma,
        "filtered.mean" => &mut baseline.filtered.mean,
        "filtered.sigma" => &mut baseline.filtered.sigma,
        _ => bail!("unknown part of a baseline: {part:?}"),
    };
    let expected = row.len();
    ensure!(words.len() == expected, "baseline {part}: {} words, expected {expected}", words.len());
    row.iter_mut().zip(words).for_each(|(value, word)| *value = f32::from_bits(*word));
    Ok(())
}

/// Sets a value as the log writes it: perhaps with a unit behind.
fn set(config: &mut Config, name: &str, value: &str) -> anyhow::Result<()> {
    let known = Name::find(name).map_err(|error| anyhow::anyhow!("{error}"))?;
    let number = value.rsplit_once(' ').map_or(value, |(number, _unit)| number);
    known
        .set(config, name, value)
        .or_else(|_| known.set(config, name, number))
        .map_err(|error| anyhow::anyhow!("{error}"))
}

/// What follows a keyword, wherever a logger's prefix ends.
fn after<'a>(line: &'a str, keyword: &str) -> Option<&'a str> {
    let at = line.find(keyword)?;
    let stands_alone = at == 0 || line[..at].ends_with([' ', ']', '\t']);
    stands_alone.then(|| &line[at + keyword.len()..])
}

fn parse(line: &str) -> anyhow::Result<Line> {
    if let Some(rest) = after(line, "tick ") {
        let words: Vec<&str> = rest.split_ascii_whitespace().take(WORDS).collect();
        let hex = |word: &&str| word.len() <= 8 && word.bytes().all(|b| b.is_ascii_hexdigit());
        if !words.get(..8).is_some_and(|first| first.iter().all(hex)) {
            return Ok(Line::Other); // a sentence that speaks of a tick
        }
        return Ok(Line::Tick(Box::new(format!("tick {}", words.join(" ")).parse()?)));
    }
    if let Some(rest) = after(line, "order ") {
        return order(rest);
    }
    if after(line, "denied ").is_some() {
        return Ok(Line::Denied);
    }
    if let Some(rest) = after(line, "setting ") {
        let Some((name, value)) = rest.split_once(" = ") else { return Ok(Line::Other) };
        return Ok(Line::Setting(name.trim().into(), value.trim().into()));
    }
    if let Some(rest) = after(line, "baseline ") {
        let mut words = rest.split_ascii_whitespace();
        let part = words.next().unwrap_or_default();
        let radix = if part == "samples" { 10 } else { 16 };
        let words = words.map_while(|word| u32::from_str_radix(word, radix).ok()).collect();
        return Ok(Line::Baseline(part.into(), words));
    }
    if let Some(rest) = after(line, "lockout ") {
        return Ok(rest
            .split_ascii_whitespace()
            .next()
            .and_then(|w| w.parse().ok())
            .map_or(Line::Other, Line::Lockout));
    }
    Ok(if line.contains("PT-326 FDI") { Line::Boot } else { Line::Other })
}

/// `TICK VERB [ARGUMENT]`.
fn order(text: &str) -> anyhow::Result<Line> {
    let mut words = text.split_ascii_whitespace();
    let Some(tick) = words.next().and_then(|w| w.parse().ok()) else { return Ok(Line::Other) };
    let verb = words.next().unwrap_or_default();
    let argument = words.next().unwrap_or_default();
    let expected = || format!("{argument:?} after {verb}: expected a value");
    let command = match verb {
        "settings" => return Ok(Line::Order(tick, None)),
        "arm" => Command::Arm,
        "stop" => Command::Stop,
        "ack" => Command::Acknowledge,
        "relearn" => Command::Relearn,
        "setpoint" => Command::SetPoint(Celsius(argument.parse().with_context(expected)?)),
        "excite" => Command::Excite(argument.parse().with_context(expected)?),
        _ => bail!("unknown order {verb:?}, expected settings, arm, stop, ack, relearn, setpoint or excite"),
    };
    Ok(Line::Order(tick, Some(command)))
}

/// In what the core's bits differ from the board's.
pub(super) fn differences(said: &TickLine, recorded: &Recorded, tick: &Tick, report: &Report) -> Vec<String> {
    let beat = TickRecord {
        raw: recorded.raw,
        tick: *tick,
        applied: said.applied(),
        arrival: Arrival { late_us: said.late_us(), ..Arrival::default() },
        missed: said.missed(),
        lockout: None,
        outcome: None,
        news: None,
        checked: false,
    };
    let ours = TickLine::new(&beat, report);
    let number = |bits: u32| format!("{bits:#010x} ({})", f32::from_bits(bits));
    said.differences(&ours)
        .map(|(name, board, core)| format!("{name}: board {}, core {}", number(board), number(core)))
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use fdi_core::{AdcCode, Instrument, RawSample};
    use pt326_rig::{Disturbance, Rig, RigConfig};

    /// What a board would log of a run on the rig: armed before tick 3, another gain before tick 200.
    pub(crate) fn log_of(config: &Config, seconds: f64) -> String {
        let mut instrument = Instrument::new(config).unwrap();
        let mut rig = Rig::new(&RigConfig::default(), Disturbance::Calm, 0.11, 1, &[]);
        let mut log = String::from("0.000000 [INFO ] PT-326 FDI 0.1.0 (abc) on NUCLEO-F411RE (start.rs:1)\n");
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
            let [t0, t1, t2] = rig.sample().map(|code| AdcCode(code as f32));
            let raw = RawSample { t0, t1, t2 };
            let tick = instrument.control(raw);
            let report = instrument.diagnose(&tick, tick.drive);
            rig.advance(f64::from(tick.drive.0));
            let beat = TickRecord {
                raw,
                tick,
                applied: tick.drive,
                arrival: Arrival::default(),
                missed: false,
                lockout: None,
                outcome: None,
                news: None,
                checked: false,
            };
            log += &format!("{}.0 [DEBUG] {} (firmware diagnosis.rs:40)\n", k, TickLine::new(&beat, &report));
            log += "1.0 [WARN ] tick 5 came after 2 missed\n";
        }
        log
    }

    #[test]
    fn broken_lines_are_named() {
        let record = format!("tick {}", ["1f"; WORDS - 1].join(" "));
        let error = format!("{:#}", read(&format!("boot\n{record}\n"), Config::default()).err().unwrap());
        assert!(error.contains("line 2") && error.contains("30 words, expected 31"), "{error}");
        let error = format!("{:#}", read("order 5 explode\n", Config::default()).err().unwrap());
        assert!(error.contains("line 1") && error.contains("explode"), "{error}");
        let late = format!("tick 7 {}", ["0"; WORDS - 1].join(" "));
        let error = format!("{:#}", read(&late, Config::default()).err().unwrap());
        assert!(error.contains("begins at tick 7"), "{error}");
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
            &format!("{lines}{}", log_of(&Config::default(), 1.0).replace("PT-326 FDI", "")),
            Config::default(),
        );
        let baseline = recording.unwrap().baseline.unwrap();
        assert_eq!((baseline.samples, baseline.raw.mean[0], baseline.filtered.sigma[6]), (1636, 1.0, 36.0));
        let error = format!("{:#}", read("baseline raw.mean 1 2\n", Config::default()).err().unwrap());
        assert!(error.contains("line 1") && error.contains("2 words, expected 7"), "{error}");
    }
}
