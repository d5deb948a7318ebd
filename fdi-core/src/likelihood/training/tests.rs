extern crate std;

use std::vec::Vec;

use super::super::reference::{Random, Rig};
use super::*;
use crate::likelihood::Tuning;

/// A rig, excited as while it is learnt, and how it is trained.
struct Plant {
    p: Parameters,
    rig: Rig,
    random: Random,
    /// Power about which it is excited, by how much, %, and ticks a bit.
    level: f32,
    bit: f32,
    length: usize,
    /// Coloured noise of both residuals, degC, and the standard deviation of what drives it.
    noise: [f64; 2],
    sigma: f64,
    /// Share of the samples that are missing.
    missing: f64,
    /// Answer time, ticks, and gain as they are thought to be.
    answer: f32,
    usual: f32,
    ticks: usize,
    power: f32,
}

impl Plant {
    fn new(p: Parameters, level: f32, seed: u64) -> Self {
        let length = (p.residence() / 6.0).max(2.0) as usize;
        let answer = p.get(Parameter::Delay1)
            + p.get(Parameter::Delay2)
            + 4.0
                * [Parameter::Heater, Parameter::Lag1].map(|lag| libm::expf(p.get(lag))).iter().sum::<f32>();
        Self {
            rig: Rig::new(&p, 0.0),
            random: Random::new(seed),
            level,
            bit: 5.0,
            length,
            noise: [0.0; 2],
            sigma: 0.03,
            missing: 0.0,
            answer,
            usual: libm::expf(p.get(Parameter::Gain)),
            ticks: 0,
            power: 0.0,
            p,
        }
    }

    /// About the reference rig.
    fn reference(seed: u64) -> Self {
        let [gain, heater, lag1, lag2, wall] = [0.3, 4.1, 0.45, 3.6, 270.0].map(libm::logf);
        let p = [gain, heater, 0.9, lag1, 0.03, 0.92, 0.9, lag2, 0.01, wall, 0.4, -0.3, 0.0];
        Self::new(Parameters(p), 40.0, seed)
    }

    /// One of those that heaters are: time constants of 2 to 60 ticks, dead times of 0 to 35, the most of them before T1, gains of 0.05
    /// to 3 degC per %. How fast and strong it is is known within a third.
    fn drawn(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut ln = |low: f64, high: f64| random.between(low.ln(), high.ln());
        let (gain, heater) = (ln(0.05, 3.0), ln(2.0, 60.0));
        let (lag1, lag2) = (heater + ln(0.05, 0.25), heater + ln(0.3, 1.0));
        let wrong = [ln(0.75, 1.33), ln(0.75, 1.33)].map(|ln| ln.exp() as f32);
        let (dead, part, reaches) =
            (random.between(0.0, 35.0), random.between(0.6, 1.0), random.between(0.8, 1.0));
        let wall = [random.between(0.0, 0.1), random.between(0.0, 0.05), heater + random.between(1.8, 3.2)];
        let offsets = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let ([s1, s2, tw], [c1, c2]) = (wall, offsets);
        let p =
            [gain, heater, part * dead, lag1, s1, reaches, (1.0 - part) * dead, lag2, s2, tw, c1, c2, 0.0];
        // A rise of 15 degC, as far as power goes.
        let level = (15.0 / gain.exp()).clamp(10.0, 60.0);
        let mut plant = Self::new(Parameters(p.map(|p| p as f32)), level as f32, seed + 1000);
        plant.answer *= wrong[0];
        plant.usual *= wrong[1];
        plant
    }

    /// Ticks until it has settled, and both parts of training: in proportion to how slowly it answers.
    fn lengths(&self) -> (usize, Trainer) {
        let fit = (50.0 * self.p.residence()).max(980.0);
        let trainer =
            Trainer::new(Default::default(), fit as u32, (0.65 * fit) as u32, self.answer, self.usual)
                .unwrap();
        (((15.0 * self.p.residence()) as usize).max(400), trainer)
    }

