//! How a rig was when somebody began to look at it: nobody knows whether it was at rest. The model begins at rest, with the power of then; what T1 and T2
//! read beyond it for a while is a sum of ways in which the rig forgets how it began, each of an unknown size.
//!
//! ```text
//! e = sum of theta_i phi_i + noise,      theta = (Phi' Phi + D^-1)^-1 Phi' e       e, Phi whitened
//! ```
//!
//! The ways are the model's own without power, from a unit of heat in the heater, in the thermistors, in the wall and in the heater beside. The last is a
//! room that is warmer than the one in which the rig was learnt.

use super::Likelihood;
use super::LikelihoodState;
use super::cholesky::Cholesky;
use super::inputs::Inputs;
use super::process::{Motion, Process};
use super::second_heater::SecondHeater;
use super::whitening::{Past, WhiteningFilter};
use super::work::Work;
use crate::bounds::{larger, smaller};
use crate::vector::dot;

/// Heat; by how much m and w of T1 are above that, and its room; the same of T2 or, without it, the heat of the heater beside, and by how much its
/// lag is above that.
const COUNT: usize = 7;
/// Standard deviations of what is unknown, % of power and degC: heat and wall of a rig that is as the model has it, of one that was about at rest, and of
/// one that was anyhow. What is likeliest by what was seen is believed. And of a room that is another than that of the learning.
const KINDS: [[f32; 2]; 3] = [[0.0, 0.0], [3.0, 3.0], [50.0, 15.0]];
const ROOM_SD: f32 = 2.0;
/// Twice as many samples as unknowns: fewer are explained by almost any state.
const SURE: usize = 2 * COUNT;
/// So many residuals say what those that follow are expected to be, and nothing else.
const UNHEARD: u32 = 3;

/// Is all as trained, from another state than that of the model?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Nothing yet.
    Open,
    /// Something is wrong still, or was when this began.
    No,
    /// All is as trained.
    Yes,
}

/// What is known so far of how the rig began.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    process: Process,
    whitening: WhiteningFilter,
    inputs: Inputs,
    room_sd: f32,
    /// The rig may be as the model has it.
    may_be_known: bool,
    /// What is left of a unit of heat everywhere; of one in m, as m and w; of one in w; and of one in the heater beside, and in its lag.
    heat: Motion,
    lag: [f32; 2],
    lag_wall: [f32; 2],
    wall: f32,
    beside: [SecondHeater; 2],
    information: [[f32; COUNT]; COUNT],
    score: [f32; COUNT],
    past: Past,
    pasts: [Past; COUNT],
    /// Samples that were heard, and that are wanted.
    heard: u32,
    wanted: u32,
    begun: bool,
    /// Sum of the squares of the innovations that were heard.
    energy: f32,
}

/// What it was, as found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun {
    /// To be added to what moves, to both heaters beside and to the means of the residuals.
    pub(super) motion: Motion,
    pub(super) beside: SecondHeater,
    pub(super) room: [f32; 2],
}

impl Start {
    /// Of a rig whose model begins at rest with the next tick.
    pub(super) fn new(
        process: Process,
        whitening: WhiteningFilter,
        beside: SecondHeater,
        inputs: Inputs,
        wanted: u32,
    ) -> Self {
        let heat = Motion::steady(1.0);
        Self {
            process,
            whitening,
            inputs,
            room_sd: ROOM_SD,
            may_be_known: false,
            heat,
            lag: [1.0; 2],
            lag_wall: [0.0; 2],
            wall: 1.0,
            beside: [beside.free(1.0, 1.0), beside.free(0.0, 1.0)],
            information: [[0.0; COUNT]; COUNT],
            score: [0.0; COUNT],
            past: Past::default(),
            pasts: [Past::default(); COUNT],
            heard: 0,
            wanted,
            begun: false,
            energy: 0.0,
        }
    }

