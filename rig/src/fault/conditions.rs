//! What the faults that act at one time make of the rig.

use super::{Fault, Verb};
use crate::noise::Noise;

/// What the converter of a channel says, instead of the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ConverterOutput {
    /// The truth.
    #[default]
    True,
    /// Full scale.
    Open,
    /// Zero.
    Short,
    /// What it said before, with noise.
    Stuck {
        /// Standard deviation of the noise, codes.
        noise: f64,
    },
    /// Nothing, now and then.
    Missing {
        /// Probability for each sample.
        probability: f64,
    },
}

/// All that acts on the rig at one time. Arrays are for T0, T1, T2.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Added to what a sensor reads, degC.
    pub offset: [f64; 3],
    /// Share of the rise that a sensor sees.
    pub gain: [f64; 3],
    /// Time constant that a clogged or detached sensor has, s.
    pub lag: [Option<f64>; 3],
    /// Which sensor lies at each input.
    pub wired: [usize; 3],
    /// What the converter says.
    pub reading: [ConverterOutput; 3],
    /// Resistance across a sensor, ohm.
    pub shunt: [Option<f64>; 3],
    /// Resistance of the return wire that the three thermistors share, ohm.
    pub common_return: f64,
    /// Air flow, relative.
    pub flow: f64,
    /// Heater power, relative to what is asked for.
    pub power: f64,
    /// Voltage of the heater's supply, relative.
    pub supply: f64,
    /// Heater power whatever is asked for, %.
    pub stuck_power: Option<f64>,
    /// Ambient temperature above its usual, degC.
    pub ambient: f64,
}

impl Conditions {
    /// What acts at time `t`; `sample_time` is how long a single sample stands for a spike.
    pub fn at(faults: &[Fault], t: f64, sample_time: f64) -> Self {
        let mut now = Self {
            offset: [0.0; 3],
            gain: [1.0; 3],
            lag: [None; 3],
            wired: [0, 1, 2],
            reading: [ConverterOutput::True; 3],
            shunt: [None; 3],
            common_return: 0.0,
            flow: 1.0,
            power: 1.0,
            supply: 1.0,
            stuck_power: None,
            ambient: 0.0,
        };
        for fault in faults.iter().filter(|f| f.is_active(t)) {
            let i = fault.sensor.map_or(0, |s| s as usize);
            let size = fault.size_at(t);
            match fault.verb {
                Verb::Offset => now.offset[i] += size,
                Verb::Loose if is_apart(fault.at, t) => now.offset[i] += size,
                Verb::Loose => {}
                Verb::Drift => now.offset[i] += size * (t - fault.at) / 60.0,
                Verb::Clog => {
                    now.gain[i] *= size;
                    now.lag[i] = fault.lag.or(now.lag[i]);
                }
                Verb::Detach => {
                    now.gain[i] *= 1.0 - size;
                    now.lag[i] = fault.lag.or(now.lag[i]);
                }
                Verb::Swap => now.wired.swap(i, fault.with.map_or(i, |s| s as usize)),
                Verb::Open => now.reading[i] = ConverterOutput::Open,
                Verb::Short => now.reading[i] = ConverterOutput::Short,
                Verb::Stuck | Verb::Freeze => now.reading[i] = ConverterOutput::Stuck { noise: size },
                Verb::Spike if t - fault.at < sample_time => now.offset[i] += size,
                Verb::Spike => {}
                Verb::Missing => now.reading[i] = ConverterOutput::Missing { probability: size },
                Verb::Shunt => now.shunt[i] = Some(size),
                Verb::Return => now.common_return += size,
                Verb::AirFlow => now.flow *= size,
                Verb::HeaterPower => now.power *= size,
                Verb::SupplyVoltage => now.supply *= size,
                Verb::HeaterStuck => now.stuck_power = Some(size),
                Verb::Ambient => now.ambient += size,
                Verb::AmbientDrift => now.ambient += size * (t - fault.at) / 60.0,
            }
        }
        now
    }
}

/// A contact that is loose keeps as it is for so long, and then is as likely to change as not, s.
const STAYS: f64 = 20.0;

/// Whether a contact that has been loose since `from` is apart at the time `t`, by a draw that only these two decide. It begins apart.
fn is_apart(from: f64, t: f64) -> bool {
    let spell = ((t - from) / STAYS) as u64;
    spell == 0 || Noise::new(from.to_bits() ^ spell).uniform(0.0, 1.0) < 0.5
}

#[cfg(test)]
mod tests {
    use super::super::Sensor;
    use super::*;

    /// It is apart about half of the time, for some 40 s at once, and the same whenever it is asked.
    #[test]
    fn a_loose_contact_opens_and_closes_at_random() {
        let fault = Fault::new(Verb::Loose, Some(Sensor::T1), Some(0.5), 400.0, 20_000.0);
        let apart = |t: f64| Conditions::at(std::slice::from_ref(&fault), t, 0.1).offset[1] == 0.5;
        let seen: Vec<bool> = (0..20_000).map(|i| apart(400.0 + f64::from(i))).collect();
        let share = seen.iter().filter(|apart| **apart).count() as f64 / 20_000.0;
        let changes = seen.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(seen[0] && (0.45..0.55).contains(&share), "{share}");
        assert!((450..550).contains(&changes), "{changes}");
        assert!(!apart(399.0));
    }
}
