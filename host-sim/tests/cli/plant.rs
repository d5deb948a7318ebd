//! A heater of two lags under random levels of power, as somebody would log it.

/// Numbers that are the same each time.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn of(seed: u64) -> Self {
        let mut dice = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..8).for_each(|_| _ = dice.next());
        dice
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub(crate) fn one_in(&mut self, count: f64) -> bool {
        self.next() * count < 1.0
    }

    pub(crate) fn any<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.next() * of.len() as f64) as usize]
    }
}

/// The heater. Its lags are in samples, so that it answers alike whatever the sample time is.
pub(crate) struct Plant {
    pub(crate) sample_time: f64,
    pub(crate) lags: [f64; 2],
    /// degC a %.
    pub(crate) gain: f64,
    /// Half of the width of the noise, degC, and how much of it stays until the next sample.
    pub(crate) noise: f64,
    pub(crate) wander: f64,
    /// The heat that both lags hold, % of power.
    pub(crate) heat: [f64; 2],
    /// Least and largest power, %.
    pub(crate) power: [f64; 2],
    pub(crate) dice: Dice,
}

impl Plant {
    /// Lags of 30 and 4 samples, 0.4 degC a %, at rest.
    pub(crate) fn of(sample_time: f64, seed: u64) -> Self {
        Self {
            sample_time,
            lags: [30.0, 4.0],
            gain: 0.4,
            noise: 0.05,
            wander: 0.0,
            heat: [0.0; 2],
            power: [10.0, 80.0],
            dice: Dice::of(seed),
        }
    }

    /// A log of so many samples with a header; `off` is what T1 reads too high at each, degC.
    pub(crate) fn log(&mut self, count: usize, off: impl Fn(usize) -> f64) -> String {
        let mut text = "time,temp,power\n".to_owned();
        let (mut power, mut noise) = (0.0, 0.0);
        for k in 0..count {
            if k % 40 == 0 {
                let [low, high] = self.power;
                power = (10.0 * self.dice.between(low, high)).round() / 10.0;
            }
            noise = self.wander * noise + (1.0 - self.wander) * self.dice.between(-self.noise, self.noise);
            let read = 21.0 + self.gain * self.heat[1] + noise + off(k);
            text += &format!("{},{read:.2},{power}\n", k as f64 * self.sample_time);
            self.heat[0] += (power - self.heat[0]) / self.lags[0];
            self.heat[1] += (self.heat[0] - self.heat[1]) / self.lags[1];
        }
        text
    }
}
