//! Is what is seen a fault that was taught? Each response is a hypothesis that frees its size, beside all that the bank has.

use super::response::{MAX_TAUGHT, REGRESSORS, Responses};
use crate::bounds::{larger, smaller};
use crate::likelihood::evidence::{Beyond, Estimate};
use crate::likelihood::tuning::TaughtTuning;

/// What each response gains over the nuisances.
pub(in crate::likelihood) type Weighed = [Estimate; MAX_TAUGHT];

/// Weighs all of them; what is not possible stays as it is.
#[inline(never)]
pub(in crate::likelihood) fn weigh(
    t: &TaughtTuning,
    responses: &Responses,
    beyond: &Beyond,
    weighed: &mut Weighed,
) {
    if responses.is_empty() {
        return;
    }
    let among = beyond.among(&REGRESSORS);
    for (weighed, response) in weighed.iter_mut().zip(responses) {
        let estimate = among.estimate(&response.weights(), (1.0, t.size_sd));
        if estimate.gain > t.least_gain && estimate.value > t.least_size && estimate.value < t.most_size {
            *weighed = Estimate { gain: estimate.gain + t.prior, ..estimate };
        }
    }
}

/// The place of the likeliest, and the probability of its name beside all classes, whose evidence together has the logarithm `classes`. Two responses of
/// one name are one fault in two forms.
pub(in crate::likelihood) fn likeliest(
    responses: &Responses,
    weighed: &Weighed,
    classes: f32,
) -> (usize, f32) {
    let mut best = 0;
    for (i, estimate) in weighed.iter().enumerate() {
        if estimate.gain > weighed[best % MAX_TAUGHT].gain {
            best = i;
        }
    }
    let Some(likeliest) = responses.get(best) else { return (best, 0.0) };
    let gain = weighed[best % MAX_TAUGHT].gain;
    let ratio = |other: f32| libm::expf(smaller(60.0, larger(-60.0, other - gain)));
    let (mut own, mut all) = (0.0, ratio(classes));
    for (estimate, response) in weighed.iter().zip(responses) {
        let weight = ratio(estimate.gain);
        all += weight;
        own += if response.name == likeliest.name { weight } else { 0.0 };
    }
    (best, own / all)
}

#[cfg(test)]
mod tests {
    use super::super::response::{EFFECTS, Response};
    use super::*;
    use crate::likelihood::evidence::Nuisances;
    use crate::likelihood::hypothesis::{ALL_PAIRS, IMPOSSIBLE, SINCE_ONSET};
    use crate::likelihood::normal::Normal;
    use crate::likelihood::regressor::{COUNT, Regressor};

    fn weighed(gains: &[(usize, f32)]) -> Weighed {
        let mut weighed = [Estimate { gain: IMPOSSIBLE, ..Estimate::default() }; MAX_TAUGHT];
        gains.iter().for_each(|(place, gain)| weighed[*place].gain = *gain);
        weighed
    }

    fn named(names: &[&str]) -> Responses {
        names.iter().map(|name| Response { name: name.parse().unwrap(), effects: [1; EFFECTS] }).collect()
    }

    #[test]
    fn the_likeliest_has_its_share_of_all_that_is_possible() {
        let close = |(place, p): (usize, f32), wanted: (usize, f64)| {
            assert!(place == wanted.0 && (f64::from(p) - wanted.1).abs() < 1e-4, "{place} {p} {wanted:?}");
        };
        let all = named(&["a", "b", "c", "d", "e", "f", "g", "h"]);
        close(likeliest(&all, &weighed(&[(3, 40.0)]), 37.0), (3, 1.0 / (1.0 + (-3.0f64).exp())));
        let two = weighed(&[(3, 40.0), (7, 41.0)]);
        close(likeliest(&all, &two, 39.0), (7, 1.0 / (1.0 + (-1.0f64).exp() + (-2.0f64).exp())));
        close(likeliest(&all, &weighed(&[(0, -2.0)]), 5000.0), (0, 0.0));
        assert!(likeliest(&all, &weighed(&[]), 10.0).1 < 1e-6, "none is possible");
        assert!(likeliest(&Responses::new(), &weighed(&[]), 10.0).1 == 0.0, "nothing was taught");
    }

    #[test]
    fn two_forms_of_one_fault_do_not_silence_each_other() {
        let alike = weighed(&[(0, 40.0), (1, 40.0)]);
        assert!(likeliest(&named(&["cap", "hand"]), &alike, 30.0).1 < 0.51);
        assert!(likeliest(&named(&["cap", "cap"]), &alike, 30.0).1 > 0.99);
    }

    /// T2 reads 30 standard deviations too high on every tick; what hardly changes anything does not live by its prior.
    #[test]
    fn the_data_have_to_speak_for_it() {
        let mut normal = <Normal>::default();
        let mut row = [[0.0; 2]; COUNT];
        row[Regressor::Offset2 as usize] = [0.0, 20.0];
        (0..50).for_each(|_| normal.add(1.0, &row, [0.0, 30.0], 1.0));
        let nuisances = Nuisances::new(normal.sums(), &SINCE_ONSET, 1.5).beyond(&ALL_PAIRS);
        let mut responses = named(&["low", "none", "tiny", "high"]);
        for (response, offset) in responses.iter_mut().zip([-150, 0, 1, 150]) {
            response.effects = [0; EFFECTS];
            response.effects[4] = offset;
        }
        let mut weighed = weighed(&[]);
        weigh(&TaughtTuning::DEFAULT, &responses, &nuisances, &mut weighed);
        let gains = weighed.map(|estimate| estimate.gain);
        assert_eq!(gains[..3], [IMPOSSIBLE; 3]);
        assert!(gains[3] > 50.0, "{gains:?}");
    }
}
