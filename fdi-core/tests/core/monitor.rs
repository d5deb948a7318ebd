//! The passive monitor on a heater that answers slowly, beside another one, with one thermistor and no T0.

use fdi_core::likelihood::inputs::Inputs;
use fdi_core::likelihood::{Channel, Readiness};
use fdi_core::{Celsius, Config, FaultClass, Monitor, Observed, Seconds, Units};

/// Samples of the training, and of the means.
const TRAINED: usize = 4000;
const EVERY: u32 = 5;

/// Two lags, of 150 and 12 samples, 0.6 degC a %; the heater beside adds a fifth of that through 100 samples more.
struct Plant {
    random: u64,
    x: [f32; 4],
    wander: f32,
}

impl Plant {
    fn new(seed: u64) -> Self {
        Self { random: seed, x: [30.0, 30.0, 30.0, 30.0], wander: 0.0 }
    }

    fn noise(&mut self) -> f32 {
        let uniform = |random: &mut u64| {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*random >> 40) as f32 / (1u64 << 24) as f32 - 0.5
        };
        (0..4).map(|_| uniform(&mut self.random)).sum::<f32>() * 1.7
    }

    /// What the thermistor reads, after a second with these powers.
    fn step(&mut self, u: f32, beside: f32) -> f32 {
        self.x[0] += (u - self.x[0]) / 150.0;
        self.x[1] += (self.x[0] - self.x[1]) / 12.0;
        self.x[2] += (beside - self.x[2]) / 150.0;
        self.x[3] += (self.x[2] - self.x[3]) / 100.0;
        self.wander += 0.006 * self.noise() - 0.001 * self.wander;
        22.0 + 0.6 * self.x[1] + 0.12 * self.x[3] + self.wander + 0.1 * self.noise()
    }
}

/// Powers that change every 5 minutes.
fn powers(k: usize) -> [f32; 2] {
    const LEVELS: [f32; 7] = [30.0, 45.0, 30.0, 20.0, 40.0, 25.0, 35.0];
    [LEVELS[k / 300 % 7], LEVELS[(k / 300 * 3 + 2) % 7]]
}

fn config() -> Config {
    let mut config = Config { sample_time: Seconds(1.0), ..Config::default() };
    config.identification.answer_time = Seconds(400.0);
    config.identification.y_scale = Celsius(25.0);
    config.likelihood.fit_time = Seconds(0.6 * TRAINED as f32);
    config.likelihood.check_time = Seconds(0.35 * TRAINED as f32);
    config
}

fn monitor(units: Units) -> Monitor {
    let inputs = Inputs { t0: false, t2: false, fan: false, ..Inputs::ALL };
    let monitor = Monitor::new(&config(), inputs, units).unwrap();
    monitor.with_means(&config(), EVERY).unwrap()
}

/// What is said from each sample after the training on: an alarm, and a name with its size.
type Said = Vec<(bool, Option<(FaultClass, Option<f32>)>)>;

/// The fault is put in 1000 samples after the training, for 400.
fn run(seed: u64, unit: f32, share: f32, offset: f32) -> (Monitor, Said) {
    let mut monitor = monitor(Units { celsius: 1.0 / unit, ..Units::default() });
    let mut plant = Plant::new(seed);
    let mut said = Said::new();
    let mut read = 40.0;
    for k in 0..TRAINED + 2000 {
        let [u, beside] = powers(k);
        let faulty = (TRAINED + 1000..TRAINED + 1400).contains(&k);
        let observed = Observed {
            t: [None, Some(unit * (read + if faulty { offset } else { 0.0 })), None],
            power: Some(u),
            beside: Some(beside),
            learn: k < TRAINED,
            ..Observed::default()
        };
        let (_, report) = monitor.step(&observed);
        if k >= TRAINED {
            assert_eq!(report.likelihood.readiness, Readiness::Armed);
            let finding = report.likelihood.finding;
            said.push((report.likelihood.alarm, finding.map(|f| (f.class, f.magnitude.map(|m| m.value)))));
        }
        read = plant.step(if faulty { u * (1.0 + share) } else { u }, beside);
    }
    (monitor, said)
}

#[test]
fn it_learns_a_heater_and_the_one_beside_it_and_is_silent_where_nothing_happens() {
    for seed in 1..4 {
        let (monitor, said) = run(seed, 1.0, 0.0, 0.0);
        let model = monitor.model().unwrap();
        assert!((model.gain - 0.6).abs() < 0.06 && (model.gain_beside - 0.12).abs() < 0.05, "{model:?}");
        assert!((model.heater - 150.0).abs() < 25.0, "{model:?}");
        assert!(said.iter().all(|(alarm, _)| !alarm), "seed {seed}");
    }
}

