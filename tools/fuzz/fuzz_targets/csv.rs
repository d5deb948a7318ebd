//! Files that somebody calls recordings: read, or refused with words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pt326_host::recording::table::Table;

fuzz_target!(|text: &str| {
    let Ok(table) = Table::parse("fuzz".into(), text) else { return };
    for column in 0..table.width().min(6) {
        let _ = (table.name(column), table.values_or_gaps(column).map(drop));
    }
});
