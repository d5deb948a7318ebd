//! Training on all samples at once: an output-error fit of the model of `fdi_core`, with how each stretch began free (L. Ljung, *System
//! Identification*, 2nd ed., 1999, chapter 7). A board keeps no samples and learns in one pass; a recording lies on a disk.

mod normal;
mod plant;
mod prepared;
mod search;
pub mod stretches;

use fdi_core::likelihood::Likelihood;
use fdi_core::likelihood::Parameter::{
    self, Curvature, Delay1, Delay2, Gain, Heater, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall1, Wall2,
    WallTime,
};
use fdi_core::likelihood::inputs::Inputs;
use fdi_core::{Celsius, Config, Observed, Seconds, Units};

pub use plant::Theta;
use plant::{PARAMETERS, Pairs, Plant};
use prepared::Prepared;
use search::{Point, Search};

/// Answer times from which it is looked for, samples; as long as there are so many of them.
const FIRST_ANSWER: f64 = 10.0;
const LONGER: f64 = 2.0;
const LEAST_ANSWERS: f64 = 2.0;
/// Steps from each of them, and from the best.
const STEPS: usize = 8;
const MOST_STEPS: usize = 25;
/// Steps over all rows together, so that many rows take no longer; and the least of them.
const STEPS_OF_ALL: usize = 400_000;
const LEAST_STEPS: usize = 3;
/// Of more rows than this means are asked first.
const FEW: usize = 6000;
/// Dead time and about four time constants are so many times what the heat takes to arrive.
pub const ANSWER: f64 = 4.4;
/// The spread of the residuals that is assumed first, as a share of that of T1.
const ASSUMED: f64 = 0.1;
/// Twice the logarithm of the likelihood ratio from which on there is a wall, since what drifts looks like one. Measured on made records (docs/evidence/records.md):
/// of 96 heaters with a wall 8 have less, of 48 incubators without one 1 has more, in a room that wanders; from 40 to 60 nothing changes.
const WORTH_A_WALL: f64 = 50.0;
/// A wall is looked for from two starts. One is small and slow, as that of a tube. The other is a second mass, such as the glass on a heated bed: with about
/// half of the heat (mean and standard deviation of its share), and as slow as the heater was without it. Chosen.
const SECOND_MASS: (f64, f64) = (0.5, 0.2);
/// The largest share of a second mass. Measured: with 0.63, the largest of a tube's wall, the fits of beds and ovens end at it.
const MOST_MASS: f64 = 0.9;
/// By how much the heater is faster beside a second mass. Measured: from 4 and from 8 the same masses are found, that of one oven that radiates from 8 alone.
const FASTER: f64 = 8.0;
const NO_WALL: (f64, f64) = (0.0, 0.0);
/// No room is further from what is told of it, standard deviations.
const FAR: f64 = 20.0;
/// A wall that is slower than this share of all there is shows nothing but a drift. (With half of it the gain of printers that were heated once came out a fifth too low.)
const LONGEST_WALL: f64 = 1.0;
/// What the diagnosis remembers of the air, as a share of its ticks: see `longest_delay` of the tuning.
const LONGEST_DELAY: f64 = 43.0;

/// What is fitted.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The samples.
    pub samples: &'a [Observed],
    /// What is measured.
    pub inputs: Inputs,
    /// What its units are.
    pub units: Units,
    /// The settings.
    pub config: &'a Config,
    /// About how many degC there are for a %.
    pub usual: f64,
    /// What T1 reads without power where there is no T0, degC: mean and standard deviation; none: anything.
    pub room: Option<(f64, f64)>,
    /// Means of so many samples are fitted.
    pub every: usize,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The parameters, times in ticks of `every` samples.
    pub theta: Theta,
    /// Their standard deviations; 0 of what was not looked for.
    pub sd: Theta,
    /// What they would be by the samples alone, as shares of those of the priors; 0 of what was not looked for.
    pub known: Theta,
    /// Standard deviation of the logarithm of the gain of the heater beside.
    pub sd_beside: f64,
    /// The T1 over which rises count where there is no T0, degC.
    pub base: f64,
    /// Residuals and rises of T1 and T2, degC, of each sample that has them.
    pub left: Vec<([f32; 2], [f32; 2])>,
    /// Which sample each of them is of, or the first of those of which it is a mean.
    pub places: Vec<usize>,
    /// By how many standard deviations the room is off what was told of it; 0 where nothing was.
    pub room_off: f64,
    /// How much of T1 the model explains, %.
    pub fit: f64,
    /// How many stretches there were.
    pub stretches: usize,
}

