//! Lines at the board's console, with the rig beside it: no line ends the program, and nothing heats that was not armed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pt326::commands::console::Bench;
use pt326_host::experiment::scenario::Scenario;

fuzz_target!(|text: &str| {
    let mut bench =
        Bench::new(&fdi_core::Config::default(), &Scenario::default(), 1).expect("the defaults are valid");
    for line in text.lines().take(40) {
        bench.answer(line);
        bench.pass();
        let may_heat = text.contains("arm") || text.contains("check") || text.contains("tune");
        assert!(may_heat || bench.output().given().0 == 0.0, "{text:?}");
    }
});
