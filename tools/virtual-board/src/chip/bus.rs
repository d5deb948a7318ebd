//! Accesses of the core to the peripherals.

use super::Chip;
use super::map::{APB2, Block, MAP, Place};
use crate::adc::{self, Adc};
use crate::checksum::Checksum;
use crate::clock::RESETS;
use crate::flash::Effect;
use crate::gpio::Mode;
use crate::registers::Refusal;
use crate::time::Ps;

impl Chip {
    fn find(&self, address: u32) -> Result<(Block, u32), Refusal> {
        let place = MAP.iter().find(|p| (p.base..p.base + p.size).contains(&address));
        let place = place.ok_or("no such peripheral in the model")?;
        if let Some((register, bit)) = place.clock
            && !self.clocks.is_enabled(register, bit)
        {
            return Err(format!("{:?} has no clock", place.block));
        }
        Ok((place.block, address - place.base))
    }

    /// Reads `size` bytes.
    ///
    /// # Errors
    /// It is not modelled.
    pub fn read(&mut self, address: u32, size: usize, now: Ps) -> Result<u32, Refusal> {
        self.follow_pwm(now);
        let (block, offset) = self.find(address & !3)?;
        let word = match block {
            Block::Tim1 => self.tim1.read(offset, now),
            Block::Tim2 => self.tim2.read(offset, now),
            Block::Tim5 => self.tim5.read(offset, now),
            Block::Usart2 => self.usart.read(offset, now),
            Block::Adc1 => self.adc.read(offset, now),
            Block::Checksum => self.checksum.read(offset),
            Block::Gpio(0) => self.ports[0].read(offset).map(|bits| self.with_levels(offset, bits, now)),
            Block::Gpio(port) => self.ports[port].read(offset),
            Block::Clocks => self.clocks.read(offset, now),
            Block::Power => self.power.read(offset),
            Block::Flash => self.flash.read(offset),
            Block::FlashMemory => Ok(self.flash.word(offset)),
            Block::Watchdog => self.watchdog.read(offset, now),
            Block::Exti => self.exti.read(offset),
            Block::Syscfg => self.exti.syscfg.read(offset),
            Block::Scs => self.scs.read(offset, now),
            Block::Cycles => self.scs.read_cycles(offset, now),
            Block::Debug => self.debug.read(offset),
        }
        .map_err(|why| format!("{block:?}: {why}"))?;
        if block == Block::Usart2 {
            self.settle(now);
        }
        let (shift, mask) = (8 * (address & 3), u32::MAX >> (32 - 8 * size.min(4)));
        Ok(word >> shift & mask)
    }

    /// Writes `size` bytes. The core may have to stand still for it: [`Chip::stands_until`].
    ///
    /// # Errors
    /// It is not modelled.
    pub fn write(&mut self, address: u32, size: usize, value: u32, now: Ps) -> Result<(), Refusal> {
        self.follow_pwm(now);
        let (block, offset) = self.find(address)?;
        if size != 4 {
            self.write_part(block, offset, size, value, now)
        } else {
            self.write_word(block, offset, value, now)
        }
        .map_err(|why| format!("{block:?}: {why}"))?;
        self.settle(now);
        Ok(())
    }

    /// The few registers that the program writes a byte or a half of.
    fn write_part(
        &mut self,
        block: Block,
        offset: u32,
        size: usize,
        value: u32,
        now: Ps,
    ) -> Result<(), Refusal> {
        match (block, offset, size) {
            (Block::Scs, _, 1) => self.scs.write_byte(offset, value as u8),
            (Block::Usart2, 4, 1) => self.usart.write(offset, value, now),
            // Registers of 16 bits.
            (Block::Tim2, 0..0x24 | 0x28, 2) => self.tim2.write(offset, value, now),
            (Block::Tim5, 0..0x24 | 0x28, 2) => self.tim5.write(offset, value, now),
            (Block::Tim1, _, 2) => self.tim1.write(offset, value, now),
            _ => Err(format!("writing {size} bytes here is not modelled")),
        }
    }

