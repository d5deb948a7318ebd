extern crate std;

use std::vec;
use std::vec::Vec;

use super::super::process::Parameter;
use super::super::reference::Random;
use super::super::whitening::ResidualStatistics;
use super::*;
use crate::likelihood::Tuning;

const MINUTES: f32 = 0.11 / 60.0;
const LEAD: usize = 4;
/// The last tick before the regressors begin, and ticks in all.
const QUIET: usize = 300;
const TICKS: usize = 420;

fn parameters() -> Parameters {
    Parameters([-1.2, 1.4, 2.3, 0.2, 0.06, 0.9, 1.3, 1.1, 0.03, 4.0, 0.1, -0.2, 0.01])
}

fn constants() -> OnsetConstants {
    OnsetConstants { lead: LEAD, lags: [0.25, 0.1], fan: 0.4, minutes: MINUTES }
}

fn powers() -> Vec<f32> {
    let mut random = Random::new(5);
    (0..TICKS).map(|k| 40.0 + if k % 3 == 0 { 20.0 * random.uniform() as f32 } else { 0.0 }).collect()
}

/// Whitening that changes nothing, so that regressors are seen in degC.
fn plain() -> WhiteningFilter {
    let mut whitening = WhiteningFilter::default();
    (whitening.sigma, whitening.inv_sigma) = ([1.0; 2], [1.0; 2]);
    whitening
}

/// A whole simulation from the first tick on: rises of each tick, with what is changed from a tick on.
fn simulated(heat: impl Fn(usize, f32) -> f32, process: impl Fn(usize) -> Process) -> Vec<Rises> {
    let mut motion = Motion::default();
    let nominal = Process::new(Default::default(), &parameters(), 1.0);
    let tick = |(k, power): (usize, &f32)| process(k).step(&mut motion, heat(k, nominal.heat(*power)));
    powers().iter().enumerate().map(tick).collect()
}

fn nominal() -> Vec<Rises> {
    simulated(|_, heat| heat, |_| Process::new(Default::default(), &parameters(), 1.0))
}

/// The regressors of all ticks from QUIET on.
fn regressors(restart: Option<usize>) -> Vec<Regressors> {
    let (p, c, whitening) = (parameters(), constants(), plain());
    let process = Process::new(Default::default(), &p, 1.0);
    let (mut motion, mut history, mut onset) = (Motion::default(), History::default(), Onset::default());
    let (mut before, mut rows) = ([0.0; 2], vec![]);
    for (k, power) in powers().into_iter().enumerate() {
        let heat = process.heat(power);
        let rises = process.step(&mut motion, heat);
        let now = Nominal {
            parameters: &p,
            fan: 1.0,
            process: &process,
            motion: &motion,
            history: &history,
            heat,
            rises,
            before,
            inlet: [0.3, 0.7],
        };
        if restart == Some(k) {
            onset.restart_sensors(before[0]);
        }
        if k >= QUIET {
            rows.push(onset.step(&c, &whitening, &now)[1]);
        }
        history.push(heat, &motion);
        before = rises.y;
    }
    rows
}

/// A regressor against the difference of a changed simulation and the nominal one, for each unit of the change.
fn assert_difference(regressor: Regressor, changed: &[Rises], unit: f32) {
    let (rows, nominal) = (regressors(None), nominal());
    let mut largest = 0.0f32;
    for (row, k) in rows.iter().zip(QUIET..) {
        for m in 0..2 {
            let wanted = (changed[k].y[m] - nominal[k].y[m]) / unit;
            let got = row[regressor as usize][m];
            largest = largest.max(wanted.abs());
            assert!(
                (got - wanted).abs() < 2e-3 * (1.0 + wanted.abs()),
                "{regressor:?}, T{}, {k}: {got}, not {wanted}",
                m + 1
            );
        }
    }
    assert!(largest > 0.1, "{regressor:?} does something");
}

/// What changes begins so many ticks before it shows.
const BEGINS: usize = QUIET - LEAD;

#[test]
fn power_and_a_constant_power_are_differences_of_two_simulations() {
    let nominal_process = |_| Process::new(Default::default(), &parameters(), 1.0);
    let more = simulated(|k, heat| if k >= BEGINS { 1.5 * heat } else { heat }, nominal_process);
    assert_difference(Regressor::Power, &more, 0.5);
    let constant = simulated(|k, heat| if k >= BEGINS { heat + 10.0 } else { heat }, nominal_process);
    assert_difference(Regressor::Constant, &constant, 10.0);
}

