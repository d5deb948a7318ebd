//! Charts, an alarm's beginning and end, names.

use super::tuning;

tuning! {
    /// Charts, and what widens them (docs/diagnosis.md, sections 4 and 5). Their allowances and decision intervals are settings.
    pub struct ChartTuning: charts {
        /// A sum stops growing here, so that it comes back soon after a long fault.
        ceiling = 2.5, "decision intervals", chosen "";
        /// An innovation is clipped here: a spike counts once.
        clip = 6.0, "standard deviations", measured "prototype 1, configuration J";
        /// So long after its start, and after an end that was seen as such, a watch has no charts.
        first = 10.0, "ticks", chosen "";
        /// The share of a swing beyond this that the model may get wrong counts.
        swing = 1.5, "degC", chosen "";
        /// T0 is above its mean by so much without moving: its noise.
        inlet_noise = 0.15, "degC", chosen "";
        /// A T1 and a T2 whose difference is so much other than learnt contradict each other: neither is regulated by.
        largest_contradiction = 6.0, "degC", chosen "";
    }
}

tuning! {
    /// An alarm's beginning and end (docs/diagnosis.md, sections 6 and 8).
    pub struct AlarmTuning: alarm {
        /// Evidence since an onset is divided by so much: residuals are not as independent as the sums take them for.
        kappa = 1.5, "1", measured "prototype 2: confidence and coverage";
        /// The regressors begin anew while the fast charts are below this.
        near = 0.5, "standard deviations", chosen "";
        /// And the slow chart below this share of its decision interval.
        near_slow = 0.14, "1", chosen "";
        /// Log Bayes factor that raises an alarm.
        raise = 4.5, "1", chosen "prototype 2 had 6";
        /// Smallest change of the air flow that is a fault, 1/f - 1.
        least_flow = 0.06, "1", chosen "";
        /// Smallest drift that is a fault.
        least_drift = 1.0, "degC/min", chosen "";
        /// A change is a fault only beyond so many standard deviations of what is usual here.
        unusual = 2.5, "standard deviations", chosen "";
        /// Covariance inflation of what was learnt of the curvature: the filter takes slow surroundings for noise.
        curvature_inflation = 2.5, "1", chosen "";
        /// So many steps of the power around the trained one count as excited.
        excited = 0.5, "1", chosen "half of the step";
        /// A tick counts for less the wider the charts are, by this times the square of by how many standard deviations.
        widened = 0.25, "1", chosen "";
        /// Share of a new innovation in its mean, from which jumps are counted.
        mean_share = 0.3, "1", chosen "";
        /// A jump from that mean by more than this makes a tick count for less.
        transient_from = 3.0, "standard deviations", chosen "";
        /// By so much for each standard deviation more.
        transient_slope = 0.1, "1", chosen "";
        /// Least sum of both squares of what begins in one tick while something else is under way.
        jump = 16.0, "1", derived "4 standard deviations";
        /// Twice as much from this age of an onset on.
        outlasted = 4.0, "ticks", chosen "";
        /// Such a jump is so many times what was before: its sum at first, its mean later.
        jump_ratio = 4.0, "1", chosen "";
        /// What was under way for longer before an alarm may have been something else.
        before = 0.4, "s", chosen "";
        /// It was, where the hypothesis leaves more than so much of each whitened residual's square.
        inexplicable = 10.0, "1", chosen "";
        /// What nuisances explain for so long the tracker takes over.
        taken_after = 8.0, "s", chosen "";
        /// From this age on an alarm forgets.
        forgets_from = 3.0, "s", measured "a later sag is absorbed (prototype 2)";
        /// Log odds by which an alarm is over, and in slow surroundings by which that is refuted.
        over = 5.0, "1", measured "prototype 2";
        /// It is asked from this age on.
        asked_from = 0.5, "s", chosen "";
        /// It is over, too, where no hypothesis gains more, once flow and power can be told apart.
        least_gain = 1.0, "1", chosen "";
        /// So long an alarm is ranked and asked for its end on every tick, later by turns.
        young = 2.0, "s", chosen "for the cost of a tick";
        /// So long after an alarm there are no charts; in slow surroundings a tick on which it may have ended is held for so long.
        holdoff = 1.0, "s", chosen "about the residence time";
        /// Then the tracker is less sure of the power by this.
        power_after = 0.015, "1", chosen "";
        /// And of both offsets by this.
        offset_after = 0.05, "degC", chosen "";
        /// After so long an alarm is advice.
        stands = 3600.0, "s", chosen "who has not come within an hour needs no siren";
        /// From this many alarms of one thermistor's error on its contact is loose.
        chatters = 3.0, "1", chosen "a fault that is made twice on purpose is two faults";
        /// Where each came within this time of the one before.
        returns = 270.0, "s", chosen "an alarm may outlive its fault by no more than five minutes";
    }
}

tuning! {
    /// Surroundings that move as slowly as the rig answers: recordings of other heaters (docs/records.md).
    pub struct SlowTuning: slow {
        /// They do where the whitening filter's DC gain is below this.
        dc_gain = 0.15, "1", chosen "";
        /// Log odds by which a sensor's error is over at once.
        sensor_over = 10.0, "1", chosen "";
        /// The dead time is not known better than this there.
        shift = 0.7, "ticks", chosen "";
        /// A jump is no spike where the next tick is above this share of it, with the other sign of what goes back.
        back = 0.5, "1", chosen "";
        /// Ticks from which the intercept is taken, where a recording is not the one that was trained on.
        anchored = 30.0, "ticks", chosen "";
        /// A rig that forgets how it began within these is waited for, in its residence times.
        settles = 2.0, "residence times", chosen "";
    }
}

tuning! {
    /// Names (docs/diagnosis.md, section 8). The probability from which on a fault is named is a setting.
    pub struct NamingTuning: naming {
        /// What is named loses its name below the probability that named it less this.
        unname = 0.05, "1", chosen "";
        /// No name is surer: what is not among the hypotheses has its share.
        certain = 0.98, "1", chosen "commit 4781ecf";
        /// Air flow or heater power is named by itself from this probability on.
        process = 0.97, "1", chosen "";
        /// And only from this age of the alarm on; until then the pair is said, no drift, and nothing is unknown.
        process_time = 3.0, "s", measured "no assumed lag of the fan is safe (docs/diagnosis.md, section 16)";
        /// The best hypothesis does not fit where it leaves more than so much of each whitened residual's square: 1 is noise.
        strange = 4.0, "1", chosen "";
        /// And more than this share of what there was.
        strange_share = 0.06, "1", chosen "";
        /// It fits again below this of each square.
        fits = 1.5, "1", chosen "";
        /// Or below this share of what there was.
        fits_share = 0.02, "1", chosen "";
        /// Share of a new judgement in how often nothing fits.
        misfit_share = 0.2, "1", chosen "";
        /// What has a name becomes unknown where nothing has fitted on more than this share of the judgements.
        lasting_misfit = 0.6, "1", measured "a named fault that ends was unknown for a moment (commit 58a822d)";
        /// Error of the model in a size of the air flow, whose exponents are those of a book.
        flow_error = 0.10, "1", measured "prototype 2: coverage of the intervals";
        /// Error of the model in any other size.
        size_error = 0.04, "1", measured "prototype 2: coverage of the intervals";
    }
}
