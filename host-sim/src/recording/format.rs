//! How recordings that others make are laid out: which column is what, guessed from the header where it is obvious.

use anyhow::{bail, ensure};

use super::table::Table;

/// What a column may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Time: see [`super::stamp`].
    Time,
    /// Ambient temperature.
    T0,
    /// Temperature at the heater's outlet.
    T1,
    /// Temperature behind that.
    T2,
    /// Power of the heater, measured or commanded.
    Power,
    /// Power of a second heater, which warms T1 too.
    Known,
    /// Level of the fan, % of the usual one.
    Fan,
    /// Supply of the heater, share of the nominal voltage.
    Supply,
    /// What is another number in another session: a run of the logger, from which nothing follows for the next.
    Session,
}

/// Every role by the name that it has on the command line.
pub const ROLES: [(&str, Role); 9] = [
    ("time", Role::Time),
    ("t0", Role::T0),
    ("t1", Role::T1),
    ("t2", Role::T2),
    ("power", Role::Power),
    ("known", Role::Known),
    ("fan", Role::Fan),
    ("supply", Role::Supply),
    ("session", Role::Session),
];

/// One heater with its thermistors: which column is what.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    columns: Vec<(Role, String)>,
}

impl Map {
    /// From `role=column` each.
    ///
    /// # Errors
    /// A role that there is none of, one that is given twice, or neither T1 nor power.
    pub fn parse<'a>(pairs: impl Iterator<Item = &'a str>) -> anyhow::Result<Self> {
        let mut columns: Vec<(Role, String)> = Vec::new();
        for pair in pairs {
            let known = || ROLES.map(|(name, _)| name).join(", ");
            let Some((name, column)) = pair.split_once('=') else {
                bail!("--map {pair}: expected ROLE=COLUMN, such as t1=T1_read_degC")
            };
            let Some((_, role)) = ROLES.iter().find(|(known, _)| *known == name) else {
                bail!("--map {pair}: there is no role `{name}`, expected one of {}", known())
            };
            ensure!(columns.iter().all(|(known, _)| known != role), "--map {pair}: {name} is given twice");
            columns.push((*role, column.to_owned()));
        }
        let map = Self { columns };
        for (name, role) in [("t1", Role::T1), ("power", Role::Power)] {
            ensure!(map.column(role).is_some(), "no column is said to be `{name}`: add --map {name}=COLUMN");
        }
        Ok(map)
    }

    /// The column that has a role.
    pub fn column(&self, role: Role) -> Option<&str> {
        self.columns.iter().find(|(known, _)| *known == role).map(|(_, column)| column.as_str())
    }

    /// The arguments that say the same.
    pub fn arguments(&self) -> String {
        let pairs = self.to_pairs().map(|pair| {
            match pair.chars().any(|c| !c.is_alphanumeric() && !"_=.-".contains(c)) {
                true => format!("--map '{}'", pair.replace('\'', "'\\''")),
                false => format!("--map {pair}"),
            }
        });
        pairs.collect::<Vec<_>>().join(" ")
    }

    fn to_pairs(&self) -> impl Iterator<Item = String> {
        let name = |role: Role| ROLES.iter().find(|(_, known)| *known == role).map_or("", |(name, _)| name);
        self.columns.iter().map(move |(role, column)| format!("{}={column}", name(*role)))
    }
}

impl std::fmt::Display for Map {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.to_pairs().collect::<Vec<_>>().join(" "))
    }
}

/// A layout that is known by its header.
struct Format {
    name: &'static str,
    /// One map for each heater.
    heaters: &'static [&'static str],
    /// The power that is 100 %.
    full_power: f64,
    /// Nothing but a fan moves its air.
    fan: bool,
}

/// The first whose columns are all there is taken.
const FORMATS: [Format; 6] = [
    Format {
        name: "a trace of this project",
        heaters: &["time=t_s t0=t0_c t1=t1_c t2=t2_c power=pa_pct fan=fan_pct supply=supply"],
        full_power: 100.0,
        fan: true,
    },
    Format {
        name: "a trace of this project without known inputs",
        heaters: &["time=t_s t0=t0_c t1=t1_c t2=t2_c power=pa_pct"],
        full_power: 100.0,
        fan: true,
    },
    Format {
        name: "TCLab, commands and readings",
        heaters: &[
            "time=t_s t1=T1_read_degC power=Q1_cmd_pct known=Q2_cmd_pct",
            "time=t_s t1=T2_read_degC power=Q2_cmd_pct known=Q1_cmd_pct",
        ],
        full_power: 100.0,
        fan: false,
    },
    Format {
        name: "TCLab",
        heaters: &[
            "time=t_s t1=T1_degC power=Q1_pct known=Q2_pct",
            "time=t_s t1=T2_degC power=Q2_pct known=Q1_pct",
        ],
        full_power: 100.0,
        fan: false,
    },
    Format {
        name: "TCLab's historian",
        heaters: &["time=Time t1=T1 power=Q1 known=Q2", "time=Time t1=T2 power=Q2 known=Q1"],
        full_power: 100.0,
        fan: false,
    },
    Format {
        name: "TCLab with one heater",
        heaters: &["time=Time t1=T1 power=Q1"],
        full_power: 100.0,
        fan: false,
    },
];