    /// One tick: what T1 and T2 read, and the power from now on.
    fn tick(&mut self, resting: bool) -> ([Option<f32>; 2], f32) {
        let y = self.rig.tick(f64::from(self.power), 1.0);
        for noise in &mut self.noise {
            *noise = 0.6 * *noise + self.sigma * self.random.gaussian();
        }
        if self.ticks.is_multiple_of(self.length) {
            self.bit = if self.random.uniform() > 0.5 { self.bit.abs() } else { -self.bit.abs() };
        }
        self.ticks += 1;
        self.power = if resting { 0.0 } else { self.level + self.bit };
        let read = |m: usize| {
            let here = self.random.uniform() >= self.missing;
            here.then_some((y[m] + self.noise[m]) as f32)
        };
        ([0, 1].map(read), self.power)
    }

    /// From cold to the end of training, or why not.
    fn train(&mut self) -> Result<Trained, RejectReason> {
        let (settles, trainer) = self.lengths();
        let (mut cold, mut training) = (Cold::default(), trainer.start());
        for _ in 0..50 {
            let (y, _) = self.tick(true);
            cold.step(&Tuning::DEFAULT, y, true);
        }
        for k in 0.. {
            let (y, u) = self.tick(false);
            if let Some(trained) = trainer.step(&mut training, &cold, y, [u, 0.0], k >= settles)? {
                return Ok(trained);
            }
            assert!(k < 100 * settles, "never trained");
        }
        unreachable!("returned above")
    }

    /// Largest difference of the responses to a step to the power at which it was learnt, as shares of T1's final rise.
    fn response_error(&self, trained: &Parameters) -> [f64; 2] {
        let (mut rig, process) = (Rig::new(&self.p, 0.0), Process::new(Default::default(), trained, 1.0));
        let (mut motion, mut worst) = (Motion::default(), [0.0f64; 2]);
        let final_rise = f64::from(self.level) * f64::from(self.p.get(Parameter::Gain)).exp();
        for _ in 0..(10.0 * self.p.residence()) as usize {
            let y = process.step(&mut motion, process.heat(self.level)).y;
            let wanted = rig.tick(f64::from(self.level), 1.0);
            for (m, which) in [Parameter::Offset1, Parameter::Offset2].into_iter().enumerate() {
                let error = f64::from(y[m]) - (wanted[m] - f64::from(self.p.get(which)));
                worst[m] = worst[m].max(error.abs() / final_rise);
            }
        }
        worst
    }
}

/// From priors to the truth, over the whole range of plants: none is refused, and how T1 and T2 answer to the power at which they were learnt
/// is known to 5 % in the median.
#[test]
fn every_heater_is_learnt() {
    let mut errors: Vec<(f64, u64)> = (1..21)
        .map(|seed| {
            let mut plant = Plant::drawn(seed);
            let trained = plant.train().unwrap_or_else(|why| panic!("seed {seed}: {why:?}, {:?}", plant.p));
            (plant.response_error(&trained.parameters).into_iter().fold(0.0, f64::max), seed)
        })
        .collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(
        errors[9].0 < 0.05 && errors[16].0 < 0.12 && errors[19].0 < 0.25,
        "shares of the rise, seeds: {errors:.3?}"
    );
}

