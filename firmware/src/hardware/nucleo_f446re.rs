//! NUCLEO-F446RE (STM32F446RET6): wired as the others, and how fast it runs.

/// Registers that the ADCs of the chip share.
pub(crate) use embassy_stm32::pac::ADC123_COMMON as ADC_COMMON;
use embassy_stm32::rcc::{APBPrescaler, PllMul};

pub(crate) use super::nucleo_64::*;

/// Name in the log.
pub(crate) const NAME: &str = "NUCLEO-F446RE";
/// Core clock 90 MHz: the PLL multiplies 1 MHz by this and halves it.
pub(crate) const PLL_MUL: PllMul = PllMul::MUL180;
/// APB1 may run at 45 MHz, which is why the core does not run faster; its timers run at 90 MHz.
pub(crate) const APB1: APBPrescaler = APBPrescaler::DIV2;
