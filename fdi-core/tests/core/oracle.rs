//! The core's numbers against independent f64 computations, with stated tolerances.

use crate::reference::{InformationLeastSquares, PaperPid, TestNoise, beta_equation, mean_and_sigma};
use fdi_core::control::pid::{Pid, PidConfig, PidState};
use fdi_core::diagnosis::baseline::Statistics;
use fdi_core::filter::{LowPass, LowPassState};
use fdi_core::identify::rls::Rls;
use fdi_core::identify::transfer::Transfer;
use fdi_core::identify::{Adaptation, RlsConfig};
use fdi_core::{AdcCode, Celsius, Config, Instrument, RawSample, Seconds};

const TS: f64 = 0.11;

/// Samples of an excited second-order plant: regressors of ARX(3,3,1), about one in size, and outputs.
fn excited(samples: usize, seed: u64) -> Vec<([f32; 6], f32)> {
    let mut noise = TestNoise(seed);
    let (mut y, mut u) = ([0.0f64; 3], [0.0f64; 3]);
    (0..samples)
        .map(|_| {
            let now = 1.2 * y[0] - 0.36 * y[1] + 0.1 * u[0] + 0.06 * u[1] + 0.01 * noise.draw();
            let phi = [-y[0], -y[1], -y[2], u[0], u[1], u[2]].map(|x| x as f32);
            let now = f64::from(now as f32);
            y = [now, y[0], y[1]];
            u = [f64::from((noise.draw() + 1.0) as f32), u[0], u[1]];
            (phi, now as f32)
        })
        .collect()
}

#[test]
fn rls_agrees_with_information_form_in_f64() {
    for (lambda, d_initial) in [(0.95f32, 1e4f32), (0.99, 1e4), (1.0, 1e6)] {
        let config = RlsConfig { adaptation: Adaptation::Forgetting { lambda }, d_initial, d_max: 1e6 };
        let rls = Rls::<6>::new(&config).unwrap();
        let mut state = rls.start();
        let mut oracle = InformationLeastSquares::new(6, f64::from(lambda), 1.0 / f64::from(d_initial));
        for (k, (phi, y)) in excited(3000, 7).into_iter().enumerate() {
            rls.step(&mut state, &phi, y);
            oracle.push(&phi.map(f64::from), f64::from(y));
            if k >= 100 && k % 97 == 0 {
                let (expected, variances) = (oracle.solve(), oracle.variances());
                for i in 0..6 {
                    let (got, wanted) = (f64::from(state.theta[i]), expected[i]);
                    assert!(
                        (got - wanted).abs() < 2e-4,
                        "lambda {lambda}, k {k}, theta {i}: {got}, not {wanted}"
                    );
                    let (got, wanted) = (f64::from(state.variances()[i]), variances[i]);
                    assert!(
                        (got / wanted - 1.0).abs() < 0.01,
                        "lambda {lambda}, k {k}, P {i}: {got}, not {wanted}"
                    );
                }
            }
        }
    }
}

/// The Kalman form against a textbook filter in f64 with the full covariance matrix.
#[test]
fn random_walk_agrees_with_a_kalman_filter_in_f64() {
    let (r1, r2) = (1e-5f32, 0.0064f32);
    let config = RlsConfig { adaptation: Adaptation::RandomWalk { r1, r2 }, d_initial: 100.0, d_max: 1e6 };
    let rls = Rls::<6>::new(&config).unwrap();
    let mut state = rls.start();
    let (mut theta, mut p) = ([0.0f64; 6], [[0.0f64; 6]; 6]);
    for (i, row) in p.iter_mut().enumerate() {
        row[i] = 100.0;
    }
    for (k, (phi, y)) in excited(2000, 3).into_iter().enumerate() {
        rls.step(&mut state, &phi, y);
        let phi = phi.map(f64::from);
        let p_phi: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| p[i][j] * phi[j]).sum());
        let s = f64::from(r2) + (0..6).map(|i| phi[i] * p_phi[i]).sum::<f64>();
        let e = f64::from(y) - (0..6).map(|i| phi[i] * theta[i]).sum::<f64>();
        for i in 0..6 {
            theta[i] += p_phi[i] / s * e;
            for j in 0..6 {
                p[i][j] -= p_phi[i] * p_phi[j] / s;
            }
        }
        for (i, row) in p.iter_mut().enumerate() {
            row[i] += f64::from(r1);
        }
        if k > 50 {
            for i in 0..6 {
                assert!((f64::from(state.theta[i]) - theta[i]).abs() < 1e-3, "k {k}, theta {i}");
                assert!((f64::from(state.variances()[i]) / p[i][i] - 1.0).abs() < 0.02, "k {k}, P {i}");
            }
        }
    }
}

