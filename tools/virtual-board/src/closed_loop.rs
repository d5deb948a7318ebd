//! The rig on the board's wires: the codes of thermistors and supply out, the power at the heater's pin in.

use std::cell::RefCell;
use std::rc::Rc;

use pt326_rig::Rig;

use crate::chip::Analog;
use crate::time::{MS, Ps};

/// Ts.
pub const TICK: Ps = 110 * MS;
/// Sensor on each channel of the converter: T1 on PA0, T2 on PA1, T0 on PA4.
const SENSORS: [(u8, usize); 3] = [(0, 1), (1, 2), (4, 0)];
/// Channel of the heater's supply, on PB0.
const SUPPLY: u8 = 8;

/// The rig, which stands still at ambient temperature until it is started.
///
/// It moves on a grid of ticks that begins with the first conversion after its start: all conversions of a tick read the
/// same codes, and what the pin gave at the end of a tick drove the heater for all of it. So it is the loop of
/// the simulation, but for the steps of the PWM.
pub struct ClosedLoop {
    rig: Option<Rig>,
    /// When tick 0 began, and the tick at hand.
    grid: Option<(Ps, u64)>,
    codes: [u16; 3],
    /// Code at the input of the heater's supply; the rig's, where that is measured.
    pub supply: u16,
    /// Codes that stand in for the rig's, by sensor: a wire that is broken or shorted.
    pub overrides: [Option<u16>; 3],
    /// Power of each tick of the rig so far, as a share.
    pub power: Vec<f64>,
}

impl ClosedLoop {
    /// A rig in a room that reads `room` on all three sensors.
    pub fn at_rest(ambient: u16) -> Self {
        Self {
            rig: None,
            grid: None,
            codes: [ambient; 3],
            supply: 0,
            overrides: [None; 3],
            power: Vec::new(),
        }
    }

    /// Lets the rig begin with the next tick.
    pub fn start(&mut self, rig: Rig) {
        (self.rig, self.grid) = (Some(rig), None);
        self.power.clear();
    }

    /// The rig, once it has been started.
    pub fn rig(&mut self) -> Option<&mut Rig> {
        self.rig.as_mut()
    }

    /// Moves the rig to the tick of a conversion.
    fn follow(&mut self, now: Ps, power: f64) {
        let Some(rig) = &mut self.rig else { return };
        let Some((begin, tick)) = self.grid else {
            // A sample takes 1.3 ms, and nobody starts the rig in the middle of one.
            self.grid = Some((now, 0));
            (self.codes, self.supply) = (rig.sample().map(code), code(rig.supply()));
            return;
        };
        let current = (now - begin + TICK / 2) / TICK;
        for _ in tick..current {
            self.power.push(power);
            rig.advance(100.0 * power);
            (self.codes, self.supply) = (rig.sample().map(code), code(rig.supply()));
        }
        self.grid = Some((begin, current));
    }
}

/// A sample that went missing in the simulation reads as an open wire.
fn code(code: f64) -> u16 {
    if code.is_finite() { code.round().clamp(0.0, 4095.0) as u16 } else { 4095 }
}

/// A handle to the loop that the board and whoever plays with it share.
#[derive(Clone)]
pub struct Shared(pub Rc<RefCell<ClosedLoop>>);

impl Shared {
    /// A rig at rest.
    pub fn at_rest(ambient: u16) -> Self {
        Self(Rc::new(RefCell::new(ClosedLoop::at_rest(ambient))))
    }
}

impl Analog for Shared {
    fn code(&mut self, channel: u8, now: Ps, power: f64) -> u16 {
        let mut this = self.0.borrow_mut();
        this.follow(now, power);
        if channel == SUPPLY {
            return this.supply;
        }
        let sensor = SENSORS.iter().find(|(wired, _)| *wired == channel).map(|(_, sensor)| *sensor);
        sensor.map_or(0, |i| this.overrides[i].unwrap_or(this.codes[i]))
    }
}
