//! The watch over a trained rig: residuals of a frozen model, charts on them, and the banks that explain what the charts find.
//!
//! While nothing stirs, a tracker follows slow change, and all columns begin anew on every tick; when a chart fires, they have gathered since
//! the onset. Beside that the state is held against the trained one, over a minute.

use super::alarm::{Alarm, ModelAlarm};
use super::beside::Beside;
use super::chart::{Chart, Sums};
use super::class::FaultClass;
use super::column::{Column, Direction, LASTING, LESS, MORE, Row, SENSORS};
use super::evidence::{Free, Freed, Nuisance, Nuisances};
use super::gone::Gone;
use super::heat::{Heat, HeatState, Rise};
use super::hypothesis::{self, CONSTANT, COUNT, HYPOTHESES, Hypothesis, IMPOSSIBLE, SINCE_ONSET, in_unit};
use super::inputs::Inputs;
use super::ladder::{Ladder, Past};
use super::model::Model;
use super::normal::Normal;
use super::onset::{History, Nominal, Onset, OnsetConstants, REMEMBERED};
use super::posterior::Posterior;
use super::process::{Motion, Parameter, Parameters, Process};
use super::steady::{Steady, SteadyConstants};
use super::tracker::Tracker;
use super::training::Trained;
use super::verdict::{Finding, Magnitude};
use crate::bounds::{bounded, larger, smaller};
use crate::filter::LowPass;
use crate::root::sqrt;

/// Charts see no more of an innovation than so many standard deviations: a spike counts once.
const CLIP: f32 = 6.0;
/// Ticks from which the intercept is taken, where a recording is not the one that was trained on. A rig that answers within half of these is waited
/// for before; a slower one is taken to be at rest.
const ANCHORED: u32 = 30;
/// Ticks without a chart at the start.
const FIRST_TICKS: u32 = 10;
/// All columns begin anew while the fast charts are below so many standard deviations, and the slow one below this share of its interval.
const NEAR: f32 = 0.5;
const NEAR_SLOW: f32 = 0.14;
/// The tracker runs while all charts are below this share of their intervals.
const TRACK_BELOW: f32 = 0.4;
/// The share of a swing beyond this, degC, that the model may get wrong, and the swing's memory, s.
const SWING: f32 = 1.5;
const SWING_TIME: f32 = 2.0;
/// T0 is above its mean by so much without moving, degC: its noise.
const INLET_NOISE: f32 = 0.15;
/// Memory of how far power, flow and offsets wander, s.
const WANDER_TIME: f32 = 7200.0;
/// Weight of a new step of the power in what is known of their size.
const STEP_SHARE: f32 = 0.2;
/// A change is a fault only beyond so many standard deviations of what is usual here.
const UNUSUAL: f32 = 2.5;
/// Memory of T0's mean, s: what the inlet moves has passed T1 and T2 by then.
const INLET_TIME: f32 = 1.0;
/// Evidence since an onset is divided by so much.
pub(super) const KAPPA: f32 = 1.5;
/// Log Bayes factors that raise an alarm: since the onset, and since training.
const RAISE: f32 = 4.5;
const RAISE_SLOW: f32 = 1.5;
/// An alarm since training goes on above this share of both the factor and the size that raised it.
const GOES_ON: [f32; 2] = [0.4, 0.7];
/// What is named loses its name below the probability that named it less this.
const UNNAME: f32 = 0.05;
/// No name is surer: what is not among the hypotheses has its share (docs/diagnosis.md, section 11).
const CERTAIN: f32 = 0.98;
/// Air flow or heater power is named by itself from this probability on.
const NAME_PROCESS: f32 = 0.97;
const ALWAYS_BOTH: f32 = 2.0;
/// The same for what has changed since training.
const NAME_LASTING: f32 = 0.9;
/// Flow and power are told apart only after so long, s.
const PROCESS_TIME: f32 = 3.0;
/// The best hypothesis does not fit where it leaves more than so much of each whitened residual's square (1 is noise), and such a share of what there
/// was; it fits again below these. Asked after so long, s.
const STRANGE: [f32; 2] = [4.0, 0.06];
const FITS: [f32; 2] = [1.5, 0.02];
const UNKNOWN_AFTER: f32 = 3.0;
/// What nuisances explain for so long is taken into the tracker, s.
const TAKEN_AFTER: f32 = 8.0;
/// From so old on an alarm forgets with this memory, s.
const FORGETS_FROM: f32 = 3.0;
const FORGETS_WITH: f32 = 10.0;
/// An alarm is over by these log odds in a window, which is asked from so long on, s.
const OVER: f32 = 5.0;
/// Where a constant leaves less than this share of itself after whitening, a sensor's error that goes at once is asked for by itself, with these
/// log odds.
const SLOW_NOISE: f32 = 0.15;
const GOES: f32 = 10.0;
/// There the dead time is not known better than this, ticks.
const VAGUE_SHIFT: f32 = 0.7;
const WINDOW: f32 = 0.7;
const ASKED_FROM: f32 = 0.5;
/// The fast band learns for so long where the model is wrong, s.
const REFERENCE_TIME: f32 = 90.0;
/// An alarm is young for so long, s.
const YOUNG: f32 = 2.0;
/// Smallest faults that are reported since training: share of power, `1/f - 1`, degC, share of gain.
const LEAST_POWER: f32 = 0.1;
const LEAST_FLOW: f32 = 0.085;
const LEAST_OFFSET: f32 = 0.8;
const LEAST_GAIN: f32 = 0.08;
/// Error of the models in a size: of air flow, of all others.
const SIZE_ERROR: [f32; 2] = [0.10, 0.04];
/// Half of the width of a 95 % interval, in standard deviations.
const HALF_OF_95: f32 = 1.96;

