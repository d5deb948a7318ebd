//! What a user calls faults of his own.

use fdi_core::Config;

/// The names that a user has given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// Numbers of fiv, of rows of the isolation table, each with its name.
    pub rows: Vec<(u8, String)>,
    /// Faults that were taught to the likelihood diagnosis, in the order of their places.
    pub taught: Vec<String>,
}

impl Names {
    /// Those of a configuration.
    pub fn of(config: &Config) -> Self {
        let named = config.diagnosis.isolation.iter().filter(|row| !row.name.is_empty());
        let rows = named.map(|row| (row.number, row.name.to_string())).collect();
        let taught = config.likelihood.taught.iter().map(|response| response.name.to_string()).collect();
        Self { rows, taught }
    }
}

#[cfg(test)]
mod tests {
    use fdi_core::diagnosis::signature::Signature;
    use fdi_core::likelihood::taught::Response;

    use super::*;

    #[test]
    fn rows_keep_their_numbers_and_what_was_taught_its_order() {
        assert_eq!(Names::of(&Config::default()), Names::default(), "the paper's rows have none");
        let mut config = Config::default();
        let row = config.diagnosis.isolation[0];
        let named = Signature { number: 4, name: "hand".parse().unwrap(), ..row };
        config.diagnosis.isolation.push(named).unwrap();
        for name in ["low", "cap"] {
            let response = Response { name: name.parse().unwrap(), ..Response::default() };
            config.likelihood.taught.push(response).unwrap();
        }
        let names = Names { rows: vec![(4, "hand".into())], taught: vec!["low".into(), "cap".into()] };
        assert_eq!(Names::of(&config), names);
        let told = crate::protocol::recorded(&config);
        assert_eq!(told["taught_names"], serde_json::json!(["low", "cap"]));
    }
}
