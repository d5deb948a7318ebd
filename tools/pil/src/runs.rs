//! The runs whose every output bit must be the same on the target and on the host.

use core::fmt::{self, Write};

use fdi_core::control::pid::{Pid, PidConfig, PidState};
use fdi_core::filter::{LowPass, LowPassState};
use fdi_core::identify::rls::Rls;
use fdi_core::identify::transfer::Transfer;
use fdi_core::identify::{Adaptation, Bandwidth, RlsConfig};
use fdi_core::{Celsius, Command, Config, Instrument, Percent, Seconds};

use crate::codes::{Generator, sample};
use crate::digest::Digest;
use crate::recording::Recording;

/// Samples between two lines: small enough to find a difference, large enough to read.
const LINE_EVERY: usize = 500;
/// Samples of a run over corner inputs.
const CORNER_SAMPLES: usize = 10_000;

/// Does every run and writes a line with the hash so far for every few hundred samples of it.
///
/// # Errors
/// Those of the writer.
pub fn write_all(paper: &Recording, out: &mut impl Write) -> fmt::Result {
    recorded(paper, out)?;
    any_codes(out)?;
    for (name, config) in configurations() {
        plausible_codes(name, &config, out)?;
    }
    estimators(out)?;
    models(out)?;
    small_parts(out)
}

/// The hash of one run, and the writing of its lines.
struct Log<'a, W: Write> {
    name: [&'static str; 2],
    digest: Digest,
    samples: usize,
    out: &'a mut W,
}