/// A validated watch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    pub(super) fast: Chart,
    pub(super) slow: Chart,
    pub(super) heat: Heat,
    pub(super) model_uncertainty: f32,
    pub(super) naming: f32,
    pub(super) least_power: f32,
    pub(super) sample_time: f32,
    pub(super) inputs: Inputs,
}

/// What follows from the model: how fast everything goes.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Seconds here for each of the reference rig.
    stretch: f32,
    onset: OnsetConstants,
    steady: SteadyConstants,
    swing: LowPass,
    inlet: LowPass,
    wander: LowPass,
    forgets: f32,
    window: f32,
}

/// Its memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct WatchState {
    parameters: Parameters,
    beside: Beside,
    /// The fan's level as announced, behind its lag, and the model there.
    fan: f32,
    process: Process,
    flows: [Process; 2],
    motion: Motion,
    ladder: Ladder,
    mean: [f32; 2],
    pace: Pace,
    power: f32,
    before: [f32; 2],
    history: History,
    past: Past,
    past_clipped: Past,
    tracker: Tracker,
    /// Mean squares of what the tracker has followed, and of the steps of the power that were taken in.
    wander: [f32; 4],
    steps: f32,
    fast: [Sums; 2],
    slow: Sums,
    swing: [f32; 2],
    /// Rise of T1 at which training took place, degC.
    trained: f32,
    /// T0 and its mean, and what its motion may have been at T1 and at T2, degC.
    inlet: Option<(f32, f32, [f32; 2])>,
    z_mean: [f32; 2],
    candidate: f32,
    rests: u32,
    /// Ticks for which a change of the fan settles.
    settling: u32,
    ticks: u32,
    /// Ticks that the intercept is still taken from.
    anchoring: u32,
    alarm: Option<Alarm>,
    steady: Steady,
    lasting: Option<Lasting>,
    heat: HeatState,
    measured: [f32; 2],
    stays: [f32; 2],
    contradict: bool,
    expected: [f32; 2],
}

/// What has been gathered since the assumed onset: columns, their sums, and those of late. It is needed only while the instrument watches.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gathered {
    onset: Onset,
    since: Normal,
    window: Normal,
    gone: Gone,
    /// The whitened answer to the power since the onset, on the last tick.
    answer: [f32; 2],
}

impl Gathered {
    /// Begins anew with the next tick that stirs.
    fn begin_anew(&mut self) {
        self.onset.age = 0;
        if self.since.count > 0.0 {
            self.since = Normal::default();
        }
    }
}

/// Largest sums, as shares of the decision intervals.
struct Charted {
    fast: f32,
    slow: f32,
}

/// A valid T1 and T2 whose difference is so much other than learnt contradict each other, degC: neither is regulated by.
const MAX_CONTRADICTION: f32 = 6.0;

/// Levels of the fan that differ by less are one, and for how long after a change nothing is judged, s.
const FAN_STEP: f32 = 1e-3;
const FAN_SETTLES: f32 = 10.0;

/// Residence time of the reference rig, s: what all times here were tuned on.
const REFERENCE: f32 = 1.1;

impl WatchState {
    /// What was learnt.
    pub(super) fn model(&self, sample_time: f32) -> Model {
        let p = |which| self.parameters.get(which);
        let time = |which| sample_time * libm::expf(p(which));
        let (gain_beside, lag_beside) = self.beside.learnt();
        Model {
            gain: self.gain(),
            curvature: p(Parameter::Curvature),
            offset: p(Parameter::Offset1),
            heater: time(Parameter::Heater),
            lag: time(Parameter::Lag1),
            wall: time(Parameter::WallTime),
            dead_time: sample_time * p(Parameter::Delay1),
            wall_share: p(Parameter::Wall1),
            reaches: p(Parameter::Reaches2),
            lag2: time(Parameter::Lag2),
            transport: sample_time * p(Parameter::Delay2),
            gain_beside,
            lag_beside: sample_time * lag_beside,
            noise: self.ladder.sigma,
        }
    }

    /// Static gain from the power to T1, degC per %.
    pub(super) fn gain(&self) -> f32 {
        libm::expf(self.parameters.get(Parameter::Gain))
    }
}

impl Watch {
    fn pace(&self, p: &Parameters) -> Pace {
        let ts = self.sample_time;
        let stretch = bounded(p.residence() * ts / REFERENCE, 0.5, 100.0);
        let share = |time: f32| 1.0 - libm::expf(-ts / (time * stretch));
        let lags = [0.35, 1.0].map(share);
        Pace {
            stretch,
            onset: OnsetConstants {
                lead: (p.get(Parameter::Delay1) + 1.5) as usize,
                lags,
                fan: ts / (0.2 * stretch),
                minutes: ts / 60.0,
            },
            steady: SteadyConstants {
                keep: 1.0 - share(60.0),
                reference: (REFERENCE_TIME * stretch / ts) as u32,
                split: LowPass::over(1.0 / share(5.0)),
                mean: LowPass::over(1.0 / share(25.0)),
            },
            swing: LowPass::over(1.0 / share(SWING_TIME)),
            inlet: LowPass::over(1.0 / share(INLET_TIME)),
            wander: LowPass::over(1.0 / share(WANDER_TIME)),
            forgets: 1.0 - share(FORGETS_WITH),
            window: 1.0 - share(WINDOW),
        }
    }

