//! Whatever goes in: finite, in range, flagged; or refused with the parameter's name.

use fdi_core::identify::Adaptation;
use fdi_core::{AdcCode, Command, Config, Instrument, Percent, RawSample, Report, Tick, Validity};
use proptest::prelude::*;

/// Any bit pattern, with a preference for what comes near the truth and for the awkward.
fn any_code() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.0f32..4095.0,
        2 => any::<u32>().prop_map(f32::from_bits),
        1 => prop_oneof![
            Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(0.0), Just(-0.0), Just(4095.0),
            Just(1e-40), Just(f32::MIN_POSITIVE), Just(f32::MAX), Just(40.0), Just(4055.0), Just(4094.9999)
        ],
    ]
}

fn check_tick(tick: &Tick) -> Result<(), TestCaseError> {
    for (name, percent) in [("drive", tick.drive), ("pid", tick.pid)] {
        prop_assert!((0.0..=100.0).contains(&percent.0), "{name} is {percent}");
    }
    prop_assert!(tick.prbs.0.abs() <= 50.0);
    for reading in [tick.sample.t0, tick.sample.t1, tick.sample.t2] {
        prop_assert!(reading.celsius.0.is_finite() && reading.celsius.0.abs() <= 400.0, "{reading:?}");
        let plausible = (-20.0..=110.0).contains(&reading.celsius.0);
        prop_assert!(plausible || reading.validity != Validity::Good, "{reading:?}");
    }
    prop_assert!(tick.known.supply.is_none_or(|share| (0.5..=1.25).contains(&share)));
    prop_assert!(tick.mode.is_heating() || tick.drive.0 == 0.0);
    Ok(())
}

fn check_report(report: &Report) -> Result<(), TestCaseError> {
    let mut numbers = vec![report.y1, report.y2];
    for model in [report.ms1, report.ms2] {
        numbers.extend([model.prediction, model.static_gain, model.bandwidth]);
        prop_assert!(model.static_gain.is_none_or(|g| g.abs() <= 2.0));
        prop_assert!(model.bandwidth.is_none_or(|b| b > 0.0));
    }
    for residuals in [report.features, report.features_filtered, report.residuals, report.residuals_filtered]
    {
        numbers.extend(residuals.into_iter().flatten().map(Some));
    }
    let likelihood = &report.likelihood;
    numbers.extend(likelihood.expected);
    numbers.extend([likelihood.virtual_rise, likelihood.air_flow]);
    if let Some(finding) = likelihood.finding {
        prop_assert!((0.0..=1.0).contains(&finding.confidence), "{finding:?}");
        prop_assert!(finding.onset <= report.tick, "{finding:?}");
        numbers.push(finding.magnitude.map(|size| size.value));
        numbers.push(finding.magnitude.map(|size| size.half_width));
    }
    prop_assert!(numbers.iter().flatten().all(|x| x.is_finite()), "{report:?}");
    Ok(())
}

/// A quick learner, so that the whole chain is reached in a few hundred ticks.
fn impatient() -> Config {
    let mut config = Config::default();
    config.supervisor.learn_start.0 = 5.0;
    config.supervisor.learn_end.0 = 17.0;
    config.likelihood.fit_time.0 = 10.0;
    config.likelihood.check_time.0 = 10.0;
    config.supervisor.regulation_time.0 = 0.0;
    config.supervisor.regulation_band.0 = 100.0;
    config
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// Codes of every bit pattern, and any claim about what was applied.
    #[test]
    fn any_codes_give_finite_and_safe_outputs(
        codes in prop::collection::vec((any_code(), any_code(), any_code(), any_code(), any_code()), 1..400),
        fan in any_code(),
    ) {
        let mut config = impatient();
        config.supply.nominal_voltage.0 = 12.0;
        let mut instrument = Instrument::new(&config).unwrap();
        instrument.command(Command::Arm).unwrap();
        let _ = instrument.command(Command::Fan(Percent(fan)));
        for (t0, t1, t2, supply, applied) in codes {
            let [t0, t1, t2, supply] = [t0, t1, t2, supply].map(AdcCode);
            let tick = instrument.control(RawSample { t0, t1, t2, supply });
            check_tick(&tick)?;
            check_report(&instrument.diagnose(&tick, Percent(applied)))?;
            if !tick.mode.is_heating() {
                let _ = instrument.command(Command::Acknowledge);
                let _ = instrument.command(Command::Arm);
            }
        }
    }

    /// Wild but plausible codes after the instrument has settled and learnt: no trip hides the rest of the chain.
    #[test]
    fn any_plausible_codes_are_diagnosed(
        codes in prop::collection::vec((500.0f32..3500.0, 500.0f32..3500.0), 200..400),
        amplitude in 0.0f32..200.0,
    ) {
        let mut instrument = Instrument::new(&impatient()).unwrap();
        instrument.command(Command::Arm).unwrap();
        for (k, (a, b)) in codes.iter().enumerate() {
            let wave = amplitude * (k as f32 * 0.3).sin();
            let raw = RawSample { t0: AdcCode(2160.0), t1: AdcCode(1620.0 + wave), t2: AdcCode(0.05 * a + 0.4 * b), ..RawSample::default() };
            let tick = instrument.control(raw);
            check_tick(&tick)?;
            check_report(&instrument.diagnose(&tick, tick.drive))?;
        }
    }

    /// Every number of the configuration, any value: an error that names it, or an instrument that works.
    #[test]
    fn any_configuration_works_or_is_refused_by_name(
        which in 0..NUMBERS.len(), value in any_number(),
        codes in prop::collection::vec((any_code(), any_code(), any_code()), 1..40),
    ) {
        let mut config = Config::default();
        let (name, set) = NUMBERS[which];
        set(&mut config, value);
        match Instrument::new(&config) {
            Err(error) => {
                let message = error.to_string();
                let group = name.split('.').next().unwrap();
                // A long sample time leaves too few samples between learn_start and learn_end.
                let named = message.contains(group) || (name == "sample_time" && message.contains("learn_end"));
                prop_assert!(named, "{name} = {value}: {message}");
            }
            Ok(mut instrument) => {
                prop_assert!(value.is_finite(), "{name} = {value} was accepted");
                instrument.command(Command::Arm).unwrap();
                for (t0, t1, t2) in codes {
                    let raw = RawSample { t0: AdcCode(t0), t1: AdcCode(t1), t2: AdcCode(t2), ..RawSample::default() };
                    let tick = instrument.control(raw);
                    prop_assert!((0.0..=100.0).contains(&tick.drive.0), "{name} = {value}: {}", tick.drive);
                    let report = instrument.diagnose(&tick, tick.drive);
                    let finite = report.features.into_iter().flatten().all(f32::is_finite);
                    prop_assert!(finite, "{name} = {value}: {report:?}");
                }
            }
        }
    }
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        2 => any::<u32>().prop_map(f32::from_bits),
        2 => -10.0f32..10.0,
        2 => 0.0f32..5000.0,
        1 => Just(f32::NAN),
        1 => Just(f32::INFINITY),
        1 => Just(0.0),
    ]
}