impl<'a, W: Write> Log<'a, W> {
    fn new(name: [&'static str; 2], out: &'a mut W) -> Self {
        Self { name, digest: Digest::default(), samples: 0, out }
    }

    /// Ends a sample.
    fn next(&mut self) -> fmt::Result {
        self.samples += 1;
        if self.samples.is_multiple_of(LINE_EVERY) { self.line() } else { Ok(()) }
    }

    /// Writes what has been hashed so far.
    fn line(&mut self) -> fmt::Result {
        let ([kind, name], samples, hash) = (self.name, self.samples, self.digest.value());
        writeln!(self.out, "{kind}, {name}, {samples} samples: {hash:016x}")
    }
}

/// A recorded run through the whole instrument, with the paper's settings.
fn recorded(recording: &Recording, out: &mut impl Write) -> fmt::Result {
    let mut log = Log::new(["recorded codes", "the paper's run"], out);
    let mut instrument = armed(&Config::default());
    for row in recording.rows() {
        let tick = instrument.control(sample(row.codes));
        let report = instrument.diagnose(&tick, tick.drive);
        log.digest.tick(&tick);
        log.digest.report(&report);
        log.next()?;
    }
    log.digest.option(instrument.baseline(), Digest::baseline);
    log.line()
}

/// Settings under which a few hundred ticks reach every part, for each way to adapt and to read the bandwidth.
fn configurations() -> [(&'static str, Config); 3] {
    let mut impatient = Config::default();
    impatient.supervisor.learn_start.0 = 5.0;
    impatient.supervisor.learn_end.0 = 17.0;
    impatient.supervisor.regulation_time.0 = 0.0;
    impatient.supervisor.regulation_band.0 = 100.0;
    let mut walk = impatient.clone();
    walk.identification.adaptation = Adaptation::RandomWalk { r1: 1e-5, r2: 0.0064 };
    let mut residence = impatient.clone();
    residence.identification.bandwidth = Bandwidth::ResidenceTime;
    [("forgetting", impatient), ("random walk", walk), ("residence time", residence)]
}

/// Codes of every bit pattern, and any claim about what was applied; armed again whenever it trips.
fn any_codes(out: &mut impl Write) -> fmt::Result {
    let mut log = Log::new(["any codes", "the paper's settings"], out);
    let mut generator = Generator::new(0x5EED_0001);
    let mut instrument = armed(&Config::default());
    for _ in 0..CORNER_SAMPLES {
        let codes = core::array::from_fn(|_| generator.anything());
        let tick = instrument.control(sample(codes));
        let report = instrument.diagnose(&tick, Percent(generator.anything()));
        log.digest.tick(&tick);
        log.digest.report(&report);
        if !tick.mode.is_heating() {
            let _ = instrument.command(Command::Acknowledge);
            let _ = instrument.command(Command::Arm);
        }
        log.next()?;
    }
    log.line()
}

/// Wild but plausible codes with an awkward one now and then, so that the diagnosis runs and does not only reject.
fn plausible_codes(name: &'static str, config: &Config, out: &mut impl Write) -> fmt::Result {
    let mut log = Log::new(["plausible codes", name], out);
    let mut generator = Generator::new(0x5EED_0002);
    let mut instrument = armed(config);
    for _ in 0..CORNER_SAMPLES {
        let t1 = generator.uniform(1560.0, 1680.0);
        let t2 = if generator.bits().is_multiple_of(64) {
            generator.awkward()
        } else {
            t1 + generator.uniform(0.0, 90.0)
        };
        let tick = instrument.control(sample([generator.uniform(2150.0, 2170.0), t1, t2]));
        let report = instrument.diagnose(&tick, tick.drive);
        log.digest.tick(&tick);
        log.digest.report(&report);
        log.next()?;
    }
    log.digest.option(instrument.baseline(), Digest::baseline);
    log.line()
}

/// The estimator alone, behind no gate: whatever comes in.
fn estimators(out: &mut impl Write) -> fmt::Result {
    let adaptations = [
        ("forgetting", Adaptation::Forgetting { lambda: 0.95 }),
        ("random walk", Adaptation::RandomWalk { r1: 1e-5, r2: 0.0064 }),
    ];
    for (name, adaptation) in adaptations {
        let mut log = Log::new(["estimator", name], out);
        let mut generator = Generator::new(0x5EED_0003);
        let rls = Rls::<6>::new(&RlsConfig { adaptation, d_initial: 1e4, d_max: 1e5 }).expect("valid");
        let mut state = rls.start();
        for k in 0..CORNER_SAMPLES {
            // Mostly sound samples, so that it has something to lose.
            let sound = k % 16 != 0;
            let mut number = || if sound { generator.uniform(-1.5, 1.5) } else { generator.anything() };
            let phi = core::array::from_fn(|_| number());
            let update = rls.step(&mut state, &phi, number());
            log.digest.numbers(&[update.prediction, update.innovation]);
            log.digest.word(u32::from(update.diverged));
            log.digest.numbers(&state.theta);
            log.digest.numbers(&state.variances());
            log.digest.word(state.resets);
            log.next()?;
        }
        log.line()?;
    }
    Ok(())
}

/// What is read off a model, for any coefficients.
fn models(out: &mut impl Write) -> fmt::Result {
    let mut log = Log::new(["models", "any coefficients"], out);
    let mut generator = Generator::new(0x5EED_0004);
    for k in 0..CORNER_SAMPLES {
        let sound = k % 4 != 0;
        let mut number = || if sound { generator.uniform(-1.0, 1.0) } else { generator.anything() };
        let a = core::array::from_fn(|_| number());
        let b = core::array::from_fn(|_| 0.1 * number());
        let model = Transfer::<3, 3> { a, b, nk: 1 };
        log.digest.word(u32::from(model.is_stable()));
        let gain = model.static_gain();
        for feature in [gain, model.residence_time(), model.rise_time(0.95 * gain.unwrap_or(1.0), 64)] {
            log.digest.option(feature, Digest::number);
        }
        log.next()?;
    }
    log.line()
}

/// PID, low-pass and tick counts, behind no gate.
fn small_parts(out: &mut impl Write) -> fmt::Result {
    let mut log = Log::new(["small parts", "any input"], out);
    let mut generator = Generator::new(0x5EED_0005);
    let sample_time = Seconds(0.11);
    let pid = Pid::new(&PidConfig::default(), sample_time).expect("valid");
    let low_pass = LowPass::new(0.6, sample_time);
    let (mut pid_state, mut filter_state): (PidState, LowPassState<2>) = Default::default();
    for _ in 0..CORNER_SAMPLES {
        let y = Celsius(generator.anything());
        let output = pid.step(&mut pid_state, Celsius(generator.uniform(0.0, 100.0)), y);
        log.digest.number(pid.saturate(output, Percent(generator.anything())).0);
        log.digest.numbers(&low_pass.step(&mut filter_state, &[y.0, generator.awkward()]));
        log.digest.word(Seconds(generator.anything()).ticks(sample_time));
        if generator.bits().is_multiple_of(8) {
            (pid_state, filter_state) = Default::default();
        }
        log.next()?;
    }
    log.line()
}

fn armed(config: &Config) -> Instrument {
    let mut instrument = Instrument::new(config).expect("valid");
    instrument.command(Command::Arm).expect("a new instrument is off");
    instrument
}