    pub(super) fn start(&self, trained: Trained) -> WatchState {
        let p = trained.parameters;
        let process = Process::new(&p, 1.0);
        WatchState {
            parameters: p,
            beside: trained.beside,
            fan: 1.0,
            process,
            flows: [Process::new(&p, LESS), Process::new(&p, MORE)],
            motion: trained.motion,
            ladder: trained.ladder,
            mean: trained.mean,
            pace: self.pace(&p),
            power: trained.power,
            before: [trained.rise; 2],
            history: History::default(),
            past: Past::default(),
            past_clipped: Past::default(),
            tracker: Tracker::default(),
            wander: [0.0; 4],
            steps: hypothesis::POWER_SD * hypothesis::POWER_SD,
            fast: Default::default(),
            slow: Sums::default(),
            swing: [trained.rise, 0.0],
            trained: trained.rise,
            inlet: None,
            z_mean: [0.0; 2],
            candidate: 0.0,
            rests: 0,
            settling: 0,
            ticks: 0,
            anchoring: 0,
            alarm: None,
            steady: Steady::new(&trained.motion, trained.rise),
            lasting: None,
            heat: HeatState::new(trained.rise),
            measured: [trained.rise; 2],
            stays: [trained.rise; 2],
            contradict: false,
            expected: [trained.rise; 2],
        }
    }

    /// What the models say of a tick: rises over T0 and over the ambient that is believed, degC, and the power applied from now on, %, with
    /// the fan's level and the power of a heater beside.
    #[expect(clippy::too_many_arguments, reason = "a tick as all parts see it")]
    pub(super) fn step(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        tick: u32,
        y: [Option<f32>; 2],
        t0: Option<f32>,
        believed: [Option<f32>; 2],
        [u, fan, beside]: [f32; 3],
    ) -> ModelAlarm {
        let added = s.beside.step(beside);
        let [y, believed] = [y, believed].map(|rises| rises.map(|rise| Some(rise? - added)));
        if self.follow_fan(s, fan) {
            g.begin_anew();
        }
        if let Some(t0) = t0 {
            let (before, mut mean, _) = s.inlet.unwrap_or((t0, t0, [0.0; 2]));
            let above = t0 - mean;
            s.pace.inlet.follow(&mut mean, t0);
            s.inlet = Some((t0, mean, [5.0 * (t0 - before), above]));
        }
        let heat = s.process.heat(self.inputs.drove(&mut s.power, u));
        let before = s.before;
        let rises = s.process.step(&mut s.motion, heat);
        s.before = rises.y;
        let offsets = [s.parameters.get(Parameter::Offset1), s.parameters.get(Parameter::Offset2)];
        let expected: [f32; 2] = core::array::from_fn(|m| rises.y[m] + offsets[m] + s.mean[m]);
        s.expected = expected;
        self.follow_rises(s, believed, true);
        // Without T1 above all: what is regulated by then must not leave T2.
        if let Some(y2) = y[1] {
            self.heat.correct(&mut s.heat, y2 - expected[1], s.parameters.get(Parameter::Reaches2));
        }
        let row = s.steady.row(&s.flows, heat, &rises, before);
        let now = NowRises { heat, rises, before };
        let told = match y {
            [Some(y1), Some(y2)] => {
                let e = [y1 - expected[0], y2 - expected[1]];
                if s.anchoring > 0 {
                    Self::anchor(s, e);
                    return ModelAlarm::Quiet;
                }
                s.ticks = s.ticks.saturating_add(1);
                s.contradict = s.heat.contradiction() > MAX_CONTRADICTION;
                self.judge(s, g, tick, e, &row, &now);
                s.measured = [y1 - offsets[0] - s.mean[0], y2 - offsets[1] - s.mean[1]];
                s.reported(&self.heat, tick)
            }
            _ => {
                s.contradict = false;
                if g.onset.age > 0 {
                    g.onset.pass(&s.pace.onset, &s.ladder, &s.nominal(&now));
                }
                s.reported(&self.heat, tick)
            }
        };
        s.history.push(heat, &s.motion);
        told
    }

    /// Another recording of the same rig begins, long after its power was last changed. Where nothing says how warm the room is by now, the
    /// first ticks do.
    pub(super) fn resume(&self, s: &mut WatchState, [u, fan, beside]: [f32; 3]) {
        let heat = s.process.heat(u);
        s.motion = Motion::steady(heat);
        s.power = u;
        s.beside = s.beside.resumed(beside);
        s.steady.resume(&s.motion);
        s.history = History::default();
        for _ in 0..REMEMBERED {
            s.history.push(heat, &s.motion);
        }
        s.before = s.process.rises(s.motion.m, s.motion.w).y;
        (s.fan, s.tracker, s.alarm, s.lasting) = (fan, Tracker::default(), None, None);
        (s.past, s.past_clipped) = (Past::default(), Past::default());
        s.swing = [s.before[0] + s.parameters.get(Parameter::Offset1), 0.0];
        let settles = 2.0 * s.parameters.residence();
        let settles = if settles <= ANCHORED as f32 { settles as u32 } else { 0 };
        s.anchoring = settles + if self.inputs.t0 { 0 } else { ANCHORED };
        s.ticks = 0;
        s.rest();
    }

