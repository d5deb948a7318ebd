//! The pins of heater and contactor, the timer behind them, the break input.

use super::{Mutant, mutant};

const FILE: &str = "firmware/src/hardware/heater.rs";
const LOOP: &str = "firmware-logic/src/control_loop.rs";

pub(super) const MUTANTS: &[Mutant] = &[
    mutant(
        "ossi-off",
        "pins are released when the output is off",
        FILE,
        ["            w.set_ossi(Ossi::IDLE_LEVEL);\n", ""],
        &["pins::"],
    ),
    mutant(
        "ossr-off",
        "a channel that is off releases its pin",
        FILE,
        ["            w.set_ossr(Ossr::IDLE_LEVEL);\n", ""],
        &["pins::a_channel", "pins::a_stray"],
    ),
    mutant("lock-off", "stray writes undo the protection", FILE, ["            w.set_lock(Lock::LEVEL3);\n", ""], &["pins::a_stray"]),
    mutant(
        "lock-level-2",
        "a stray write forces a channel high",
        FILE,
        ["Lock::LEVEL3", "Lock::LEVEL2"],
        &["pins::a_stray"],
    ),
    mutant(
        "lock-level-1",
        "a stray write inverts a channel or releases the pins",
        FILE,
        ["Lock::LEVEL3", "Lock::LEVEL1"],
        &["pins::a_stray"],
    ),
    mutant(
        "break-off",
        "an open interlock is seen by nobody",
        FILE,
        ["            w.set_bke(0, true);\n", ""],
        &["heater_off::break_input", "heater_off::external_clock_stops"],
    ),
    mutant(
        "break-polarity",
        "an open interlock runs, a closed one stops",
        FILE,
        ["w.set_bkp(0, Bkp::ACTIVE_HIGH)", "w.set_bkp(0, Bkp::ACTIVE_LOW)"],
        &["heater_off::break_input", "boot::arms"],
    ),
    mutant(
        "break-pull-up-off",
        "a pulled plug is not seen",
        FILE,
        ["AfType::input(Pull::Up)", "AfType::input(Pull::None)"],
        &["heater_off::break_input"],
    ),
    mutant(
        "break-pin-not-connected",
        "the timer does not see the break input",
        FILE,
        ["break_input.set_as_af_unchecked(board::TIM1_AF, AfType::input(Pull::Up));", "break_input.set_as_input(Pull::Up);"],
        &["heater_off::break_input"],
    ),
    mutant(
        "automatic-output",
        "a closed interlock brings the heater back",
        FILE,
        ["            w.set_bke(0, true);\n", "            w.set_bke(0, true);\n            w.set_aoe(true);\n"],
        &["pins::a_closed_interlock", "pins::nothing_is_enabled"],
    ),
    mutant(
        "enabled-from-the-start",
        "the output is enabled before it is armed",
        FILE,
        ["            w.set_lock(Lock::LEVEL3);\n", "            w.set_lock(Lock::LEVEL3);\n            w.set_moe(true);\n"],
        &["pins::nothing_is_enabled"],
    ),
    mutant(
        "power-preload-off",
        "a new power takes effect within a period",
        FILE,
        ["w.set_ocpe(channel % 2, true)", "w.set_ocpe(channel % 2, false)"],
        &["pins::a_new_power"],
    ),
    mutant(
        "period-preload-off",
        "a new period takes effect within a period",
        FILE,
        ["            w.set_arpe(true);\n", ""],
        &["pins::"],
    )
    .unseen("the period is written once, before the counter runs"),
    mutant(
        "pin-before-timer",
        "the pin is handed over before the timer holds it low",
        FILE,
        [
            "        rcc::enable_and_reset::<TIM1>();\n",
            "        rcc::enable_and_reset::<TIM1>();\n        pac::GPIOA.afr(1).modify(|w| w.set_afr(0, 1));\n        \
             pac::GPIOA.moder().modify(|w| w.set_moder(8, pac::gpio::vals::Moder::ALTERNATE));\n",
        ],
        &["pins::after_the_start", "boot::"],
    )
    .unseen("the timer as reset releases its channels, as an input would"),
    mutant(
        "heater-inverted",
        "off is on",
        FILE,
        [
            "        t.psc().write_value(0);\n",
            "        t.psc().write_value(0);\n        t.ccer().write(|w| w.set_ccp(HEATER, true));\n",
        ],
        &["pins::after_the_start", "heater_off::t1_broken"],
    ),
    mutant("pwm-mode-2", "power 0 is full power", FILE, ["Ocm::PWM_MODE1", "Ocm::PWM_MODE2"], &["pins::"]),
    mutant("period-too-long", "100 % is less than always", FILE, ["w.set_arr(period - 1)", "w.set_arr(period)"], &["pins::a_new_power"]),
    mutant(
        "cut-without-effect",
        "nothing that cuts the heater does",
        FILE,
        ["pac::TIM1.bdtr().modify(|w| w.set_moe(false));", "let _ = pac::TIM1.bdtr().read();"],
        &["last_gasp::", "heater_off::control_task_hangs", "heater_off::stop_works", "heater_off::t1_broken"],
    ),
    mutant(
        "cut-with-reason-without-effect",
        "dead man's handle and voltage detector note a reason and cut nothing",
        FILE,
        ["    cut();\n    if was_enabled {", "    if was_enabled {"],
        &["heater_off::control_task_hangs", "brown_out::a_falling"],
    ),
    mutant(
        "contactor-left-closed",
        "one stray bit closes the contactor",
        FILE,
        ["if closed { CLOSED } else { OPEN }", "if closed { CLOSED } else { CLOSED }"],
        &["pins::a_stray_enable", "pins::the_contactor"],
    ),
    mutant(
        "contactor-never-closed",
        "the heater gets no power",
        FILE,
        ["if closed { CLOSED } else { OPEN }", "if closed { OPEN } else { OPEN }"],
        &["pins::the_contactor"],
    ),
    mutant(
        "contactor-closed-after-the-trip",
        "a trip leaves the contactor's channel closed",
        LOOP,
        ["            heater.disable();\n            heater.contactor(false);\n            heater.drive(Percent(0.0));", "            heater.disable();\n            heater.drive(Percent(0.0));"],
        &["pins::a_stray_enable"],
    ),
    mutant(
        "power-left-after-the-trip",
        "a trip leaves the power in its register",
        LOOP,
        ["            heater.contactor(false);\n            heater.drive(Percent(0.0));", "            heater.contactor(false);"],
        &["pins::a_stray_enable"],
    ),
    mutant(
        "trip-does-not-cut",
        "a trip sets the power to 0 and leaves the output enabled",
        LOOP,
        ["            heater.disable();\n            heater.contactor(false);\n            heater.drive", "            heater.contactor(false);\n            heater.drive"],
        &["pins::nothing_is_enabled", "heater_off::t1_broken"],
    ),
    mutant(
        "cut-not-latched",
        "what hardware has cut is switched on again",
        LOOP,
        ["            self.interlock.latch(hold);\n", ""],
        &["heater_off::break_input", "heater_off::control_task_hangs"],
    ),
    mutant(
        "stop-waits-for-the-tick",
        "`stop` takes up to 110 ms",
        "firmware/src/instrument.rs",
        ["    heater::cut();\n", ""],
        &["heater_off::stop_works"],
    ),
    mutant(
        "duty-never-zero",
        "power 0 is one step",
        "firmware-logic/src/duty.rs",
        ["+ 0.5) as u16", "+ 1.5) as u16"],
        &["paper::drives"],
    ),
    mutant(
        "pins-of-another-timer",
        "pins and break input are not the timer's",
        "firmware/src/hardware/nucleo_f411re.rs",
        ["const TIM1_AF: u8 = 1;", "const TIM1_AF: u8 = 2;"],
        &["pins::after_the_start", "heater_off::break_input"],
    ),
    mutant(
        "armed-with-an-open-interlock",
        "hardware alone keeps it off",
        LOOP,
        ["                if heater.break_is_open() {", "                if heater.break_is_open() && false {"],
        &["heater_off::an_open_interlock"],
    ),
    mutant("pins-not-locked", "a stray write to the port takes the pins from the timer", FILE, ["        lock_pins();\n", ""], &["pins::a_stray_write_to_the_port"]),
];
