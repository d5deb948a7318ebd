//! `pt326 core`: the instrument on standard input and output, for co-simulation with any other program.

use std::io::{BufRead, Write};
use std::path::PathBuf;

use anyhow::{Context, bail, ensure};
use fdi_core::schema::Moment;
use fdi_core::{AdcCode, Celsius, Command, Config, Instrument, Percent, RawSample, Seconds};

use crate::commands::terminal::Output;
use pt326_host::experiment::as_written;
use pt326_host::record::trace::{append_cells, header, instrument_columns};
use pt326_host::settings;

/// Arguments of `core`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = PROTOCOL)]
pub struct CoreArgs {
    /// Settings of the instrument, TOML; see `pt326 config`.
    #[arg(long, value_name = "FILE.toml")]
    pub config: Option<PathBuf>,
    /// Go on after a line that can't be carried out.
    #[arg(long)]
    pub keep_going: bool,
}

/// What goes in and what comes out.
const PROTOCOL: &str = r#"The first line written is a header with the names of the columns. Then each line read is answered by one line:

  line read           meaning                                answer
  2160,1620.5,1655    a sample: ADC codes of T0, T1 and T2,  a row: the power to apply until the
                      0 to 4095, decimals allowed            next sample, in %, then the columns
  2160,,1655          the same, the code of T1 being lost    of trace.csv without `truth`
  2160,1620,1655,2980 the same with the code of the
                      heater's supply, if it is measured
  setpoint 40         new set-point, °C                      ok
  arm                 begin to regulate                      ok
  stop                heater off                             ok
  ack                 acknowledge a trip                     ok
  relearn             learn anew what is normal              ok
  excite on           excitation on; off: excite off         ok
  fan 80              the fan now runs at 80 % of its level  ok
  anything else                                              error line N: what was expected

The instrument is armed from the start. Time is counted in samples, which are `sample_time` (0.11 s) apart; other lines take no time. After an error the program ends with exit code 2; with --keep-going it reads on. Blank lines, lines that begin with #, and a first line with three or four names are skipped without an answer.

Example, in Python:

  import subprocess
  core = subprocess.Popen(["pt326", "core"], text=True, stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE)
  columns = core.stdout.readline().strip().split(",")
  def ask(line):
      print(line, file=core.stdin, flush=True)
      return core.stdout.readline().strip()
  ask("setpoint 40")
  for codes in ["2160,2160,2160"] * 20:    # here your plant's codes, given row["drive_pct"]
      row = dict(zip(columns, ask(codes).split(",")))
  print(row["t_s"], row["mode"], row["drive_pct"])"#;

/// Runs on the process's standard streams.
///
/// # Errors
/// A bad configuration, a bad line, a stream that fails.
pub fn run(args: &CoreArgs) -> anyhow::Result<()> {
    let config = settings::read(args.config.as_deref())?;
    serve(&config, args.keep_going, std::io::stdin().lock(), Output(std::io::stdout().lock()))
}

/// Answers the lines of `input` on `output`, until the input ends.
///
/// # Errors
/// A stream that fails; a line that can't be carried out, by number, with what was expected, unless `keep_going`.
pub fn serve(
    config: &Config,
    keep_going: bool,
    input: impl BufRead,
    mut output: impl Write,
) -> anyhow::Result<()> {
    let mut instrument = Instrument::new(config)?;
    instrument.command(Command::Arm).context("can't begin to regulate")?;
    let sample_time = as_written(config.sample_time.0);
    writeln!(output, "drive_pct,{}", header(instrument_columns()))?;
    output.flush()?;
    let mut first = true;
    for (line, number) in input.lines().zip(1..) {
        let line = line.with_context(|| format!("line {number} can't be read"))?;
        let line = line.trim();
        let is_header = std::mem::take(&mut first) && is_header(line);
        if line.is_empty() || line.starts_with('#') || is_header {
            continue;
        }
        let answer = answer(&mut instrument, line, sample_time).with_context(|| format!("line {number}"));
        match &answer {
            Ok(answer) => writeln!(output, "{answer}")?,
            Err(error) => writeln!(output, "error {error:#}")?,
        }
        output.flush()?;
        if !keep_going {
            answer?;
        }
    }
    Ok(())
}