    /// The first ticks of a recording say what the intercept is there, after those in which the rig has forgotten how it began.
    fn anchor(s: &mut WatchState, e: [f32; 2]) {
        s.anchoring -= 1;
        if s.anchoring >= ANCHORED {
            return;
        }
        let share = 1.0 / (ANCHORED - s.anchoring) as f32;
        for (mean, e) in s.mean.iter_mut().zip(e) {
            *mean += share * e;
        }
    }

    /// Keeps the models going while the instrument does not watch by them.
    pub(super) fn idle(
        &self,
        s: &mut WatchState,
        believed: [Option<f32>; 2],
        [u, fan, beside]: [f32; 3],
        heating: bool,
    ) {
        let added = s.beside.step(beside);
        let believed = believed.map(|rise| Some(rise? - added));
        self.follow_fan(s, fan);
        s.alarm = None;
        s.lasting = None;
        s.rest();
        let heat = s.process.heat(self.inputs.drove(&mut s.power, u));
        let rises = s.process.step(&mut s.motion, heat);
        let before = core::mem::replace(&mut s.before, rises.y);
        s.steady.row(&s.flows, heat, &rises, before);
        s.history.push(heat, &s.motion);
        let offsets = [s.parameters.get(Parameter::Offset1), s.parameters.get(Parameter::Offset2)];
        s.expected = core::array::from_fn(|m| rises.y[m] + offsets[m] + s.mean[m]);
        self.follow_rises(s, believed, heating);
    }

    /// Follows an announced change of the fan, with its lag. What is known of such a change is its kind, hardly its size: for a while nothing is
    /// judged, and the state since training is taken anew from there.
    fn follow_fan(&self, s: &mut WatchState, fan: f32) -> bool {
        let left = fan - s.fan;
        if left.abs() < FAN_STEP {
            return false;
        }
        s.fan += left * s.pace.onset.fan.min(1.0);
        if (fan - s.fan).abs() < FAN_STEP {
            s.fan = fan;
        }
        s.process = Process::new(&s.parameters, s.fan);
        s.flows = [Process::new(&s.parameters, LESS * s.fan), Process::new(&s.parameters, MORE * s.fan)];
        s.tracker.widen([0.02, 0.3 * left.abs(), 0.0, 0.0]);
        s.steady.rebase();
        s.alarm = None;
        s.lasting = None;
        s.rest();
        s.settling = (FAN_SETTLES * s.pace.stretch / self.sample_time) as u32;
        true
    }

    /// Holds the measured rises against the expected ones.
    fn follow_rises(&self, s: &mut WatchState, believed: [Option<f32>; 2], heating: bool) {
        let rise = |m: usize| Some(Rise { measured: believed[m]?, expected: s.expected[m] });
        self.heat.step(&mut s.heat, [rise(0), rise(1)], heating);
    }

    /// One whole tick: residuals since training and what the tracker leaves of them, charts, both banks.
    fn judge(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        tick: u32,
        e: [f32; 2],
        row: &Row<LASTING>,
        now: &NowRises,
    ) {
        let known = s.tracker.expected(row);
        let left = [e[0] - known[0], e[1] - known[1]];
        let mut z = s.ladder.step(&mut s.past, left);
        let mut z_trained = s.steady.residual(&s.ladder, e);
        let whitened = s.steady.whitened(&s.ladder, row);
        if s.ticks < FIRST_TICKS {
            (z, z_trained) = ([0.0; 2], [0.0; 2]);
        }
        let widened = self.widened(s, s.expected[0]);
        let clipped = s.ladder.step_clipped(&mut s.past_clipped, left, CLIP);
        // T1 answers to the inlet sooner than T0 does: it is not charted by what the inlet does, but the bank sees all of it.
        let inlet = s.inlet.map_or(0.0, |(_, _, [_, above])| larger(0.0, above.abs() - INLET_NOISE));
        let allowed = [widened[0] + inlet * s.ladder.inv_sigma[0], widened[1]];
        let charted = self.chart(s, if s.ticks < FIRST_TICKS { [0.0; 2] } else { clipped }, allowed);
        self.follow_onset(s, g, z, widened, &charted, now);
        if s.alarm.is_none() {
            self.decide(s, g, tick, &charted, row);
        } else {
            self.follow_alarm(s, g, z, row, now.heat);
        }
        let settling = s.settling > 0;
        s.settling = s.settling.saturating_sub(1);
        if s.rests > 0 || settling {
            s.rests = s.rests.saturating_sub(1);
            s.fast = Default::default();
            s.slow = Sums::default();
        }
        let quiet = s.alarm.is_none();
        if quiet && s.lasting.is_none() {
            for (square, x) in s.wander.iter_mut().zip(s.tracker.x) {
                s.pace.wander.follow(square, x * x);
            }
        }
        if quiet && (settling || larger(charted.fast, charted.slow) < TRACK_BELOW) {
            s.tracker.step(&whitened, [bounded(z[0], -CLIP, CLIP), bounded(z[1], -CLIP, CLIP)]);
        }
        if quiet && s.rests == 0 && !settling && s.swing[1] < SWING && s.ticks > FIRST_TICKS {
            s.steady.gather(&s.pace.steady, row, &whitened, e, z_trained);
            self.judge_lasting(s, tick);
        }
    }

