//! Layouts of recordings that are known by their header.

use super::map::Map;
use super::names::by_words;
use super::table::Table;

/// A layout that is known by its header.
struct Format {
    name: &'static str,
    /// One map for each heater.
    heaters: &'static [&'static str],
    /// The power that is 100 %.
    full_power: f64,
    /// Nothing but a fan moves its air.
    fan: bool,
    /// It is a rig of this project.
    is_ours: bool,
}

/// The first whose columns are all there is taken.
const FORMATS: [Format; 7] = [
    Format {
        name: "a trace of this project",
        heaters: &["time=t_s t0=t0_c t1=t1_c t2=t2_c power=pa_pct fan=fan_pct supply=supply"],
        full_power: 100.0,
        fan: true,
        is_ours: true,
    },
    Format {
        name: "a trace of this project without known inputs",
        heaters: &["time=t_s t0=t0_c t1=t1_c t2=t2_c power=pa_pct"],
        full_power: 100.0,
        fan: true,
        is_ours: true,
    },
    Format {
        name: "a board's log",
        heaters: &["time=board_s t0=t0_c t1=t1_c t2=t2_c power=pa_pct"],
        full_power: 100.0,
        fan: true,
        is_ours: true,
    },
    Format {
        name: "TCLab, commands and readings",
        heaters: &[
            "time=t_s t1=T1_read_degC power=Q1_cmd_pct known=Q2_cmd_pct",
            "time=t_s t1=T2_read_degC power=Q2_cmd_pct known=Q1_cmd_pct",
        ],
        full_power: 100.0,
        fan: false,
        is_ours: false,
    },
    Format {
        name: "TCLab",
        heaters: &[
            "time=t_s t1=T1_degC power=Q1_pct known=Q2_pct",
            "time=t_s t1=T2_degC power=Q2_pct known=Q1_pct",
        ],
        full_power: 100.0,
        fan: false,
        is_ours: false,
    },
    Format {
        name: "TCLab's historian",
        heaters: &["time=Time t1=T1 power=Q1 known=Q2", "time=Time t1=T2 power=Q2 known=Q1"],
        full_power: 100.0,
        fan: false,
        is_ours: false,
    },
    Format {
        name: "TCLab with one heater",
        heaters: &["time=Time t1=T1 power=Q1"],
        full_power: 100.0,
        fan: false,
        is_ours: false,
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
    /// It is a rig of this project.
    pub is_ours: bool,
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
        let Format { name, full_power, fan, is_ours, .. } = *format;
        all_there.then_some(Guess { name: Some(name), heaters, full_power: Some(full_power), fan, is_ours })
    });
    known.or_else(|| by_words(table))
}

#[cfg(test)]
mod tests {
    use super::super::map::Role;
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
}