type Setter = fn(&mut Config, f32);

/// Every number of the configuration.
const NUMBERS: [(&str, Setter); 39] = [
    ("sample_time", |c, x| c.sample_time.0 = x),
    ("setpoint", |c, x| c.setpoint.0 = x),
    ("sensors.t1.r25", |c, x| c.sensors.t1.r25.0 = x),
    ("sensors.t1.beta", |c, x| c.sensors.t1.beta = x),
    ("sensors.t1.pull_up", |c, x| c.sensors.t1.pull_up.0 = x),
    ("sensors.t1.gain", |c, x| c.sensors.t1.gain = x),
    ("sensors.t1.offset", |c, x| c.sensors.t1.offset.0 = x),
    ("plausibility.open_code", |c, x| c.plausibility.open_code.0 = x),
    ("plausibility.short_code", |c, x| c.plausibility.short_code.0 = x),
    ("plausibility.min", |c, x| c.plausibility.min.0 = x),
    ("plausibility.max", |c, x| c.plausibility.max.0 = x),
    ("plausibility.jump", |c, x| c.plausibility.jump.0 = x),
    ("plausibility.stuck_time", |c, x| c.plausibility.stuck_time.0 = x),
    ("plausibility.ambient_stuck_time", |c, x| c.plausibility.ambient_stuck_time.0 = x),
    ("plausibility.stuck_band", |c, x| c.plausibility.stuck_band.0 = x),
    ("pid.kp", |c, x| c.pid.kp = x),
    ("pid.ti", |c, x| c.pid.ti.0 = x),
    ("pid.td", |c, x| c.pid.td.0 = x),
    ("pid.output_min", |c, x| c.pid.output_min.0 = x),
    ("pid.output_max", |c, x| c.pid.output_max.0 = x),
    ("prbs.amplitude", |c, x| c.prbs.amplitude.0 = x),
    ("identification.adaptation.forgetting", |c, x| {
        c.identification.adaptation = Adaptation::Forgetting { lambda: x }
    }),
    ("identification.adaptation.random-walk", |c, x| {
        c.identification.adaptation = Adaptation::RandomWalk { r1: x, r2: 0.0064 }
    }),
    ("identification.d_initial", |c, x| c.identification.d_initial = x),
    ("identification.d_max", |c, x| c.identification.d_max = x),
    ("identification.y_scale", |c, x| c.identification.y_scale.0 = x),
    ("identification.u_scale", |c, x| c.identification.u_scale.0 = x),
    ("identification.dead_time", |c, x| c.identification.dead_time.0 = x),
    ("identification.gain_max", |c, x| c.identification.gain_max = x),
    ("diagnosis.filter_cutoff", |c, x| c.diagnosis.filter_cutoff = x),
    ("diagnosis.sigma_factor", |c, x| c.diagnosis.sigma_factor = x),
    ("diagnosis.onset_window", |c, x| c.diagnosis.onset_window.0 = x),
    ("diagnosis.clear_time", |c, x| c.diagnosis.clear_time.0 = x),
    ("supervisor.learn_start", |c, x| c.supervisor.learn_start.0 = x),
    ("supervisor.learn_end", |c, x| c.supervisor.learn_end.0 = x),
    ("supervisor.regulation_band", |c, x| c.supervisor.regulation_band.0 = x),
    ("supervisor.regulation_time", |c, x| c.supervisor.regulation_time.0 = x),
    ("supervisor.over_temperature", |c, x| c.supervisor.over_temperature.0 = x),
    ("supervisor.signal_timeout", |c, x| c.supervisor.signal_timeout.0 = x),
];

/// The sequence of every register length visits each state but zero once.
#[test]
fn prbs_has_maximal_length() {
    use fdi_core::control::prbs::{Prbs, PrbsConfig};
    for bits in 3..=16u8 {
        let prbs =
            Prbs::new(&PrbsConfig { bits, samples_per_bit: 1, amplitude: Percent(1.0), start: 1 }).unwrap();
        let mut state = prbs.start();
        let start = state;
        let mut period = 0u32;
        loop {
            prbs.step(&mut state);
            period += 1;
            if state == start || period > 70_000 {
                break;
            }
        }
        assert_eq!(period, (1 << bits) - 1, "{bits} bits");
    }
}
