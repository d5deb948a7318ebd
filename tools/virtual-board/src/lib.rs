#![doc = include_str!("../README.md")]

pub mod adc;
pub mod board;
pub mod checksum;
pub mod chip;
pub mod clock;
pub mod closed_loop;
pub mod cpu;
pub mod experiment;
pub mod exti;
pub mod flash;
pub mod gpio;
pub mod image;
pub mod inject;
pub mod live;
pub mod nvic;
pub mod on_target;
pub mod port;
pub mod power;
pub mod recording;
pub mod registers;
pub mod rtt;
pub mod scene;
pub mod scs;
pub mod time;
pub mod timer;
pub mod twin;
pub mod usart;
pub mod watchdog;
pub mod wiring;

/// What a program ends with: 0 where all is as it should be, 1 where not, 2 where that could not be found out, and why to standard error.
pub fn exit_code(is_well: anyhow::Result<bool>) -> std::process::ExitCode {
    let code = is_well.map_or_else(
        |error| {
            eprintln!("error: {error:#}");
            2
        },
        |is_well| u8::from(!is_well),
    );
    code.into()
}