    /// By how many standard deviations the residuals may be off because the temperature moves.
    fn widened(&self, s: &mut WatchState, rise: f32) -> [f32; 2] {
        let [mean, swing] = &mut s.swing;
        s.pace.swing.follow(mean, rise);
        let kept = *swing * (1.0 - s.pace.swing.share());
        *swing = larger(kept, (rise - *mean).abs());
        let moved = self.model_uncertainty * larger(0.0, *swing - SWING);
        let away = self.model_uncertainty * (*mean - s.trained).abs();
        let rest = s.ladder.rest();
        core::array::from_fn(|m| (moved + away * rest[m]) * s.ladder.inv_sigma[m])
    }

    fn chart(&self, s: &mut WatchState, z: [f32; 2], widened: [f32; 2]) -> Charted {
        let mut fast = 0.0;
        for m in 0..2 {
            fast = larger(fast, self.fast.step(&mut s.fast[m], z[m], widened[m]));
        }
        let slow = self.slow.step(&mut s.slow, z[1], widened[1]);
        Charted { fast: fast / self.fast.interval, slow: slow / self.slow.interval }
    }

    /// Gathers since the onset, or begins anew while nothing stirs.
    fn follow_onset(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        z: [f32; 2],
        widened: [f32; 2],
        charted: &Charted,
        now: &NowRises,
    ) {
        if s.alarm.is_none() && charted.fast * self.fast.interval < NEAR && charted.slow < NEAR_SLOW {
            g.begin_anew();
            s.z_mean = [0.0; 2];
            s.candidate = 0.0;
            return;
        }
        if g.onset.age == 0 {
            s.stays = s.measured;
        }
        let mut weight = 1.0 / (1.0 + 0.25 * widened[0] * widened[0]);
        let mut jump: f32 = 0.0;
        for m in 0..2 {
            s.z_mean[m] += 0.3 * (z[m] - s.z_mean[m]);
            jump = larger(jump, (z[m] - s.z_mean[m]).abs());
        }
        let transient = if s.is_slow() { 1.0 } else { 1.0 + 0.1 * larger(0.0, jump - 3.0) };
        weight /= transient * transient;
        // A jump while a sag or the like already stirs: what sensors do begins here, what the process does goes on.
        let evidence = smaller(z[0] * z[0], 64.0) + smaller(z[1] * z[1], 64.0);
        if s.alarm.is_none() && g.onset.age > 0 && evidence > 16.0 && evidence > 4.0 * g.since.energy {
            g.since.forget(&SENSORS);
            g.onset.restart_sensors(now.before[0]);
            s.stays = s.measured;
        }
        let row = g.onset.step(&s.pace.onset, &s.ladder, &s.nominal(now));
        g.answer = row[Column::Power as usize];
        if let Some(alarm) = &s.alarm {
            if alarm.age > FORGETS_FROM {
                g.since.scale(s.pace.forgets);
            }
            g.window.scale(s.pace.window);
            g.window.add(&row, z, weight);
        }
        g.since.add(&row, z, weight);
    }

    /// Raises the alarm where a fault explains more than the nuisances do.
    fn decide(&self, s: &mut WatchState, g: &mut Gathered, tick: u32, charted: &Charted, row: &Row<LASTING>) {
        if larger(charted.fast, charted.slow) <= 1.0 || g.onset.age == 0 {
            return;
        }
        s.candidate += self.sample_time / s.pace.stretch;
        let (mut freed, left) = s.judge_since(g, self.inputs);
        let posterior = Posterior::new(&freed);
        let best = &HYPOTHESES[posterior.best % COUNT];
        let size = freed[posterior.best % COUNT].value.abs();
        let small = match best.class {
            FaultClass::HeaterPower => size < larger(self.least_power, UNUSUAL * sqrt(s.steps)),
            FaultClass::Drift => size < 1.0,
            FaultClass::AirFlow => size < LEAST_FLOW,
            _ => false,
        };
        if posterior.best_gain > RAISE && !small {
            let onset = tick.saturating_sub(g.onset.age.saturating_sub(1));
            g.window = g.since;
            let mut alarm = Alarm::new(onset);
            self.name(g, &mut alarm, &mut freed, left);
            s.alarm = Some(alarm);
        } else if s.candidate > TAKEN_AFTER {
            s.take_in(g, row);
        }
    }