    /// A tick: what T1 and T2 read beyond the model, degC. Says whether it is enough.
    pub(crate) fn step(&mut self, e: [Option<f32>; 2]) -> bool {
        if core::mem::replace(&mut self.begun, true) {
            let p = &self.process;
            p.step(&mut self.heat, 0.0);
            for i in 0..2 {
                self.lag[i] -= p.lag[i] * self.lag[i];
                self.lag_wall[i] += p.wall * (self.lag[i] - self.lag_wall[i]);
            }
            self.wall -= p.wall * self.wall;
            self.beside.iter_mut().for_each(|beside| _ = beside.step(0.0));
        }
        let by_heat = self.process.rises(self.heat.m, self.heat.w).y;
        let by_lag = self.process.rises(self.lag, self.lag_wall).y;
        let by_wall = self.process.rises([0.0; 2], [self.wall; 2]).y;
        let (e1, e2) = match (e, self.inputs.t2) {
            ([Some(e1), Some(e2)], true) => (e1, e2),
            ([Some(e1), _], false) => (e1, 0.0),
            _ => return false,
        };
        let [b1, b2] = self.beside.map(|beside| beside.added());
        let room = 1.0;
        let others = if self.inputs.t2 {
            [[0.0, by_lag[1]], [0.0, by_wall[1]], [0.0, room]]
        } else {
            [[b1, 0.0], [b2, 0.0], [0.0; 2]]
        };
        let [o1, o2, o3] = others;
        let phi = [by_heat, [by_lag[0], 0.0], [by_wall[0], 0.0], [room, 0.0], o1, o2, o3];
        let z = self.whitening.step(&mut self.past, [e1, e2]);
        let mut whitened = [[0.0; 2]; COUNT];
        for ((whitened, phi), past) in whitened.iter_mut().zip(phi).zip(&mut self.pasts) {
            *whitened = self.whitening.step(past, phi);
        }
        self.heard = self.heard.saturating_add(1);
        if self.heard > UNHEARD {
            self.energy += z[0] * z[0] + z[1] * z[1];
            for (row, (score, a)) in self.information.iter_mut().zip(self.score.iter_mut().zip(whitened)) {
                *score += a[0] * z[0] + a[1] * z[1];
                row.iter_mut().zip(whitened).for_each(|(sum, b)| *sum += a[0] * b[0] + a[1] * b[1]);
            }
        }
        self.heard >= self.wanted
    }

    /// How many samples count.
    pub(crate) fn counted(&self) -> u32 {
        self.heard.saturating_sub(UNHEARD)
    }