/// The fan follows with its lag: the flow of each tick is that in its middle.
#[test]
fn air_flows_are_differences_of_two_simulations() {
    let t = Tuning::DEFAULT.hypotheses;
    let regressors = [Regressor::LessFlow, Regressor::MoreFlow];
    for (regressor, (flow, unit)) in regressors.into_iter().zip(t.flows().into_iter().zip(t.secants())) {
        let at = |k: usize| {
            let age = k as f32 + 0.5 - BEGINS as f32;
            let approach = if age > 0.0 { 1.0 - (-0.4 * age).exp() } else { 0.0 };
            // The lag is over after eight of its time constants.
            Process::new(Default::default(), &parameters(), 1.0 + (flow - 1.0) * approach)
        };
        assert_difference(regressor, &simulated(|_, heat| heat, at), unit);
    }
}

/// The wall has always been there: its regressor is the derivative of the whole simulation by its share.
#[test]
fn the_walls_column_is_the_derivative_by_its_share() {
    let mut p = parameters();
    p.set(Parameter::Wall1, p.get(Parameter::Wall1) + 0.1);
    assert_difference(
        Regressor::Wall,
        &simulated(|_, heat| heat, |_| Process::new(Default::default(), &p, 1.0)),
        0.1,
    );
}

/// A longer dead time by a tick gives what was there a tick ago.
#[test]
fn a_shift_is_a_longer_dead_time() {
    let mut p = parameters();
    p.set(Parameter::Delay1, p.get(Parameter::Delay1) + 1.0);
    assert_difference(
        Regressor::Shift,
        &simulated(|_, heat| heat, |_| Process::new(Default::default(), &p, 1.0)),
        1.0,
    );
}

/// T1 behind a further lag that begins with the onset: what it reads less what it should; and what a lost share of the rise is behind it.
#[test]
fn lags_and_losses_begin_at_the_onset() {
    let (rows, rises) = (regressors(None), nominal());
    for (place, share) in constants().lags.into_iter().enumerate() {
        let (lag, loss) =
            [(Regressor::ShortLag, Regressor::ShortLoss), (Regressor::LongLag, Regressor::LongLoss)][place];
        let share = f64::from(share);
        for (row, k) in rows.iter().zip(QUIET..) {
            // The lag as a sum over its past: the level before the onset decays, what came since is weighted.
            let weight = |i: usize| share * (1.0 - share).powi((k - i) as i32);
            let since: f64 = (QUIET..=k).map(|i| weight(i) * f64::from(rises[i].y[0])).sum();
            let held = (1.0 - share).powi((k + 1 - QUIET) as i32) * f64::from(rises[QUIET - 1].y[0]);
            let wanted = since + held - f64::from(rises[k].y[0]);
            assert!((f64::from(row[lag as usize][0]) - wanted).abs() < 1e-3, "{lag:?} {k}: {row:?}");
            assert!((f64::from(row[loss as usize][0]) - since).abs() < 1e-3, "{loss:?} {k}: {row:?}");
            assert_eq!((row[lag as usize][1], row[loss as usize][1]), (0.0, 0.0), "T2 is not clogged");
        }
    }
}

#[test]
fn sensors_columns_are_what_they_are_called() {
    let (rows, rises) = (regressors(None), nominal());
    for (age, (row, k)) in rows.iter().zip(QUIET..).enumerate() {
        let [y1, y2] = rises[k].y;
        let at = |regressor: Regressor| row[regressor as usize];
        assert_eq!((at(Regressor::Offset1), at(Regressor::Offset2)), ([1.0, 0.0], [0.0, 1.0]));
        assert_eq!((at(Regressor::Gain1), at(Regressor::Gain2)), ([y1, 0.0], [0.0, y2]));
        assert_eq!(at(Regressor::Exchanged), [y2 - y1, y1 - y2]);
        assert_eq!((at(Regressor::Inlet1), at(Regressor::Inlet2)), ([0.3, 0.0], [0.0, 0.7]));
        let minutes = age as f32 * MINUTES;
        assert!(
            (at(Regressor::Ramp1)[0] - minutes).abs() < 1e-5
                && (at(Regressor::Ramp2)[1] - minutes).abs() < 1e-5
        );
        assert!(at(Regressor::Ramp1)[1] == 0.0 && at(Regressor::Ramp2)[0] == 0.0);
    }
}