    fn write_word(&mut self, block: Block, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        match block {
            Block::Tim1 => self.tim1.write(offset, value, now),
            Block::Tim2 => self.tim2.write(offset, value, now),
            Block::Tim5 => self.tim5.write(offset, value, now),
            Block::Usart2 => self.usart.write(offset, value, now),
            Block::Adc1 => self.write_adc(offset, value, now),
            Block::Checksum => self.checksum.write(offset, value),
            Block::Gpio(port) => self.ports[port].write(offset, value),
            Block::Clocks => {
                self.clocks.write(offset, value, now)?;
                self.reset_blocks(offset, value, now);
                self.clocks_changed(now);
                self.check_speed()
            }
            Block::Power => self.power.write(offset, value, now),
            Block::Flash => {
                let effect = self.flash.write(offset, value, now)?;
                self.power_cut |= effect == Effect::PowerCut;
                self.check_speed()
            }
            Block::FlashMemory => {
                self.power_cut |= self.flash.program(offset, 4, value, now)? == Effect::PowerCut;
                Ok(())
            }
            Block::Watchdog => {
                self.watchdog.write(offset, value, now)?;
                self.tim5.set_slow_oscillator(self.watchdog.slow_period(), now);
                Ok(())
            }
            Block::Exti => self.exti.write(offset, value),
            Block::Syscfg => self.exti.syscfg.write(offset, value),
            Block::Scs => self.scs.write(offset, value, now),
            Block::Cycles => self.scs.write_cycles(offset, value, now),
            Block::Debug => self.debug.write(offset, value),
        }
    }

    /// A one in a reset register resets the peripheral whose enable stands at the same place.
    fn reset_blocks(&mut self, offset: u32, value: u32, now: Ps) {
        let Some(register) = offset.checked_sub(RESETS).filter(|r| *r <= APB2) else { return };
        let hit = |p: &&Place| p.clock.is_some_and(|(r, place)| r == register && value >> place & 1 == 1);
        for place in MAP.iter().filter(hit) {
            match place.block {
                Block::Tim1 => self.tim1.reset(now),
                Block::Tim2 => self.tim2.reset(now),
                Block::Tim5 => self.tim5.reset(now),
                Block::Usart2 => self.usart.reset(),
                Block::Adc1 => self.adc = Adc::default(),
                Block::Checksum => self.checksum = Checksum::default(),
                Block::Gpio(port) => self.ports[port].reset(),
                _ => {}
            }
        }
    }

    fn write_adc(&mut self, offset: u32, value: u32, now: Ps) -> Result<(), Refusal> {
        let Some(channel) = self.adc.write(offset, value, now)? else { return Ok(()) };
        let pclk2 = self.frequencies.map_or(0, |f| f.pclk2);
        if channel == adc::REFERENCE {
            self.adc.begin(channel, pclk2, now)?;
            return self.adc.sample_reference(self.wiring.reference);
        }
        let (port, pin) = match channel {
            0..8 => (0, channel),
            8..10 => (1, channel - 8),
            10..16 => (2, channel - 10),
            _ => return Err(format!("channel {channel} is not modelled")),
        };
        if self.ports[port].mode(pin.into()) != Mode::Analog {
            return Err(format!("channel {channel} is converted, but its pin is not analogue"));
        }
        let code = self.analog.code(channel, now, self.power_at_rig());
        let ends_at = self.adc.begin(channel, pclk2, now)?;
        let at_pin = self.at_pin(f64::from(code), ends_at);
        self.adc.sample(at_pin, self.wiring.source(at_pin));
        Ok(())
    }

    /// What is at the pin at the end of a sample, in codes: ripple and noise are added to what the rig gives.
    fn at_pin(&mut self, code: f64, now: Ps) -> f64 {
        let ripple = self.wiring.ripple(self.tim1.phase(now), self.heater());
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 7;
        self.noise ^= self.noise << 17;
        let noise = 2.0 * (self.noise >> 11) as f64 / (1u64 << 53) as f64 - 1.0;
        (code + ripple + self.wiring.noise * noise).clamp(0.0, 4095.0)
    }
}