    /// The unknowns, where heat and wall are unknown by so much, and the logarithm of how likely what was seen is then.
    fn solved(&self, [heat, wall]: [f32; 2], room: f32) -> ([f32; COUNT], f32) {
        let sd = [heat, heat, wall, room, heat, wall, room];
        let mut matrix = self.information;
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x *= sd[i] * sd[j];
            }
            row[i] += 1.0;
        }
        let score: [f32; COUNT] = core::array::from_fn(|i| self.score[i] * sd[i]);
        let (factor, mut theta) = (Cholesky::new(matrix), score);
        factor.forward(&mut theta);
        factor.backward(&mut theta);
        let evidence = 0.5 * (dot(&score, &theta) - factor.log_determinant());
        (core::array::from_fn(|i| theta[i] * sd[i]), evidence)
    }

    /// The unknowns of the likeliest kind of rig, and its evidence.
    fn likeliest(&self) -> ([f32; COUNT], f32) {
        let [known, rested, anyhow] = KINDS.map(|sd| self.solved(sd, self.room_sd));
        let likelier = if anyhow.1 > rested.1 { anyhow } else { rested };
        if self.may_be_known && known.1 > likelier.1 { known } else { likelier }
    }

    /// Whether all is as trained from some state on; an alarm leaves `left` of the squares of the innovations that count.
    pub(crate) fn answer(&self, left: f32) -> Answer {
        let t = &self.process.tuning;
        let (theta, evidence) = self.likeliest();
        // What the unknowns at their best leave of each innovation's square.
        let mut leaves = self.energy - 2.0 * dot(&theta, &self.score);
        for (row, a) in self.information.iter().zip(theta) {
            leaves += a * dot(row, &theta);
        }
        let channels = if self.inputs.t2 { 2.0 } else { 1.0 };
        leaves /= channels * larger(1.0, self.counted() as f32);
        // What else it may be: what the alarm says or, whatever that is, a thermistor that reads wrong all the time.
        let goes_on = (evidence - 0.5 * (self.energy - left)) / t.alarm.kappa;
        let (_, offset) = self.solved(KINDS[0], t.hypotheses.offset_sd);
        let no_offset = (evidence - offset) / t.alarm.kappa;
        let sure = self.counted() as usize >= SURE;
        let refuted = sure && smaller(goes_on, no_offset) < -t.alarm.over;
        if refuted || leaves > t.naming.strange || self.heard > self.wanted {
            Answer::No
        } else if sure && goes_on > t.alarm.over && no_offset > 0.0 && leaves < t.naming.fits {
            Answer::Yes
        } else {
            Answer::Open
        }
    }

    /// What the rig has of it now that the model has not.
    pub(super) fn begun(&self) -> Begun {
        let ([heat, m1, w1, c1, m2, w2, c2], _) = self.likeliest();
        let mut motion = Motion::default();
        motion.add(&self.heat, heat);
        let of_t2 = if self.inputs.t2 { [m2, w2, c2] } else { [m1, w1, c1] };
        for (i, [m, w, _]) in [[m1, w1, c1], of_t2].into_iter().enumerate() {
            motion.m[i] += m * self.lag[i];
            motion.w[i] += m * self.lag_wall[i] + w * self.wall;
        }
        let mut beside = SecondHeater::default();
        if !self.inputs.t2 {
            beside.add(&self.beside[0], m2);
            beside.add(&self.beside[1], w2);
        }
        Begun { motion, beside, room: [c1, of_t2[2]] }
    }
}

impl Likelihood {
    /// What has to be found of a rig with which the model has just begun anew; none where nothing was learnt.
    /// `same_room` says that the room is that of the learning, also where T0 is missing. What a thermistor reads wrong in it is not told from what is left
    /// of the heat until that has gone, and stays for good: there the rig is looked at for longer.
    pub(crate) fn start(&self, state: &LikelihoodState, same_room: bool) -> Option<Start> {
        let start = self.watch.begins(state.trained.as_ref()?, same_room);
        let known = same_room || self.inputs.t0;
        Some(Start { room_sd: if known { self.tuning.nuisances.onset_offset } else { ROOM_SD }, ..start })
    }

    /// The same while an alarm stands: the rig may be as the model has it, and the room is as far from that of the learning as a nuisance may be.
    pub(crate) fn start_anew(&self, state: &LikelihoodState) -> Option<Start> {
        let start = self.watch.begins(state.trained.as_ref()?, false);
        Some(Start { room_sd: self.tuning.nuisances.onset_offset, may_be_known: true, ..start })
    }

    /// What the alarm of the models leaves of the squares of this tick's innovations, if it has any; none without an alarm that is asked.
    pub(crate) fn left_by_alarm(&self, state: &LikelihoodState) -> Option<Option<f32>> {
        match &state.work {
            Work::Watching(onset) => onset.left_by_alarm(),
            _ => None,
        }
    }

    /// All is as trained since the `start`, from another state: what alarm stands is over.
    pub(crate) fn end_by(&self, state: &mut LikelihoodState, start: &Start) {
        let _ = self.end_in(state, &start.begun());
    }

