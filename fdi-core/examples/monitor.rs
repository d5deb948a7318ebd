//! Diagnosis of a heater that something else controls: `cargo run -p fdi-core --example monitor`.
//!
//! The heater of this example answers with a lag of 8 s. It is sampled each second; for ten minutes all is well, and then T2 comes to
//! read 3 degC too much.

use fdi_core::{Config, Inputs, Monitor, Observed, Seconds, Units};

fn main() -> Result<(), fdi_core::ConfigError> {
    // What is known of the heater beforehand: how often it is sampled, and about how long it takes to answer.
    let mut config = Config { sample_time: Seconds(1.0), ..Config::default() };
    config.identification.answer_time = Seconds(30.0);
    (config.likelihood.fit_time, config.likelihood.check_time) = (Seconds(400.0), Seconds(200.0));

    let mut monitor = Monitor::new(&config, Inputs::ALL, Units::default())?;
    let (mut rise, mut said) = (0.0, None);
    for second in 0..900_u32 {
        let power = if (second / 20) % 2 == 0 { 30.0 } else { 45.0 };
        rise += (0.5 * power - rise) / 8.0;
        let noise = [0.02, -0.03, 0.01, 0.03, -0.02, -0.01, 0.0][second as usize % 7];
        let error = if second < 700 { 0.0 } else { 3.0 };
        let (_, report) = monitor.step(&Observed {
            t: [Some(21.0), Some(21.0 + rise + noise), Some(21.0 + 0.9 * rise - noise + error)],
            power: Some(power),
            learn: second < 650, // somebody knows that all is well until then
            ..Observed::default()
        });
        let now = (report.likelihood.readiness, report.likelihood.finding.map(|finding| finding.class));
        if said != Some(now) {
            println!("{second:>4} s  {:?}: {:?}", now.0, report.likelihood.finding);
            said = Some(now);
        }
    }
    Ok(())
}
