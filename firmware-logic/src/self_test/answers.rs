//! From which thermistors answer the heater, and in which order, to what is wired wrongly.

use fdi_core::likelihood::Channel;

use super::CHANNELS;
use super::finding::CheckFinding;
use super::lock_in::{Answer, Noise};

/// An answer smaller than this share of the strongest, squared, is none: warmth that strays.
const STRAY: f32 = 0.25 * 0.25;
/// Square of the sine of the phase below which two answers come at the same time: 0.05 s of a cycle.
const SAME_TIME: f32 = 0.005;

/// What the thermistors say to heat that comes and goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answers<'a> {
    pub answers: &'a [Answer; 3],
    pub noises: &'a [Noise; 3],
    /// Whose codes have moved at all.
    pub moves: [bool; 3],
}

impl Answers<'_> {
    /// Whether anything answers.
    pub(super) fn any(&self) -> bool {
        self.answers.iter().zip(self.noises).any(|(answer, noise)| answer.is_clear(noise))
    }

    fn strongest(&self) -> f32 {
        self.answers.iter().fold(0.0, |most: f32, answer| most.max(answer.power()))
    }

    /// Whether those that are silent would have shown, had they answered half as strongly as the strongest.
    pub(super) fn is_loud(&self) -> bool {
        let share = 0.25 * self.strongest();
        self.any()
            && self.answers.iter().zip(self.noises).all(|(answer, noise)| answer.would_show(share, noise))
    }

    fn each(&self) -> [bool; 3] {
        let strongest = self.strongest();
        let mut answered = self.answers.iter().zip(self.noises);
        [(); 3].map(|()| {
            answered.next().is_some_and(|(a, noise)| a.is_clear(noise) && a.power() > STRAY * strongest)
        })
    }

    /// What is wrong; `None` for nothing.
    pub(super) fn judge(&self) -> Option<CheckFinding> {
        use Channel::{T0, T1, T2};
        let [t0, t1, t2] = self.answers;
        match self.each() {
            [false, true, true] => match t1.lead_over(t2) {
                lead if lead > SAME_TIME => None,
                lead if lead < -SAME_TIME => Some(CheckFinding::Swapped(T1, T2)),
                _ => Some(CheckFinding::SameTime),
            },
            // The first to answer is at T1's place, the next at T2's, the silent one in the room.
            [true, false, true] if t0.lead_over(t2) > 0.0 => Some(CheckFinding::Swapped(T0, T1)),
            [true, true, false] if t1.lead_over(t0) > 0.0 => Some(CheckFinding::Swapped(T0, T2)),
            [true, true, false] | [true, false, true] => Some(CheckFinding::Rotated),
            [false, true, false] => Some(self.silent(T2)),
            [false, false, true] => Some(self.silent(T1)),
            [true, false, false] => Some(CheckFinding::OnlyT0),
            [true, true, true] => Some(CheckFinding::AllAnswer),
            [false, false, false] => Some(CheckFinding::Unheated),
        }
    }

    fn silent(&self, channel: Channel) -> CheckFinding {
        let still = CHANNELS.iter().zip(self.moves).any(|(c, moves)| *c == channel && !moves);
        if still { CheckFinding::Stuck(channel) } else { CheckFinding::Silent(channel) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lock_in::Cycle;
    use super::*;

    /// In phase with the heat, by so many degC.
    fn answer(size: f32) -> Answer {
        let mut cycle = Cycle::default();
        (0..20).for_each(|step| cycle.add(step, size));
        Answer::of(&cycle)
    }

    /// Of so many degC: one cycle of a third contrast alone.
    fn noise(size: f32) -> Noise {
        let mut cycle = Cycle::default();
        (0..40).for_each(|step| cycle.add(step, if (step / 10) % 2 == 0 { size } else { -size }));
        let mut noise = Noise::default();
        noise.add(&cycle);
        noise
    }

    /// Half of 2 degC, squared and over two, is 0.5: above 300 times the noise's variance, 4/3 of its square, up to 0.0354 degC.
    #[test]
    fn silence_says_something_where_half_of_the_strongest_answer_would_have_shown() {
        let answers = [answer(0.0), answer(2.0), answer(0.0)];
        assert!((answers[1].power() - 4.0).abs() < 1e-5);
        for (of_t0, loud) in [(0.035, true), (0.036, false)] {
            let noises = [noise(of_t0), noise(0.01), noise(0.01)];
            let answers = Answers { answers: &answers, noises: &noises, moves: [true; 3] };
            assert!(answers.any() && answers.is_loud() == loud, "{of_t0}");
        }
    }

    #[test]
    fn a_quarter_of_the_strongest_answer_is_warmth_that_strays() {
        for (share, found) in [(0.2, CheckFinding::Silent(Channel::T2)), (0.3, CheckFinding::AllAnswer)] {
            let t2 = if share < 0.25 { 0.0 } else { 2.0 };
            let answers = [answer(share * 2.0), answer(2.0), answer(t2)];
            let noises = [noise(0.001); 3];
            let answers = Answers { answers: &answers, noises: &noises, moves: [true; 3] };
            assert_eq!(answers.judge(), Some(found), "{share}");
        }
    }
}
