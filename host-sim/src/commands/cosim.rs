//! `host-sim core`: the instrument on standard input and output, for co-simulation with any other program.

use std::io::{BufRead, Write};

use anyhow::{Context, ensure};
use fdi_core::{AdcCode, Command, Config, Instrument, RawSample};

use crate::commands::CoreArgs;
use crate::experiment::as_written;
use crate::record::trace::{OneTick, append_cells, header, instrument_columns};

/// Runs on the process's standard streams.
///
/// # Errors
/// A bad configuration, a bad line, a stream that fails.
pub fn run(args: &CoreArgs) -> anyhow::Result<()> {
    let config = crate::settings::read(args.config.as_deref())?;
    serve(&config, std::io::stdin().lock(), std::io::stdout().lock())
}

/// Answers each line of `input` with one on `output`, until the input ends.
///
/// # Errors
/// A bad line, by number, with what was expected; a stream that fails.
pub fn serve(config: &Config, input: impl BufRead, mut output: impl Write) -> anyhow::Result<()> {
    let mut instrument = Instrument::new(config)?;
    instrument.command(Command::Arm).context("can't begin to regulate")?;
    let sample_time = as_written(config.sample_time.0);
    writeln!(output, "drive_pct,{}", header(instrument_columns()))?;
    output.flush()?;
    for (i, line) in input.lines().enumerate() {
        let number = i + 1;
        let line = line.with_context(|| format!("line {number} can't be read"))?;
        let raw = parse(&line).with_context(|| format!("line {number}"))?;
        let tick = instrument.control(raw);
        let report = instrument.diagnose(&tick, tick.drive);
        let mut answer = format!("{},", tick.drive.0);
        let on = OneTick { tick: &tick, report: &report, truth: 0, sample_time };
        append_cells(&mut answer, instrument_columns(), &on);
        writeln!(output, "{answer}")?;
        output.flush()?;
    }
    Ok(())
}

/// Parses `t0_code,t1_code,t2_code`.
fn parse(line: &str) -> anyhow::Result<RawSample> {
    const EXPECTED: &str =
        "expected t0_code,t1_code,t2_code: three 12-bit codes, 0 to 4095, such as 2160,1620.5,1655";
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    ensure!(fields.len() == 3, "{} fields in {line:?}, {EXPECTED}", fields.len());
    let mut codes = [AdcCode(0.0); 3];
    for ((code, field), name) in codes.iter_mut().zip(fields).zip(["t0_code", "t1_code", "t2_code"]) {
        let value: f32 = field.parse().ok().with_context(|| format!("{name} is {field:?}, {EXPECTED}"))?;
        ensure!((0.0..=AdcCode::FULL_SCALE).contains(&value), "{name} is {field}, {EXPECTED}");
        *code = AdcCode(value);
    }
    let [t0, t1, t2] = codes;
    Ok(RawSample { t0, t1, t2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(input: &str) -> (String, anyhow::Result<()>) {
        let mut output = Vec::new();
        let result = serve(&Config::default(), input.as_bytes(), &mut output);
        (String::from_utf8(output).unwrap(), result)
    }

    #[test]
    fn each_line_is_answered_with_every_column() {
        let (output, result) = answers("2160,2160,2160\r\n2160,2159.5,2160\n");
        result.unwrap();
        let lines: Vec<&str> = output.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[0].starts_with("drive_pct,t_s,t0_c,"));
        let columns = lines[0].split(',').count();
        assert!(lines.iter().all(|line| line.split(',').count() == columns));
        assert!(lines[2].contains(",0.11,") && lines[2].ends_with(",settle,0,,,,,"));
    }

    #[test]
    fn bad_lines_are_named() {
        for (bad, word) in [
            ("1,2", "2 fields"),
            ("1,2,x", "t2_code"),
            ("1,4096,3", "4096"),
            ("1,nan,3", "nan"),
            ("", "1 fields"),
        ] {
            let (output, result) = answers(&format!("2160,2160,2160\n{bad}\n"));
            let message = format!("{:#}", result.unwrap_err());
            assert!(
                message.contains("line 2") && message.contains(word) && message.contains("expected"),
                "{message}"
            );
            assert_eq!(output.lines().count(), 2, "nothing is answered to a bad line");
        }
    }
}
