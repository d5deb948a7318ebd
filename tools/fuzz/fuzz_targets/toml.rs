//! Settings and scenarios as text: in force within their bounds, or refused with the name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::settings;

fuzz_target!(|text: &str| {
    let Ok(table) = text.parse::<toml::Table>() else { return };
    if let Ok(config) = settings::from_table(table.clone()) {
        fdi_core::Instrument::new(&config).expect("what was read is valid");
    }
    if let Ok(scenario) = table.try_into::<Scenario>() {
        let _ = scenario.validate();
    }
});
