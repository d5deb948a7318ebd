//! Which column of a recording is what.

use anyhow::{bail, ensure};

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
    pub(super) columns: Vec<(Role, String)>,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_names_what_is_wrong_with_it() {
        let error = |pairs: &[&str]| Map::parse(pairs.iter().copied()).unwrap_err().to_string();
        assert!(error(&["t1"]).contains("ROLE=COLUMN"));
        assert!(error(&["t9=x"]).contains("no role `t9`"));
        assert!(error(&["t1=x", "t1=y"]).contains("twice"));
        assert!(error(&["t1=x"]).contains("--map power=COLUMN"));
        assert_eq!(Map::parse(["t1=x", "power=y"].into_iter()).unwrap().to_string(), "t1=x power=y");
    }

    #[test]
    fn arguments_are_quoted_for_a_shell() {
        let map = Map::parse(["time=t", "t1=Temp [°C]", "power=it's"].into_iter()).unwrap();
        assert_eq!(map.arguments(), "--map time=t --map 't1=Temp [°C]' --map 'power=it'\\''s'");
    }
}
