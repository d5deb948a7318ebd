//! What may be asked for over MQTT. There are two things, and neither switches a heater on.

use fdi_core::Refusal;
use pt326_lab::refusal;
use pt326_lab::scene::Order;
use serde_json::{Value, json};

/// What a message on the command topic may ask for. Whoever adds to this list answers for what a stranger at the broker can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Command {
    /// Heater off: `{"command":"stop"}`.
    Stop,
    /// Another set-point, degC: `{"command":"setpoint","celsius":35}`. It heats nothing where nothing regulates.
    Setpoint(f32),
}

impl Command {
    /// Reads a message.
    ///
    /// # Errors
    /// What it answers where it is none of these, or its set-point is not within the limits.
    pub(super) fn read(payload: &[u8], limits: Option<[f32; 2]>) -> Result<Self, Value> {
        let message: Value = serde_json::from_slice(payload).unwrap_or_default();
        let keys = message.as_object().map_or(0, serde_json::Map::len);
        match (message["command"].as_str(), keys, message["celsius"].as_f64()) {
            (Some("stop"), 1, _) => Ok(Self::Stop),
            (Some("setpoint"), 2, Some(celsius)) => within(celsius as f32, limits).map(Self::Setpoint),
            _ => Err(refused(r#"expected {"command":"stop"} or {"command":"setpoint","celsius":35}"#)),
        }
    }

    /// What the rig is ordered.
    pub(super) fn order(self) -> Order {
        match self {
            Self::Stop => Order::Stop,
            Self::Setpoint(celsius) => Order::Setpoint { celsius },
        }
    }
}

fn within(celsius: f32, limits: Option<[f32; 2]>) -> Result<f32, Value> {
    let [min, max] = limits.ok_or_else(|| refused("no set-point is taken here"))?;
    match celsius >= min && celsius <= max {
        true => Ok(celsius),
        false => Err(refusal::message(&Refusal::SetPoint { wanted: celsius, min, max }.into())),
    }
}

/// The answer to what is not carried out.
pub(super) fn refused(why: &str) -> Value {
    json!({ "type": "refused", "why": why })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Option<[f32; 2]> = Some([25.0, 60.0]);

    fn why(payload: &str) -> String {
        Command::read(payload.as_bytes(), LIMITS).unwrap_err()["why"].as_str().unwrap().to_owned()
    }

    #[test]
    fn stop_and_a_set_point_are_understood() {
        let read = |payload: &str| Command::read(payload.as_bytes(), LIMITS).unwrap();
        assert_eq!(read(r#"{"command":"stop"}"#).order(), Order::Stop);
        for (celsius, text) in [(25.0, "25"), (36.5, "36.50"), (36.5, "3.65e1"), (60.0, "60.0")] {
            let payload = format!(r#"{{"command":"setpoint","celsius":{text}}}"#);
            assert_eq!(read(&payload).order(), Order::Setpoint { celsius });
        }
    }

    #[test]
    fn a_set_point_out_of_bounds_is_refused_with_the_bounds() {
        for celsius in ["24.9", "60.1", "-1e9", "1e39", "1e300"] {
            let why = why(&format!(r#"{{"command":"setpoint","celsius":{celsius}}}"#));
            assert!(why.contains("expected 25 to 60 degC"), "{celsius}: {why}");
        }
        assert!(Command::read(br#"{"command":"setpoint","celsius":36}"#, None).is_err());
    }

    /// Every order of the page, under the names by which it could be asked for.
    #[test]
    fn nothing_else_is_understood() {
        let orders = [
            "arm",
            "tune",
            "acknowledge",
            "shelve",
            "relearn",
            "accept",
            "excite",
            "fan",
            "set",
            "break",
            "mend",
            "console",
        ];
        let all = orders.iter().flat_map(|order| {
            [
                format!(r#"{{"command":"{order}"}}"#),
                format!(r#"{{"command":"order","order":{{"order":"{order}"}}}}"#),
                format!(r#"{{"command":"stop","order":"{order}","celsius":30,"line":"{order}"}}"#),
                format!(r#"{{"command":"setpoint","celsius":30,"order":"{order}"}}"#),
                format!(r#"[{{"command":"stop"}},{{"command":"{order}"}}]"#),
                (*order).to_owned(),
            ]
        });
        let others = [
            "",
            "null",
            "{}",
            "{\"command\":null}",
            "\u{3}",
            r#"{"command":"setpoint"}"#,
            r#"{"command":"setpoint","celsius":"36"}"#,
        ];
        let nan = r#"{"command":"setpoint","celsius":NaN}"#;
        for payload in all.chain(others.iter().copied().chain([nan]).map(str::to_owned)) {
            let answer = Command::read(payload.as_bytes(), LIMITS).expect_err(&payload);
            assert_eq!(answer["type"], "refused");
        }
        assert!(why("arm").contains(r#"expected {"command":"stop"}"#));
    }
}
