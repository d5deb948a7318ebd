//! The simulated PT-326: physics in f64 that knows nothing of the instrument. It takes a drive and gives ADC codes.
//!
//! Between two ticks the drive, the air flow, the mains and the room are constant, so every linear part is integrated
//! exactly: the heater node, its dead times (a record of past exponentials), the lags of the sensors, and the turbulence
//! as seen through them. A fault that begins or ends within a tick splits the tick.

mod air;
mod noise;
mod sensor;

use serde::{Deserialize, Serialize};

use crate::fault::{Conditions, Fault};
use air::{AirStream, HeaterHistory};
use noise::{Noise, OrnsteinUhlenbeck, Turbulence};
use sensor::Digitizer;

/// Constants of the rig. Defaults: the reference rig (paper where it prints a value, else our choice; docs/theory.md).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RigConfig {
    /// Room temperature, degC.
    pub room: f64,
    /// Static gain K at T1, degC per % of heater power.
    pub gain: f64,
    /// Time constant of the heater node, s.
    pub heater_time: f64,
    /// Dead time from heater to T1, s.
    pub dead_time: f64,
    /// Lag of thermistor T1, s.
    pub t1_lag: f64,
    /// Lag of thermistor T2, s.
    pub t2_lag: f64,
    /// Transport from T1 to T2, s.
    pub t2_delay: f64,
    /// Share of the rise lost between T1 and T2.
    pub heat_loss: f64,
    /// Lag of the room thermistor, s.
    pub t0_lag: f64,
    /// Time constants go with air flow to the power of minus this.
    pub flow_exponent: f64,
    /// Standard deviation of the air's turbulence at T1 and at T2, degC.
    pub turbulence: f64,
    /// Correlation time of the turbulence, s.
    pub turbulence_time: f64,
    /// Standard deviation of the white measurement noise, degC.
    pub white_noise: f64,
    /// Bits of the ADC; codes are given on the 12-bit scale whatever their number.
    pub adc_bits: u32,
    /// Thermistors: resistance at 25 degC, ohm.
    pub r25: f64,
    /// Thermistors: beta, K.
    pub beta: f64,
    /// Pull-up from VDDA to the ADC input, ohm.
    pub pull_up: f64,
}

impl Default for RigConfig {
    fn default() -> Self {
        Self {
            room: 22.5,
            gain: 0.3,
            heater_time: 0.45,
            dead_time: 0.1,
            t1_lag: 0.05,
            t2_lag: 0.40,
            t2_delay: 0.1,
            heat_loss: 0.08,
            t0_lag: 0.40,
            flow_exponent: 0.8,
            turbulence: 0.12,
            turbulence_time: 0.15,
            white_noise: 0.03,
            adc_bits: 12,
            r25: 10e3,
            beta: 3950.0,
            pull_up: 10e3,
        }
    }
}

impl RigConfig {
    /// Checks every constant.
    ///
    /// # Errors
    /// The name of the first that is out of bounds, its value and the bounds.
    pub fn validate(&self) -> anyhow::Result<()> {
        let check = |name: &str, value: f64, min: f64, max: f64| {
            anyhow::ensure!(value >= min && value <= max, "rig.{name} is {value}, expected {min} to {max}");
            Ok(())
        };
        check("room", self.room, -20.0, 60.0)?;
        check("gain", self.gain, 0.001, 100.0)?;
        check("heater_time", self.heater_time, 0.01, 1000.0)?;
        check("dead_time", self.dead_time, 0.0, 5.0)?;
        check("t1_lag", self.t1_lag, 0.001, 100.0)?;
        check("t2_lag", self.t2_lag, 0.001, 100.0)?;
        check("t2_delay", self.t2_delay, 0.0, 5.0)?;
        check("heat_loss", self.heat_loss, 0.0, 0.9)?;
        check("t0_lag", self.t0_lag, 0.001, 100.0)?;
        check("flow_exponent", self.flow_exponent, 0.0, 3.0)?;
        check("turbulence", self.turbulence, 0.0, 10.0)?;
        check("turbulence_time", self.turbulence_time, 0.001, 100.0)?;
        check("white_noise", self.white_noise, 0.0, 10.0)?;
        check("adc_bits", f64::from(self.adc_bits), 6.0, 24.0)?;
        check("r25", self.r25, 10.0, 10e6)?;
        check("beta", self.beta, 500.0, 10e3)?;
        check("pull_up", self.pull_up, 10.0, 10e6)
    }
}

