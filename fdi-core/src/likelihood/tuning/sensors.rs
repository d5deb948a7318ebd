//! What needs no bank: rises, contradictions, ambient, sensors.

use super::tuning;

tuning! {
    /// Measured rises held against those of the model (docs/diagnosis.md, sections 8 and 13; docs/safety.md). In degC they suit rigs that rise by 10 degC
    /// and more.
    pub struct HeatTuning: heat {
        /// T2 and the model may disagree by so much about T1; beyond it nothing is left to regulate by.
        correction = 3.0, "degC", chosen "";
        /// And by this share of the rise.
        correction_share = 0.2, "1", chosen "";
        /// The heater is stuck on when a thermistor is so much hotter than expected.
        too_hot = 4.0, "degC", measured "hazards of the campaign's runaway cells";
        /// While no more rise is expected than this.
        no_rise = 1.5, "degC", measured "the same";
        /// For so long while heating.
        too_hot_time = 1.0, "answer times", measured "the same";
        /// For so long while the heater is off, when the fan may be off as well.
        too_hot_off = 10.0, "answer times", measured "the same";
        /// Without cooling by so much then.
        cooling = 0.3, "degC", measured "the same";
        /// The smallest rise that says anything of the air flow.
        flow_rise = 2.0, "degC", chosen "";
        /// What nothing else explains is out of the tube where it sees less than this share of the rise.
        unexplained = 0.85, "1", chosen "";
        /// The other sees all of it, give or take this share of what the one lacks.
        attached = 0.25, "1", chosen "";
        /// And a rise of this is expected.
        detached_rise = 4.0, "degC", chosen "";
        /// A stuck T1 shows less than this share of the motion from tick to tick that is expected.
        stuck = 0.2, "1", chosen "";
        /// It is asked for so long after the onset, in memories of the rises.
        stuck_time = 2.5, "1", chosen "";
    }
}

tuning! {
    /// Thermistors that contradict each other (docs/diagnosis.md, section 8).
    pub struct ContradictionTuning: contradiction {
        /// A thermistor answers where its response is larger than this.
        answers = 6.0, "standard deviations", derived "false names below 1e-9 a memory (docs/diagnosis.md, section 8)";
        /// It is silent where its response is below this share of another's.
        silent = 0.2, "1", derived "the same";
        /// By so much.
        silent_sds = 4.0, "standard deviations", derived "the same";
        /// T0 answers where it does so by more than this share of T1's or T2's response: a tube that warms the room does not count.
        ambient = 0.3, "1", chosen "";
        /// One comes after the other by so much.
        after = 1.0, "ticks", derived "two to three ticks on rigs that are rightly wired (docs/diagnosis.md, section 8)";
        /// Readings that differ by more contradict each other.
        differ = 4.0, "degC", measured "the campaign's runaway and wiring cells";
        /// T2 above T1 also by this share of T2's rise.
        differ_share = 0.25, "1", measured "the same";
        /// For so many steps of the impulse response, fewer the larger the difference.
        steps = 20.0, "steps", measured "the same";
        /// But each counts for so many at most.
        weight = 4.0, "steps", chosen "";
        /// It is over after so many steps without it.
        over = 100.0, "steps", chosen "";
        /// Not while T2 is so much below its own mean: when it cools it lags behind T1.
        falling = 0.5, "degC", chosen "";
        /// Memory of that mean.
        mean = 20.0, "steps", chosen "";
        /// A thermistor reads as the room does within this share of the other's rise.
        cold_share = 0.1, "1", chosen "";
        /// And so many degC.
        cold = 1.5, "degC", chosen "";
        /// It is judged anew every so many steps, and holds when it is the same twice.
        every = 8.0, "steps", chosen "for the cost of a tick";
        /// So long after heating has ended the response to it is still judged.
        after_heating = 32.0, "steps", chosen "";
    }
}

tuning! {
    /// Impulse responses from the power to each thermistor (docs/diagnosis.md, section 8).
    pub struct ImpulseTuning: impulse {
        /// A step is a tick, or as many as make so many steps of the rig's answer.
        steps = 20.0, "steps", chosen "";
        /// Time constant of the high-pass.
        high_pass = 0.25, "answer times", chosen "";
        /// Memory of the sums.
        memory = 6.0, "answer times", chosen "";
        /// While the power of no band has moved by so much nothing is learnt or forgotten.
        least_power = 0.2, "%", chosen "";
        /// Ridge of the regression: it keeps the sums regular where little has been seen.
        ridge = 100.0, "%^2", derived "2 % of what the default excitation gathers";
    }
}

tuning! {
    /// The ambient temperature that is believed (docs/diagnosis.md, section 8).
    pub struct AmbientTuning: ambient {
        /// A room changes no faster.
        fastest = 1.0, "degC/min", chosen "what a room can do";
        /// Beyond so much from what is believed T0 is not followed: no room moves so far from itself.
        followed = 3.0, "degC", chosen "what a room can do";
        /// At rest T1 and T2 are alike to this.
        alike = 2.0, "degC", chosen "tolerance of thermistors";
        /// And without a trend: the difference of means over two memories.
        trend = 0.1, "degC", derived "0.3 degC a minute with an answer time of 2 s, slower than a hot tube cools without its fan";
        /// The shorter memory; T0 reads wrong after so long.
        short_memory = 2.5, "answer times", chosen "";
        /// The longer memory.
        long_memory = 12.5, "answer times", chosen "";
        /// For so long.
        rest = 10.0, "answer times", chosen "";
        /// An answer time longer than this counts as this: else what a room drifts by is a trend.
        longest = 24.0, "s", chosen "";
        /// T0 reads wrong from this distance on.
        wrong = 5.0, "degC", chosen "";
        /// And right again below this distance.
        right = 4.0, "degC", chosen "";
        /// Where a rig stands it is no colder.
        coldest = 3.0, "degC", chosen "";
        /// And no warmer.
        warmest = 40.0, "degC", chosen "";
    }
}

tuning! {
    /// Thermistors that give nothing usable.
    pub struct SensorTuning: sensors {
        /// One is lost after so many ticks without a usable sample; fewer are noise on the line.
        lost = 8.0, "ticks", chosen "";
        /// An open or shorted wire is believed after so many.
        broken = 2.0, "ticks", chosen "";
    }
}
