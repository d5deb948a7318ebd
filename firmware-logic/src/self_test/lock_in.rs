//! Does a thermistor answer the heater, and which one first? Heat comes in cycles, on for half of each. A cycle is cut into
//! four quarters, whose means `q` give three contrasts: in phase `(q0 + q1 - q2 - q3) / 2`, which is the rise where an
//! answer comes at once; in quadrature `(q1 + q2 - q3 - q0) / 2`, the larger the later it comes; and
//! `(q0 - q1 + q2 - q3) / 2`, which a steady answer does not move. Without heat all three are noise, slow disturbance of the air
//! included: that is how each thermistor's own noise is measured, at the very frequency at which the answer is sought.

/// Steps in a cycle: 4.4 s where a step is a tick of 110 ms, so that even with 2 s of dead time the answer falls into its cycle.
pub const CYCLE: u32 = 40;
const QUARTER: u32 = CYCLE / 4;

/// Variance in degC² below which no noise is believed to lie: the converter's steps, 0.02 degC.
const LEAST_VARIANCE: f32 = 0.02 * 0.02;

/// One cycle of one thermistor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cycle {
    sums: [f32; 4],
}

impl Cycle {
    /// Adds the reading at a step of the cycle, in degC above some reference near it.
    pub(super) fn add(&mut self, step: u32, rise: f32) {
        if let Some(sum) = self.sums.get_mut((step / QUARTER) as usize) {
            *sum += rise;
        }
    }

    pub(super) fn mean(&self) -> f32 {
        self.sums.iter().sum::<f32>() / CYCLE as f32
    }

    fn contrasts(&self) -> [f32; 3] {
        let [q0, q1, q2, q3] = self.sums.map(|sum| sum / QUARTER as f32);
        [(q0 + q1 - q2 - q3) / 2.0, (q1 + q2 - q3 - q0) / 2.0, (q0 - q1 + q2 - q3) / 2.0]
    }
}

/// Noise of one thermistor, as its contrasts show it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    squares: f32,
    /// How many independent contrasts `squares` is made of.
    freedom: u32,
}

impl Noise {
    /// Adds a cycle without heat.
    pub(super) fn add(&mut self, cycle: &Cycle) {
        self.squares += cycle.contrasts().iter().map(|x| x * x).sum::<f32>();
        self.freedom += 3;
    }

    fn variance(&self) -> f32 {
        (self.squares / self.freedom.max(1) as f32).max(LEAST_VARIANCE)
    }

    /// How many times the noise's variance an answer must exceed: noise alone does once in a million, by Fisher's F with
    /// 2 and `freedom` degrees.
    fn limit(&self) -> f32 {
        match self.freedom {
            0..9 => 300.0,
            9..12 => 92.0,
            12..15 => 54.0,
            15..18 => 40.0,
            18..24 => 33.0,
            _ => 26.0,
        }
    }
}

/// The answer of one thermistor over some cycles with heat.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Answer {
    in_phase: f32,
    quadrature: f32,
    squares: f32,
    odd_squares: f32,
    sum: f32,
    cycles: u32,
}

impl Answer {
    pub(super) fn of(cycle: &Cycle) -> Self {
        let mut answer = Self::default();
        answer.add(cycle);
        answer
    }

    pub(super) fn add(&mut self, cycle: &Cycle) {
        let [in_phase, quadrature, odd] = cycle.contrasts();
        self.in_phase += in_phase;
        self.quadrature += quadrature;
        self.squares += in_phase * in_phase + quadrature * quadrature;
        self.odd_squares += odd * odd;
        self.sum += cycle.mean();
        self.cycles += 1;
    }

    /// Mean rise, degC.
    pub(super) fn mean(&self) -> f32 {
        self.sum / self.cycles.max(1) as f32
    }

    /// Square of its size in degC².
    pub(super) fn power(&self) -> f32 {
        let n = self.cycles.max(1) as f32;
        (self.in_phase * self.in_phase + self.quadrature * self.quadrature) / (n * n)
    }

    /// Whether it stands out from the noise.
    pub(super) fn is_clear(&self, noise: &Noise) -> bool {
        self.would_show(self.power(), noise)
    }

    /// Whether an answer of this `power` would stand out from the noise, to which what differs from cycle to cycle is added.
    pub(super) fn would_show(&self, power: f32, noise: &Noise) -> bool {
        let n = self.cycles as f32;
        let mut noise = *noise;
        if self.cycles > 1 {
            noise.squares += (self.squares - n * self.power()).max(0.0) + self.odd_squares;
            noise.freedom += 3 * self.cycles - 2;
        }
        n * power / 2.0 > noise.limit() * noise.variance()
    }