#[test]
fn pid_is_the_papers_at_a_constant_set_point() {
    let pid = Pid::new(&PidConfig::default(), Seconds(TS as f32)).unwrap();
    let mut state = PidState::default();
    let mut oracle = PaperPid::new(2.4, 0.5, 0.075, TS);
    let mut noise = TestNoise(11);
    for k in 0..5000 {
        let swing = if (k / 500) % 2 == 0 { 4.0 } else { 0.5 }; // into both limits, and between them
        let y = 35.0 + swing * (k as f64 / 40.0).sin() + 0.2 * noise.draw();
        let y = f64::from(y as f32);
        let got = f64::from(pid.step(&mut state, Celsius(35.0), Celsius(y as f32)).0);
        let wanted = oracle.step(35.0 - y);
        assert!((got - wanted).abs() < 0.02, "k {k}: {got}, not {wanted}");
    }
}

#[test]
fn low_pass_is_the_sampled_first_order_filter() {
    let filter = LowPass::new(0.6, Seconds(TS as f32));
    let mut state: LowPassState<1> = None;
    filter.step(&mut state, &[0.0]);
    for k in 1..=200 {
        let got = f64::from(filter.step(&mut state, &[1.0])[0]);
        let wanted = 1.0 - (-0.6 * TS * f64::from(k)).exp();
        assert!((got - wanted).abs() < 1e-5, "k {k}: {got}, not {wanted}");
    }
}

#[test]
fn statistics_keep_their_digits_on_a_large_offset() {
    let mut noise = TestNoise(5);
    let x: Vec<f32> = (0..300_000).map(|_| (1000.0 + 0.05 * noise.draw()) as f32).collect();
    let mut statistics = Statistics::<1>::default();
    for &x in &x {
        statistics.push(&[x]);
    }
    let (mean, sigma) = mean_and_sigma(&x.iter().map(|&x| f64::from(x)).collect::<Vec<_>>());
    assert!((f64::from(statistics.mean()[0]) - mean).abs() < 1e-4, "{} not {mean}", statistics.mean()[0]);
    assert!(
        (f64::from(statistics.sigma()[0]) / sigma - 1.0).abs() < 1e-3,
        "{} not {sigma}",
        statistics.sigma()[0]
    );
}

/// The arithmetic of the conversion errs by less than 0.01 degC over 0..100 degC, for other constants too.
#[test]
fn conversion_agrees_with_the_beta_equation() {
    for (r25, beta, pull_up) in
        [(10e3f32, 3950.0f32, 10e3f32), (100e3, 4250.0, 47e3), (2252.0, 3430.0, 4.7e3)]
    {
        let mut config = Config::default();
        config.sensors.t1.r25.0 = r25;
        config.sensors.t1.beta = beta;
        config.sensors.t1.pull_up.0 = pull_up;
        config.plausibility.short_code = AdcCode(1.0);
        config.plausibility.open_code = AdcCode(4094.0);
        let mut worst = 0.0f64;
        for tenth in 41..40_900 {
            let code = tenth as f32 / 10.0;
            let r = f64::from(pull_up) * f64::from(code) / (4095.0 - f64::from(code));
            let wanted = beta_equation(r, f64::from(r25), f64::from(beta));
            if (0.0..=100.0).contains(&wanted) {
                let mut instrument = Instrument::new(&config).unwrap();
                let raw = RawSample {
                    t0: AdcCode(2000.0),
                    t1: AdcCode(code),
                    t2: AdcCode(2000.0),
                    ..RawSample::default()
                };
                let got = f64::from(instrument.control(raw).sample.t1.celsius.0);
                worst = worst.max((got - wanted).abs());
            }
        }
        assert!(worst < 1e-3, "{r25} ohm, beta {beta}: {worst} degC");
    }
}

