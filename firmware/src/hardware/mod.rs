//! The only place that names a peripheral. What is wired where is in one file a board; the rest follows from it.

#[cfg(all(feature = "nucleo-f411re", feature = "nucleo-f446re"))]
compile_error!("one board at a time: add --no-default-features when choosing nucleo-f446re");
#[cfg(not(any(feature = "nucleo-f411re", feature = "nucleo-f446re")))]
compile_error!("choose a board: --features nucleo-f411re or --features nucleo-f446re");

#[cfg_attr(feature = "nucleo-f411re", path = "nucleo_f411re.rs")]
#[cfg_attr(feature = "nucleo-f446re", path = "nucleo_f446re.rs")]
pub(crate) mod board;

pub(crate) mod clock;
pub(crate) mod control_executor;
pub(crate) mod fault;
pub(crate) mod heater;
pub(crate) mod panel;
pub(crate) mod reset;
pub(crate) mod retained;
pub(crate) mod rtt;
pub(crate) mod serial;
pub(crate) mod settings_flash;
pub(crate) mod stack;
pub(crate) mod thermistors;
pub(crate) mod tick_timer;
pub(crate) mod watchdog;

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

/// Who may interrupt whom. The dead man's handle comes before the control task that it watches; the console's bytes
/// come last, so that a flood of them delays nothing that heats.
pub(crate) fn set_priorities() {
    interrupt::TIM5.set_priority(Priority::P0); // control tick and dead man's handle
    interrupt::SPI4.set_priority(Priority::P2); // executor of the control task; the SPI itself is not used
    interrupt::TIM2.set_priority(Priority::P4); // clock of everything else
    interrupt::USART2.set_priority(Priority::P6); // console
}

/// Freezes the timers and the watchdog while a debugger halts the core. A frozen TIM1 has its outputs off, as if its
/// main output enable were cleared: a breakpoint must not leave the heater at its last power.
pub(crate) fn freeze_while_halted() {
    const TIM2_TIM5_IWDG: u32 = 1 << 0 | 1 << 3 | 1 << 12;
    const TIM1: u32 = 1 << 0;
    embassy_stm32::pac::DBGMCU.apb1fzr().modify(|w| w.0 |= TIM2_TIM5_IWDG);
    embassy_stm32::pac::DBGMCU.apb2fzr().modify(|w| w.0 |= TIM1);
}