    /// Names the fault while it lasts; clears the alarm when it has gone. A young alarm is ranked and asked for its end on every tick, an older one
    /// by turns.
    fn follow_alarm(&self, s: &mut WatchState, g: &mut Gathered, z: [f32; 2], row: &Row<LASTING>, heat: f32) {
        let Some(mut alarm) = s.alarm else { return };
        alarm.age += self.sample_time / s.pace.stretch;
        alarm.turn = !alarm.turn;
        let young = alarm.age < YOUNG;
        if young || alarm.turn {
            let (mut freed, left) = s.judge_since(g, self.inputs);
            self.name(g, &mut alarm, &mut freed, left);
        }
        let over = (young || !alarm.turn) && s.is_over(g, &alarm);
        s.alarm = Some(alarm);
        if let Some(change) = s.goes_at_once(&alarm, z, row) {
            s.goes_on_without(g, change);
        } else if let Some(change) = self.has_gone(s, g, &alarm, z, heat) {
            s.goes_on_without(g, change);
        } else if over || (alarm.age > PROCESS_TIME && alarm.gain < 1.0) {
            s.alarm = None;
            s.rest();
            g.begin_anew();
            s.rests = (s.pace.stretch / self.sample_time) as u32;
            s.tracker.widen([0.015, 0.0, 0.05, 0.05]);
        }
    }

    /// Whether the heater's power is right again. What it did lately the rig still has: the model goes on from there.
    fn has_gone(
        &self,
        s: &mut WatchState,
        g: &mut Gathered,
        alarm: &Alarm,
        z: [f32; 2],
        heat: f32,
    ) -> Option<[f32; 2]> {
        let of_power = HYPOTHESES[alarm.hypothesis % COUNT].first.direction == Direction::Of(Column::Power);
        if !of_power || !s.is_slow() || alarm.age < ASKED_FROM {
            g.gone = Gone::default();
            return None;
        }
        let theta = alarm.values[0];
        let longest = (s.pace.stretch / self.sample_time) as u32;
        if !g.gone.step((&s.process, &s.ladder), heat, [z, g.answer], theta, (KAPPA, longest)) {
            return None;
        }
        let before = s.process.rises(s.motion.m, s.motion.w).y;
        s.motion.add(&g.onset.power, theta);
        s.motion.add(&g.gone.power, -theta);
        let after = s.process.rises(s.motion.m, s.motion.w).y;
        g.gone = Gone::default();
        Some([after[0] - before[0], after[1] - before[1]])
    }

    /// Names the fault by a ranking of the hypotheses; `left` is what the nuisances leave of the residual sum of squares.
    fn name(&self, g: &Gathered, alarm: &mut Alarm, freed: &mut [Freed; COUNT], left: f32) {
        if alarm.age < PROCESS_TIME {
            for (freed, row) in freed.iter_mut().zip(&HYPOTHESES) {
                if row.class == FaultClass::Drift {
                    freed.gain = smaller(freed.gain, 0.0);
                }
            }
        }
        let posterior = Posterior::new(freed);
        let h = posterior.likeliest % COUNT;
        let Freed { gain, value, second, .. } = freed[h];
        (alarm.gain, alarm.hypothesis, alarm.values) = (posterior.best_gain, h, [value, second]);
        let least = if alarm.age < PROCESS_TIME { ALWAYS_BOTH } else { NAME_PROCESS };
        let (class, confidence) = named(&posterior, if self.inputs.fan { least } else { 0.0 });
        let unexplained = left - 2.0 * KAPPA * gain;
        let [most, most_share] = if alarm.strange { FITS } else { STRANGE };
        alarm.strange = alarm.age > UNKNOWN_AFTER
            && unexplained > most * larger(1.0, g.since.count)
            && unexplained > most_share * larger(1.0, g.since.energy);
        let magnitude = magnitude(h, class, &freed[h]);
        let finding = Finding { class, confidence, magnitude, onset: alarm.onset };
        if alarm.strange {
            let class = FaultClass::Unknown;
            alarm.finding = Some(Finding { class, confidence: 0.0, magnitude: None, ..finding });
        } else if confidence > self.naming || alarm.finding.is_some_and(|was| was.class == class) {
            alarm.finding = (confidence > self.naming - UNNAME).then_some(finding);
        }
    }

    /// The minute, against the trained state.
    fn judge_lasting(&self, s: &mut WatchState, tick: u32) {
        let first = 20.0 * s.pace.stretch / self.sample_time;
        if !s.steady.is_ready(first) {
            return;
        }
        let mut freed = [Freed::default(); COUNT];
        let nuisances = hypothesis::since_training(&s.wander);
        s.steady.judge(&nuisances, &mut freed, self.inputs);
        let posterior = Posterior::new(&freed);
        let h = posterior.likeliest % COUNT;
        let row = &HYPOTHESES[h];
        let sized = s.steady.size(&nuisances, h, self.inputs);
        let sized = if row.judged(sized).gain == IMPOSSIBLE { freed[h] } else { sized };
        let least = match row.class {
            FaultClass::HeaterPower => larger(LEAST_POWER, UNUSUAL * sqrt(s.wander[0])),
            FaultClass::AirFlow => larger(LEAST_FLOW, UNUSUAL * sqrt(s.wander[1])),
            FaultClass::T1Clogged => LEAST_GAIN,
            _ => LEAST_OFFSET,
        };
        let (factor, share) = if s.lasting.is_some() { (GOES_ON[0], GOES_ON[1]) } else { (1.0, 1.0) };
        let there = posterior.best_gain > factor * RAISE_SLOW && freed[h].value.abs() > share * least;
        let onset = s.lasting.map_or(tick, |was| was.onset);
        let least = if self.inputs.fan { NAME_LASTING } else { 0.0 };
        let (class, confidence) = named(&posterior, least);
        s.lasting = there.then(|| Lasting {
            onset,
            finding: (confidence > NAME_LASTING).then(|| Finding {
                class,
                confidence,
                magnitude: magnitude(h, class, &sized),
                onset,
            }),
        });
    }
}

