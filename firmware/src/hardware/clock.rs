//! Clocks. The ST-LINK's 8 MHz (from its crystal, by way of MCO) makes 110 ms exact to some 50 ppm; the internal
//! oscillator is 1 % off and a model identified with it has time constants that are 1 % off.
//!
//! Hazard: a clock that never starts (some Nucleo revisions do not route it) would hang the start for ever, with the
//! heater off but also without a word. So it is tried for a bounded time first, and the log says which one runs.
//!
//! Hazard: a clock of another frequency makes every time of this program wrong by as much. So it is compared with the internal oscillator before
//! anything runs from it, by way of a third one, that of the watchdog; and later, while it runs, with that third one.

use embassy_stm32::Peripherals;
use embassy_stm32::pac::{FLASH, RCC};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;

use super::{board, slow_clock, tick_timer};

/// Where the time comes from.
#[derive(Clone, Copy, PartialEq, Eq, defmt::Format)]
pub(crate) enum Source {
    /// 8 MHz from the ST-LINK's crystal.
    StLink,
    /// 16 MHz internal oscillator, 1 % off.
    Internal,
    /// The same, since the external clock is not 8 MHz.
    InternalForWrongClock,
}

impl Source {
    /// Name for people.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::StLink => "the ST-LINK's crystal",
            Self::Internal => "the internal oscillator",
            Self::InternalForWrongClock => "the internal oscillator, for the external clock is not 8 MHz",
        }
    }
}

/// Frequency of the core, Hz: that of the timer of the PWM, whose bus is not divided.
pub(crate) fn core_hz() -> u32 {
    embassy_stm32::rcc::frequency::<board::PwmTimer>().0
}

/// Polls at the 16 MHz of the reset state: some 20 ms, a hundred times what a clock that is there needs.
const START_POLLS: u32 = 40_000;

/// Starts all clocks and takes the peripherals.
pub(crate) fn init() -> (Peripherals, Source) {
    slow_clock::set_reference(span_by(Sysclk::HSI, 16));
    let source = match external_starts() {
        false => Source::Internal,
        true if slow_clock::agrees(span_by(Sysclk::HSE, 8)) => Source::StLink,
        true => Source::InternalForWrongClock,
    };
    let (pll_src, prediv) = match source {
        Source::StLink => (PllSource::HSE, PllPreDiv::DIV8),
        Source::Internal | Source::InternalForWrongClock => (PllSource::HSI, PllPreDiv::DIV16),
    };
    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = (source == Source::StLink).then_some(Hse { freq: Hertz(8_000_000), mode: HseMode::Bypass });
    rcc.pll_src = pll_src;
    rcc.pll = Some(Pll { prediv, mul: board::PLL_MUL, divp: Some(PllPDiv::DIV2), divq: None, divr: None });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = board::APB1;
    rcc.apb2_pre = APBPrescaler::DIV1;
    let peripherals = embassy_stm32::init(config);

    // The HAL sets the wait states and leaves the flash accelerator off, which would halve the speed.
    FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    if source == Source::StLink {
        // If the clock dies while running, hardware triggers the break of the PWM's timer: heater off, then the NMI.
        RCC.cr().modify(|w| w.set_csson(true));
    }
    (peripherals, source)
}

/// What the slow oscillator measures by a clock that is ready, of so many MHz if it is right; the core runs from it meanwhile.
fn span_by(clock: Sysclk, mhz: u32) -> u32 {
    RCC.cfgr().modify(|w| w.set_sw(clock));
    tick_timer::count(mhz);
    let span = slow_clock::measure();
    RCC.cfgr().modify(|w| w.set_sw(Sysclk::HSI));
    span
}

fn external_starts() -> bool {
    RCC.cr().modify(|w| w.set_hsebyp(true));
    RCC.cr().modify(|w| w.set_hseon(true));
    let ready = (0..START_POLLS).any(|_| RCC.cr().read().hserdy());
    if !ready {
        RCC.cr().modify(|w| w.set_hseon(false));
        RCC.cr().modify(|w| w.set_hsebyp(false));
    }
    ready
}