/// Near what it was tuned on: gain and times one by one, noise as it is, and no mean left.
#[test]
fn the_reference_rig_is_learnt_well() {
    for seed in 1..6 {
        let mut plant = Plant::reference(seed);
        let trained = plant.train().unwrap();
        let error = plant.response_error(&trained.parameters);
        assert!(error[0] < 0.03 && error[1] < 0.03, "seed {seed}: {error:?}");
        let [p, t] = [&plant.p, &trained.parameters];
        // Sampled at a tick's end, the model's dead times are longer by half a tick for each thermistor.
        assert!((t.residence() - p.residence() - 0.5).abs() < 1.0, "{} {}", t.residence(), p.residence());
        for which in [Parameter::Offset1, Parameter::Offset2] {
            assert!((t.get(which) - p.get(which)).abs() < 0.2, "{which:?} {}", t.get(which));
        }
        assert!((t.get(Parameter::Reaches2) - 0.92).abs() < 0.02);
        assert!(
            trained.whitening.sigma.iter().all(|sigma| (0.027..0.036).contains(sigma)),
            "{:?}",
            trained.whitening
        );
        assert!(trained.mean.iter().all(|mean| mean.abs() < 0.1), "{:?}", trained.mean);
        let rise = 40.0 * 0.3 + 0.4;
        assert!((trained.rise - rise).abs() < 0.3, "{}", trained.rise);
    }
}

/// Every fifth sample of either thermistor is missing: it takes longer, and ends at the same.
/// What bends the model may have been a step of the mains: the bend is no surer than that there is none.
#[test]
fn a_bend_that_was_learnt_may_be_none() {
    let mut plant = Plant::reference(3);
    plant.p.0[Parameter::Curvature as usize] = 0.06;
    let trained = Plant::new(plant.p, 40.0, 3).train().unwrap();
    let bend = trained.parameters.get(Parameter::Curvature);
    assert!(bend > 0.03 && trained.curvature_error >= bend, "{bend} {}", trained.curvature_error);
}

#[test]
fn missing_samples_cost_time_only() {
    for seed in 1..6 {
        let mut plant = Plant::reference(seed);
        plant.missing = 0.2;
        let trained = plant.train().unwrap();
        let error = plant.response_error(&trained.parameters);
        assert!(error[0] < 0.05 && error[1] < 0.05, "seed {seed}: {error:?}");
    }
}

/// A rig that is warm already, as after a relearning, is learnt from where it is.
#[test]
fn a_warm_start_is_learnt() {
    for seed in 1..6 {
        let mut plant = Plant::reference(seed);
        let (settles, trainer) = plant.lengths();
        for _ in 0..settles {
            plant.tick(false);
        }
        let mut training = trainer.start();
        let trained = loop {
            let (y, u) = plant.tick(false);
            match trainer.step(&mut training, &Cold::default(), y, [u, 0.0], true) {
                Ok(None) => {}
                Ok(Some(trained)) => break trained,
                Err(why) => panic!("seed {seed}: {why:?}"),
            }
        };
        let error = plant.response_error(&trained.parameters);
        assert!(error[0] < 0.06 && error[1] < 0.06, "seed {seed}: {error:?}");
    }
}

/// Only ticks that are fit to learn count, and both parts take as many as they are to.
#[test]
fn what_is_not_fit_to_learn_does_not_count() {
    let mut plant = Plant::reference(1);
    let trainer = Trainer::new(Default::default(), 300, 200, plant.answer, plant.usual).unwrap();
    let mut training = trainer.start();
    let (mut counted, mut done) = (0, false);
    for k in 0..3000 {
        let (y, u) = plant.tick(false);
        let fit_to_learn = k > 500 && k % 3 != 0;
        counted += u32::from(fit_to_learn);
        done = trainer.step(&mut training, &Cold::default(), y, [u, 0.0], fit_to_learn).unwrap().is_some();
        if done {
            break;
        }
    }
    assert!(done);
    assert_eq!(counted, 500);
}

/// A rig that does not answer to its power: refused, whatever is read instead, and a training after that starts from the priors.
#[test]
fn what_does_not_answer_is_refused() {
    let trainer = Trainer::new(Default::default(), 400, 300, 20.0, 0.3).unwrap();
    let mut random = Random::new(1);
    for rise in [0.0, 12.0] {
        let mut training = trainer.start();
        let outcome = (0..2000).find_map(|k| {
            let y = [0; 2].map(|_| Some((rise + 0.4 * random.gaussian()) as f32));
            let u = if (k / 2) % 3 == 0 { 35.0 } else { 45.0 };
            trainer.step(&mut training, &Cold::default(), y, [u, 0.0], true).transpose()
        });
        assert_eq!(outcome.expect("an end").err(), Some(RejectReason::PoorFit), "a rise of {rise} degC");
    }
    let fresh = trainer.start();
    assert_eq!(fresh.parameters, Parameters(trainer.prior.map(|(mean, _)| mean)));
}