impl Question<'_> {
    /// The parameters that explain the samples best; `near` is where they are looked for, none: anywhere.
    pub fn fit(&self, near: Option<&Theta>) -> Option<Found> {
        let prepared = self.prepared();
        let rows: usize = prepared.stretches.iter().map(Vec::len).sum();
        let spread = prepared.spread()?;
        let most = (STEPS_OF_ALL / rows.max(1)).clamp(LEAST_STEPS, MOST_STEPS);
        let tuning = &self.config.tuning;
        let plant = Plant { t2: self.inputs.t2, model: &tuning.model };
        let search = |answer: f64| {
            let (prior, mut range) = self.limits(answer, rows, prepared.beside, prepared.base);
            [Wall1, Wall2, WallTime].into_iter().for_each(|which| range[which as usize] = NO_WALL);
            Search {
                plant,
                stretches: &prepared.stretches,
                prior,
                range,
                t0: self.inputs.t0,
                beside: prepared.beside,
                sigma: [ASSUMED * spread; 2],
                kappa: [1.0; 2],
            }
        };
        let tried = self.begins(near, rows).into_iter().map(|(answer, near)| {
            let search = search(answer);
            let theta = near.unwrap_or(search.prior.map(|(mean, _)| mean));
            let theta = std::array::from_fn(|i| theta[i].clamp(search.range[i].0, search.range[i].1));
            let point = search.descend(search.begin(theta), most.min(STEPS));
            (search, point)
        });
        let (mut search, mut point) = tried.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost))?;
        search.settle(&mut point, most);
        if near.is_none_or(|near| near[Wall1 as usize] != 0.0) {
            let least = if near.is_none() { WORTH_A_WALL } else { 0.0 };
            let tried = [1.0, FASTER].map(|faster| {
                let (mut walled, begin) = self.with_wall(&search, &point, faster, (rows, prepared.base));
                let mut other = walled.descend(begin, most);
                walled.settle(&mut other, most);
                (search.explains_more(&point, &other), walled, other)
            });
            let best = tried.into_iter().max_by(|(a, ..), (b, ..)| a.total_cmp(b));
            if let Some((_, walled, other)) = best.filter(|(worth, ..)| *worth > least) {
                (search, point) = (walled, other);
            }
        }
        Some(self.found(&search, &point, &prepared))
    }

    /// The same search with a wall, and where it begins. It is a second mass where the heater is `faster` than without one.
    fn with_wall<'a>(
        &self,
        search: &Search<'a>,
        point: &Point,
        faster: f64,
        (rows, base): (usize, f64),
    ) -> (Search<'a>, Point) {
        let mut theta = point.theta;
        let (wall, heater) = (WallTime as usize, Heater as usize);
        theta[heater] -= faster.ln();
        let (mut prior, mut range) = self.limits(ANSWER * residence(&theta), rows, search.beside, base);
        if faster > 1.0 {
            prior[Wall1 as usize] = SECOND_MASS;
            range[Wall1 as usize].1 = MOST_MASS;
            prior[wall].0 = point.theta[heater];
            range[wall].0 = residence(&theta).ln();
        }
        for which in [Wall1, Wall2, WallTime].map(|which| which as usize) {
            theta[which] = prior[which].0;
        }
        let theta = std::array::from_fn(|i| theta[i].clamp(range[i].0, range[i].1));
        let walled = Search { prior, range, ..search.clone() };
        let begin = walled.judged(theta, point.starts.clone());
        (walled, begin)
    }

    /// Where the search begins, of `rows` rows: answer times in samples, and parameters where a fit is near.
    fn begins(&self, near: Option<&Theta>, rows: usize) -> Vec<(f64, Option<Theta>)> {
        let close = |theta: Theta| (ANSWER * residence(&theta), Some(theta));
        if let Some(theta) = near {
            return vec![close(*theta)];
        }
        if rows <= FEW {
            let longer = std::iter::successors(Some(FIRST_ANSWER), |answer| Some(LONGER * answer));
            let answers = longer.take_while(|answer| rows as f64 > LEAST_ANSWERS * answer);
            return answers.map(|answer| (answer, None)).collect();
        }
        // Of many samples means say where to look, or the first, where the rig is faster than that.
        let every = rows.div_ceil(FEW);
        let means = Question { every: every * self.every, ..*self };
        let means = means.fit(None).map(|found| in_ticks_of(1.0 / every as f64, &found.theta));
        let first = &self.samples[..(FEW * self.every).min(self.samples.len())];
        let first = Question { samples: first, ..*self }.fit(None).map(|found| found.theta);
        means.into_iter().chain(first).map(close).collect()
    }

    fn found(&self, search: &Search, point: &Point, prepared: &Prepared) -> Found {
        let (mut left, mut places, mut squares, mut ys) = (Vec::new(), Vec::new(), 0.0, Vec::new());
        let parts = search.stretches.iter().zip(search.residuals(point)).zip(&prepared.begins);
        for ((stretch, residuals), begin) in parts {
            for (i, (row, e)) in stretch.iter().zip(residuals).enumerate() {
                if e[0].is_finite() {
                    squares += e[0] * e[0];
                    ys.push(row.y[0]);
                }
                let (e, y) = if self.inputs.t2 { (e, row.y) } else { ([e[0]; 2], [row.y[0]; 2]) };
                if e.iter().all(|e| e.is_finite()) {
                    left.push((e.map(|e| e as f32), y.map(|y| y as f32)));
                    places.push(begin + i * self.every);
                }
            }
        }
        let mean = ys.iter().sum::<f64>() / ys.len() as f64;
        let all: f64 = ys.iter().map(|y| (y - mean).powi(2)).sum();
        let [covariance, alone] = search.covariances(point);
        let deviations = |of: &[[f64; PARAMETERS]; PARAMETERS]| -> Theta {
            std::array::from_fn(|i| if search.moves(i) { of[i][i].sqrt() } else { 0.0 })
        };
        let (known, by_all) = (deviations(&alone), deviations(&covariance));
        let sd = |which: Parameter| search.prior[which as usize].1;
        // Its gain is K b: ln K + ln b, to first order.
        let beside =
            [(Gain, sd(Gain)), (Reaches2, sd(Reaches2) / point.theta[Reaches2 as usize].abs().max(1e-6))];
        let pairs = beside.iter().flat_map(|a| beside.iter().map(move |b| (a, b)));
        let variance: f64 = pairs.map(|((i, a), (j, b))| a * b * covariance[*i as usize][*j as usize]).sum();
        Found {
            theta: point.theta,
            sd: std::array::from_fn(|i| by_all[i] * search.prior[i].1),
            known,
            sd_beside: variance.max(0.0).sqrt(),
            base: prepared.base,
            left,
            places,
            room_off: self
                .room(prepared.base)
                .map_or(0.0, |(mean, sd)| (point.theta[Offset1 as usize] - mean) / sd),
            fit: 100.0 * (1.0 - (squares / all).sqrt()),
            stretches: search.stretches.len(),
        }
    }

    /// What is told of the room, as a rise over this T1.
    fn room(&self, base: f64) -> Option<(f64, f64)> {
        self.room.filter(|_| !self.inputs.t0).map(|(mean, sd)| (mean - base, sd))
    }

    /// Priors and ranges of a rig that answers within `answer` ticks.
    fn limits(&self, answer: f64, rows: usize, beside: bool, base: f64) -> (Pairs, Pairs) {
        let mut config = self.config.clone();
        config.identification.answer_time = Seconds(answer as f32);
        config.identification.y_scale =
            Celsius((self.usual * f64::from(config.identification.u_scale.0)) as f32);
        let likelihood =
            Likelihood::new(&config.likelihood, config.tuning, &config.identification, Seconds(1.0))
                .map(|likelihood| likelihood.with(self.inputs));
        let pairs = |pairs: [(f32, f32); PARAMETERS]| pairs.map(|(a, b)| (f64::from(a), f64::from(b)));
        let (mut prior, usual) = match &likelihood {
            Ok(likelihood) => (pairs(likelihood.priors()), pairs(likelihood.ranges())),
            Err(_) => ([(0.0, 1.0); PARAMETERS], [(0.0, 0.0); PARAMETERS]),
        };
        let mut range = [(0.0, 0.0); PARAMETERS];
        let mut put = |which: Parameter, within: (f64, f64)| range[which as usize] = within;
        let usual = |which: Parameter| usual[which as usize];
        let longest = (4.0 * rows as f64).ln();
        let delay = if self.inputs.t2 { LONGEST_DELAY / 2.0 } else { LONGEST_DELAY };
        for which in [Gain, Wall1, Offset1, Curvature] {
            put(which, usual(which));
        }
        if let Some((mean, sd)) = self.room(base) {
            prior[Offset1 as usize] = (mean, sd);
            put(Offset1, (mean - FAR * sd, mean + FAR * sd));
        }
        put(Heater, (usual(Heater).0, longest));
        put(Delay1, (0.0, delay));
        put(Lag1, (usual(Lag1).0, longest));
        let wall = (60.0 * answer).min(LONGEST_WALL * rows as f64).max(2.0 * answer);
        put(WallTime, (answer.ln(), wall.ln()));
        if self.inputs.t2 || beside {
            put(Reaches2, usual(Reaches2));
            put(Lag2, (usual(Lag2).0, longest));
        }
        if self.inputs.t2 {
            put(Delay2, (0.0, delay));
            put(Wall2, usual(Wall2));
            put(Offset2, usual(Offset2));
        }
        (prior, range)
    }
}