/// What has changed since training: when that was seen, and what it is, once that can be told.
#[derive(Clone, Copy, Debug)]
struct Lasting {
    onset: u32,
    finding: Option<Finding>,
}

/// Power and rises of this tick, and the rises before.
struct NowRises {
    heat: f32,
    rises: super::process::Rises,
    before: [f32; 2],
}

/// The class that is likeliest, and how likely. Air flow and heater power are one until one of them is likely enough by itself.
fn named(posterior: &Posterior, least: f32) -> (FaultClass, f32) {
    let class = HYPOTHESES[posterior.likeliest % COUNT].class;
    let probability = posterior.of(posterior.likeliest);
    let [flow, power] = [FaultClass::AirFlow, FaultClass::HeaterPower].map(|class| posterior.of_class(class));
    let process = matches!(class, FaultClass::AirFlow | FaultClass::HeaterPower);
    if process && larger(flow, power) < least {
        return (FaultClass::AirFlowOrHeaterPower, smaller(CERTAIN, flow + power));
    }
    (class, smaller(CERTAIN, probability))
}

/// The size of a hypothesis in the unit of its class.
fn magnitude(h: usize, class: FaultClass, freed: &Freed) -> Option<Magnitude> {
    let Freed { value, variance, .. } = *freed;
    let with_error = |share: f32| sqrt(variance + share * share * value * value) * HALF_OF_95;
    let others = SIZE_ERROR[1];
    match class {
        FaultClass::AirFlowOrHeaterPower | FaultClass::Stuck(_) | FaultClass::Swapped(_) => None,
        FaultClass::HeaterPower if h == CONSTANT => None,
        FaultClass::AirFlow => {
            let inverse = larger(0.1, 1.0 + value);
            let half_width = 100.0 * with_error(SIZE_ERROR[0]) / (inverse * inverse);
            Some(Magnitude { value: in_unit(class, value), half_width })
        }
        FaultClass::HeaterPower | FaultClass::T1Clogged | FaultClass::T1Detached | FaultClass::T2Detached => {
            Some(Magnitude { value: in_unit(class, value), half_width: 100.0 * with_error(others) })
        }
        _ => Some(Magnitude { value, half_width: with_error(others) }),
    }
}

