//! The inputs of the three thermistors and of the heater's supply, converted one by one and polled: a conversion takes 4 µs, less than an
//! interrupt for each would. With each sample the converter measures the chip's own reference, too: one that gets that wrong gives none.

use embassy_stm32::Peri;
use embassy_stm32::gpio::Flex;
use embassy_stm32::pac::adc::vals::SampleTime;
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::rcc;
use fdi_core::RawSample;
use firmware_logic::control_loop::NO_SAMPLE;
use firmware_logic::sampling::{Mean, ROUNDS, SPACING_US};

use super::board::{self, ADC, Adc, SupplyPin, T0Pin, T1Pin, T2Pin};
use super::tick_timer;

/// Polls of the end-of-conversion flag, some 20 times what a conversion takes: a converter that hangs gives "no
/// sample" and the core trips, instead of the tick waiting for ever.
const MAX_POLLS: u32 = 1000;

/// Channel of the reference, and the codes that it may have: 1.18 to 1.24 V (data sheet) at a supply of 3.3 V +-5 %, and 2 % for the converter.
const REFERENCE_CHANNEL: u8 = 17;
const REFERENCE: core::ops::RangeInclusive<u16> = 1367..=1652;

/// The converter.
pub(crate) struct Inputs {
    _adc: Peri<'static, Adc>,
}

impl Inputs {
    /// Switches the converter on.
    pub(crate) fn new(
        adc: Peri<'static, Adc>,
        thermistors: (Peri<'static, T0Pin>, Peri<'static, T1Pin>, Peri<'static, T2Pin>),
        supply: Peri<'static, SupplyPin>,
    ) -> Self {
        let (t0, t1, t2) = thermistors;
        for mut pin in [Flex::new(t0), Flex::new(t1), Flex::new(t2), Flex::new(supply)] {
            pin.set_as_analog();
            core::mem::forget(pin); // dropping it would disconnect it again
        }
        rcc::enable_and_reset::<Adc>();
        // 22.5 or 25 MHz, at most 36 allowed. 84 cycles are 3.4 µs: the divider's 5 kohm charge the sampling capacitor
        // (4 pF) a hundred times over, and the RC filter's 100 nF hardly notice.
        board::ADC_COMMON.ccr().modify(|w| w.set_adcpre(Adcpre::DIV4));
        board::ADC_COMMON.ccr().modify(|w| w.set_tsvrefe(true));
        // 19 to 21 µs; at least 10 asked for.
        ADC.smpr1().modify(|w| w.set_smp(usize::from(REFERENCE_CHANNEL - 10), SampleTime::CYCLES480));
        ADC.smpr2().modify(|w| {
            for channel in board::ADC_CHANNELS {
                w.set_smp(usize::from(channel), SampleTime::CYCLES84);
            }
        });
        ADC.cr2().modify(|w| w.set_adon(true));
        embassy_time::block_for(embassy_time::Duration::from_micros(10)); // t_STAB is 3 µs at most
        Self { _adc: adc }
    }

    /// One sample of each input, the mean of [`ROUNDS`] conversions.
    pub(crate) async fn sample(&mut self) -> RawSample {
        let is_right = convert(REFERENCE_CHANNEL).is_some_and(|code| REFERENCE.contains(&code));
        let start = tick_timer::now();
        let mut means = [Mean::default(); 4];
        for round in 0..ROUNDS {
            tick_timer::until(start.wrapping_add(round * SPACING_US)).await;
            for (mean, channel) in means.iter_mut().zip(board::ADC_CHANNELS) {
                mean.push(convert(channel));
            }
        }
        let [t0, t1, t2, supply] = means.map(|mean| if is_right { mean.code() } else { NO_SAMPLE.t1 });
        RawSample { t0, t1, t2, supply }
    }
}

fn convert(channel: u8) -> Option<u16> {
    ADC.sqr3().write(|w| w.set_sq(0, channel));
    ADC.cr2().modify(|w| w.set_swstart(true));
    let done = (0..MAX_POLLS).any(|_| ADC.sr().read().eoc());
    done.then(|| ADC.dr().read().0 as u16) // reading the data clears the flag
}
