//! What the board's hardware must do, tried on the chip itself: `cargo fw-test` with a board and a probe, `cargo test -p virtual-board --test
//! fw_test` on the virtual board. Each test begins with a reset. Nothing needs to be wired, and nothing heats: the heater's output is never
//! enabled with power. **The settings that were saved on the board are erased.**
#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unexpected_cfgs, reason = "the macro of the tests asks for `rust_analyzer`")]

#[cfg(target_os = "none")]
#[path = "../src/hardware/mod.rs"]
#[allow(dead_code, reason = "each test needs a part of it")]
mod hardware;

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
#[embedded_test::tests]
mod tests {
    use embassy_futures::block_on;
    use embassy_time::{Duration, block_for};
    use embedded_io_async::Write;
    use embedded_storage_async::nor_flash::{NorFlash, ReadNorFlash};
    use fdi_core::control::Controller;
    use fdi_core::sense::thermistor::Thermistor;
    use fdi_core::{AdcCode, Celsius, Command, Config, Feedback, Percent, RawSample};
    use firmware_logic::cadence::Arrival;
    use firmware_logic::control_loop::{ControlLoop, Heater, Order};
    use firmware_logic::interlock::{Interlock, Lockout};
    use firmware_logic::retained::Retained;

    use super::hardware::board::{First, Parts, SETTINGS_SECTOR};
    use super::hardware::clock::{self, Source};
    use super::hardware::heater::HeaterOutput;
    use super::hardware::inputs::Inputs;
    use super::hardware::settings_flash::SettingsFlash;
    use super::hardware::watchdog::{self, Deadline};
    use super::hardware::{memory, reset, retained, serial, slow_clock, tick_timer};

    /// The chip with its clocks running.
    struct Chip {
        clock: Source,
        first: First,
        parts: Parts,
    }

    #[init]
    fn init() -> Chip {
        // The watchdog's oscillator, which its start starts, measures the clocks; 8 s are more than any test takes.
        watchdog::start();
        let (peripherals, clock) = clock::init();
        super::hardware::set_priorities();
        let (first, parts) = Parts::new(peripherals);
        Chip { clock, first, parts }
    }

    fn heater(parts: (Parts, First)) -> HeaterOutput {
        let (parts, _) = parts;
        HeaterOutput::new(parts.pwm_timer, (parts.heater, parts.contactor), parts.break_input, false)
    }

    #[test]
    fn both_timers_count_microseconds(chip: Chip) {
        tick_timer::start(chip.first.tick_timer);
        let begin = tick_timer::now();
        block_for(Duration::from_millis(20));
        let took = tick_timer::now().wrapping_sub(begin);
        assert!((20_000..20_020).contains(&took), "{} us", took);
    }

    #[test]
    fn the_clock_is_the_crystal_and_agrees_with_the_watchdogs_oscillator(chip: Chip) {
        assert!(chip.clock == Source::StLink);
        tick_timer::start(chip.first.tick_timer);
        tick_timer::enable_interrupt();
        for _ in 0..20 {
            slow_clock::begin();
            block_for(Duration::from_millis(2));
            assert!(slow_clock::is_right());
        }
    }

    #[test]
    fn the_converter_reads_its_reference_and_all_inputs(chip: Chip) {
        tick_timer::start(chip.first.tick_timer);
        tick_timer::enable_interrupt();
        let mut inputs = Inputs::new(chip.parts.adc, chip.parts.thermistors, chip.parts.supply);
        let begin = tick_timer::now();
        let RawSample { t0, t1, t2, supply } = block_on(inputs.sample());
        let took = tick_timer::now().wrapping_sub(begin);
        assert!([t0, t1, t2, supply].iter().all(|code| (0.0..=4095.0).contains(&code.0)));
        assert!((1_200..1_400).contains(&took), "{} us", took);
    }

    #[test]
    fn a_sector_of_the_settings_is_erased_written_and_read(chip: Chip) {
        let mut flash = SettingsFlash::new(chip.first.flash);
        let (from, to) = (SETTINGS_SECTOR as u32, 2 * SETTINGS_SECTOR as u32);
        let mut seen = [0; 8];
        for _ in 0..2 {
            assert!(block_on(flash.erase(from, to)).is_ok());
            assert!(block_on(flash.read(from, &mut seen)).is_ok() && seen == [0xFF; 8]);
            assert!(block_on(flash.write(from, b"PT-326 !")).is_ok());
            assert!(block_on(flash.read(from, &mut seen)).is_ok() && seen == *b"PT-326 !");
        }
        assert!(block_on(flash.erase(from, to)).is_ok());
    }

    /// Twice through here: the second time after a reset by the watchdog.
    #[test]
    fn an_unfed_watchdog_resets_within_its_deadline(chip: Chip) {
        if reset::take_flags().watchdog {
            return;
        }
        tick_timer::start(chip.first.tick_timer);
        watchdog::set(Deadline::Running);
        block_for(Duration::from_millis(753));
        panic!("no reset");
    }