impl WatchState {
    /// The model as learnt on this tick.
    fn nominal(&self, now: &NowRises) -> Nominal<'_> {
        Nominal {
            parameters: &self.parameters,
            fan: self.fan,
            process: &self.process,
            motion: &self.motion,
            history: &self.history,
            heat: now.heat,
            rises: now.rises,
            before: now.before,
            inlet: self.inlet.map_or([0.0; 2], |(_, _, moved)| moved),
        }
    }

    /// Gains of all hypotheses since the onset.
    fn judge_since(&self, g: &Gathered, inputs: Inputs) -> ([Freed; COUNT], f32) {
        let nuisances = self.nuisances();
        let nuisances = Nuisances::new(&g.since, &nuisances, KAPPA).for_many();
        let mut freed = [Freed { gain: IMPOSSIBLE, ..Freed::default() }; COUNT];
        for (freed, row) in freed.iter_mut().zip(&HYPOTHESES).filter(|(_, row)| self.asks(inputs, row)) {
            let mut second = row.second;
            if let (Some(second), Some(m)) = (&mut second, row.stays) {
                second.mean = self.stays[m];
            }
            *freed = row.judged(nuisances.free(row.first, second));
        }
        (freed, g.since.energy - nuisances.explained)
    }

    /// Whether the nuisances alone explain one of the windows better than the fault as it was.
    fn is_over(&self, g: &Gathered, alarm: &Alarm) -> bool {
        let row = &HYPOTHESES[alarm.hypothesis % COUNT];
        let [value, second] = alarm.values;
        let first = (row.first.direction, value);
        let both = [first, row.second.map_or(first, |free| (free.direction, second))];
        let at = if row.second.is_some() { &both[..] } else { &both[..1] };
        let list = self.nuisances();
        alarm.age > ASKED_FROM && Nuisances::new(&g.window, &list, KAPPA).fixed(at) < -OVER
    }

    /// Whether a fault can be told here. What a controller holds looks stuck, or as if the heater gave always the same, where only slow answers
    /// would tell.
    fn asks(&self, inputs: Inputs, row: &Hypothesis) -> bool {
        let stands = matches!(row.class, FaultClass::Stuck(_))
            || row.first.direction == Direction::Of(Column::Constant);
        inputs.tell(row.class) && !(self.is_slow() && stands)
    }

    /// Whether the surroundings move so slowly that a constant residual says hardly anything.
    fn is_slow(&self) -> bool {
        self.ladder.rest()[0] < SLOW_NOISE
    }

    /// The alarm is over, and what it changed of the residuals with it.
    fn goes_on_without(&mut self, g: &mut Gathered, change: [f32; 2]) {
        self.past.lower(change);
        self.past_clipped.lower(change);
        self.alarm = None;
        self.rest();
        g.begin_anew();
        self.rests = FIRST_TICKS;
    }

    /// By how much T1 and T2 read other where all that this tick shows is that a thermistor reads right again. What follows shows hardly
    /// anything of it where the surroundings move as slowly as an offset does.
    fn goes_at_once(&self, alarm: &Alarm, z: [f32; 2], row: &Row<LASTING>) -> Option<[f32; 2]> {
        let hypothesis = &HYPOTHESES[alarm.hypothesis % COUNT];
        let Free { direction, .. } = hypothesis.first;
        let of_a_sensor = hypothesis.second.is_none() && hypothesis.class.sensor().is_some();
        if !of_a_sensor || !self.is_slow() {
            return None;
        }
        let mut change = [0.0; 2];
        for (column, weight) in direction.columns().into_iter().zip(direction.weights()) {
            for (change, value) in change.iter_mut().zip(row[column % LASTING]) {
                *change += weight * value * alarm.values[0];
            }
        }
        let explained = |m: usize| {
            let left = z[m] + change[m] * self.ladder.inv_sigma[m];
            (z[m] * z[m] - left * left) / (2.0 * KAPPA)
        };
        (explained(0) + explained(1) > GOES).then_some(change)
    }

    /// Nuisances explain what the charts say: the tracker takes them.
    fn take_in(&mut self, g: &mut Gathered, row: &Row<LASTING>) {
        let before = self.tracker.expected(row);
        let nuisances = self.nuisances();
        let nuisances = Nuisances::new(&g.since, &nuisances, KAPPA);
        let [power, less, more, offset1, offset2, offset0, ..] = nuisances.values();
        self.steps += STEP_SHARE * (power * power - self.steps);
        self.steps = larger(hypothesis::POWER_SD * hypothesis::POWER_SD, self.steps);
        let by = [power, less + more, offset1 - offset0, offset2 - offset0];
        for (x, by) in self.tracker.x.iter_mut().zip(by) {
            *x += by;
        }
        self.tracker.widen([0.01, 0.0, 0.1, 0.1]);
        let after = self.tracker.expected(row);
        let change = [after[0] - before[0], after[1] - before[1]];
        self.past.lower(change);
        self.past_clipped.lower(change);
        self.rest();
        g.begin_anew();
    }

    /// Charts and bank as if nothing had happened.
    fn rest(&mut self) {
        self.fast = Default::default();
        self.slow = Sums::default();
        self.candidate = 0.0;
    }

    /// What is reported: what began at an onset first, then what lasts.
    fn reported(&self, heat: &Heat, tick: u32) -> ModelAlarm {
        let finding = match (&self.alarm, self.lasting) {
            (Some(Alarm { finding: Some(finding), .. }), _) => *finding,
            (_, Some(Lasting { finding: Some(finding), .. })) => finding,
            (Some(_), _) | (_, Some(_)) => return ModelAlarm::Unnamed,
            (None, None) => return ModelAlarm::Quiet,
        };
        heat.review(&self.heat, finding, tick)
    }

    /// The virtual T1: its rise over the ambient on the next tick by the models and T2, degC; None where they disagree, or T1 and T2 do.
    pub(super) fn virtual_t1(&self) -> Option<f32> {
        if self.contradict {
            return None;
        }
        self.heat.virtual_t1(self.expected[0])
    }

    /// Air flow, % of that at which the rig was learnt: an announced level of the fan is what the model expects, not what is enough.
    pub(super) fn air_flow(&self) -> Option<f32> {
        Some(self.fan * self.heat.air_flow()?)
    }

    /// Whether the rig has been hot without power for too long.
    pub(super) fn heater_stuck_on(&self) -> bool {
        self.heat.heater_stuck_on()
    }

    /// The columns of the last tick since an onset that is assumed; none before enough is remembered.
    pub(super) fn columns(&self, onset: &mut Onset) -> Option<Row> {
        let [(heat, rises), (_, before)] = [0, 1].map(|ago| self.history.at(&self.process, ago));
        let nominal = Nominal {
            parameters: &self.parameters,
            fan: self.fan,
            process: &self.process,
            motion: &self.motion,
            history: &self.history.before(),
            heat,
            rises,
            before: before.y,
            inlet: self.inlet.map_or([0.0; 2], |(_, _, moved)| moved),
        };
        (self.ticks as usize > REMEMBERED).then(|| onset.step(&self.pace.onset, &self.ladder, &nominal))
    }

    /// What may move since an onset without being a fault, as far as is known now.
    pub(super) fn nuisances(&self) -> [Nuisance; SINCE_ONSET.len()] {
        let shift = if self.is_slow() { VAGUE_SHIFT } else { hypothesis::SHIFT };
        hypothesis::since_onset(self.steps, shift)
    }

    /// Rises of the model on the last tick, degC.
    pub(super) fn rises(&self) -> [f32; 2] {
        self.before
    }

    /// What T1 and T2 should be above the ambient now, degC.
    pub(super) fn expected(&self) -> [f32; 2] {
        self.expected.map(|rise| rise + self.beside.added())
    }
}

#[cfg(test)]
mod tests;