/// A dead time that the transport does not hold is told, not learnt as a short one.
#[test]
fn too_long_a_dead_time_is_refused_with_its_reason() {
    let mut plant = Plant::reference(1);
    plant.p.set(Parameter::Delay1, 58.0);
    plant.rig = Rig::new(&plant.p, 0.0);
    plant.answer += 58.0;
    assert_eq!(plant.train().err(), Some(RejectReason::DeadTime));
}

/// Readings that may be anything a thermistor can say, and any power: parameters stay numbers within their bounds on every tick.
#[test]
fn wild_samples_leave_numbers() {
    for seed in 1..21 {
        let mut random = Random::new(seed);
        let trainer = Trainer::new(Default::default(), 2000, 1000, 20.0, 0.3).unwrap();
        let (mut training, mut cold) = (trainer.start(), Cold::default());
        for k in 0..4000 {
            let mut reading = || (random.uniform() > 0.1).then_some(random.between(-130.0, 130.0) as f32);
            let y = [reading(), reading()];
            let u = if random.uniform() > 0.5 { 100.0 } else { 0.0 };
            cold.step(&Tuning::DEFAULT, y, k < 10);
            match trainer.step(&mut training, &cold, y, [u, 0.0], k > 500) {
                Ok(None) => {}
                Ok(Some(trained)) => {
                    assert!(trained.whitening.sigma.iter().chain(&trained.mean).all(|x| x.is_finite()));
                    break;
                }
                Err(_) => break,
            }
            assert!(
                training.parameters.0.iter().all(|p| p.is_finite() && p.abs() < 100.0),
                "{:?}",
                training.parameters
            );
            assert!(training.motion.m.iter().all(|m| m.is_finite()));
        }
    }
}

/// What thermistors differ by is read while nothing heats, with how surely; heat, or a trend, spoils it.
#[test]
fn thermistors_are_compared_while_it_is_cold() {
    let mut random = Random::new(1);
    let mut noisy = |level: f32| Some(level + 0.05 * random.gaussian() as f32);
    let mut cold = Cold::default();
    (0..200).for_each(|_| cold.step(&Tuning::DEFAULT, [noisy(0.5), noisy(-0.8)], true));
    let [(c1, sd1), (c2, sd2)] = [cold.offset(&Tuning::DEFAULT, 0), cold.offset(&Tuning::DEFAULT, 1)];
    assert!((c1 - 0.5).abs() < 0.05 && (c2 + 0.8).abs() < 0.05, "{c1} {c2}");
    assert!(sd1 < 0.1 && sd2 < 0.1, "{sd1} {sd2}");
    let known = cold;
    cold.step(&Tuning::DEFAULT, [None, noisy(0.0)], true);
    assert_eq!(
        cold.offset(&Tuning::DEFAULT, 0),
        known.offset(&Tuning::DEFAULT, 0),
        "half a sample says nothing"
    );
    for (y, resting) in [(0.5, false), (8.0, true)] {
        let mut spoilt = known;
        spoilt.step(&Tuning::DEFAULT, [Some(y), Some(y)], resting);
        assert_eq!(spoilt.samples, 0.0);
    }
    let mut cooling = Cold::default();
    (0..100u16)
        .for_each(|k| cooling.step(&Tuning::DEFAULT, [Some(2.5 - 0.02 * f32::from(k)), Some(0.0)], true));
    assert!(cooling.offset(&Tuning::DEFAULT, 0).1 > 0.3, "{:?}", cooling.offset(&Tuning::DEFAULT, 0));
}
