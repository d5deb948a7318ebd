//! What the NUCLEO-64 boards have in common: which pin, timer, converter and interrupt does what, by the name of what it does.
//! A board that is wired otherwise has all of this in its own file.

use embassy_stm32::interrupt::{self, Interrupt};
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Peri, bind_interrupts, peripherals};

/// Registers.
pub(crate) use embassy_stm32::pac::{
    ADC1 as ADC, GPIOA as OUTPUT_PORT, TIM1 as PWM_TIMER, TIM2 as TASK_TIMER, TIM5 as TICK_TIMER,
};
/// Peripherals and pins, to be owned. `TASK_TIMER` belongs to embassy, whose feature in Cargo.toml has to name the same timer.
pub(crate) use embassy_stm32::peripherals::{
    ADC1 as Adc, CRC as Checksum, FLASH as Flash, PA0 as T1Pin, PA1 as T2Pin, PA2 as TxPin, PA3 as RxPin,
    PA4 as T0Pin, PA5 as LedPin, PA6 as BreakPin, PA8 as HeaterPin, PA10 as ContactorPin, PB0 as SupplyPin,
    PC13 as ButtonPin, TIM1 as PwmTimer, TIM5 as TickTimer, USART2 as Usart,
};

/// ADC channels of T0 (PA4, A2), T1 (PA0, A0), T2 (PA1, A1) and the supply (PB0, A3).
pub(crate) const ADC_CHANNELS: [u8; 4] = [4, 0, 1, 8];

/// Alternate function that connects heater, contactor and break input to the timer of the PWM.
pub(crate) const PWM_AF: u8 = 1;
/// Channels of that timer, counted from 0 as the register access does.
pub(crate) const HEATER_CHANNEL: usize = 0;
pub(crate) const CONTACTOR_CHANNEL: usize = 2;
/// Channel of the tick's timer whose input the watchdog's oscillator can be, and the bits of that timer's option register (TI4_RMP = 01) that
/// make it so.
pub(crate) const SLOW_CHANNEL: usize = 3;
pub(crate) const SLOW_INPUT: u32 = 1 << 6;
/// Break input (PA6), heater (PA8) and contactor (PA10) as bits of their port.
pub(crate) const OUTPUT_PINS: u32 = 1 << 6 | HEATING_PINS;
pub(crate) const HEATING_PINS: u32 = 1 << 8 | 1 << 10;

/// Bits of the debug unit (DBGMCU) that stop a peripheral while the core is halted: the timer of the tasks and the watchdog,
/// the timer of the tick, and, in the other register, the timer of the PWM.
pub(crate) const HALT_TASKS: u32 = 1 << 0 | 1 << 12;
pub(crate) const HALT_TICK: u32 = 1 << 3;
pub(crate) const HALT_PWM: u32 = 1 << 0;

/// Where the two sectors for the settings begin (6 and 7), from the start of the flash, and the size of each.
pub(crate) const SETTINGS_START: u32 = 0x4_0000;
pub(crate) const SETTINGS_SECTOR: usize = 128 * 1024;

/// Control tick and deadline watchdog.
pub(crate) const TICK_INTERRUPT: Interrupt = interrupt::TIM5;
/// Runs the control task; the SPI itself is not used.
pub(crate) const CONTROL_INTERRUPT: Interrupt = interrupt::SPI4;
/// Clock of everything else.
pub(crate) const TASK_INTERRUPT: Interrupt = interrupt::TIM2;
/// Console.
pub(crate) const CONSOLE_INTERRUPT: Interrupt = interrupt::USART2;

bind_interrupts!(pub(crate) struct ConsoleInterrupts {
    USART2 => BufferedInterruptHandler<peripherals::USART2>;
});

/// Has the interrupt of the tick's timer call a function.
macro_rules! on_tick_interrupt {
    ($handler:path) => {
        #[interrupt]
        fn TIM5() {
            $handler();
        }
    };
}
/// Has the interrupt that runs the control task call a function.
macro_rules! on_control_interrupt {
    ($handler:path) => {
        #[interrupt]
        fn SPI4() {
            $handler();
        }
    };
}
pub(crate) use {on_control_interrupt, on_tick_interrupt};

/// The peripherals and pins, by what they do.
pub(crate) struct Parts {
    /// Thermistor inputs: T0, T1, T2.
    pub(crate) thermistors: (Peri<'static, T0Pin>, Peri<'static, T1Pin>, Peri<'static, T2Pin>),
    /// Input for the supply of the heater.
    pub(crate) supply: Peri<'static, SupplyPin>,
    pub(crate) adc: Peri<'static, Adc>,
    /// Heater PWM (D7) and its break input (D12).
    pub(crate) heater: Peri<'static, HeaterPin>,
    /// The contactor in series with the heater (D2).
    pub(crate) contactor: Peri<'static, ContactorPin>,
    pub(crate) break_input: Peri<'static, BreakPin>,
    pub(crate) pwm_timer: Peri<'static, PwmTimer>,
    /// The ST-LINK's virtual COM port.
    pub(crate) usart: Peri<'static, Usart>,
    pub(crate) tx: Peri<'static, TxPin>,
    pub(crate) rx: Peri<'static, RxPin>,
    /// LD2 (lit when high) and the user button B1 (low when pressed; the board has a pull-up).
    pub(crate) led: Peri<'static, LedPin>,
    pub(crate) button: Peri<'static, ButtonPin>,
}

/// What is needed before the settings have been read.
pub(crate) struct First {
    pub(crate) tick_timer: Peri<'static, TickTimer>,
    pub(crate) flash: Peri<'static, Flash>,
    pub(crate) checksum: Peri<'static, Checksum>,
}

impl Parts {
    /// Names the parts.
    pub(crate) fn new(p: embassy_stm32::Peripherals) -> (First, Self) {
        let parts = Self {
            thermistors: (p.PA4, p.PA0, p.PA1),
            supply: p.PB0,
            adc: p.ADC1,
            heater: p.PA8,
            contactor: p.PA10,
            break_input: p.PA6,
            pwm_timer: p.TIM1,
            usart: p.USART2,
            tx: p.PA2,
            rx: p.PA3,
            led: p.PA5,
            button: p.PC13,
        };
        (First { tick_timer: p.TIM5, flash: p.FLASH, checksum: p.CRC }, parts)
    }
}