/// First-order plants with dead time, exactly sampled: what the model says is what the plant is.
#[test]
fn transfer_function_reads_gain_time_constant_and_stability() {
    for (tau, dead) in [(0.5f64, 0.0f64), (0.5, 0.04), (0.9, 0.09), (0.3, 0.1)] {
        let pole = (-TS / tau).exp();
        let split = (-(TS - dead) / tau).exp();
        let (b1, b2) = (0.3 * (1.0 - split), 0.3 * (split - pole));
        let model = Transfer { a: [-pole as f32, 0.0, 0.0], b: [b1 as f32, b2 as f32, 0.0], nk: 1 };
        assert!(model.is_stable());
        assert!((model.static_gain().unwrap() - 0.3).abs() < 1e-5);
        let rise = f64::from(model.rise_time(0.95 * 0.3, 64).unwrap()) * TS;
        assert!((rise - (3.0 * tau + dead)).abs() < 0.02, "tau {tau}, dead {dead}: t95 {rise}");
        let residence = f64::from(model.residence_time().unwrap()) * TS;
        // Half a sample of it belongs to the zero-order hold; the next term of the series is Ts^2 / 12 tau.
        let expected = tau + dead + 0.5 * TS;
        assert!(
            (residence - expected).abs() < TS * TS / (11.0 * tau),
            "tau {tau}, dead {dead}: Tres {residence}"
        );
    }
}

#[test]
fn stability_test_agrees_with_the_poles() {
    let mut noise = TestNoise(9);
    for _ in 0..2000 {
        // Poles: a real one and a pair r e^(+-j phi), inside or outside but not on the circle.
        let real = 1.3 * noise.draw();
        let (radius, angle) = (1.3 * noise.draw().abs(), std::f64::consts::PI * noise.draw().abs());
        if (real.abs() - 1.0).abs() < 0.01 || (radius - 1.0).abs() < 0.01 {
            continue;
        }
        let (c1, c2) = (-2.0 * radius * angle.cos(), radius * radius);
        let a = [c1 - real, c2 - real * c1, -real * c2].map(|x| x as f32);
        let stable = real.abs() < 1.0 && radius < 1.0;
        assert_eq!(
            Transfer { a, b: [1.0], nk: 1 }.is_stable(),
            stable,
            "real {real}, radius {radius}, angle {angle}"
        );
    }
}

/// Gains may change while it runs: the output goes on from where it was.
#[test]
fn new_gains_and_set_points_do_not_bump() {
    let ts = Seconds(TS as f32);
    let slow = Pid::new(&PidConfig::default(), ts).unwrap();
    let fast = Pid::new(&PidConfig { kp: 8.0, ..PidConfig::default() }, ts).unwrap();
    let mut state = PidState::default();
    let mut output = 0.0;
    for _ in 0..60 {
        output = slow.step(&mut state, Celsius(35.0), Celsius(34.0)).0;
    }
    let after = fast.step(&mut state, Celsius(34.0), Celsius(34.0)).0;
    assert!((after - output).abs() < 1e-4, "gains: from {output} to {after}");
    let after = slow.step(&mut state, Celsius(35.0), Celsius(34.0)).0;
    let integral = 2.4 * TS as f32 / 0.5;
    assert!(
        (after - output - integral).abs() < 1e-3,
        "set-point: from {output} to {after}, integral part {integral}"
    );
}