#[test]
fn a_thermistor_that_reads_wrong_is_named_within_three_samples_and_ends_as_soon() {
    for (seed, unit, offset) in [(1, 1.0, 5.0), (2, 1.0, -5.0), (3, 0.1, 5.0)] {
        let (_, said) = run(seed, unit, 0.0, offset);
        assert!(said[..1000].iter().all(|(alarm, _)| !alarm), "seed {seed}");
        assert!(matches!(said[1003].1, Some((FaultClass::T1Offset, _))), "seed {seed}: {:?}", said[1003]);
        let Some((_, Some(size))) = said[1010].1 else { panic!("seed {seed}: no size") };
        assert!((size - unit * offset).abs() < 0.1 * unit * offset.abs(), "seed {seed}: {size}");
        assert!(said[1430..].iter().all(|(alarm, _)| !alarm), "seed {seed}");
    }
}

#[test]
fn a_heater_that_gives_less_is_named_by_the_means() {
    for seed in 1..4 {
        let (_, said) = run(seed, 1.0, -0.4, 0.0);
        assert!(said[..1000].iter().all(|(alarm, _)| !alarm), "seed {seed}");
        let named = said.iter().position(|(_, named)| matches!(named, Some((FaultClass::HeaterPower, _))));
        assert!(named.is_some_and(|k| k < 1120), "seed {seed}: {named:?}");
        let Some((_, Some(size))) = said[1300].1 else { panic!("seed {seed}: no size") };
        assert!((size + 40.0).abs() < 10.0, "seed {seed}: {size}");
        assert!(said[1600..].iter().all(|(alarm, _)| !alarm), "seed {seed}");
    }
}

/// What T1 repeats while the model says that it moves is no temperature; a T1 that has nowhere to go may repeat itself for as long as it likes.
#[test]
fn a_thermistor_that_repeats_itself_is_stuck_where_it_should_move() {
    let (monitor, said) = run(1, 1.0, 0.0, 0.0);
    assert!(said.iter().all(|(alarm, _)| !alarm));
    for (power, stuck) in [(60.0, true), (30.0, false)] {
        let mut monitor = monitor.clone();
        monitor.resume();
        let (mut plant, mut read, mut named) = (Plant::new(9), 43.6, None);
        for k in 0..2000 {
            // The rig is at rest; then T1 repeats itself, and the power may change.
            let power = if k < 1500 { 30.0 } else { power };
            let beside = Some(30.0);
            if k < 1500 {
                read = plant.step(30.0, 30.0);
            }
            let t = [None, Some(read), None];
            let observed = Observed { t, power: Some(power), beside, ..Observed::default() };
            let (_, report) = monitor.step(&observed);
            let finding = report.likelihood.finding.filter(|f| f.class == FaultClass::Stuck(Channel::T1));
            named = named.or(finding.filter(|_| k >= 1500).map(|_| k));
        }
        assert_eq!(named.is_some_and(|k| k < 1600), stuck, "{named:?}");
    }
}

#[test]
fn another_recording_begins_where_its_first_samples_say() {
    let (mut monitor, _) = run(1, 1.0, 0.0, 0.0);
    monitor.resume();
    let (mut plant, mut read) = (Plant::new(9), 43.0);
    for k in 0..1000 {
        let observed = Observed {
            // The room is colder by 3 degC than it was.
            t: [None, Some(read - 3.0), None],
            power: Some(30.0),
            beside: Some(30.0),
            ..Observed::default()
        };
        let (_, report) = monitor.step(&observed);
        assert!(!report.likelihood.alarm, "sample {k}");
        read = plant.step(30.0, 30.0);
    }
}

/// Samples without a number, and a power that is none, are gaps: nothing panics, and nothing is claimed of them.
#[test]
fn gaps_and_wild_numbers_are_survived() {
    let (mut monitor, _) = run(1, 1.0, 0.0, 0.0);
    for k in 0..3000 {
        let wild = [f32::NAN, f32::INFINITY, 1e30, -1e30][k % 4];
        let t1 = if k % 3 == 0 { None } else { Some(wild) };
        let observed =
            Observed { t: [None, t1, None], power: Some(wild), beside: Some(wild), ..Observed::default() };
        let (seen, report) = monitor.step(&observed);
        assert!(seen.sample.t1.celsius.0.is_finite() && (0.0..=100.0).contains(&seen.power.0));
        assert!(report.likelihood.finding.and_then(|f| f.magnitude).is_none_or(|m| m.value.is_finite()));
    }
}

/// The inverse of no air has no end, and must not come into what is remembered.
#[test]
fn a_fan_that_stands_still_leaves_what_was_learnt() {
    let (mut monitor, _) = run(1, 1.0, 0.0, 0.0);
    for k in 0..1000 {
        let fan = Some(if k < 500 { 0.0 } else { 100.0 });
        let t = [None, Some(40.0 + 0.1 * (k % 3) as f32), None];
        let observed = Observed { t, power: Some(30.0), beside: Some(30.0), fan, ..Observed::default() };
        let (_, report) = monitor.step(&observed);
        assert_eq!(
            (report.likelihood.readiness, report.likelihood.restarts),
            (Readiness::Armed, 0),
            "sample {k}"
        );
        assert!(report.likelihood.expected.into_iter().flatten().all(f32::is_finite), "sample {k}");
    }
}