/// What a recording is taken for.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// What to call the format; none: each column is taken for what its name says.
    pub name: Option<&'static str>,
    /// One map for each heater.
    pub heaters: Vec<Map>,
    /// The power that is 100 %; none: as the numbers say.
    pub full_power: Option<f64>,
    /// Nothing but a fan moves its air.
    pub fan: bool,
}

/// Takes a table for the first format whose columns it has, and else its columns for what they are called.
pub fn guess(table: &Table) -> Option<Guess> {
    let maps = |format: &Format| {
        let parse = |text: &&str| Map::parse(text.split(' ')).ok();
        format.heaters.iter().map(parse).collect::<Option<Vec<Map>>>()
    };
    let known = FORMATS.iter().find_map(|format| {
        let heaters = maps(format)?;
        let all_there = heaters.iter().flat_map(|map| &map.columns).all(|(_, column)| table.has(column));
        let Format { name, full_power, fan, .. } = *format;
        all_there.then_some(Guess { name: Some(name), heaters, full_power: Some(full_power), fan })
    });
    known.or_else(|| by_words(table))
}

const TIME: [&str; 14] = [
    "timestamp",
    "datetime",
    "time",
    "elapsed",
    "clock",
    "date",
    "epoch",
    "uptime",
    "millis",
    "seconds",
    "sec",
    "ms",
    "s",
    "t",
];
const TEMPERATURE: [&str; 8] =
    ["temperature", "temp", "temps", "t", "thermistor", "thermocouple", "pv", "celsius"];
/// What is hot, and nothing else is said of it.
const THINGS: [&str; 11] =
    ["hotend", "nozzle", "extruder", "bed", "chamber", "oven", "boiler", "tank", "plate", "block", "outlet"];
/// What is nearer to the heat comes first.
const POWER: [&str; 17] = [
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
    "q",
    "mv",
    "control",
    "u",
    "out",
];
const WANTED: [&str; 9] =
    ["setpoint", "set", "target", "sp", "desired", "reference", "ref", "goal", "wanted"];
const ROOM: [&str; 8] =
    ["ambient", "amb", "room", "outside", "outdoor", "environment", "env", "surroundings"];
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
pub fn words(name: &str) -> Vec<String> {
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
fn by_words(table: &Table) -> Option<Guess> {
    let named = |i: usize| {
        let name = if table.has(&table.name(i)) { table.name(i) } else { (i + 1).to_string() };
        let is_date = table.first_of(i).ok().flatten().is_some_and(|cell| super::stamp::is_time(&cell));
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
    })
}

/// The last word of a column in degC, or in what is made degC.
pub const DEGREES: [&str; 6] = ["c", "celsius", "f", "fahrenheit", "k", "kelvin"];

/// How many degC a temperature of this column is: `None` where it is in degC, or says nothing.
pub fn to_celsius(name: &str) -> Option<fn(f64) -> f64> {
    match words(name).last()?.as_str() {
        "f" | "fahrenheit" => Some(|x| (x - 32.0) / 1.8),
        "k" | "kelvin" => Some(|x| x - 273.15),
        _ => None,
    }
}

/// Klipper's log as a table: of each `Stats` line the time, the number of starts so far, and of each heater `temp` and `pwm`. After a shutdown
/// the log repeats what was measured and asked for last: these lines are left out. A row stands on the line that it is from. `None` of what is no such log.
pub fn klipper(text: &str) -> Option<String> {
    let (mut sessions, mut is_down) = (1, false);
    let mut heaters: Vec<&str> = Vec::new();
    let mut stats = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.starts_with("Start printer at") || line.starts_with("Starting Klippy") {
            (sessions, is_down) = (sessions + 1, false);
        }
        is_down |= line.starts_with("Transition to shutdown state") || line.contains("' shutdown: ");
        let Some((time, rest)) = line.split_once("Stats ").and_then(|(_, rest)| rest.split_once(": ")) else {
            continue;
        };
        let of = of_heaters(rest);
        if is_down || of.is_empty() {
            continue;
        }
        for (name, ..) in &of {
            if !heaters.contains(name) {
                heaters.push(name);
            }
        }
        stats.push((number, time, sessions, of));
    }
    // The hot end first: it is what most ask about.
    heaters.sort_by_key(|name| !name.starts_with("extruder"));
    let columns = heaters.iter().map(|name| format!(",{name}_temp,{name}_pwm"));
    let mut out = format!("t_s,session{}\n", columns.collect::<String>());
    let mut written = 1;
    for (number, time, session, of) in &stats {
        (written..*number).for_each(|_| out.push('\n'));
        written = number + 1;
        out += &format!("{time},{session}");
        for name in &heaters {
            let (_, temp, pwm) = of.iter().find(|(of, ..)| of == name).unwrap_or(&("", "", ""));
            out += &format!(",{temp},{pwm}");
        }
        out.push('\n');
    }
    (!stats.is_empty()).then_some(out)
}