/// The names of the columns of a sample.
fn is_header(line: &str) -> bool {
    let is_name = |field: &str| field.trim().starts_with(|c: char| c.is_alphabetic());
    (3..=4).contains(&line.split(',').count()) && line.split(',').all(is_name)
}

/// Carries out one line.
fn answer(instrument: &mut Instrument, line: &str, sample_time: f64) -> anyhow::Result<String> {
    if let Some(command) = command(line)? {
        instrument.command(command)?;
        return Ok("ok".into());
    }
    let tick = instrument.control(sample(line)?);
    let report = instrument.diagnose(&tick, tick.drive);
    let mut row = format!("{},", tick.drive.0);
    append_cells(&mut row, instrument_columns(), &Moment::new(&tick, &report), sample_time);
    Ok(row)
}

/// Reads a command; none where the line is meant as a sample.
fn command(line: &str) -> anyhow::Result<Option<Command>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    Ok(Some(match words[..] {
        ["arm"] => Command::Arm,
        ["tune"] => Command::Tune,
        ["stop"] => Command::Stop,
        ["ack"] => Command::Acknowledge,
        ["shelve", time] => match time.parse() {
            Ok(time) => Command::Shelve(Seconds(time)),
            Err(_) => bail!("shelve is \"{time}\", expected a time in s, such as shelve 1800"),
        },
        ["relearn"] => Command::Relearn,
        ["excite", "on"] => Command::Excite(true),
        ["excite", "off"] => Command::Excite(false),
        ["setpoint", celsius] => match celsius.parse() {
            Ok(celsius) => Command::SetPoint(Celsius(celsius)),
            Err(_) => bail!("setpoint is \"{celsius}\", expected a temperature in °C, such as setpoint 40"),
        },
        ["fan", level] => match level.parse() {
            Ok(level) => Command::Fan(Percent(level)),
            Err(_) => bail!("fan is \"{level}\", expected a level in %, such as fan 80"),
        },
        [word, ..] if !line.contains(',') && word.starts_with(|c: char| c.is_alphabetic()) => bail!(
            "\"{line}\" given, expected three codes, or setpoint CELSIUS, arm, stop, ack, shelve SECONDS, relearn, excite on, excite off, fan LEVEL"
        ),
        _ => return Ok(None),
    }))
}

