//! Channel 4 of TIM5 as an input: each eighth edge of the slow oscillator, which the option register leads there, is captured. RM0383,
//! TIM5_OR, "Input capture mode" and "Internal/external clock measurement using TIM5/TIM11".

use super::Timer;
use crate::registers::{Refusal, bit, field};
use crate::time::{NEVER, Ps};

/// TI4_RMP of the option register, and its value for the slow oscillator.
const REMAP: u32 = 0xC0;
const SLOW_OSCILLATOR: u32 = 0x40;
/// The channel, counted from 0.
const CHANNEL: usize = 3;
const CC4E: u32 = 12;
const CC4IF: u32 = 1 << 4;
const CC4OF: u32 = 1 << 12;

/// What is wired to the input.
#[derive(Clone, Copy)]
pub(super) struct Capture {
    /// Option register.
    pub(super) or: u32,
    /// Period of the slow oscillator; `None` while it stands still.
    pub(super) period: Option<Ps>,
    /// The next capture.
    pub(super) at: Ps,
}

impl Capture {
    pub(super) const NONE: Self = Self { or: 0, period: None, at: NEVER };
}

impl Timer {
    /// The slow oscillator runs with this period, or stands still.
    pub fn set_slow_oscillator(&mut self, period: Option<Ps>, now: Ps) {
        if self.capture.period != period {
            self.advance(now);
            self.capture.period = period;
            self.schedule_capture(now);
        }
    }

    pub(super) fn is_input(&self, channel: usize) -> bool {
        channel == CHANNEL && field(self.ccmr[1], 8, 2) == 1
    }

    /// # Errors
    /// The mode of a channel is not modelled: any input but this one, a filter.
    pub(super) fn check_input(&self, half: usize, value: u32) -> Result<(), Refusal> {
        let direct = !self.advanced && half == 1 && field(value, 8, 2) == 1 && field(value, 12, 4) == 0;
        if value & 3 != 0 || field(value, 8, 2) != 0 && !direct {
            return Err(format!("CCMR{}: {value:#x}, this input capture is not modelled", half + 1));
        }
        Ok(())
    }

    /// # Errors
    /// Another input than pin or slow oscillator.
    pub(super) fn write_or(&mut self, value: u32, now: Ps) -> Result<(), Refusal> {
        if value & !SLOW_OSCILLATOR != 0 {
            return Err(format!("OR: {value:#x} is not modelled"));
        }
        self.capture.or = value;
        self.schedule_capture(now);
        Ok(())
    }

    /// Edges between two captures: the channel's divider.
    fn edges(&self) -> u64 {
        1 << field(self.ccmr[1], 10, 2)
    }

    /// The divider begins anew when the channel is enabled.
    pub(super) fn schedule_capture(&mut self, now: Ps) {
        let led_here = self.capture.or & REMAP == SLOW_OSCILLATOR;
        let on = led_here && self.is_input(CHANNEL) && bit(self.ccer, CC4E);
        self.capture.at = match self.capture.period.filter(|_| on) {
            Some(period) => now + self.edges() * period,
            None => NEVER,
        };
    }

    /// When the next capture asks for the processor.
    pub(super) fn next_capture(&self) -> Ps {
        if self.dier & !self.sr & CC4IF != 0 { self.capture.at } else { NEVER }
    }

    /// Captures all edges until `now`; the counter has not been set anew since they came.
    pub(super) fn capture_until(&mut self, now: Ps) {
        while self.capture.at <= now {
            let at = self.capture.at;
            self.ccr[CHANNEL] = self.count(at.max(self.origin));
            if self.sr & CC4IF != 0 {
                self.sr |= CC4OF;
            }
            self.sr |= CC4IF;
            self.capture.at = self.capture.period.map_or(NEVER, |period| at + self.edges() * period);
        }
    }

    /// What a read of a capture or compare register gives; a capture is taken by that.
    pub(super) fn read_ccr(&mut self, channel: usize) -> u32 {
        if self.is_input(channel) {
            self.sr &= !CC4IF;
        }
        self.ccr[channel]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CCER, CCMR2, CCR4, CEN, CR1, EGR, OR, PSC, SR};
    use super::*;
    use crate::time::US;

    #[test]
    fn captures_each_eighth_edge_and_says_when_one_was_lost() {
        let mut timer = Timer::general(50);
        timer.set_clock(10_000, 0);
        timer.set_slow_oscillator(Some(31 * US), 0);
        for (register, value) in
            [(PSC, 99), (OR, 0x40), (CCMR2, 0xD00), (EGR, 1), (CR1, CEN), (CCER, 1 << 12)]
        {
            timer.write(register, value, 5 * US).unwrap();
        }
        assert_eq!(timer.read(SR, 252 * US).unwrap() & (CC4IF | CC4OF), 0);
        assert_eq!(timer.read(SR, 253 * US).unwrap() & (CC4IF | CC4OF), CC4IF);
        assert_eq!(timer.read(CCR4, 300 * US).unwrap(), 248);
        assert_eq!(timer.read(SR, 300 * US).unwrap() & CC4IF, 0, "taken by reading");
        assert_eq!(timer.read(SR, 800 * US).unwrap() & (CC4IF | CC4OF), CC4IF | CC4OF);
        assert_eq!(timer.read(CCR4, 800 * US).unwrap(), 3 * 248);
        timer.write(CCER, 0, 900 * US).unwrap();
        timer.write(SR, 0, 900 * US).unwrap();
        assert_eq!(timer.read(SR, 9_000 * US).unwrap() & CC4IF, 0, "off");
    }
}