    /// Takes over how the rig began: it is watched from now on.
    pub(crate) fn settle(&self, state: &mut LikelihoodState, start: &Start) {
        if let Some(trained) = &mut state.trained {
            self.watch.settle(trained, &start.begun());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::process::Parameters;
    use super::*;

    /// A rig that began with any heat, lag and wall, in a room that is warmer: after some samples the model reads what it does, and goes on to.
    #[test]
    fn how_a_rig_began_is_found() {
        let parameters = Parameters([-0.7, 3.4, 2.3, 1.6, 0.08, 0.9, 1.3, 2.0, 0.03, 6.0, 0.0, 0.0, 0.0]);
        let process = Process::new(Default::default(), &parameters, 1.0);
        for t2 in [false, true] {
            let inputs = Inputs { t0: false, t2, ..Inputs::ALL };
            let beside = SecondHeater::steady(&parameters, 0.0);
            let mut truth = Motion::steady(30.0);
            (truth.m, truth.w) = ([-15.0, -10.0], [5.0, 8.0]);
            let mut warm = beside.free(10.0, -20.0);
            let room = [1.5, if t2 { 1.2 } else { 1.5 }];
            let mut whitening = WhiteningFilter::default();
            whitening.inv_sigma = [20.0; 2];
            let mut start = Start::new(process, whitening, beside, inputs, 100);
            let mut model: Option<Begun> = None;
            for k in 0..400 {
                if k > 0 {
                    process.step(&mut truth, 0.0);
                    warm.step(0.0);
                }
                let added = if t2 { 0.0 } else { warm.added() };
                let rises = process.rises(truth.m, truth.w).y;
                let reads: [f32; 2] = core::array::from_fn(|i| rises[i] + room[i] + added);
                if let Some(begun) = &mut model {
                    process.step(&mut begun.motion, 0.0);
                    begun.beside.step(0.0);
                    let rises = process.rises(begun.motion.m, begun.motion.w).y;
                    let expected = rises[0] + begun.room[0] + begun.beside.added();
                    assert!((reads[0] - expected).abs() < 0.3, "{t2} {k}: {} {expected}", reads[0]);
                } else if start.step(reads.map(Some)) {
                    let begun = start.begun();
                    let mut warm = beside.free(0.0, 0.0);
                    warm.add(&begun.beside, 1.0);
                    model = Some(Begun { beside: warm, ..begun });
                }
            }
            assert!(model.is_some());
        }
    }

    /// What T1 reads beyond a model of 30 and 5 ticks with noise of 0.05 degC, and what an alarm leaves of each sample: what is answered in the end.
    fn answered(beyond: impl Fn(f32) -> f32, left: f32) -> Answer {
        let parameters = Parameters([-0.7, 3.4, 2.3, 1.6, 0.0, 0.9, 1.3, 2.0, 0.0, 6.0, 0.0, 0.0, 0.0]);
        let process = Process::new(Default::default(), &parameters, 1.0);
        let mut whitening = WhiteningFilter::default();
        whitening.inv_sigma = [20.0, 0.0];
        let (beside, inputs) = (SecondHeater::default(), Inputs { t0: false, t2: false, ..Inputs::ALL });
        let mut start = Start::new(process, whitening, beside, inputs, 60);
        (start.room_sd, start.may_be_known) = (0.08, true);
        let mut seen = 0.0;
        for k in 0..60_u16 {
            let noise = 0.05 * (f32::from(k * 37 % 64) / 32.0 - 1.0);
            start.step([Some(beyond(f32::from(k)) + noise), None]);
            seen += if start.counted() > 0 { left } else { 0.0 };
            let answer = start.answer(seen);
            if answer != Answer::Open {
                return answer;
            }
        }
        Answer::Open
    }

    /// Heat that is left goes as the rig forgets it. What T1 reads wrong stays, and an alarm that expects all that is seen has nothing against it.
    #[test]
    fn what_is_left_of_something_is_no_fault() {
        let forgotten = |k: f32| -4.0 * libm::expf(-k / 30.0);
        assert_eq!(answered(forgotten, 1000.0), Answer::Yes, "heat was lost");
        assert_eq!(answered(|_| 0.0, 1000.0), Answer::Yes, "nothing is left");
        assert_ne!(answered(forgotten, 1.0), Answer::Yes, "the alarm expects just that");
        assert_ne!(answered(|_| -0.7, 1000.0), Answer::Yes, "T1 reads wrong");
        assert_ne!(
            answered(|k| -4.0 * (1.0 - libm::expf(-k / 30.0)), 1.0),
            Answer::Yes,
            "heat is being lost"
        );
    }
}