    #[test]
    fn what_is_retained_is_read_again_and_a_detector_that_has_cut_is_told(_chip: Chip) {
        let left = Retained { lockout: Some(Lockout::WrongClock), ..Retained::EMPTY };
        retained::store(&left);
        assert!(retained::load().is_some_and(|read| read.lockout == left.lockout));
        retained::store(&Retained::EMPTY);
        retained::note_undervoltage();
        assert!(retained::load().is_some_and(|read| read.lockout == Some(Lockout::Undervoltage)));
        retained::store(&Retained::EMPTY);
    }

    #[test]
    fn flash_and_ram_hold_what_was_written(chip: Chip) {
        memory::start(chip.first.checksum);
        for _ in 0..1500 {
            memory::test();
            watchdog::feed();
        }
        assert!(memory::holds());
    }

    #[test]
    fn without_an_enable_no_power_reaches_a_pin(chip: Chip) {
        let mut output = heater((chip.parts, chip.first));
        output.drive(Percent(100.0));
        output.contactor(true);
        block_for(Duration::from_millis(1));
        assert!(!output.is_enabled() && !output.is_stuck_high());
        output.contactor(false);
        output.drive(Percent(0.0));
    }

    /// With the interlock closed by the timer's own event, with an open one by its level.
    #[test]
    fn the_break_input_cuts(chip: Chip) {
        let mut output = heater((chip.parts, chip.first));
        if output.break_is_open() {
            output.enable();
            assert!(!output.is_enabled(), "the interlock is open");
        } else {
            assert!(output.test_break());
        }
        assert!(!output.is_enabled() && !output.is_stuck_high());
    }

    #[test]
    fn the_port_sends_at_its_rate(chip: Chip) {
        tick_timer::start(chip.first.tick_timer);
        let port = serial::open(chip.parts.usart, chip.parts.rx, chip.parts.tx);
        let Some((mut tx, _rx)) = port else { panic!("the HAL refuses") };
        let begin = tick_timer::now();
        assert!(block_on(tx.write_all(b"on-target tests\r\n")).is_ok() && block_on(tx.flush()).is_ok());
        // 17 bytes of 10 bits; the flush ends when the last of them has left the ring.
        let took = tick_timer::now().wrapping_sub(begin);
        assert!((1_300..1_700).contains(&took), "{} us", took);
    }

    /// A rig of one lag: 0.3 degC a per cent, 2 s.
    #[test]
    fn the_loop_holds_a_simulated_rig_at_its_set_point(_chip: Chip) {
        let mut config = Config::default();
        config.supervisor.check_before_arming = false;
        let (Ok(controller), Ok(thermistor)) =
            (Controller::new(&config), Thermistor::new(&config.sensors.t1, 1))
        else {
            panic!("the defaults are valid")
        };
        let mut control = ControlLoop::new(controller, config.setpoint, Interlock::default());
        let mut output = Nothing::default();
        let (room, mut rise, mut sum) = (22.0, 0.0, 0.0);
        for tick in 0..600 {
            let code = |celsius: f32| AdcCode(whole(thermistor.code(Celsius(celsius)).0));
            let raw = RawSample {
                t0: code(room),
                t1: code(room + rise),
                t2: code(room + 0.9 * rise),
                supply: AdcCode(0.0),
            };
            let order = (tick == 20).then_some(Order::Command(Command::Arm));
            let record = control.tick(raw, Arrival::default(), order, Feedback::default(), &mut output);
            rise += (0.3 * output.power - rise) * config.sample_time.0 / 2.0;
            sum += if tick >= 400 { room + rise } else { 0.0 };
            assert!(record.lockout.is_none());
            watchdog::feed();
        }
        let mean = sum / 200.0;
        assert!((mean - config.setpoint.0).abs() < 0.5, "{} degC", mean);
    }

    /// A code of the converter.
    fn whole(code: f32) -> f32 {
        (code + 0.5) as u32 as f32
    }

    /// An output that leads nowhere.
    #[derive(Default)]
    struct Nothing {
        power: f32,
        enabled: bool,
    }

    impl Heater for Nothing {
        fn drive(&mut self, power: Percent) {
            self.power = power.0;
        }
        fn contactor(&mut self, _closed: bool) {}
        fn enable(&mut self) {
            self.enabled = true;
        }
        fn disable(&mut self) {
            (self.enabled, self.power) = (false, 0.0);
        }
        fn is_enabled(&self) -> bool {
            self.enabled
        }
        fn break_is_open(&self) -> bool {
            false
        }
        fn cut_by(&self) -> Lockout {
            Lockout::BreakInput
        }
        fn test_break(&mut self) -> bool {
            true
        }
    }
}
