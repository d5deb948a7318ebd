//! What needs no bank: rises, contradictions, ambient, sensors.

use super::tuning;

tuning! {
    /// Measured rises compared with those of the model (docs/diagnosis.md, sections 8 and 13; docs/safety.md). In degC they suit rigs that rise by 10 degC
    /// and more.
    pub struct HeatTuning: heat {
        /// If T2 would correct the model by more than this (and the share below), there is no virtual T1.
        correction = 3.0, "degC", chosen "";
        /// This share of the rise is added to that limit.
        correction_share = 0.2, "1", chosen "";
        /// The heater may be stuck on if T1 and T2 are this much hotter than expected ...
        too_hot = 4.0, "degC", measured "hazards of the campaign's runaway cells";
        /// ... while the model expects less rise than this ...
        no_rise = 1.5, "degC", measured "the same";
        /// ... for this long while heating ...
        too_hot_time = 1.0, "answer times", measured "the same";
        /// ... or for this long while the heater is off, when the fan may be off as well ...
        too_hot_off = 10.0, "answer times", measured "the same";
        /// ... and the rig has not cooled by this meanwhile.
        cooling = 0.3, "degC", measured "the same";
        /// The smallest rise from which the air flow is computed.
        flow_rise = 2.0, "degC", chosen "";
        /// If no hypothesis fits, a thermistor is out of the tube if it sees less than this share of the rise ...
        unexplained = 0.85, "1", chosen "";
        /// ... the other one sees all of it, give or take this share of what the first one lacks ...
        attached = 0.25, "1", chosen "";
        /// ... and at least this rise is expected.
        detached_rise = 4.0, "degC", chosen "";
        /// A stuck T1 shows less than this share of the expected motion around its mean.
        stuck = 0.2, "1", chosen "";
        /// This is asked from this time after the onset on, in memories of the low-passed rises.
        stuck_time = 2.5, "1", chosen "";
    }
}

tuning! {
    /// Thermistors that contradict each other (docs/diagnosis.md, section 8).
    pub struct ContradictionTuning: contradiction {
        /// A thermistor answers if the area of its response is larger than this.
        answers = 6.0, "standard deviations", derived "false names below 1e-9 a memory (docs/diagnosis.md, section 8)";
        /// It is silent if the area of its response is below this share of another's ...
        silent = 0.2, "1", derived "the same";
        /// ... by this many standard deviations.
        silent_sds = 4.0, "standard deviations", derived "the same";
        /// T0 answers only if its response is more than this share of T1's or T2's: a tube that warms the room does not count.
        ambient = 0.3, "1", chosen "";
        /// T1 comes after T2 if its centroid is later by this ...
        after = 1.0, "ticks", derived "two to three ticks on rigs that are rightly wired (docs/diagnosis.md, section 8)";
        /// Readings that differ by more than this contradict each other.
        differ = 4.0, "degC", measured "the campaign's runaway and wiring cells";
        /// T2 above T1: the difference must also exceed this share of T2's rise.
        differ_share = 0.25, "1", measured "the same";
        /// The difference must last for this many steps of the impulse response; fewer if it is larger.
        steps = 20.0, "steps", measured "the same";
        /// A step with a large difference counts for this many steps at most.
        weight = 4.0, "steps", chosen "";
        /// The contradiction is over after this many steps without a difference.
        over = 100.0, "steps", chosen "";
        /// A T2 that is this much below its own mean is cooling and lags behind T1: the difference does not count then.
        falling = 0.5, "degC", chosen "";
        /// Memory of that mean of T2.
        mean = 20.0, "steps", chosen "";
        /// A thermistor reads as the room does if its rise is below this share of the other's ...
        cold_share = 0.1, "1", chosen "";
        /// ... and this many degC.
        cold = 1.5, "degC", chosen "";
        /// The responses are judged once in this many steps; two judgements in a row must agree.
        every = 8.0, "steps", chosen "for the cost of a tick";
        /// For this many steps after the end of heating the responses are still judged.
        after_heating = 32.0, "steps", chosen "";
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
        /// A T0 that is further than this from the believed temperature is not followed: no room moves that far.
        followed = 3.0, "degC", chosen "what a room can do";
        /// At rest, T1 and T2 differ by no more than this.
        alike = 2.0, "degC", chosen "tolerance of thermistors";
        /// At rest, they have no trend: the difference of their means over a short and a long memory is below this.
        trend = 0.1, "degC", derived "0.3 degC a minute with an answer time of 2 s, slower than a hot tube cools without its fan";
        /// The short memory.
        short_memory = 2.5, "answer times", chosen "";
        /// The long memory.
        long_memory = 12.5, "answer times", chosen "";
        /// At rest, this has been so for this time.
        rest = 10.0, "answer times", chosen "";
        /// An answer time longer than this counts as this; else the drift of a room would look like a trend.
        longest = 24.0, "s", chosen "";
        /// T0 reads wrong from this distance from the believed temperature on ...
        wrong = 5.0, "degC", chosen "";
        /// ... for this long.
        wrong_time = 2.5, "answer times", chosen "";
        /// T0 reads right again below this distance.
        right = 4.0, "degC", chosen "";
        /// No room with a rig is colder than this.
        coldest = 3.0, "degC", chosen "";
        /// No room with a rig is warmer than this.
        warmest = 40.0, "degC", chosen "";
    }
}

tuning! {
    /// Thermistors that give nothing usable.
    pub struct SensorTuning: sensors {
        /// A thermistor is lost after this many ticks without a usable sample; fewer are noise on the line.
        lost = 8.0, "ticks", chosen "";
        /// An open or shorted wire is believed after this many ticks.
        broken = 2.0, "ticks", chosen "";
    }
}
