//! The rig in motion: heater, air, sensors and surroundings, from tick to tick.

use crate::air::{AirStream, HeaterHistory};
use crate::config::{Disturbance, RigConfig};
use crate::element::{Element, World};
use crate::fan::Fan;
use crate::fault::{Conditions, Fault};
use crate::heater::Heater;
use crate::mains::Mains;
use crate::meter::Meter;
use crate::noise::{Noise, OrnsteinUhlenbeck, Turbulence};
use crate::pickup::Pickup;
use crate::room::Room;
use crate::sensor::{Digitizer, Wiring};
use crate::thermistor::Thermistors;
use crate::wall::Wall;

/// Steps of a stretch within which flow or power change by themselves.
const RESTLESS_STEPS: u32 = 4;
/// How far the room drifts from where it began, degC: then it drifts back, as a room that is heated and aired does.
const FARTHEST_DRIFT: f64 = 2.0;
/// At full power and nominal flow the element is so many times as much warmer than the air behind it as that is than the room: our choice, a wire that glows
/// without air and does not with it.
pub const ELEMENT_OVER_AIR: f64 = 4.0;

/// How far the room has drifted by the time `t` in s, degC, with `slope` in degC/s: a triangle wave.
fn drift(slope: f64, t: f64) -> f64 {
    let way = slope * t;
    if way.abs() <= FARTHEST_DRIFT {
        return way;
    }
    let place = (way + FARTHEST_DRIFT).rem_euclid(4.0 * FARTHEST_DRIFT);
    FARTHEST_DRIFT - (place - 2.0 * FARTHEST_DRIFT).abs()
}

/// The share of the rise that is left after a loss that goes against the flow: 1 - loss, as measured; where so little air flows that most is lost, the
/// exponential that continues it.
fn kept(loss: f64) -> f64 {
    const MOST: f64 = 0.75;
    if loss <= MOST { 1.0 - loss } else { (1.0 - MOST) * libm::exp((MOST - loss) / (1.0 - MOST)) }
}

/// The rig in motion.
pub struct Rig {
    config: RigConfig,
    sample_time: f64,
    tick: u64,
    faults: Vec<Fault>,
    noise: Noise,
    ambient_disturbance: OrnsteinUhlenbeck,
    ambient_ramp: f64,
    flow_disturbance: OrnsteinUhlenbeck,
    mains_disturbance: OrnsteinUhlenbeck,
    mains: Option<Mains>,
    meter: Option<Meter>,
    fan: Fan,
    /// Power of the heater's wire now, %.
    power: f64,
    /// What its user has set it to, relative.
    fan_level: f64,
    room: Option<Room>,
    pickup: Option<Pickup>,
    thermistors: Thermistors,
    source: Heater,
    heater: HeaterHistory,
    turbulence: [Turbulence; 2],
    /// The walls before the three sensors.
    walls: [Option<Wall>; 3],
    /// The three sensor elements.
    elements: [Element; 3],
    /// What they would be if nothing had ever happened to a sensor.
    unharmed: [Element; 3],
    digitizer: Digitizer,
    /// The last codes of the three inputs.
    codes: [f64; 3],
}

