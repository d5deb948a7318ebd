//! NUCLEO-F411RE (STM32F411RET6): wired as the others, and how fast it runs.

/// Registers that the ADCs of the chip share.
pub(crate) use embassy_stm32::pac::ADC1_COMMON as ADC_COMMON;
use embassy_stm32::rcc::{APBPrescaler, PllMul};

pub(crate) use super::nucleo_64::*;

/// Name in the log.
pub(crate) const NAME: &str = "NUCLEO-F411RE";
/// Core clock 100 MHz: the PLL multiplies 1 MHz by this and halves it.
pub(crate) const PLL_MUL: PllMul = PllMul::MUL200;
/// APB1 may run at 50 MHz; its timers run at 100 MHz.
pub(crate) const APB1: APBPrescaler = APBPrescaler::DIV2;
