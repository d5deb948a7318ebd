//! What was learnt from a recording, and what can be told with it.

use std::fmt::Write as _;

use fdi_core::Config;
use fdi_core::likelihood::inputs::Inputs;

use pt326_host::experiment::as_written;
use pt326_host::isolability::{Isolability, Question, output};
use pt326_host::recording::run::{Diagnosed, Training};
use pt326_host::recording::{Heater, Recording};

/// Times within which faults are to be told apart, in times that T1 takes to answer.
const WITHIN: [f64; 3] = [0.3, 1.0, 3.0];

/// What cannot be said for want of a thermistor.
pub(super) fn missing(inputs: Inputs) -> String {
    let mut text = String::new();
    if !inputs.t0 {
        text += "No T0: a constant is learnt in its place, so a room that warms looks like any other thing that warms T1.\n";
    }
    if !inputs.t2 {
        text +=
            "No T2: faults of T1, of the heater and of the air are told apart only by how fast T1 changes.\n";
    }
    if !inputs.fan {
        text += "No fan: the air flow, and dirt that it carries, are not considered.\n";
    }
    text
}

/// The model, and how well it fits.
pub(super) fn learnt(
    recording: &Recording,
    heater: &Heater,
    training: &Training,
    done: &Diagnosed,
) -> String {
    let (model, trained) = (&done.trained.model, &done.trained);
    let degc = f64::from(recording.units.celsius);
    let unit = recording.unit(heater);
    let full = f64::from(recording.units.full_power) / 100.0;
    let gain = |gain: f32| f64::from(gain) / degc / full;
    let mut text = format!(
        "Model: power -> lag {:.3} s -> dead time {:.3} s -> lag {:.3} s -> T1; gain {:.4} {unit} a unit of power, {:+.1} % of it for each 20 % of \
         power more; {:.1} % of the rise comes with a wall of {:.0} s\n",
        model.heater,
        model.dead_time,
        model.lag,
        gain(model.gain),
        100.0 * model.curvature,
        100.0 * model.wall_share,
        model.wall,
    );
    if heater.inputs.t2 {
        let _ = writeln!(
            text,
            "       T1 -> dead time {:.3} s -> lag {:.3} s -> T2, which has {:.1} % of T1's rise",
            model.transport,
            model.lag2,
            100.0 * model.reaches
        );
    } else if heater.map.column(pt326_host::recording::map::Role::Known).is_some() {
        let _ = writeln!(
            text,
            "       the heater beside -> lag {:.3} s -> lag {:.3} s -> T1; gain {:.4} {unit} a unit of its power",
            model.heater,
            model.lag_beside,
            gain(model.gain_beside)
        );
    }
    let _ = write!(
        text,
        "Fit, simulated: {:.1} % of T1 where it was learnt{}; what is left is white with {:.3} {unit}",
        trained.fit,
        match training {
            _ if !done.fit_on_the_rest.is_finite() => String::new(),
            Training::Own(..) | Training::Found(..) => format!(", {:.1} % on the rest", done.fit_on_the_rest),
            Training::Other(_) => format!(", {:.1} % here, faults and all", done.fit_on_the_rest),
        },
        f64::from(model.noise[0]) / degc
    );
    for unknown in &trained.unknown {
        let _ = write!(text, "\nNot known: {unknown}");
    }
    if trained.every > 1 {
        let _ = write!(
            text,
            "\nT1 answers over so many samples that the process is watched by means of {} s, thermistors by each sample",
            as_written((recording.sample_time * f64::from(trained.every)) as f32)
        );
    }
    if heater.is_ours {
        text += "\nIt is a rig of this project: the paper's signatures are run as well, and are in trace.csv";
    }
    text + "\n"
}

/// Which faults can be told apart, from which size on, or why that cannot be said.
pub(super) fn told_apart(
    recording: &Recording,
    heater: &Heater,
    training: &Training,
    done: &Diagnosed,
) -> String {
    let model = &done.trained.model;
    let answer = f64::from(model.heater + model.lag + model.dead_time);
    let digits = |x: f64| (x * 10.0).round().max(1.0) / 10.0;
    let horizons = WITHIN.map(|share| digits(share * answer)).to_vec();
    let samples = match training {
        Training::Own(part, _) | Training::Found(part, ..) => &heater.samples[part.clone()],
        Training::Other(_) => &heater.samples[..],
    };
    let mut monitor = done.trained.monitor.clone();
    monitor.resume();
    let question = Question { seed: 1, horizons, equal_odds: false };
    let rate = (heater.inputs, recording.sample_time, done.trained.every);
    let found = match Isolability::watched(&monitor, samples, rate, &question) {
        Ok(found) => found,
        Err(error) => return format!("\nWhich faults can be told apart is not known: {error:#}\n"),
    };
    let unit = if recording.units.celsius == 1.0 {
        String::new()
    } else {
        format!("degC are those that one unit of T1 counts for: {}.\n", recording.units.celsius)
    };
    format!("\n{}{unit}Median of {} onsets.\n", output::tables(&found), found.onsets)
}

/// The settings that differ from the defaults, as TOML.
pub(super) fn settings_of(config: &Config) -> String {
    let number = |x: f32| {
        let x = as_written(x);
        if x.fract() == 0.0 { format!("{x:.1}") } else { x.to_string() }
    };
    let (i, l) = (&config.identification, &config.likelihood);
    format!(
        "# Learnt from a recording by pt326 diagnose. Limits, controller and thermistors are the defaults: set them for your rig (docs/porting.md).\n\
         sample_time = {}\n\n[identification]\ny_scale = {}\nu_scale = {}\nanswer_time = {}\ngain_max = {}\n\n[likelihood]\nfit_time = {}\n\
         check_time = {}\n",
        number(config.sample_time.0),
        number(i.y_scale.0),
        number(i.u_scale.0),
        number(i.answer_time.0),
        number(i.gain_max),
        number(l.fit_time.0),
        number(l.check_time.0)
    )
}