impl Rig {
    /// A cold rig: everything at ambient temperature.
    pub fn new(
        config: &RigConfig,
        disturbance: Disturbance,
        sample_time: f64,
        seed: u64,
        faults: &[Fault],
    ) -> Self {
        let mut noise = Noise::new(seed);
        let (ambient_sd, ramp) =
            if disturbance == Disturbance::None { (0.0, 0.0) } else { (0.05, noise.uniform(-1.0, 1.0)) };
        let lively = if disturbance == Disturbance::Lively { 0.004 } else { 0.0 };
        let ambient_disturbance = OrnsteinUhlenbeck::new(ambient_sd, 600.0, sample_time, &mut noise);
        let flow_disturbance = OrnsteinUhlenbeck::new(lively, 60.0, sample_time, &mut noise);
        let mains_disturbance = OrnsteinUhlenbeck::new(lively, 30.0, sample_time, &mut noise);
        let room = Room::new(&config.room, sample_time, seed);
        let ambient = config.ambient + room.as_ref().map_or(0.0, |room| room.warmer(0.0));
        Self {
            sample_time,
            tick: 0,
            faults: faults.to_vec(),
            ambient_disturbance,
            ambient_ramp: ramp / 3600.0,
            flow_disturbance,
            mains_disturbance,
            mains: Mains::new(&config.mains, sample_time, seed),
            meter: Meter::new(config, seed),
            fan: Fan::new(&config.fan, seed),
            power: 0.0,
            fan_level: 1.0,
            room,
            pickup: Pickup::new(&config.pickup, seed),
            thermistors: Thermistors::new(&config.thermistor, config.beta, config.r25_over_pull_up(), seed),
            source: Heater::new(&config.heater),
            heater: HeaterHistory::cold(),
            turbulence: [Turbulence::new(config.turbulence, config.turbulence_time); 2],
            walls: Wall::before_each(&config.wall, ambient),
            elements: [Element::new(ambient); 3],
            unharmed: [Element::new(ambient); 3],
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
        let now = self.now();
        let temperatures = self.elements.map(|element| element.celsius());
        let raised = self.digitizer.raised(temperatures, conditions.common_return);
        self.codes = core::array::from_fn(|i| {
            let white = self.config.white_noise * self.noise.normal();
            let sensor = conditions.wired[i];
            let indicated = self.thermistors.indicated(sensor, self.elements[sensor].celsius() + air[sensor]);
            let celsius = indicated + conditions.offset[sensor] + white;
            let hum = self.pickup.as_ref().map_or(0.0, |pickup| pickup.codes(i, now));
            let wiring = Wiring { shunt: conditions.shunt[sensor], raised };
            self.digitizer.code(i, celsius, wiring, hum, &conditions.reading[i], &mut self.noise)
        });
        self.codes
    }

    /// Code of the heater's supply at the present tick, on the 12-bit scale; 0 where it is not measured.
    pub fn supply(&mut self) -> f64 {
        let sag = Conditions::at(&self.faults, self.now(), self.sample_time).supply;
        let voltage = sag * self.mains.as_ref().map_or(1.0, Mains::voltage);
        self.meter.as_mut().map_or(0.0, |meter| meter.code(voltage))
    }

    /// Sets the fan, relative to its nominal level, from now on.
    pub fn set_fan(&mut self, level: f64) {
        self.fan_level = level.max(0.0);
    }

    /// Drives the heater with `drive` % until the next tick.
    pub fn advance(&mut self, drive: f64) {
        let (start, end) = (self.now(), (self.tick + 1) as f64 * self.sample_time);
        let mut from = start;
        let mut edges: Vec<f64> = Vec::new();
        edges.extend(self.faults.iter().flat_map(|f| f.edges()).filter(|&t| t > start && t < end));
        edges.sort_by(f64::total_cmp);
        edges.dedup(); // a stretch of no length has no mean
        for to in edges.into_iter().chain([end]) {
            let conditions = Conditions::at(&self.faults, 0.5 * (from + to), 0.0);
            let steps = self.steps();
            for step in 0..steps {
                let at = |step: u32| from + (to - from) * f64::from(step) / f64::from(steps);
                self.integrate(
                    at(step),
                    if step + 1 == steps { to } else { at(step + 1) },
                    drive,
                    &conditions,
                );
            }
            from = to;
        }
        self.disturbance();
        self.tick += 1;
        if let Some(room) = &mut self.room {
            room.step(end, drive > 0.0);
        }
    }

    /// In how many steps a stretch is integrated, each with constant flow and power.
    fn steps(&self) -> u32 {
        if self.fan.is_restless() || self.source.is_restless() { RESTLESS_STEPS } else { 1 }
    }

    /// Moves the deterministic part from one time to another under constant conditions.
    fn integrate(&mut self, from: f64, to: f64, drive: f64, now: &Conditions) {
        let flow = self.fan.blow(self.asked_flow(now), (from, to));
        let air = self.air_stream(from, flow, now);
        let driven = self.source.driven(drive);
        let volts = self.mains.as_ref().map_or(1.0, Mains::power);
        let power =
            now.stuck_power.unwrap_or(driven * now.power) * (1.0 + self.mains_disturbance.value()) * volts;
        let power = power * now.supply * now.supply;
        self.power = power;
        let power = self.source.warm(power, air.slowness, to - from);
        let time = self.config.heater_time * air.slowness;
        self.heater.drive(from, to, self.config.gain / air.flow * power, time);
        let world = World { air: &air, heater: &self.heater, thermistors: &self.thermistors };
        let lags = [self.config.t0_lag, self.config.t1_lag, self.config.t2_lag];
        let roughness = self.fan.roughness(air.flow);
        for i in 0..3 {
            let clean = self.thermistors.lag(i, lags[i], air.flow);
            let lag = now.lag[i].unwrap_or(clean);
            let wall = self.walls[i].as_mut().map(|wall| wall.follow(&air, &self.heater, i, (from, to)));
            let follow = |mut element: Element, seen| {
                element.follow(&world, i, (from, to), seen, wall.as_ref());
                element
            };
            let before = self.elements[i];
            self.elements[i] = follow(before, (now.gain[i], lag));
            let unharmed = (now.gain[i], lag) == (1.0, clean) && self.unharmed[i] == before;
            self.unharmed[i] =
                if unharmed { self.elements[i] } else { follow(self.unharmed[i], (1.0, clean)) };
            if i > 0 {
                self.turbulence[i - 1].see_through(roughness, lag, now.gain[i], self.sample_time);
            }
        }
        self.heater.forget_before(from - air.delay[2] - 1.0);
    }

    /// The flow that comes once the fan has followed, without its hunting.
    fn asked_flow(&self, now: &Conditions) -> f64 {
        let flow = self.fan_level * now.flow * (1.0 + self.flow_disturbance.value());
        self.mains.as_ref().map_or(flow, |mains| flow * mains.flow())
    }

    /// The air as it is at a time, at the flow that the fan gives.
    fn air_stream(&self, t: f64, flow: f64, now: &Conditions) -> AirStream {
        let c = &self.config;
        let room = self.room.as_ref().map_or(0.0, |room| room.warmer(t));
        let (flow, arrives) = self.fan.with_free_convection(flow);
        AirStream {
            flow,
            slowness: if flow == 1.0 { 1.0 } else { libm::pow(flow, -c.flow_exponent) },
            ambient: c.ambient
                + drift(self.ambient_ramp, t)
                + self.ambient_disturbance.value()
                + now.ambient
                + room,
            delay: [0.0, c.dead_time / flow, (c.dead_time + c.t2_delay) / flow],
            share: [0.0, arrives, arrives * kept(c.heat_loss / flow)],
        }
    }

    /// What a contact in the stream of air sees: the flow now, as a share of the nominal one.
    pub fn flow(&self) -> f64 {
        self.fan.flow(self.asked_flow(&Conditions::at(&self.faults, self.now(), 0.0)), self.now())
    }

    /// For scores: the true temperature of the air at T1 and at T2 now, without turbulence, degC.
    pub fn air(&self) -> [f64; 2] {
        let now = self.now();
        let conditions = Conditions::at(&self.faults, now, 0.0);
        let air = self.air_stream(now, self.flow(), &conditions);
        [1, 2].map(|i| {
            let rise = air.share[i] * self.heater.rise_at(now - air.delay[i]);
            air.ambient + self.walls[i].as_ref().map_or(rise, |wall| wall.mix(&air, rise))
        })
    }

    /// For scores: the true temperature of the heater's element once it has followed its power, degC. Radiation is left out: it limits only what is far too hot.
    pub fn element(&self) -> f64 {
        let conditions = Conditions::at(&self.faults, self.now(), 0.0);
        let air = self.air_stream(self.now(), self.flow(), &conditions);
        let rise = self.config.gain * self.power;
        air.ambient + rise / air.flow + ELEMENT_OVER_AIR * rise * air.slowness
    }

    /// For scores: how far the input that is worst off reads from what it would read at this power without any fault of
    /// a sensor, degC, by the last codes. Missing ones are passed over; turbulence and noise are in it.
    pub fn sensor_error(&self) -> f64 {
        let expected = |i: usize| self.thermistors.indicated(i, self.unharmed[i].celsius());
        let readings = self.codes.iter().enumerate().filter(|(_, code)| !code.is_nan());
        let errors = readings.map(|(i, &code)| (self.digitizer.celsius(code) - expected(i)).abs());
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
    fn disturbance(&mut self) {
        self.ambient_disturbance.step(&mut self.noise);
        self.flow_disturbance.step(&mut self.noise);
        self.mains_disturbance.step(&mut self.noise);
        if let Some(mains) = &mut self.mains {
            mains.step();
        }
        for turbulence in &mut self.turbulence {
            turbulence.step(&mut self.noise);
        }
    }
}
