//! Which column is what by what it is called.

use super::format::Guess;
use super::map::{Map, Role};
use super::stamp;
use super::table::Table;

/// English, German, Portuguese and Spanish.
const TIME: [&str; 19] = [
    "timestamp",
    "ts",
    "datetime",
    "time",
    "elapsed",
    "clock",
    "date",
    "epoch",
    "uptime",
    "millis",
    "ticks",
    "seconds",
    "sec",
    "ms",
    "s",
    "t",
    "zeit",
    "tempo",
    "tiempo",
];
const TEMPERATURE: [&str; 10] = [
    "temperature",
    "temp",
    "temps",
    "t",
    "thermistor",
    "thermocouple",
    "pv",
    "celsius",
    "temperatur",
    "temperatura",
];
/// What is hot, and nothing else is said of it.
const THINGS: [&str; 11] =
    ["hotend", "nozzle", "extruder", "bed", "chamber", "oven", "boiler", "tank", "plate", "block", "outlet"];
/// What is nearer to the heat comes first.
const POWER: [&str; 22] = [
    "power",
    "watt",
    "watts",
    "w",
    "duty",
    "dutycycle",
    "cycle",
    "pwm",
    "output",
    "heater",
    "heating",
    "heat",
    "relay",
    "ssr",
    "q",
    "mv",
    "control",
    "u",
    "out",
    "leistung",
    "potência",
    "potencia",
];
const WANTED: [&str; 14] = [
    "setpoint",
    "set",
    "target",
    "sp",
    "desired",
    "reference",
    "ref",
    "goal",
    "wanted",
    "soll",
    "sollwert",
    "referência",
    "referencia",
    "consigna",
];
const ROOM: [&str; 11] = [
    "ambient",
    "amb",
    "room",
    "outside",
    "outdoor",
    "environment",
    "env",
    "surroundings",
    "raum",
    "umgebung",
    "ambiente",
];
/// Of something else: electronics, moisture, what cools, what a controller works with.
const OTHER: [&str; 22] = [
    "cpu", "mcu", "board", "chip", "pi", "humidity", "dew", "fan", "cool", "cooling", "pump", "error", "err",
    "kp", "ki", "kd", "energy", "kwh", "factor", "pressure", "fault", "noise",
];
/// They tell no column from another.
const UNIT_WORDS: [&str; 17] = [
    "c",
    "deg",
    "degc",
    "f",
    "k",
    "pct",
    "percent",
    "read",
    "cmd",
    "value",
    "celsius",
    "fahrenheit",
    "kelvin",
    "point",
    "meas",
    "measured",
    "actual",
];