/// How much the surroundings move during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Wander {
    /// Nothing moves but the turbulence.
    None,
    /// The room drifts by up to 1 degC an hour and wanders by 0.05 degC.
    #[default]
    Calm,
    /// Calm, and air flow and mains power wander by 0.4 %.
    Lively,
}

/// The rig in motion.
pub struct Rig {
    config: RigConfig,
    sample_time: f64,
    tick: u64,
    faults: Vec<Fault>,
    noise: Noise,
    room_wander: OrnsteinUhlenbeck,
    room_ramp: f64,
    flow_wander: OrnsteinUhlenbeck,
    mains_wander: OrnsteinUhlenbeck,
    heater: HeaterHistory,
    turbulence: [Turbulence; 2],
    /// Temperatures of the three sensor elements without turbulence, degC.
    elements: [f64; 3],
    /// What they would be if nothing had ever happened to a sensor.
    unharmed: [f64; 3],
    digitizer: Digitizer,
    /// The last codes of the three inputs.
    codes: [f64; 3],
}

impl Rig {
    /// A cold rig: everything at room temperature.
    pub fn new(config: &RigConfig, wander: Wander, sample_time: f64, seed: u64, faults: &[Fault]) -> Self {
        let mut noise = Noise::new(seed);
        let (room_sd, ramp) =
            if wander == Wander::None { (0.0, 0.0) } else { (0.05, noise.uniform(-1.0, 1.0)) };
        let lively = if wander == Wander::Lively { 0.004 } else { 0.0 };
        let room_wander = OrnsteinUhlenbeck::new(room_sd, 600.0, sample_time, &mut noise);
        let flow_wander = OrnsteinUhlenbeck::new(lively, 60.0, sample_time, &mut noise);
        let mains_wander = OrnsteinUhlenbeck::new(lively, 30.0, sample_time, &mut noise);
        Self {
            sample_time,
            tick: 0,
            faults: faults.to_vec(),
            room_wander,
            room_ramp: ramp / 3600.0,
            flow_wander,
            mains_wander,
            heater: HeaterHistory::cold(),
            turbulence: [Turbulence::new(config.turbulence, config.turbulence_time); 2],
            elements: [config.room; 3],
            unharmed: [config.room; 3],
            digitizer: Digitizer::new(config),
            codes: [f64::NAN; 3],
            config: config.clone(),
            noise,
        }
    }

    /// Time of the present tick, s.
    fn now(&self) -> f64 {
        self.tick as f64 * self.sample_time
    }

    /// Codes of T0, T1, T2 at the present tick, on the 12-bit scale; NaN where a sample went missing.
    pub fn sample(&mut self) -> [f64; 3] {
        let conditions = Conditions::at(&self.faults, self.now(), self.sample_time);
        let air = [0.0, self.turbulence[0].at_sensor(), self.turbulence[1].at_sensor()];
        self.codes = core::array::from_fn(|i| {
            let white = self.config.white_noise * self.noise.normal();
            let sensor = conditions.wired[i];
            let celsius = self.elements[sensor] + air[sensor] + conditions.offset[sensor] + white;
            self.digitizer.code(i, celsius, &conditions.reading[i], &mut self.noise)
        });
        self.codes
    }