/// Ticks that it takes for the heat to arrive at T1.
pub fn residence(theta: &Theta) -> f64 {
    theta[Heater as usize].exp() + theta[Lag1 as usize].exp() + theta[Delay1 as usize]
}

/// The same parameters in ticks of so many.
pub fn in_ticks_of(every: f64, theta: &Theta) -> Theta {
    let mut theta = *theta;
    for which in [Heater, Lag1, Lag2, WallTime] {
        theta[which as usize] -= every.ln();
    }
    for which in [Delay1, Delay2] {
        theta[which as usize] /= every;
    }
    theta
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heater of two lags, 0.4 degC a %, a dead time of 3 samples; its power changes now and then.
    struct Rig {
        k: u32,
        x: f64,
        m: f64,
        past: [f64; 3],
        power: f64,
    }

    impl Rig {
        fn begun(x: f64, m: f64) -> Self {
            Self { k: 0, x, m, past: [x; 3], power: 40.0 }
        }

        fn random(&self, of: u32) -> f64 {
            f64::from(self.k.wrapping_mul(0x9E37_79B9).wrapping_add(of).wrapping_mul(0x85EB_CA6B) >> 8)
                / f64::from(1 << 24)
                - 0.5
        }

        /// A sample of it; `moves` is by how much the power does.
        fn sample(&mut self, moves: f64) -> Observed {
            let t1 = 22.0 + 0.4 * self.m + 0.2 * self.random(1);
            if self.k.is_multiple_of(50) {
                self.power = 40.0 + moves * self.random(2);
            }
            self.x += (self.power - self.x) / 60.5;
            self.m += (self.past[2] - self.m) / 8.5;
            self.past = [self.x, self.past[0], self.past[1]];
            self.k += 1;
            Observed {
                t: [None, Some(t1 as f32), None],
                power: Some(self.power as f32),
                ..Observed::default()
            }
        }
    }

    fn fit(samples: &[Observed]) -> Found {
        let inputs = Inputs { t0: false, t2: false, fan: false, ..Inputs::ALL };
        let config = Config::default();
        let question = Question {
            samples,
            inputs,
            units: Units::default(),
            config: &config,
            usual: 0.5,
            room: None,
            every: 1,
        };
        question.fit(None).unwrap()
    }

    /// Three sessions, each begun in the middle of something else, with samples that are missing and one that is wild: the rig is found as it is.
    #[test]
    fn stretches_that_begin_anyhow_are_one_rig() {
        let mut samples = Vec::new();
        for (x, m) in [(0.0, 0.0), (95.0, 60.0), (20.0, 80.0)] {
            let mut rig = Rig::begun(x, m);
            samples.extend((0..500).map(|_| rig.sample(60.0)));
            samples.extend([Observed::default(); 30]);
        }
        samples[200..206].fill(Observed::default());
        samples[300].t[1] = Some(500.0);
        let found = fit(&samples);
        let time = |which: Parameter| found.theta[which as usize].exp();
        assert_eq!(found.stretches, 3);
        assert!((time(Gain) - 0.4).abs() < 0.02, "{found:?}");
        assert!((time(Heater) - 60.0).abs() < 5.0 && (time(Lag1) - 8.0).abs() < 2.0, "{:?}", found.theta);
        let clean = fit(&samples
            .iter()
            .map(|sample| Observed { t: sample.t.map(|t| t.filter(|t| *t < 200.0)), ..*sample })
            .collect::<Vec<_>>());
        assert!(clean.fit > 95.0, "{}", clean.fit);
    }

    /// Where the power hardly moves, what the rig makes of it is not known, and that is seen.
    #[test]
    fn what_the_samples_do_not_tell_is_known_as_such() {
        let sampled = |moves: f64| {
            let mut rig = Rig::begun(40.0, 40.0);
            fit(&(0..1500).map(|_| rig.sample(moves)).collect::<Vec<_>>()).known[Gain as usize]
        };
        let (little, enough) = (sampled(0.05), sampled(30.0));
        assert!(little > 0.5 && enough < 0.2, "{little} {enough}");
    }

    /// Means of a rig are about the rig, with its times in their ticks.
    #[test]
    fn means_find_the_same_rig() {
        let mut rig = Rig::begun(10.0, 10.0);
        let samples: Vec<_> = (0..3000).map(|_| rig.sample(60.0)).collect();
        let found = fit(&samples);
        let inputs = Inputs { t0: false, t2: false, fan: false, ..Inputs::ALL };
        let config = Config::default();
        let means = Question {
            samples: &samples,
            inputs,
            units: Units::default(),
            config: &config,
            usual: 0.5,
            room: None,
            every: 5,
        };
        let means = means.fit(Some(&in_ticks_of(5.0, &found.theta))).unwrap();
        for (found, ticks) in [(&found, 60.0), (&means, 12.0)] {
            let heater = found.theta[Heater as usize].exp();
            assert!((heater / ticks - 1.0).abs() < 0.1 && found.fit > 95.0, "{heater} {}", found.fit);
        }
    }
}
