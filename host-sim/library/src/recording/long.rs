//! Long tables, a row for each value, made wide: what Home Assistant exports (`entity_id,state,last_changed`) and InfluxDB (`_time,_value,_field`).

use std::collections::HashMap;

use super::cell::{Decimal, is_missing, value};
use super::stamp::Stamps;
use super::table::Table;

/// What the columns are called: whose value it is, the value, and when it was so.
const NAME: [&str; 10] =
    ["entity_id", "_field", "variable", "sensor", "metric", "channel", "tag", "topic", "series", "parameter"];
const VALUE: [&str; 4] = ["state", "_value", "value", "reading"];
const TIME: [&str; 7] = ["last_changed", "last_updated", "_time", "timestamp", "datetime", "time", "date"];

/// A column for each name, a row for each time at which the one with most values has one: the others are as they were told last. Text of `time_s` and
/// the names; `None` of what is no such table.
pub(super) fn table(text: &str) -> Option<String> {
    let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#'))?;
    let of = |any: &[&str]| {
        let cells: Vec<String> = header
            .split([',', ';', '\t'])
            .map(|cell| cell.trim_matches(['"', ' ', '\r', '\u{feff}']).to_lowercase())
            .collect();
        any.iter().find_map(|name| cells.iter().position(|cell| cell == name))
    };
    let [name, value_of, time] = [of(&NAME)?, of(&VALUE)?, of(&TIME)?];
    // InfluxDB writes the header anew for each of its tables.
    let once = text.lines().filter(|line| *line != header).map(|line| format!("\n{line}"));
    let long = Table::parse(String::new(), &(header.to_owned() + &once.collect::<String>())).ok()?;
    let times = Stamps::of(&long, time, None).ok()?.1.values;
    let cells = long.texts([name, value_of]).ok()?;
    let mut rows: Vec<(f64, &str, &str)> = times
        .into_iter()
        .zip(&cells)
        .filter_map(|(time, [name, cell])| Some((time?, name.as_str(), cell.as_str())))
        .filter(|(_, _, cell)| value(cell, Decimal::Either).is_some() || is_missing(cell))
        .collect();
    let mut counts: HashMap<&str, usize> = HashMap::new();
    rows.iter().for_each(|(_, name, _)| *counts.entry(name).or_default() += 1);
    let mut names: Vec<&str> = counts.keys().copied().collect();
    names.sort_unstable();
    let most = *names.iter().max_by_key(|name| counts[*name])?;
    // What was told at the same time stands in the same row.
    rows.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1 == most).cmp(&(b.1 == most))));
    let first = rows.first()?.0;
    let mut out = format!("time_s;{}\n", names.join(";"));
    let mut told: HashMap<&str, &str> = HashMap::new();
    for (time, name, cell) in rows {
        told.insert(name, cell);
        if name == most {
            let cells = names.iter().map(|name| told.get(name).copied().unwrap_or(""));
            out += &format!("{:.3};{}\n", time - first, cells.collect::<Vec<_>>().join(";"));
        }
    }
    (names.len() > 1).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::super::format::guess;
    use super::*;

    fn map(text: &str) -> String {
        let table = Table::parse("f".into(), text).unwrap();
        guess(&table).unwrap().heaters[0].to_string()
    }

    /// Entity by entity, the heater only when it was switched.
    #[test]
    fn what_home_assistant_exports_is_a_table() {
        let text = "\u{feff}entity_id,state,last_changed\n\
            switch.boiler_heater,on,2026-03-01T00:00:05.000Z\n\
            switch.boiler_heater,off,2026-03-01T00:00:25.000Z\n\
            sensor.boiler_temperature,20.5,2026-03-01T00:00:00.000Z\n\
            sensor.boiler_temperature,unavailable,2026-03-01T00:00:10.000Z\n\
            sensor.boiler_temperature,21.5,2026-03-01T00:00:20.000Z\n\
            sensor.boiler_temperature,22.5,2026-03-01T00:00:30.000Z\n";
        let wide = table(text).unwrap();
        assert_eq!(
            wide,
            "time_s;sensor.boiler_temperature;switch.boiler_heater\n\
            0.000;20.5;\n10.000;unavailable;on\n20.000;21.5;on\n30.000;22.5;off\n"
        );
        assert_eq!(map(&wide), "time=time_s t1=sensor.boiler_temperature power=switch.boiler_heater");
    }

    /// With what it says of its columns, and a header for each field.
    #[test]
    fn what_influxdb_exports_is_a_table() {
        let header = ",result,table,_start,_time,_value,_field\n";
        let row = |s: u32, value: u32, field: &str| {
            format!(",,0,2026-03-01T00:00:00Z,2026-03-01T00:00:{s:02}Z,{value},{field}\n")
        };
        let of = |field: &str, first: u32| (0..3).map(|k| row(10 * k, first + k, field)).collect::<String>();
        let text =
            format!("#group,false,false\n{header}{}\n{header}{}", of("temperature", 20), of("power", 50));
        let wide = table(&text).unwrap();
        assert_eq!(wide, "time_s;power;temperature\n0.000;50;20\n10.000;51;21\n20.000;52;22\n");
    }

    #[test]
    fn a_wide_table_is_none() {
        for text in
            ["t,u,y\n0,1,2\n", "time,state,temperature\n0,1,20\n", "time,sensor,value\n0,a,1\n1,a,2\n", ""]
        {
            assert_eq!(table(text), None, "{text}");
        }
    }
}
