//! How recordings that others make are laid out: which column is what, guessed from the header where it is obvious.

use anyhow::{bail, ensure};

use super::table::Table;

/// What a column may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Time, s, or as hh:mm:ss.
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
}

/// Every role by the name that it has on the command line.
pub const ROLES: [(&str, Role); 8] = [
    ("time", Role::Time),
    ("t0", Role::T0),
    ("t1", Role::T1),
    ("t2", Role::T2),
    ("power", Role::Power),
    ("known", Role::Known),
    ("fan", Role::Fan),
    ("supply", Role::Supply),
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
}

impl std::fmt::Display for Map {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |role: Role| ROLES.iter().find(|(_, known)| *known == role).map_or("", |(name, _)| name);
        let pairs = self.columns.iter().map(|(role, column)| format!("{}={column}", name(*role)));
        f.write_str(&pairs.collect::<Vec<_>>().join(" "))
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
const FORMATS: [Format; 7] = [
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
    Format {
        name: "Klipper's log",
        heaters: &["time=t_s t1=extruder_temp power=extruder_pwm"],
        full_power: 1.0,
        fan: true,
    },
];

/// What a recording is taken for.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// What to call the format.
    pub name: &'static str,
    /// One map for each heater.
    pub heaters: Vec<Map>,
    /// The power that is 100 %.
    pub full_power: f64,
    /// Nothing but a fan moves its air.
    pub fan: bool,
}

/// Takes a table for the first format whose columns it has.
pub fn guess(table: &Table) -> Option<Guess> {
    let maps = |format: &Format| {
        let parse = |text: &&str| Map::parse(text.split(' ')).ok();
        format.heaters.iter().map(parse).collect::<Option<Vec<Map>>>()
    };
    FORMATS.iter().find_map(|format| {
        let heaters = maps(format)?;
        let all_there = heaters.iter().flat_map(|map| &map.columns).all(|(_, column)| table.has(column));
        let Format { name, full_power, fan, .. } = *format;
        all_there.then_some(Guess { name, heaters, full_power, fan })
    })
}

/// Klipper's log as a table: of each `Stats` line the time, and of each heater `temp`, `pwm` and `target`. `None` of what is no such log.
pub fn klipper(text: &str) -> Option<String> {
    let stats: Vec<&str> = text.lines().filter(|line| line.contains("extruder: target=")).collect();
    let mut out = String::from("t_s,extruder_temp,extruder_pwm,extruder_target\n");
    for line in &stats {
        let (_, heater) = line.split_once("extruder: ")?;
        let value = |key: &str| {
            let word = heater.split_whitespace().find_map(|word| word.strip_prefix(key)?.strip_prefix('='));
            word.unwrap_or_default().trim_end_matches(',')
        };
        let time =
            line.split_once("Stats ").and_then(|(_, rest)| rest.split_once(':')).map_or("", |(t, _)| t);
        out += &format!("{time},{},{},{}\n", value("temp"), value("pwm"), value("target"));
    }
    (!stats.is_empty()).then_some(out)
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
        assert_eq!((guessed.name, guessed.heaters.len()), ("TCLab", 2));
        assert_eq!(guessed.heaters[1].column(Role::T1), Some("T2_degC"));
        assert_eq!(guessed.heaters[1].column(Role::Known), Some("Q1_pct"));
        assert_eq!(guess(&table(",Time,Q1,T1,T2\n0,0,1,2,3\n")).unwrap().name, "TCLab with one heater");
        assert_eq!(guess(&table("u,y\n1,2\n")), None);
    }

    #[test]
    fn lines_of_a_printers_log_are_a_table() {
        let log = "Start\nStats 10.5: gcodein=0 heater_bed: target=60 temp=59.9 pwm=0.2 extruder: target=200 temp=199.5 pwm=0.413 x=1\nother\n";
        let text = klipper(log).unwrap();
        assert_eq!(text.lines().nth(1), Some("10.5,199.5,0.413,200"));
        assert_eq!(guess(&table(&text)).unwrap().name, "Klipper's log");
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
