//! What needs no bank: rises, contradictions, ambient, sensors.

use super::tuning;

tuning! {
    /// Measured rises compared with those of the model (docs/diagnosis.md, sections 8 and 13; docs/safety.md).
    pub struct HeatTuning: heat {
        /// The heater may be stuck on if T1 and T2 are grossly hotter than expected (`tuning.sensors`) for this long while heating, or for as long as the ambient temperature is at rest (`tuning.ambient.rest`) while the heater is off, when the fan may be off as well ...
        too_hot_time = 1.0, "answer times", measured "hazards of the campaign's runaway cells";
        /// ... and the rig has not cooled by this meanwhile. A T2 that is this much below its own mean over an answer time is cooling and lags behind T1.
        cooling = 0.3, "degC", measured "the same";
        /// If no hypothesis fits, a thermistor is out of the tube if it sees less than this share of the rise, and the other one all of it.
        unexplained = 0.85, "1", chosen "";
        /// Whether a T1 that is called stuck moves after all is asked from this time after the onset on, in memories of the low-passed rises.
        stuck_time = 2.5, "1", chosen "";
    }
}

tuning! {
    /// Thermistors that contradict each other (docs/diagnosis.md, section 8).
    pub struct ContradictionTuning: contradiction {
        /// A thermistor answers if the area of its response is larger than this, and is silent if it is smaller by as much than its share of another's.
        answers = 6.0, "standard deviations", derived "false names below 1e-9 a memory (docs/diagnosis.md, section 8)";
        /// T1 comes after T2 if its centroid is later by this ...
        after = 1.0, "ticks", derived "two to three ticks on rigs that are rightly wired (docs/diagnosis.md, section 8)";
        /// The contradiction is over after this many steps without a difference, and for as long after the end of heating the responses are still judged.
        over = 100.0, "steps", chosen "";
        /// The responses are judged once in this many steps; two judgements in a row must agree.
        every = 8.0, "steps", chosen "for the cost of a tick";
    }
}

tuning! {
    /// Impulse responses from the power to each thermistor (docs/diagnosis.md, section 8).
    pub struct ImpulseTuning: impulse {
        /// A step is a tick, or as many ticks as make this many steps of an answer time.
        steps = 20.0, "steps", chosen "";
        /// Time constant of the high-pass.
        high_pass = 0.25, "answer times", chosen "";
        /// Memory of the sums.
        memory = 6.0, "answer times", chosen "";
        /// Nothing is learnt or forgotten while the power has moved by less than this in all bands.
        least_power = 0.2, "%", chosen "";
        /// Ridge of the regression: it keeps the sums regular where little has been seen.
        ridge = 100.0, "%^2", derived "2 % of what the default excitation gathers";
    }
}

tuning! {
    /// The ambient temperature that is believed (docs/diagnosis.md, section 8).
    pub struct AmbientTuning: ambient {
        /// The believed ambient temperature changes no faster than this.
        fastest = 1.0, "degC/min", chosen "what a room can do";
        /// A T0 that is further than this from the believed temperature is not followed: no room moves that far. One that read wrong reads right again below it.
        followed = 3.0, "degC", chosen "what a room can do";
        /// T1 and T2 are at rest while they have no trend: the difference of their means over a short and a long memory is below this.
        trend = 0.1, "degC", derived "0.3 degC a minute with an answer time of 2 s, slower than a hot tube cools without its fan";
        /// The short memory. T0 reads wrong when it has been far from the believed temperature for this long.
        short_memory = 2.5, "answer times", chosen "";
        /// The long memory; they are at rest when there has been no trend for this time.
        rest = 10.0, "answer times", chosen "";
        /// An answer time longer than this counts as this; else the drift of a room would look like a trend.
        longest = 24.0, "s", chosen "";
        /// No room with a rig is colder than this.
        coldest = 3.0, "degC", chosen "";
        /// No room with a rig is warmer than this.
        warmest = 40.0, "degC", chosen "";
    }
}

tuning! {
    /// By how much thermistors differ, and when they give nothing usable. In degC the numbers suit rigs that rise by 10 degC and more.
    pub struct SensorTuning: sensors {
        /// What a reading is off by chance: the standard deviation of one reading of an offset on a cold rig, and how far T0 may be from its mean before it widens the charts.
        noise = 0.15, "degC", chosen "";
        /// Thermistors in the same air differ by no more than this, and a rise that is smaller is none. If T2 would correct the model by more than this (and the share below), there is no virtual T1.
        alike = 2.0, "degC", chosen "tolerance of thermistors";
        /// What differs by more than this (and the share below) is neither tolerance nor an error of the model: thermistors contradict each other, the heater is stuck on where hardly any rise is expected, T0 is not the room.
        gross = 4.0, "degC", measured "hazards of the campaign's runaway and wiring cells";
        /// The same as a share of a rise. What sees less than this share of a rise that another sees, or that is expected, sees nothing.
        share = 0.25, "1", measured "the same";
        /// A thermistor is lost after this many ticks without a usable sample; fewer are noise on the line.
        lost = 8.0, "ticks", chosen "";
        /// An open or shorted wire is believed after this many ticks.
        broken = 2.0, "ticks", chosen "";
    }
}
