//! Logs that name each value where it stands, made a table: `temp=93.1, pid=0.413` of a kiln, `temp:35.2,power:40` for the Arduino's plotter, JSON, and what a
//! printer with Marlin says of its temperatures, `T:200.1 /200.0 B:60.0 /60.0 @:64 B@:32`.

use super::cell::{Decimal, is_missing, value};
use super::format::guess;
use super::stamp;
use super::table::Table;

/// A log shows what it is among so many records that name values, and these among so many of any kind: what it tells of itself comes first.
const LOOKED_AT: usize = 100;
const BEGINNING: usize = 1000;

/// A record for each line, in JSON for each object: a row if it has all columns. `None` of what is no such log.
pub(super) fn table(text: &str) -> Option<String> {
    let is_json = text.trim_start_matches(|c: char| c.is_whitespace() || c == '[').starts_with('{');
    let records = || text.split_inclusive(if is_json { '}' } else { '\n' });
    let named = records().take(BEGINNING).map(pairs).filter(|pairs| pairs.len() > 1);
    let columns = columns(named.take(LOOKED_AT))?;
    let is_row = |record: &&str| columns.iter().all(|name| of(&pairs(record), name).is_some());
    let has_clock = records().filter(is_row).take(LOOKED_AT).all(|record| clock(record).is_some());
    let headings = columns.iter().map(|name| heading(name));
    let mut out =
        has_clock.then_some("time").into_iter().chain(headings).collect::<Vec<_>>().join(";") + "\n";
    // A row stands on the line that it is from, below the header.
    let (mut line, mut written) = (0, 1);
    for record in records() {
        let pairs = pairs(record);
        let cells = columns.iter().map(|name| of(&pairs, name)).collect::<Option<Vec<_>>>();
        let time = clock(record).filter(|_| has_clock);
        if let Some(cells) = cells.filter(|_| time.is_some() == has_clock) {
            (written..line).for_each(|_| out.push('\n'));
            let cells = time.as_deref().into_iter().chain(cells);
            out += &(cells.collect::<Vec<_>>().join(";") + "\n");
            written = written.max(line) + 1;
        }
        line += record.matches('\n').count();
    }
    // Whoever writes other tables may have a colon in them, too.
    (is_json || guess(&Table::parse(String::new(), &out).ok()?).is_some()).then_some(out)
}

/// The names that most records have, in their order.
fn columns<'a>(records: impl Iterator<Item = Vec<(&'a str, &'a str)>>) -> Option<Vec<&'a str>> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for (name, _) in records.flatten() {
        match counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name, 1)),
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max()?;
    let is_marlin = counts.iter().any(|(name, _)| *name == "@");
    let is_column = |name: &str| !is_marlin || MARLIN.iter().any(|(short, _)| *short == name);
    let columns = counts.into_iter().filter(|(name, count)| 2 * count > most && is_column(name));
    let columns: Vec<&str> = columns.map(|(name, _)| name).collect();
    (columns.len() > 1).then_some(columns)
}

/// What Marlin calls its heaters; more hot ends than one are left out.
const MARLIN: [(&str, &str); 4] =
    [("T", "hotend_temp"), ("@", "hotend_power"), ("B", "bed_temp"), ("B@", "bed_power")];

fn heading(name: &str) -> &str {
    MARLIN.iter().find(|(short, _)| *short == name).map_or(name, |(_, long)| long)
}

fn of<'a>(pairs: &[(&'a str, &'a str)], name: &str) -> Option<&'a str> {
    pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Each name with its value: before and behind a colon or an equals sign, with or without blanks and quotes.
fn pairs(record: &str) -> Vec<(&str, &str)> {
    let signs = record.char_indices().filter(|(_, c)| matches!(c, ':' | '='));
    signs.filter_map(|(i, _)| Some((name_before(&record[..i])?, value_behind(&record[i + 1..])?))).collect()
}

fn name_before(text: &str) -> Option<&str> {
    let text = text.trim_end();
    if let Some(quoted) = text.strip_suffix('"') {
        return quoted.rsplit_once('"').map(|(_, name)| name);
    }
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '@' | '%' | '°');
    let begin = text.trim_end_matches(is_part).len();
    Some(&text[begin..]).filter(|name| name.starts_with(|c: char| c.is_alphabetic() || c == '@'))
}

