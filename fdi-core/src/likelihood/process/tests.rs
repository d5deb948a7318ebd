use super::super::reference::{Random, Rig};
use super::*;

/// A rig whose lags are long against a tick, so that the steps of the model cost little.
fn slow() -> Parameters {
    let [gain, heater, lag1, lag2, wall] = [0.3, 30.0, 8.0, 20.0, 300.0].map(libm::logf);
    Parameters([gain, heater, 9.3, lag1, 0.08, 0.9, 6.6, lag2, 0.05, wall, 0.4, -0.7, 0.02])
}

fn steady_at(p: &Parameters, flow: f32, power: f32) -> [f32; 2] {
    let process = Process::new(Default::default(), p, flow);
    let mut motion = Motion::default();
    (0..6000).map(|_| process.step(&mut motion, process.heat(power)).y).last().unwrap()
}

/// The model against its differential equations, integrated in steps of a fiftieth of a tick, for three air flows and a power that jumps.
#[test]
fn the_model_follows_its_differential_equations() {
    let p = slow();
    for flow in [1.0f32, 0.7, 1.4] {
        let (process, mut motion) = (Process::new(Default::default(), &p, flow), Motion::default());
        let (mut rig, mut random) = (Rig::new(&p, 0.5), Random::new(1));
        let (mut power, mut worst, mut swing) = (40.0f32, [0.0f64; 2], [0.0f64; 2]);
        for k in 0..1500 {
            if k % 37 == 0 {
                power = if random.uniform() > 0.5 { 60.0 } else { 20.0 };
            }
            let rises = process.step(&mut motion, process.heat(power)).y;
            let wanted = rig.tick(f64::from(power), f64::from(flow));
            for (m, offset) in [Parameter::Offset1, Parameter::Offset2].into_iter().enumerate() {
                let error = (f64::from(rises[m] + p.get(offset)) - wanted[m]).abs();
                worst[m] = worst[m].max(error);
                swing[m] = swing[m].max(wanted[m].abs());
            }
        }
        for m in 0..2 {
            assert!(worst[m] < 0.004 * swing[m], "flow {flow}, T{}: {} of {}", m + 1, worst[m], swing[m]);
        }
    }
}

/// Less air is warmer by its inverse, and loses more on the way to T2; the power bends the gain.
#[test]
fn at_rest_the_laws_are_those_of_the_heat_balance() {
    let p = slow();
    for (flow, power) in [(1.0f32, 30.0f32), (0.5, 30.0), (2.0, 50.0), (1.3, 10.0)] {
        let heat = power * (1.0 + 0.02 * (power - 30.0) / 20.0);
        let y1 = 0.3 * heat / flow;
        let wanted = [y1, y1 * (1.0 - 0.1 / flow)];
        let y = steady_at(&p, flow, power);
        for m in 0..2 {
            assert!((y[m] / wanted[m] - 1.0).abs() < 1e-4, "flow {flow}: {y:?}, not {wanted:?}");
        }
    }
    assert_eq!(Motion::steady(40.0).air.at(Delay::new(13.7)).0, 40.0);
    let (process, mut motion) = (Process::new(Default::default(), &p, 1.0), Motion::steady(30.0));
    let y = process.step(&mut motion, 30.0).y;
    assert!((y[0] - 9.0).abs() < 1e-4 && (y[1] - 8.1).abs() < 1e-4, "{y:?}");
}

/// The wall's answer is what is lost by all of it being the wall's, and none at rest.
#[test]
fn the_wall_is_slow_and_comes_to_nothing() {
    let p = slow();
    let (process, mut motion) = (Process::new(Default::default(), &p, 1.0), Motion::default());
    let walls: [[f32; 2]; 6000] = core::array::from_fn(|_| process.step(&mut motion, 30.0).wall);
    assert!(walls[200][0] < -3.0 && walls[200][1] < -2.0, "{:?}", walls[200]);
    assert!(walls[5999].iter().all(|wall| wall.abs() < 1e-3), "{:?}", walls[5999]);
}

/// Between ticks the air's past is a straight line; no delay, however wild, reads beside it.
#[test]
fn the_transport_looks_back_between_ticks() {
    let mut air = Transport::default();
    (0..1000u16).for_each(|k| air.push(f32::from(k)));
    assert_eq!(air.at(Delay::new(0.0)), (999.0, -1.0));
    assert_eq!(air.at(Delay::new(7.25)), (991.75, -1.0));
    assert_eq!(air.at(Delay::new(LONGEST)).0, 999.0 - LONGEST);
    for (wild, wanted) in
        [(-3.0, 999.0), (1e9, 999.0 - LONGEST), (f32::INFINITY, 999.0 - LONGEST), (f32::NAN, 999.0)]
    {
        assert_eq!(air.at(Delay::new(wild)).0, wanted, "{wild}");
    }
}

/// What is pushed again after going back replaces what was there.
#[test]
fn the_transport_goes_back() {
    let mut air = Transport::default();
    (0..200u16).for_each(|k| air.push(f32::from(k)));
    let mut then = air;
    then.back(9);
    assert_eq!(then.at(Delay::new(0.0)).0, 190.0);
    assert_eq!(then.at(Delay::new(20.5)).0, 169.5);
    (191..200u16).for_each(|k| then.push(f32::from(k)));
    for delay in [0.0, 3.3, 17.0, LONGEST] {
        assert_eq!(then.at(Delay::new(delay)), air.at(Delay::new(delay)));
    }
}

/// Times are those of the plant: an air flow moves three quarters of T1's dead time, all of the transport, and the heater by its film.
#[test]
fn times_go_with_the_air_flow() {
    let p = slow();
    let [nominal, twice] = [1.0, 2.0].map(|flow| Process::new(Default::default(), &p, flow));
    let [[first, _], [sooner, later]] =
        [nominal, twice].map(|process| process.delay.map(|delay| delay.whole as f32 + delay.part));
    assert!((sooner / first - 0.625).abs() < 1e-6);
    assert!((later - sooner - 3.3).abs() < 1e-5);
    let time = |share: f32| -1.0 / libm::logf(1.0 - share);
    assert!((time(nominal.heater) - 30.0).abs() < 0.01);
    assert!((time(twice.heater) - 30.0 / libm::powf(2.0, 0.8)).abs() < 0.01);
    assert_eq!((twice.lag, twice.wall), (nominal.lag, nominal.wall));
    assert!((p.residence() - (30.0 + 20.0 + 9.3 + 6.6)).abs() < 1e-3);
    assert_eq!(share(0.0), 1.0);
}