/// Reads `t0_code,t1_code,t2_code`, and perhaps `,supply_code`; an empty field is a sample that was lost.
fn sample(line: &str) -> anyhow::Result<RawSample> {
    const EXPECTED: &str =
        "expected t0_code,t1_code,t2_code: three 12-bit codes, 0 to 4095, such as 2160,1620.5,1655";
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    ensure!((3..=4).contains(&fields.len()), "{} fields in \"{line}\", {EXPECTED}", fields.len());
    let names = ["t0_code", "t1_code", "t2_code", "supply_code"];
    let mut codes = [AdcCode(f32::NAN); 4];
    for ((code, field), name) in codes.iter_mut().zip(fields).zip(names) {
        if field.is_empty() {
            continue;
        }
        let value = field.parse().ok().filter(|code| (0.0..=AdcCode::FULL_SCALE).contains(code));
        *code = AdcCode(value.with_context(|| format!("{name} is \"{field}\", {EXPECTED}"))?);
    }
    let [t0, t1, t2, supply] = codes;
    Ok(RawSample { t0, t1, t2, supply })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(keep_going: bool, input: &str) -> (Vec<String>, anyhow::Result<()>) {
        let mut output = Vec::new();
        let result = serve(&Config::default(), keep_going, input.as_bytes(), &mut output);
        (String::from_utf8(output).unwrap().lines().map(str::to_owned).collect(), result)
    }

    /// A column of an answer.
    fn cell<'a>(lines: &'a [String], line: usize, column: &str) -> &'a str {
        let place = lines[0].split(',').position(|name| name == column).unwrap();
        lines[line].split(',').nth(place).unwrap()
    }

    #[test]
    fn each_sample_is_answered_with_every_column() {
        let (lines, result) = answers(false, "2160,2160,2160\r\n2160,2159.5,2160\n");
        result.unwrap();
        assert_eq!(lines.len(), 3);
        assert!(lines[0].starts_with("drive_pct,t_s,t0_c,"));
        let columns = lines[0].split(',').count();
        assert!(lines.iter().all(|line| line.split(',').count() == columns));
        assert_eq!((cell(&lines, 2, "t_s"), cell(&lines, 2, "mode")), ("0.11", "settle"));
        let of_it = ["alarm", "verdict", "confidence", "magnitude", "onset_s", "taught"];
        assert_eq!(of_it.map(|name| cell(&lines, 2, name)), ["0", "", "", "", "", ""]);
    }

    #[test]
    fn a_header_blank_lines_and_comments_are_no_samples() {
        let input = "t0_code,t1_code,t2_code\n\n# cold\n2160,2160,2160\n  \n2160,2160,2160\n";
        let (lines, result) = answers(false, input);
        result.unwrap();
        assert_eq!(lines.len(), 3, "{lines:?}");
        assert_eq!(cell(&lines, 2, "t_s"), "0.11");
        assert!(
            answers(false, "2160,2160,2160\nt0,t1,t2\n").1.is_err(),
            "a header comes first or not at all"
        );
    }

    #[test]
    fn an_empty_field_is_a_lost_sample() {
        let (lines, result) = answers(false, "2160,2160,2160\n2160,,2160\n");
        result.unwrap();
        assert!(!cell(&lines, 1, "y1_c").is_empty() && cell(&lines, 2, "y1_c").is_empty(), "{lines:?}");
        assert!(!cell(&lines, 2, "y2_c").is_empty());
    }

    #[test]
    fn the_supply_and_the_fan_are_known_where_they_are_given() {
        let mut config = Config::default();
        config.supply.nominal_voltage.0 = 12.0;
        let mut output = Vec::new();
        let input = "2160,2160,2160\n2160,2160,2160,2978\nfan 80\n2160,2160,2160,\n";
        serve(&config, false, input.as_bytes(), &mut output).unwrap();
        let lines: Vec<String> = String::from_utf8(output).unwrap().lines().map(str::to_owned).collect();
        assert_eq!((cell(&lines, 1, "supply"), cell(&lines, 1, "fan_pct")), ("", ""));
        let supply: f32 = cell(&lines, 2, "supply").parse().unwrap();
        assert!((supply - 1.0).abs() < 1e-3);
        assert_eq!(
            (cell(&lines, 4, "supply"), cell(&lines, 4, "fan_pct")),
            (cell(&lines, 2, "supply"), "80")
        );
    }

    #[test]
    fn commands_are_carried_out_or_refused() {
        let (lines, result) = answers(
            true,
            "setpoint 40\n2160,2160,2160\nstop\n2160,2160,2160\narm\n2160,2160,2160\nexcite off\nack\nsetpoint 400\n",
        );
        result.unwrap();
        assert_eq!((lines[1].as_str(), cell(&lines, 2, "setpoint_c")), ("ok", "40"));
        assert_eq!((lines[3].as_str(), cell(&lines, 4, "mode")), ("ok", "off"));
        assert_eq!((lines[5].as_str(), cell(&lines, 6, "mode")), ("ok", "settle"));
        assert_eq!(lines[7], "ok");
        assert!(lines[8].starts_with("error line 8: not possible in mode "), "{}", lines[8]);
        assert!(lines[9].starts_with("error line 9: ") && lines[9].contains("400"), "{}", lines[9]);
    }

    #[test]
    fn bad_lines_are_answered_and_end_it_unless_it_is_to_keep_going() {
        for (bad, word) in [
            ("1,2", "2 fields"),
            ("1,2,x", "t2_code"),
            ("1,4096,3", "4096"),
            ("1,nan,3", "nan"),
            ("set 40", "setpoint CELSIUS"),
            ("setpoint warm", "warm"),
            ("setpoint nan", "NaN"),
        ] {
            let input = format!("2160,2160,2160\n{bad}\n2160,2160,2160\n");
            let (lines, result) = answers(false, &input);
            let message = format!("{:#}", result.unwrap_err());
            assert!(
                message.contains("line 2") && message.contains(word) && message.contains("expected"),
                "{message}"
            );
            assert_eq!(lines[2], format!("error {message}"));
            assert_eq!(lines.len(), 3, "nothing more is answered after a bad line");
            let (survived, result) = answers(true, &input);
            result.unwrap();
            assert_eq!((survived.len(), cell(&survived, 3, "t_s")), (4, "0.11"), "a bad line is no tick");
        }
    }
}