    /// Square of the sine of the phase by which `other` comes later; negative where it comes first.
    pub(super) fn lead_over(&self, other: &Self) -> f32 {
        let cycles = (self.cycles * other.cycles).max(1) as f32;
        let cross = (self.in_phase * other.quadrature - self.quadrature * other.in_phase) / cycles;
        let sizes = self.power() * other.power();
        if sizes > 0.0 { cross * cross.abs() / sizes } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cycle of half heat seen through a delay and a lag, both in ticks.
    fn seen(rise: f32, delay: u32, lag: f32) -> Cycle {
        let mut cycle = Cycle::default();
        let mut value = 0.0;
        // Two cycles before it, so that it is periodic.
        for tick in 0..3 * CYCLE {
            let heated = tick >= delay && (tick - delay) % CYCLE < CYCLE / 2;
            value += (if heated { rise } else { 0.0 } - value) / lag;
            if tick >= 2 * CYCLE {
                cycle.add(tick % CYCLE, value);
            }
        }
        cycle
    }

    #[test]
    fn the_earlier_answer_leads_whatever_its_size() {
        for delay in [0, 5, 18] {
            for (near, far) in [(1.0, 0.9), (0.05, 0.05), (0.3, 3.0)] {
                let (first, second) =
                    (Answer::of(&seen(near, delay, 4.0)), Answer::of(&seen(far, delay + 1, 7.0)));
                assert!(first.lead_over(&second) > 0.02, "{delay} {near} {far}");
                assert!(second.lead_over(&first) < -0.02, "{delay} {near} {far}");
            }
        }
    }

    #[test]
    fn an_answer_is_as_large_as_the_rise_and_a_steady_one_moves_no_third_contrast() {
        let cycle = seen(2.0, 1, 2.0);
        assert!((1.6..2.1).contains(&Answer::of(&cycle).power().sqrt()));
        assert!(cycle.contrasts()[2].abs() < 1e-3, "{:?}", cycle.contrasts());
    }

    #[test]
    fn only_what_stands_out_from_its_own_noise_is_an_answer() {
        let mut noise = Noise::default();
        let mut quiet = Noise::default();
        for k in 0..4 {
            let mut cycle = Cycle::default();
            (0..CYCLE).for_each(|tick| cycle.add(tick, if (tick / 7 + k) % 2 == 0 { 0.3 } else { -0.3 }));
            noise.add(&cycle);
            quiet.add(&Cycle::default());
        }
        let small = Answer::of(&seen(0.3, 1, 4.0));
        assert!(small.is_clear(&quiet) && !small.is_clear(&noise));
        assert!(Answer::of(&seen(10.0, 1, 4.0)).is_clear(&noise));
        assert!(!Answer::of(&seen(0.05, 1, 4.0)).is_clear(&quiet), "less than the converter's steps");
    }

    /// A cycle with these quarters.
    fn quarters(q: [f32; 4]) -> Cycle {
        let mut cycle = Cycle::default();
        for (quarter, value) in q.into_iter().enumerate() {
            (0..QUARTER).for_each(|step| cycle.add(quarter as u32 * QUARTER + step, value));
        }
        cycle
    }

    /// By hand, from the formulas of this page.
    #[test]
    fn contrasts_and_sizes_are_what_the_formulas_say() {
        let (up, down) = (quarters([1.0, 2.0, 4.0, 8.0]), quarters([8.0, 4.0, 2.0, 1.0]));
        assert_eq!(
            (up.mean(), up.contrasts(), down.contrasts()),
            (3.75, [-4.5, -1.5, -2.5], [4.5, -1.5, 2.5])
        );
        let mut twice = Answer::of(&up);
        assert_eq!(twice.power(), 4.5 * 4.5 + 1.5 * 1.5);
        twice.add(&up);
        assert_eq!(twice.power(), 4.5 * 4.5 + 1.5 * 1.5, "a mean");
        let mut noise = Noise::default();
        noise.add(&up);
        assert_eq!((noise.freedom, noise.variance()), (3, (4.5 * 4.5 + 1.5 * 1.5 + 2.5 * 2.5) / 3.0));
        // (0, -3) is left of both, (4.5, 1.5) and its opposite are noise, and so is 2.5 twice.
        let mut both = Answer::of(&up);
        both.add(&down);
        let variance = (2.0 * (4.5 * 4.5 + 1.5 * 1.5) - 3.0 * 3.0 / 2.0 + 2.0 * 2.5 * 2.5) / 4.0;
        let limit = 300.0 * variance;
        assert!(
            both.would_show(limit + 1.0, &Noise::default())
                && !both.would_show(limit - 1.0, &Noise::default())
        );
        // Phases of 198.4 and 341.6 degrees.
        let sine = (4.5 * 1.5 + 1.5 * 4.5) / (4.5 * 4.5 + 1.5 * 1.5f32);
        assert!((Answer::of(&up).lead_over(&Answer::of(&down)) - sine * sine).abs() < 1e-6);
        assert!((Answer::of(&down).lead_over(&twice) + sine * sine).abs() < 1e-6);
    }

    #[test]
    fn the_less_is_known_of_the_noise_the_more_an_answer_must_exceed_it() {
        let answer = Answer::of(&seen(1.0, 1, 4.0));
        let limits =
            [(0, 8, 300.0), (9, 11, 92.0), (12, 14, 54.0), (15, 17, 40.0), (18, 23, 33.0), (24, 1000, 26.0)];
        for (least, most, limit) in limits {
            for freedom in [least, most] {
                let noise = Noise { squares: freedom as f32, freedom };
                let shows = |power| answer.would_show(power * noise.variance(), &noise);
                assert!(shows(2.02 * limit) && !shows(1.98 * limit), "{freedom}");
            }
        }
    }
}
