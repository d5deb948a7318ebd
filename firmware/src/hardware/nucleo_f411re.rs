//! NUCLEO-F411RE (STM32F411RET6): what is wired where, and how fast it runs.

use embassy_stm32::Peri;
/// Registers that the ADCs of the chip share.
pub(crate) use embassy_stm32::pac::ADC1_COMMON as ADC_COMMON;
use embassy_stm32::peripherals::{
    ADC1, FLASH, PA0, PA1, PA2, PA3, PA4, PA5, PA6, PA8, PA10, PC13, TIM1, TIM5, USART2,
};
use embassy_stm32::rcc::{APBPrescaler, PllMul};

/// Name in the log.
pub(crate) const NAME: &str = "NUCLEO-F411RE";
/// Core clock 100 MHz: the PLL multiplies 1 MHz by this and halves it.
pub(crate) const PLL_MUL: PllMul = PllMul::MUL200;
/// APB1 may run at 50 MHz; its timers run at 100 MHz.
pub(crate) const APB1: APBPrescaler = APBPrescaler::DIV2;

/// ADC channels of T0 (PA4, A2), T1 (PA0, A0) and T2 (PA1, A1).
pub(crate) const ADC_CHANNELS: [u8; 3] = [4, 0, 1];
/// Alternate function that connects PA8, PA10 and PA6 to TIM1.
pub(crate) const TIM1_AF: u8 = 1;

/// The peripherals and pins, by what they do.
pub(crate) struct Board {
    /// Thermistor inputs: T0, T1, T2.
    pub(crate) thermistors: (Peri<'static, PA4>, Peri<'static, PA0>, Peri<'static, PA1>),
    pub(crate) adc: Peri<'static, ADC1>,
    /// Heater PWM (D7) and its break input (D12).
    pub(crate) heater: Peri<'static, PA8>,
    /// The contactor in series with the heater (D2).
    pub(crate) contactor: Peri<'static, PA10>,
    pub(crate) break_input: Peri<'static, PA6>,
    pub(crate) pwm_timer: Peri<'static, TIM1>,
    pub(crate) tick_timer: Peri<'static, TIM5>,
    /// The ST-LINK's virtual COM port.
    pub(crate) usart: Peri<'static, USART2>,
    pub(crate) tx: Peri<'static, PA2>,
    pub(crate) rx: Peri<'static, PA3>,
    /// LD2 (lit when high) and the user button B1 (low when pressed; the board has a pull-up).
    pub(crate) led: Peri<'static, PA5>,
    pub(crate) button: Peri<'static, PC13>,
    pub(crate) flash: Peri<'static, FLASH>,
}

impl Board {
    /// Names the parts.
    pub(crate) fn new(p: embassy_stm32::Peripherals) -> Self {
        Self {
            thermistors: (p.PA4, p.PA0, p.PA1),
            adc: p.ADC1,
            heater: p.PA8,
            contactor: p.PA10,
            break_input: p.PA6,
            pwm_timer: p.TIM1,
            tick_timer: p.TIM5,
            usart: p.USART2,
            tx: p.PA2,
            rx: p.PA3,
            led: p.PA5,
            button: p.PC13,
            flash: p.FLASH,
        }
    }
}