fn value_behind(text: &str) -> Option<&str> {
    let text = text.trim_start();
    if let Some(quoted) = text.strip_prefix('"') {
        return quoted.split_once('"').map(|(value, _)| value).filter(|value| !value.contains(';'));
    }
    let end = text.find(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '}' | ']'));
    let word = &text[..end.unwrap_or(text.len())];
    let is_value =
        |word: &&str| !word.is_empty() && (value(word, Decimal::Either).is_some() || is_missing(word));
    // Of a printer's `22.56/60.00` the second is what is wanted.
    let pair = || word.split_once('/').filter(|(_, wanted)| is_value(wanted)).map(|(is, _)| is);
    Some(word).filter(is_value).or_else(pair).filter(is_value)
}

/// The last time of day in front of the values, with the date before it: `2019-01-21 06:25:40,390`.
fn clock(record: &str) -> Option<String> {
    let front = record.split('=').next()?.replace(',', ".");
    let words: Vec<&str> = front.split_whitespace().collect();
    let is_clock = |word: &&str| word.matches(':').count() == 2 && stamp::is_time(word);
    let at = words.iter().rposition(is_clock)?;
    let date = at.checked_sub(1).map(|before| words[before]).filter(|date| date.matches('-').count() == 2);
    Some(date.into_iter().chain([words[at]]).collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three rows of each log, and what its columns are taken for.
    #[test]
    fn logs_that_name_their_values_are_tables() {
        let kiln = |s: u32| {
            format!(
                "Jan 21 06:25:{s} pi python[286]: 2019-01-21 06:25:{s},390 INFO oven: temp =10{s}.4, target=1093.2, pid=1.000, heat_on=2.00, heat_off=0.00, run_time={s}, total_time=48780\n"
            )
        };
        let marlin = |s: u32| {
            format!(
                "2024-05-01 10:00:{s},123 - Recv: T:2{s}.10 /200.00 B:60.05 /60.00 @:64 B@:32\n2024-05-01 10:00:{s},200 - Recv: ok\n"
            )
        };
        let object = |s: u32| {
            format!("{{\"Time\": {s}.5, \"Temperature\": 3{s}.5, \"Humidity\": null, \"Heater\": \"ON\"}}")
        };
        for (text, map) in [
            ([10, 12, 14].map(kiln).concat(), "time=time t1=temp power=heat_on"),
            ([10, 12, 14].map(marlin).concat(), "time=time t1=hotend_temp power=hotend_power"),
            ([10, 12, 14].map(|s| object(s) + "\n").concat(), "time=Time t1=Temperature power=Heater"),
            (
                format!("[\n  {}\n]", [10, 12, 14].map(object).join(",\n  ")),
                "time=Time t1=Temperature power=Heater",
            ),
            ([10, 12, 14].map(|s| format!("boot\ntemp:{s}.5 power:40\n")).concat(), "t1=temp power=power"),
        ] {
            let table = Table::parse("f".into(), &table(&text).unwrap()).unwrap();
            assert_eq!(
                (table.rows(), guess(&table).unwrap().heaters[0].to_string()),
                (3, map.into()),
                "{text}"
            );
        }
    }

    #[test]
    fn a_row_stands_on_the_line_that_it_is_from() {
        let text = "temp:20 power:1\nboot\ntemp:21 power:2\n\ntemp:x power:1\ntemp:22 power:3\n";
        let table = Table::parse("f".into(), &table(text).unwrap()).unwrap();
        assert_eq!([0, 1, 2].map(|row| table.line_of(row)), [2, 3, 6]);
    }

    #[test]
    fn what_is_no_such_log_is_none() {
        for text in [
            "t,u,y\n0,1,2\n",
            "time,temp,heat\n2024-05-01T10:00:00Z,20,1\n10:00:01,21,1\n",
            "note: a=1 b=2\nt,u\n1,2\n",
            "[Logger]\nSerial: 12, Rate: 5\ntime,temp,heat\n0,20,1\n",
            "",
        ] {
            assert_eq!(table(text), None, "{text}");
        }
    }
}
