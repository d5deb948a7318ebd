//! `calibrate`: points, and what is made of them.

use core::fmt::Write;

use fdi_core::Config;

use super::{Board, BoardError, done, fail, say};
use crate::calibration::{CalibrationError, NAMES};
use crate::decimal::{self, Fixed};
use crate::settings::{Expected, SetError};

/// Carries out `calibrate WHAT [DEGC]`, with the heater off.
pub(super) async fn carry_out(what: &str, celsius: &str, board: &mut impl Board, out: &mut dyn Write) {
    if board.status().may_heat() {
        return fail(out, &BoardError::NotOff);
    }
    let config = board.config();
    match what {
        "clear" => {
            board.calibration().clear();
            say(out, "ok\n");
        }
        "back" => done(out, board.calibration().withdraw()),
        "apply" => {
            let new = board.calibration().applied(&config);
            put_in_force(new, "in force; `save` keeps it, `calibrate undo` takes it back\n", board, out)
                .await;
        }
        "undo" => {
            let old = board.calibration().undone(&config);
            put_in_force(old, "in force again; `save` keeps it\n", board, out).await;
        }
        name => match decimal::parse(celsius) {
            Some(celsius) => take_points(name, celsius, &config, board, out),
            None => {
                let expected = Expected::Words(decimal::EXPECTED);
                fail(out, &SetError::Value { name: "calibrate", given: celsius, expected });
            }
        },
    }
}

/// A point of each thermistor that is meant.
fn take_points(name: &str, celsius: f32, config: &Config, board: &mut impl Board, out: &mut dyn Write) {
    board.calibration().begin();
    for (i, thermistor) in NAMES.iter().enumerate().filter(|(_, each)| name == "all" || name == **each) {
        let reads = board.still().reading(i);
        let line = reads.and_then(|reads| board.calibration().add(i, reads, celsius, config));
        let _ = match (reads, line) {
            (Ok(reads), Ok(line)) => writeln!(out, "{thermistor} reads {}: {line}", Fixed(reads, 2)),
            (_, Err(error)) | (Err(error), _) => writeln!(out, "error: {thermistor}: {error}"),
        };
    }
}

async fn put_in_force(
    config: Result<Config, CalibrationError>,
    done: &str,
    board: &mut impl Board,
    out: &mut dyn Write,
) {
    let config = match config {
        Ok(config) => config,
        Err(error) => return fail(out, &error),
    };
    if let Err(error) = board.apply(&config).await {
        return fail(out, &error);
    }
    let sensors = [&config.sensors.t0, &config.sensors.t1, &config.sensors.t2];
    for (name, sensor) in NAMES.iter().zip(sensors) {
        let (gain, offset) = (Fixed(sensor.gain, 4), Fixed(sensor.offset.0, 3));
        let _ = writeln!(out, "{name}: gain {gain}, offset {offset} degC");
    }
    say(out, done);
}
