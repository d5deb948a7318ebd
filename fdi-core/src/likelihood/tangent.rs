//! How the rises change with each parameter of the model: its equations differentiated, run beside it (forward sensitivities).

use super::process::{COUNT, Motion, Parameter, Parameters, Process, Rises, Transport};

/// What a parameter moves on its way: heater and air for some, lags and walls for most.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    m: [f32; 2],
    w: [f32; 2],
}

/// The memory: of the parameters that act on the heater its own state and air, of all that act on the air lags and walls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tangent {
    heater: (f32, Transport, Way),
    curvature: (f32, Transport, Way),
    delay1: Way,
    delay2: Way,
    lag1: Way,
    lag2: Way,
    wall_time: Way,
}

/// d(1 - exp(-1/t)) / d ln t
fn share_slope(ln_ticks: f32) -> f32 {
    let inverse = libm::expf(-ln_ticks);
    -inverse * libm::expf(-inverse)
}

impl Way {
    /// One tick: `air` is the change of what arrives, `lag` and `wall` what changes the states besides.
    #[inline(never)]
    fn step(&mut self, p: &Process, air: [f32; 2], lag: [f32; 2], wall: [f32; 2]) -> [f32; 2] {
        core::array::from_fn(|i| {
            self.m[i] += p.lag[i] * (air[i] - self.m[i]) + lag[i];
            self.w[i] += p.wall * (self.m[i] - self.w[i]) + wall[i];
            p.gain[i] * (self.m[i] + p.slow[i] * (self.w[i] - self.m[i]))
        })
    }
}

impl Tangent {
    /// One tick of the model, from `motion`; puts its derivatives by each parameter into `out`: of the rises of T1 and T2 with their offsets.
    #[inline(never)]
    pub(super) fn step(
        &mut self,
        parameters: &Parameters,
        p: &Process,
        motion: &mut Motion,
        power: f32,
        out: &mut [[f32; COUNT]; 2],
    ) -> Rises {
        use Parameter::{
            Curvature, Delay1, Delay2, Gain, Heater, Lag1, Lag2, Offset1, Offset2, Reaches2, Wall1, Wall2,
            WallTime,
        };
        let before = (motion.x, motion.m, motion.w);
        let heat = p.heat(power);
        let rises = p.step(motion, heat);
        let arriving = [motion.air.at(p.delay[0]), motion.air.at(p.delay[1])];
        let none = [0.0; 2];

        let mut put = |which: Parameter, both: [f32; 2]| {
            out[0][which as usize] = both[0];
            out[1][which as usize] = both[1];
        };
        put(Gain, rises.y);
        let on_heater = |s: &mut (f32, Transport, Way), source: f32| {
            s.0 += p.heater * -s.0 + source;
            s.1.push(s.0);
            let air = [s.1.at(p.delay[0]).0, s.1.at(p.delay[1]).0];
            s.2.step(p, air, none, none)
        };
        let slope = share_slope(parameters.get(Heater));
        put(Heater, on_heater(&mut self.heater, slope * (heat - before.0)));
        let model = &p.tuning.model;
        let bent = p.heater * power * (power - model.centre) / model.step;
        put(Curvature, on_heater(&mut self.curvature, bent));
        let [earlier1, earlier2] = arriving.map(|(_, slope)| slope);
        put(Delay1, self.delay1.step(p, [earlier1, earlier2], none, none));
        put(Delay2, self.delay2.step(p, [0.0, earlier2], none, none));
        let lagging = |i: usize, which: Parameter| {
            let mut by = none;
            by[i] = share_slope(parameters.get(which)) * (arriving[i].0 - before.1[i]);
            by
        };
        put(Lag1, self.lag1.step(p, none, lagging(0, Lag1), none));
        put(Lag2, self.lag2.step(p, none, lagging(1, Lag2), none));
        let slope = share_slope(parameters.get(WallTime));
        let walls = core::array::from_fn(|i| slope * (motion.m[i] - before.2[i]));
        put(WallTime, self.wall_time.step(p, none, none, walls));
        put(Wall1, rises.wall);
        put(Wall2, [0.0, rises.wall[1]]);
        put(Reaches2, [0.0, if p.gain[1] > 0.0 { rises.y[1] * p.gain[0] / p.gain[1] } else { 0.0 }]);
        put(Offset1, [1.0, 0.0]);
        put(Offset2, [0.0, 1.0]);
        rises
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivatives against differences of two runs of the model.
    #[test]
    fn the_derivatives_are_those_of_differences() {
        let parameters = Parameters([-1.2, 1.4, 1.7, 0.2, 0.06, 0.9, 1.3, 1.1, 0.03, 4.0, 0.1, -0.2, 0.01]);
        let power = |k: usize| if (k / 7).is_multiple_of(3) { 45.0 } else { 30.0 };
        let run = |p: &Parameters| {
            let (process, mut motion) = (Process::new(Default::default(), p, 1.0), Motion::default());
            let mut y = [0.0; 2];
            for k in 0..120 {
                y = process.step(&mut motion, process.heat(power(k))).y;
            }
            [y[0] + p.get(Parameter::Offset1), y[1] + p.get(Parameter::Offset2)]
        };
        let process = Process::new(Default::default(), &parameters, 1.0);
        let (mut tangent, mut motion) = (Tangent::default(), Motion::default());
        let mut derivatives = [[0.0; COUNT]; 2];
        for k in 0..120 {
            tangent.step(&parameters, &process, &mut motion, power(k), &mut derivatives);
        }
        for i in 0..COUNT {
            let h = 5e-3;
            let [mut up, mut down] = [parameters; 2];
            up.0[i] += h;
            down.0[i] -= h;
            let (up, down) = (run(&up), run(&down));
            for m in 0..2 {
                let wanted = (up[m] - down[m]) / (2.0 * h);
                let error = (derivatives[m][i] - wanted).abs();
                assert!(error < 0.02 * wanted.abs() + 0.02, "{i} {m}: {} {wanted}", derivatives[m][i]);
            }
        }
    }
}
