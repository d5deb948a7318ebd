//! The parts of a tick, each alone.

use core::fmt::{self, Write};
use core::hint::black_box;

use fdi_core::control::pid::{Pid, PidState};
use fdi_core::control::prbs::{Prbs, PrbsState};
use fdi_core::diagnosis::signature::{PAPER_DETECTION, PAPER_ISOLATION, Symptoms, Table, symptoms};
use fdi_core::filter::{LowPass, LowPassState};
use fdi_core::identify::Bandwidth;
use fdi_core::identify::observer::{Identified, Observer, ObserverState};
use fdi_core::identify::observer::{NA, NB};
use fdi_core::identify::transfer::Transfer;
use fdi_core::sense::thermistor::Thermistor;
use fdi_core::sense::{Sensing, SensingState};
use fdi_core::{AdcCode, Celsius, Config, Percent, RawSample, Sample};

use super::Stopwatch;
use crate::codes::sample;
use crate::recording::Recording;

/// Counts every part over the whole run.
pub(super) fn count(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    control_parts(watch, recording, out)?;
    observers(watch, recording, out)?;
    features(watch, recording, out)?;
    decision(watch, recording, out)
}

fn control_parts(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let config = Config::default();
    let ticks = recording.len();
    let thermistor = Thermistor::new(&config.sensors.t1, 1).expect("valid");
    watch.pass(out, ["NTC conversion"], ticks, |watch, k| {
        let code = AdcCode(recording.row(k).codes[1]);
        watch.time(0, || celsius(&thermistor, code));
    })?;
    let sensing = Sensing::new(&config.sensors, &config.plausibility, config.sample_time).expect("valid");
    let mut state = SensingState::default();
    watch.pass(out, ["sensing: 3 conversions, plausibility"], ticks, |watch, k| {
        let raw = sample(recording.row(k).codes);
        watch.time(0, || sense(&sensing, &mut state, raw));
    })?;
    let pid = Pid::new(&config.pid, config.sample_time).expect("valid");
    let mut state = PidState::default();
    watch.pass(out, ["PID"], ticks, |watch, k| {
        let y = thermistor.celsius(AdcCode(recording.row(k).codes[1]));
        watch.time(0, || regulate(&pid, &mut state, config.setpoint, y));
    })?;
    let prbs = Prbs::new(&config.prbs).expect("valid");
    let mut state = prbs.start();
    watch.pass(out, ["PRBS"], ticks, |watch, _| {
        watch.time(0, || excite(&prbs, &mut state));
    })
}

/// The two observers whole; the first also reads the bandwidth.
fn observers(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let c = &Config::default();
    let forms = [
        ("observer MS1: ARX, gain, bandwidth", Some(Bandwidth::RiseTime), 0),
        ("observer MS2: ARX, gain", None, 1),
    ];
    for (name, bandwidth, which) in forms {
        let observer = Observer::new(&c.identification, bandwidth, c.sample_time).expect("valid");
        let mut state = observer.start();
        watch.pass(out, [name], recording.len(), |watch, k| {
            let row = recording.row(k);
            let y = Some(row.rise[which]).filter(|y| y.is_finite());
            watch.time(0, || observe(&observer, &mut state, y, row.power));
        })?;
    }
    Ok(())
}

/// What is read off the model of T1, as it is on each tick.
fn features(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let c = &Config::default();
    let observer = Observer::new(&c.identification, None, c.sample_time).expect("valid");
    let mut pass = |name, work: fn(&Transfer<NA, NB>)| {
        let mut state = observer.start();
        watch.pass(out, [name], recording.len(), |watch, k| {
            let row = recording.row(k);
            observer.step(&mut state, Some(row.rise[0]).filter(|y| y.is_finite()), row.power);
            let model = observer.model(&state);
            watch.time(0, || work(&model));
        })
    };
    pass("static gain", static_gain)?;
    pass("stability", stability)?;
    pass("rise time", rise_time)
}

/// From features to fault vectors, of one form of the residuals; the instrument does it for two.
fn decision(watch: &mut Stopwatch, recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let c = &Config::default();
    let low_pass = LowPass::new(c.diagnosis.filter_cutoff, c.sample_time);
    let mut state = None;
    watch.pass(out, ["low-pass of 7 residuals"], recording.len(), |watch, k| {
        let features = recording.row(k).features;
        watch.time(0, || filter(&low_pass, &mut state, &features));
    })?;
    let (detection, isolation) = (Table::new(&PAPER_DETECTION), Table::new(&PAPER_ISOLATION));
    watch.pass(out, ["symptoms and look-up"], recording.len(), |watch, k| {
        let row = recording.row(k);
        watch.time(0, || {
            let found = compare(&row.filtered, recording, c.diagnosis.sigma_factor);
            look(&detection, &isolation, &found)
        });
    })
}

#[inline(never)]
fn celsius(thermistor: &Thermistor, code: AdcCode) -> Celsius {
    thermistor.celsius(code)
}

#[inline(never)]
fn sense(sensing: &Sensing, state: &mut SensingState, raw: RawSample) -> Sample {
    sensing.step(state, raw, true)
}

#[inline(never)]
fn regulate(pid: &Pid, state: &mut PidState, setpoint: Celsius, y: Celsius) -> Percent {
    pid.step(state, setpoint, y)
}

#[inline(never)]
fn excite(prbs: &Prbs, state: &mut PrbsState) -> Percent {
    prbs.step(state)
}

#[inline(never)]
fn observe(observer: &Observer, state: &mut ObserverState, y: Option<f32>, power: f32) -> Identified {
    observer.step(state, y, power)
}

#[inline(never)]
fn static_gain(model: &Transfer<NA, NB>) {
    black_box(model.static_gain());
}

#[inline(never)]
fn stability(model: &Transfer<NA, NB>) {
    black_box(model.is_stable());
}

#[inline(never)]
fn rise_time(model: &Transfer<NA, NB>) {
    black_box(model.rise_time(black_box(0.95 * 0.3), 64));
}

#[inline(never)]
fn filter(low_pass: &LowPass, state: &mut LowPassState<7>, features: &[f32; 7]) -> [f32; 7] {
    low_pass.step(state, features)
}

#[inline(never)]
fn compare(features: &[f32; 7], recording: &Recording, factor: f32) -> Symptoms {
    symptoms(features, &recording.normal, factor)
}

#[inline(never)]
fn look(detection: &Table, isolation: &Table, symptoms: &Symptoms) -> [[u8; 2]; 2] {
    [detection, isolation].map(|table| table.look_up(symptoms))
}
