//! Charts, an alarm's beginning and end, names.

use super::tuning;

tuning! {
    /// Charts, and what widens them (docs/diagnosis.md, sections 4 and 5). Their allowances and decision intervals are settings.
    pub struct ChartTuning: charts {
        /// An innovation is clipped here, so that a spike counts once.
        clip = 6.0, "standard deviations", measured "prototype 1, configuration J";
        /// After a start, and in slow surroundings after an end, there are no charts for this time: the whitening filter must first forget what was.
        first = 10.0, "ticks", chosen "";
        /// Only the part of a swing beyond this widens the charts.
        swing = 1.5, "degC", chosen "";
    }
}

tuning! {
    /// An alarm's beginning and end (docs/diagnosis.md, sections 6 and 8).
    pub struct AlarmTuning: alarm {
        /// The evidence since an onset is divided by this, because innovations are not quite independent.
        kappa = 1.5, "1", measured "prototype 2: confidence and coverage";
        /// The onset moves on as long as the sums of the fast charts are below this (and the slow one as below).
        near = 0.5, "standard deviations", chosen "";
        /// The onset moves on as long as the slow chart is below this share of its decision interval (and the fast ones as above).
        near_slow = 0.14, "1", chosen "";
        /// Evidence (log Bayes factor) from which on an alarm is raised.
        raise = 4.5, "1", chosen "prototype 2 had 6";
        /// An alarm ends when the sum of the log odds that its fault has ended (Page's test) reaches twice this, of which one tick gives this at most. In slow surroundings the way back of the power needs only this, the same odds against it refute it, and a sensor that is right again on one tick needs twice as much.
        over = 5.0, "1", derived "noise adds up to twice this less often than once in e^10 ticks, 40 min, and a spike never";
        /// Smallest change of the air flow that is a fault, 1/f - 1. A slow change of power or air flow that goes away by itself counts as usual up to this.
        least_flow = 0.06, "1", chosen "";
        /// Smallest drift that is a fault.
        least_drift = 1.0, "degC/min", chosen "";
        /// Share of a new value in short means: of innovations, from which jumps are measured, of how often nothing fitted, and of the squares of the power's steps.
        mean_share = 0.3, "1", chosen "";
        /// What is further than this from what is usual is not chance: a change of power or flow is a fault only beyond it, and a tick whose innovation jumps further from their mean counts for less.
        unusual = 3.0, "standard deviations", chosen "";
        /// By how much less it counts, for each standard deviation beyond that.
        transient_slope = 0.1, "1", chosen "";
        /// Where there is no fan, what stays larger than `1 / lasting_error` standard deviations counts no more than that: its size is known no better than the model, which is not one of that heater's physics, and sums of its squares would leave single precision nothing to decide by.
        lasting_error = 0.02, "1", measured "made records: with 0.04, 2 offsets of 48 become drifts after hours; with 0.01, the name of a heater that is weak or dead comes and goes. With a fan, a heater that is fully on has its name after 14 to 19 s in place of at most 10 (watch/tests.rs)";
        /// A jump of a sensor during an earlier change: least z1^2 + z2^2 on one tick.
        jump = 16.0, "1", derived "4 standard deviations";
        /// From this age of an onset on, such a jump needs twice that.
        outlasted = 4.0, "ticks", measured "with 3 a heater that fails wholly has no size in 4 of 20 runs in place of 3 (seeds 11 to 30)";
        /// An onset that is older than this when the alarm is raised may belong to an earlier change.
        before = 0.4, "s", chosen "";
        /// It does, if the hypothesis leaves more than this of the square of each innovation.
        inexplicable = 10.0, "1", chosen "without it a heater that fails wholly has no size (tests/closed_loop)";
        /// Up to this age an alarm is young: it forgets nothing, neither air flow nor heater power is named by itself, no drift is, and nothing is called unknown. It is named on every tick; later on every second one.
        young = 3.0, "s", measured "no assumed lag of the fan is safe (docs/evidence/diagnosis-results.md); forgetting from the start, a clogged T1 loses its name in 9 runs of 200";
        /// An alarm that has stood for this long becomes advice.
        stands = 3600.0, "s", chosen "who has not come within an hour needs no siren";
        /// A thermistor's error that has come and gone this often is a loose contact.
        chatters = 2.0, "1", chosen "once may be a fault that is mended";
        /// A loose contact: its alarms come within this time of each other, and it is over after this time without one.
        returns = 270.0, "s", chosen "an alarm may outlive its fault by no more than five minutes";
    }
}

tuning! {
    /// Surroundings that move as slowly as the rig answers: recordings of other heaters (docs/evidence/records.md).
    pub struct SlowTuning: slow {
        /// The surroundings count as slow where the whitening filter's DC gain is below this.
        dc_gain = 0.15, "1", chosen "";
        /// The dead time is known no better than this where the surroundings are slow.
        shift = 0.7, "ticks", chosen "";
        /// A jump is no spike if it has not gone back by more than this share of itself on the next tick.
        back = 0.5, "1", chosen "";
        /// The intercept is taken from this many ticks, if the recording is not the one that was trained on.
        anchored = 30.0, "ticks", chosen "";
        /// The diagnosis waits for this many residence times, until a rig has forgotten how it began.
        settles = 2.0, "residence times", chosen "";
    }
}

tuning! {
    /// Names (docs/diagnosis.md, section 8). The probability from which on a fault is named is a setting.
    pub struct NamingTuning: naming {
        /// A class that is named keeps its name down to this probability. What has changed since training is named from it on, among all that may have.
        lasts = 0.5, "1", derived "it is likelier than all others together";
        /// A name is acted on from this confidence on; below it, it is only told.
        sure = 0.9, "1", chosen "";
        /// No name has a higher confidence, because the fault may be none of the hypotheses.
        certain = 0.98, "1", chosen "commit 4781ecf";
        /// Air flow, or heater power, is named by itself from this probability on. Until then the pair of both is named.
        process = 0.97, "1", chosen "";
        /// The best hypothesis does not fit if it leaves more than this of the square of each innovation (noise leaves 1) ... So much a jump must exceed the sum of the squares since the onset by, too; later, their mean.
        strange = 4.0, "1", chosen "";
        /// ... and also more than this share of the sum of all squares.
        strange_share = 0.06, "1", chosen "";
        /// It fits again if it leaves less than this of the square of each innovation.
        fits = 1.5, "1", chosen "";
        /// A named fault becomes unknown if nothing fitted in more than this share of the judgements.
        lasting_misfit = 0.6, "1", measured "a named fault that ends was unknown for a moment (commit 58a822d)";
        /// Error of the model in a size of the air flow, whose exponents come from a textbook.
        flow_error = 0.10, "1", measured "prototype 2: coverage of the intervals";
        /// Error of the model in any other size.
        size_error = 0.04, "1", measured "prototype 2: coverage of the intervals";
    }
}
