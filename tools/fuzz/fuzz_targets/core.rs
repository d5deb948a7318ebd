//! Codes and commands of any bits, a tick each: what comes out is finite and within its bounds, and nothing heats that was not armed.
#![no_main]

use fdi_core::{AdcCode, Celsius, Command, Config, Instrument, Percent, RawSample};
use libfuzzer_sys::fuzz_target;

fn command(byte: u8, value: f32) -> Option<Command> {
    Some(match byte {
        0 => Command::Arm,
        1 => Command::Stop,
        2 => Command::Acknowledge,
        3 => Command::Relearn,
        4 => Command::Tune,
        5 => Command::SetPoint(Celsius(value)),
        6 => Command::Fan(Percent(value)),
        7 => Command::Gain(value),
        _ => return None,
    })
}

fuzz_target!(|data: &[u8]| {
    let mut config = Config::default();
    config.supervisor.check_before_arming = false;
    let mut instrument = Instrument::new(&config).expect("the defaults are valid");
    let mut armed = false;
    for chunk in data.chunks_exact(9) {
        let code = |i: usize| {
            let whole = u16::from_le_bytes([chunk[i], chunk[i + 1]]);
            // Half of the numbers are codes, the others any bits.
            AdcCode(if whole < 0x8000 {
                f32::from(whole) / 8.0
            } else {
                f32::from_bits(u32::from(whole) << 16)
            })
        };
        let (t0, t1, t2, supply) = (code(1), code(3), code(5), code(7));
        if let Some(command) = command(chunk[0], supply.0) {
            armed |= instrument.command(command).is_ok() && matches!(command, Command::Arm | Command::Tune);
        }
        let tick = instrument.control(RawSample { t0, t1, t2, supply });
        let report = instrument.diagnose(&tick, tick.drive);
        assert!((0.0..=100.0).contains(&tick.drive.0) && (armed || tick.drive.0 == 0.0), "{tick:?}");
        assert!(report.likelihood.finding.is_none_or(|finding| (0.0..=1.0).contains(&finding.confidence)));
    }
});