/// What sensors do begins anew, what the process does goes on.
#[test]
fn restarting_the_sensors_leaves_the_process() {
    let at = QUIET + 50;
    let (whole, restarted) = (regressors(None), regressors(Some(at)));
    let (row, was) = (restarted[50], whole[50]);
    assert_eq!(row[Regressor::Ramp1 as usize], [0.0; 2]);
    assert!(row[Regressor::LongLoss as usize][0] < 0.2 * was[Regressor::LongLoss as usize][0]);
    let of_sensors = |regressor: &usize| SENSORS.iter().any(|sensor| *sensor as usize == *regressor);
    for regressor in (0..COUNT).filter(|regressor| !of_sensors(regressor)) {
        assert_eq!(restarted[100][regressor], whole[100][regressor], "regressor {regressor}");
    }
}

/// Regressors go through the same filter as the residuals: of a whitened regressor no level from before is left.
#[test]
fn the_columns_are_whitened_from_rest() {
    let mut whitening = plain();
    whitening.inv_sigma = [10.0, 20.0];
    let (p, mut onset, mut history) = (parameters(), Onset::default(), History::default());
    let (process, motion) = (Process::new(Default::default(), &p, 1.0), Motion::steady(30.0));
    history.push(30.0, &motion);
    let rises = Rises { y: [9.0, 8.0], wall: [0.0; 2] };
    let now = Nominal {
        parameters: &p,
        fan: 1.0,
        process: &process,
        motion: &motion,
        history: &history,
        heat: 30.0,
        rises,
        before: rises.y,
        inlet: [0.0; 2],
    };
    let [_, row] = onset.step(&constants(), &whitening, &now);
    assert_eq!(row[Regressor::Offset1 as usize], [10.0, 0.0]);
    assert_eq!(row[Regressor::Gain2 as usize], [0.0, 160.0]);
    assert_eq!((onset.age, onset.sensors_age), (1, 1));
}

/// A tick without samples: the models and ramps go on, and whitening takes up where it stopped, as that of the residuals does.
#[test]
fn without_samples_the_models_go_on() {
    let mut statistics = ResidualStatistics::default();
    let mut random = Random::new(1);
    let mut e = [0.0f32; 2];
    for k in 0..2000 {
        e = e.map(|e| 0.6 * e + 0.1 * random.gaussian() as f32);
        statistics.push(e, [if k % 20 < 10 { 9.0 } else { 15.0 }; 2]);
    }
    let (p, c, coloured) =
        (parameters(), constants(), statistics.finish(&Tuning::DEFAULT.whitening, 2).unwrap());
    let (process, history) = (Process::new(Default::default(), &p, 1.0), History::default());
    // Each tick of three, seen or not: the last row.
    let run = |whitening: &WhiteningFilter, seen: [bool; 3]| {
        let (mut motion, mut onset, mut before) = (Motion::steady(30.0), Onset::default(), [9.0; 2]);
        let mut row = [[0.0; 2]; COUNT];
        for seen in seen {
            let rises = process.step(&mut motion, 60.0);
            let now = Nominal {
                parameters: &p,
                fan: 1.0,
                process: &process,
                motion: &motion,
                history: &history,
                heat: 60.0,
                rises,
                before,
                inlet: [0.0; 2],
            };
            if seen {
                [_, row] = onset.step(&c, whitening, &now);
            } else {
                onset.pass(&c, whitening, &now);
            }
            before = rises.y;
        }
        row
    };
    let [whole, holed] = [[true; 3], [true, false, true]].map(|seen| run(&plain(), seen));
    assert_eq!(whole, holed, "unwhitened, a tick that is missing is missed by nothing");
    let offset = Regressor::Offset1 as usize;
    let mut past = Past::default();
    let wanted = [0; 2].map(|_| coloured.step(&mut past, [1.0, 0.0])[0])[1];
    assert_eq!(run(&coloured, [true, false, true])[offset][0], wanted, "the second that is whitened");
}