/// Name, `temp` and `pwm` of each heater of a `Stats` line: `extruder: target=200 temp=199.5 pwm=0.413`.
fn of_heaters(stats: &str) -> Vec<(&str, &str, &str)> {
    let mut heaters: Vec<(&str, &str, &str)> = Vec::new();
    for word in stats.split_whitespace() {
        if let Some(name) = word.strip_suffix(':') {
            heaters.push((name, "", ""));
        } else if let (Some(last), Some((key, value))) = (heaters.last_mut(), word.split_once('=')) {
            match key {
                "temp" => last.1 = value,
                "pwm" => last.2 = value,
                _ => {}
            }
        }
    }
    heaters.retain(|(_, temp, pwm)| !temp.is_empty() && !pwm.is_empty());
    heaters
}

/// Artisan's table without the line of properties before its header.
pub fn artisan(text: &str) -> Option<&str> {
    let (first, rest) = text.split_once('\n')?;
    (first.contains("CHARGE:") && rest.starts_with("Time1")).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table {
        Table::parse("f".into(), text).unwrap()
    }

    #[test]
    fn a_header_that_is_known_says_which_column_is_what() {
        let guessed = guess(&table("t_s,Q1_pct,Q2_pct,T1_degC,T2_degC\n0,1,2,3,4\n")).unwrap();
        assert_eq!((guessed.name, guessed.heaters.len()), (Some("TCLab"), 2));
        assert_eq!(guessed.heaters[1].column(Role::T1), Some("T2_degC"));
        assert_eq!(guessed.heaters[1].column(Role::Known), Some("Q1_pct"));
        let one = guess(&table(",Time,Q1,T1,T2\n0,0,1,2,3\n")).unwrap();
        assert_eq!(one.name, Some("TCLab with one heater"));
        assert_eq!(guess(&table("a,b\n1,2\n")), None);
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
        let map = Map::parse(["time=t", "t1=Temp [°C]", "power=it's"].into_iter()).unwrap();
        assert_eq!(map.arguments(), "--map time=t --map 't1=Temp [°C]' --map 'power=it'\\''s'");
    }

    #[test]
    fn lines_of_a_printers_log_are_a_table_of_all_heaters_and_starts() {
        let stats = |t: u32, bed: &str, pwm: &str| {
            format!(
                "Stats {t}.5: gcodein=0  mcu: mcu_awake=0.0 heater_bed: target=60 temp={bed} pwm=0.2 sysload=0.1 print_stall=0 extruder: target=200 temp=199.5 pwm={pwm}\n"
            )
        };
        let log = [
            "Start printer at Wed May  1 10:00:00 2024 (1714550400.0 9.0)\n",
            &stats(10, "59.9", "0.413"),
            "other\n",
            "Transition to shutdown state: Heater extruder not heating at expected rate\n",
            &stats(11, "59.9", "1.000"),
            "Start printer at Wed May  1 10:10:00 2024 (1714551000.0 2.0)\n",
            &stats(3, "0.0", "0.000"),
        ]
        .concat();
        let text = klipper(&log).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "t_s,session,extruder_temp,extruder_pwm,heater_bed_temp,heater_bed_pwm",
                "10.5,2,199.5,0.413,59.9,0.2",
                "",
                "",
                "",
                "",
                "3.5,3,199.5,0.000,0.0,0.2"
            ]
        );
        let guess = guess(&table(&text)).unwrap();
        assert_eq!((guess.name, guess.full_power), (Some("Klipper's log"), Some(1.0)));
        let maps: Vec<String> = guess.heaters.iter().map(Map::to_string).collect();
        assert_eq!(
            maps,
            [
                "time=t_s t1=extruder_temp power=extruder_pwm session=session",
                "time=t_s t1=heater_bed_temp power=heater_bed_pwm session=session"
            ]
        );
        assert_eq!(klipper("t,u\n1,2\n"), None);
    }

    #[test]
    fn a_map_names_what_is_wrong_with_it() {
        let error = |pairs: &[&str]| Map::parse(pairs.iter().copied()).unwrap_err().to_string();
        assert!(error(&["t1"]).contains("ROLE=COLUMN"));
        assert!(error(&["t9=x"]).contains("no role `t9`"));
        assert!(error(&["t1=x", "t1=y"]).contains("twice"));
        assert!(error(&["t1=x"]).contains("--map power=COLUMN"));
        assert_eq!(Map::parse(["t1=x", "power=y"].into_iter()).unwrap().to_string(), "t1=x power=y");
    }
}