    /// Drives the heater with `drive` % until the next tick.
    pub fn advance(&mut self, drive: f64) {
        let (start, end) = (self.now(), (self.tick + 1) as f64 * self.sample_time);
        let mut from = start;
        let mut edges: Vec<f64> = Vec::new();
        edges.extend(self.faults.iter().flat_map(|f| f.edges()).filter(|&t| t > start && t < end));
        edges.sort_by(f64::total_cmp);
        for to in edges.into_iter().chain([end]) {
            let conditions = Conditions::at(&self.faults, 0.5 * (from + to), 0.0);
            self.integrate(from, to, drive, &conditions);
            from = to;
        }
        self.wander();
        self.tick += 1;
    }

    /// Moves the deterministic part from one time to another under constant conditions.
    fn integrate(&mut self, from: f64, to: f64, drive: f64, now: &Conditions) {
        let air = self.air_stream(from, now);
        let power = now.stuck_power.unwrap_or(drive * now.power) * (1.0 + self.mains_wander.value());
        let time = self.config.heater_time * air.slowness;
        self.heater.drive(from, to, self.config.gain / air.flow * power, time);
        let heater = &self.heater;
        let clean = [self.config.t0_lag, self.config.t1_lag, self.config.t2_lag];
        for i in 0..3 {
            let lag = now.lag[i].unwrap_or(clean[i]);
            let before = self.elements[i];
            self.elements[i] = air.through(heater, i, (from, to), (now.gain[i], lag), before);
            let unharmed = (now.gain[i], lag) == (1.0, clean[i]) && self.unharmed[i] == before;
            self.unharmed[i] = if unharmed {
                self.elements[i]
            } else {
                air.through(heater, i, (from, to), (1.0, clean[i]), self.unharmed[i])
            };
            if i > 0 {
                self.turbulence[i - 1].see_through(lag, now.gain[i], self.sample_time);
            }
        }
        self.heater.forget_before(from - air.delay[2] - 1.0);
    }

    /// The air as it flows at a time.
    fn air_stream(&self, t: f64, now: &Conditions) -> AirStream {
        let c = &self.config;
        let flow = now.flow * (1.0 + self.flow_wander.value());
        AirStream {
            flow,
            slowness: if flow == 1.0 { 1.0 } else { libm::pow(flow, -c.flow_exponent) },
            room: c.room + self.room_ramp * t + self.room_wander.value() + now.room,
            delay: [0.0, c.dead_time / flow, (c.dead_time + c.t2_delay) / flow],
            share: [0.0, 1.0, 1.0 - c.heat_loss / flow],
        }
    }

    /// For scores: the true temperature of the air at T1 and at T2 now, without turbulence, degC.
    pub fn air(&self) -> [f64; 2] {
        let now = self.now();
        let air = self.air_stream(now, &Conditions::at(&self.faults, now, 0.0));
        [1, 2].map(|i| air.room + air.share[i] * self.heater.rise_at(now - air.delay[i]))
    }

    /// For scores: how far the input that is worst off reads from what it would read at this power without any fault of
    /// a sensor, degC, by the last codes. Missing ones are passed over; turbulence and noise are in it.
    pub fn sensor_error(&self) -> f64 {
        let readings = self.codes.iter().zip(&self.unharmed).filter(|(code, _)| !code.is_nan());
        let errors = readings.map(|(&code, unharmed)| (self.digitizer.celsius(code) - unharmed).abs());
        errors.fold(0.0, f64::max)
    }

    /// Lets something more happen; `fault.at` counts from now. The caller has validated it.
    pub fn inject(&mut self, fault: Fault) {
        let at = self.now() + fault.at;
        self.faults.push(Fault { at, ..fault });
    }

    /// Ends all that happens, and forgets what was still to come.
    pub fn clear(&mut self) {
        self.faults.clear();
    }

    /// Moves everything random by one tick.
    fn wander(&mut self) {
        self.room_wander.step(&mut self.noise);
        self.flow_wander.step(&mut self.noise);
        self.mains_wander.step(&mut self.noise);
        for turbulence in &mut self.turbulence {
            turbulence.step(&mut self.noise);
        }
    }
}