/// The words of a column's name in small letters, numbers apart: `HeaterTemp1_degC` is heater, temp, 1, deg, c.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let chars: Vec<char> = name.chars().collect();
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| chars[i]);
        let next_is_small = chars.get(i + 1).is_some_and(|next| next.is_lowercase());
        let begins = before.is_some_and(|before| {
            before.is_numeric() != c.is_numeric()
                || c.is_uppercase() && (before.is_lowercase() || before.is_uppercase() && next_is_small)
        });
        if begins || !c.is_alphanumeric() {
            words.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(last) = words.last_mut()
        {
            last.extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// A column by its name, or by its number where it has none.
struct Named {
    name: String,
    words: Vec<String>,
    /// Its first cell is a date or a clock.
    is_date: bool,
}

impl Named {
    fn has(&self, any: &[&str]) -> bool {
        self.rank(any).is_some()
    }

    /// The place of the first of these words that it has.
    fn rank(&self, any: &[&str]) -> Option<usize> {
        any.iter().position(|word| self.words.iter().any(|mine| mine == word))
    }

    /// A small t is the time, and a large one is not.
    fn is_time(&self) -> bool {
        let first = self.words.first().map(String::as_str);
        let short = matches!(first, Some("t" | "s" | "ms" | "sec"));
        self.has(&TIME) && !self.is_temperature() && (!short || self.name.starts_with(char::is_lowercase))
    }

    fn is_temperature(&self) -> bool {
        let small_t = self.words.first().is_some_and(|word| word == "t") && self.name.starts_with('t');
        let numbered = self.words.iter().any(|word| word.starts_with(char::is_numeric));
        let is_thing = || self.has(&THINGS) && !self.has(&POWER);
        self.has(&TEMPERATURE) && (!small_t || numbered) || is_thing()
    }

    fn is_power(&self) -> bool {
        self.has(&POWER)
            && !self.is_temperature()
            && !self.has(&WANTED)
            && !self.has(&ROOM)
            && !self.has(&OTHER)
    }

    /// What is left of its name says whose it is.
    fn whose(&self) -> Vec<&str> {
        let general = |word: &str| [&TEMPERATURE[..], &POWER, &UNIT_WORDS].concat().contains(&word);
        self.words.iter().map(String::as_str).filter(|word| !general(word)).collect()
    }
}

/// Each column as it is called; `None` without a temperature and a power.
pub(super) fn by_words(table: &Table) -> Option<Guess> {
    let named = |i: usize| {
        let name = if table.has(&table.name(i)) { table.name(i) } else { (i + 1).to_string() };
        let is_date = table.first_of(i).ok().flatten().is_some_and(|cell| stamp::is_time(&cell));
        Named { words: words(&name), name, is_date }
    };
    let columns: Vec<Named> = (0..table.width()).filter(|_| table.has_header()).map(named).collect();
    let rank = |of: &Named| of.rank(&TIME).filter(|_| of.is_time());
    let time = columns.iter().filter(|column| rank(column).is_some()).min_by_key(|column| rank(column));
    let time = time.or_else(|| columns.iter().find(|column| column.is_date));
    let is_time = |column: &Named| time.is_some_and(|time| time.name == column.name);
    let session = columns.iter().find(|column| column.words == ["session"]);
    let temperatures: Vec<&Named> = columns
        .iter()
        .filter(|column| {
            column.is_temperature() && !column.has(&WANTED) && !column.has(&OTHER) && !is_time(column)
        })
        .collect();
    let (rooms, hot): (Vec<&Named>, Vec<&Named>) =
        temperatures.into_iter().partition(|column| column.has(&ROOM));
    let room = rooms.first().copied().or_else(|| {
        columns.iter().find(|column| column.has(&ROOM) && !column.has(&WANTED) && !column.has(&OTHER))
    });
    // What goes into a controller, as that of the Arduino is called.
    let input = columns.iter().find(|column| column.words == ["input"]);
    let hot = if hot.is_empty() { input.into_iter().collect() } else { hot };
    let mut powers: Vec<&Named> =
        columns.iter().filter(|column| column.is_power() && !is_time(column)).collect();
    powers.sort_by_key(|column| column.rank(&POWER));
    let of = |hot: &Named| powers.iter().find(|power| power.whose() == hot.whose()).copied();
    let mut pairs: Vec<(&Named, &Named)> = hot.iter().filter_map(|hot| Some((*hot, of(hot)?))).collect();
    if pairs.is_empty() {
        pairs.push((hot.first()?, powers.first()?));
    }
    let numbered = |(hot, _): &(&Named, &Named)| hot.whose().iter().all(|word| word.parse::<u32>().is_ok());
    let beside = match pairs[..] {
        [(_, a), (_, b)] if pairs.iter().all(numbered) => [Some(b), Some(a)],
        _ => [None; 2],
    };
    let map = |(i, (hot, power)): (usize, &(&Named, &Named))| {
        let known = beside.get(i).copied().flatten();
        let roles = [
            (Role::Time, time),
            (Role::T0, room),
            (Role::T1, Some(*hot)),
            (Role::Power, Some(*power)),
            (Role::Known, known),
            (Role::Session, session),
        ];
        let columns = roles.into_iter().filter_map(|(role, column)| Some((role, column?.name.clone())));
        Map { columns: columns.collect() }
    };
    let is_klipper = table.has("extruder_temp") && table.has("extruder_pwm");
    Some(Guess {
        name: is_klipper.then_some("Klipper's log"),
        heaters: pairs.iter().enumerate().map(map).collect(),
        full_power: is_klipper.then_some(1.0),
        fan: is_klipper || columns.iter().any(|column| column.has(&["fan"])),
        is_ours: false,
    })
}

/// The last word of a column in degC, or in what is made degC.
pub(super) const DEGREES: [&str; 6] = ["c", "celsius", "f", "fahrenheit", "k", "kelvin"];

/// How many degC a temperature of this column is: `None` where it is in degC, or says nothing.
pub(super) fn to_celsius(name: &str) -> Option<fn(f64) -> f64> {
    match words(name).last()?.as_str() {
        "f" | "fahrenheit" => Some(|x| (x - 32.0) / 1.8),
        "k" | "kelvin" => Some(|x| x - 273.15),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::format::guess;
    use super::*;

    fn table(text: &str) -> Table {
        Table::parse("f".into(), text).unwrap()
    }

    /// Headers that people have; the arguments that say the same.
    #[test]
    fn columns_are_taken_for_what_they_are_called() {
        for (header, maps) in [
            ("time,temperature,power", ["time=time t1=temperature power=power"].as_slice()),
            ("Timestamp;Setpoint;Temp [°C];Output (%)", &["time=Timestamp t1=Temp [°C] power=Output (%)"]),
            ("t,PWM,W,T1,T2,Tout", &["time=t t1=T1 power=W"]),
            (
                "Date Time,Room temp,Oven temp,Target temp,Heater",
                &["time=Date Time t0=Room temp t1=Oven temp power=Heater"],
            ),
            (
                "millis,ambient,heaterTemp,dutyCycle",
                &["time=millis t0=ambient t1=heaterTemp power=dutyCycle"],
            ),
            (
                "time_s,T_ambient,T_box,fan_speed,heater_duty",
                &["time=time_s t0=T_ambient t1=T_box power=heater_duty"],
            ),
            (
                "Time (sec),Heater 1,Heater 2,Temperature 1,Temperature 2",
                &[
                    "time=Time (sec) t1=Temperature 1 power=Heater 1 known=Heater 2",
                    "time=Time (sec) t1=Temperature 2 power=Heater 2 known=Heater 1",
                ],
            ),
            ("t_s,bed_temp,bed_pwm,cpu_temp", &["time=t_s t1=bed_temp power=bed_pwm"]),
            ("PV,SP,MV", &["t1=PV power=MV"]),
            ("Millis,Setpoint,Input,Output", &["time=Millis t1=Input power=Output"]),
            ("t,hotend,hotend_target,hotend_power,bed", &["time=t t1=hotend power=hotend_power"]),
            (
                "Time,Q1,Q2,T1 meas,T2 meas",
                &["time=Time t1=T1 meas power=Q1 known=Q2", "time=Time t1=T2 meas power=Q2 known=Q1"],
            ),
            ("Zeit,Sollwert,Raumtemperatur,Temperatur,Leistung", &["time=Zeit t1=Temperatur power=Leistung"]),
            (
                "tempo_s,temperatura ambiente,temperatura,referência,potência",
                &["time=tempo_s t0=temperatura ambiente t1=temperatura power=potência"],
            ),
            ("time,humidity room,room,temp,relay heater", &["time=time t0=room t1=temp power=relay heater"]),
        ] {
            let cells = vec!["1"; header.split([',', ';']).count()];
            let separator = if header.contains(';') { ";" } else { "," };
            let guessed = guess(&table(&format!("{header}\n{}\n", cells.join(separator))));
            let guessed: Vec<String> = guessed.iter().flat_map(|g| &g.heaters).map(Map::to_string).collect();
            assert_eq!(guessed, maps, "{header}");
        }
        let dates = guess(&table(",temp,heat\n2024-05-01 10:00:00,20,1\n")).unwrap();
        assert_eq!(dates.heaters[0].to_string(), "time=1 t1=temp power=heat");
        for header in ["u,y", "time,temperature", "time,power,setpoint"] {
            let cells = vec!["1"; header.split(',').count()].join(",");
            assert_eq!(guess(&table(&format!("{header}\n{cells}\n"))), None, "{header}");
        }
    }
}
