//! What Home Assistant is told so that it shows the rig by itself: its device discovery, one message for all entities (2024.11 or later).

use serde_json::{Value, json};

/// Numbers of the state that are shown: name, name for people, unit, class of the device.
const SENSORS: [(&str, &str, &str, &str); 7] = [
    ("t0", "T0, room", "°C", "temperature"),
    ("t1", "T1, outlet", "°C", "temperature"),
    ("t2", "T2, outlet downstream", "°C", "temperature"),
    ("t1_expected", "T1 expected", "°C", "temperature"),
    ("t2_expected", "T2 expected", "°C", "temperature"),
    ("setpoint", "Set-point", "°C", "temperature"),
    ("drive", "Heater power", "%", "power_factor"),
];
/// Words of the state that are shown.
const WORDS: [(&str, &str); 3] = [("mode", "Mode"), ("class", "Fault"), ("trip", "Trip")];
/// Flags of the state that are shown.
const FLAGS: [(&str, &str); 2] = [("alarm", "Alarm"), ("advice", "Advice")];

/// The message for a rig of this name, whose topics begin with `base`. `limits`: of the set-point, where commands are taken.
pub(super) fn message(base: &str, name: &str, version: &str, limits: Option<[f32; 2]>) -> Value {
    let mut entities = serde_json::Map::new();
    let mut put = |key: &str, mut entity: Value| {
        entity["unique_id"] = json!(format!("pt326_{name}_{key}"));
        entities.insert(key.into(), entity);
    };
    for (key, about, unit, class) in SENSORS {
        put(
            key,
            json!({
                "p": "sensor", "name": about, "unit_of_measurement": unit, "device_class": class, "state_class": "measurement",
                "value_template": format!("{{{{ value_json.{key} }}}}"),
            }),
        );
    }
    for (key, about) in WORDS {
        let template = format!("{{{{ value_json.{key} or 'none' }}}}");
        put(key, json!({ "p": "sensor", "name": about, "value_template": template }));
    }
    for (key, about) in FLAGS {
        let template = format!("{{{{ 'ON' if value_json.{key} == 1 else 'OFF' }}}}");
        put(
            key,
            json!({ "p": "binary_sensor", "name": about, "device_class": "problem", "value_template": template }),
        );
    }
    if let Some([min, max]) = limits {
        let command_topic = format!("{base}/command");
        put(
            "stop",
            json!({
                "p": "button", "name": "Stop", "command_topic": command_topic, "payload_press": r#"{"command":"stop"}"#,
            }),
        );
        put(
            "set_setpoint",
            json!({
                "p": "number", "name": "Set-point to set", "command_topic": command_topic, "device_class": "temperature",
                "command_template": r#"{"command":"setpoint","celsius":{{ value }}}"#, "value_template": "{{ value_json.setpoint }}",
                "min": min, "max": max, "step": 0.1, "mode": "box", "unit_of_measurement": "°C",
            }),
        );
    }
    json!({
        "dev": { "ids": [format!("pt326_{name}")], "name": format!("PT-326 {name}"), "mdl": "PT-326 FDI", "sw": version },
        "o": { "name": "pt326", "sw": version },
        "cmps": entities,
        "state_topic": format!("{base}/state"),
        "availability_topic": format!("{base}/availability"),
        "payload_available": super::ONLINE,
        "payload_not_available": super::LOST,
    })
}

#[cfg(test)]
mod tests {
    use fdi_core::schema;

    use super::*;

    #[test]
    fn every_entity_is_a_number_of_the_schema_with_an_identity_of_its_own() {
        let shown = SENSORS
            .map(|(key, ..)| key)
            .into_iter()
            .chain(WORDS.map(|(key, _)| key))
            .chain(FLAGS.map(|(key, _)| key));
        assert!(shown.clone().all(|key| schema::field(key).is_some()));
        let message = message("pt326/a", "a", "1.2.3", None);
        let entities = message["cmps"].as_object().unwrap();
        for key in shown {
            assert_eq!(entities[key]["unique_id"], format!("pt326_a_{key}"));
        }
    }

    #[test]
    fn commands_are_offered_only_where_they_are_taken() {
        let offered = |limits| {
            let message = message("pt326/a", "a", "1.2.3", limits);
            let entities = message["cmps"].as_object().unwrap().clone();
            entities
                .into_iter()
                .filter(|(_, entity)| entity.get("command_topic").is_some())
                .collect::<Vec<_>>()
        };
        assert!(offered(None).is_empty());
        let all = offered(Some([20.0, 60.0]));
        assert_eq!(all.iter().map(|(key, _)| &**key).collect::<Vec<_>>(), ["set_setpoint", "stop"]);
        assert_eq!((&all[0].1["min"], &all[0].1["max"]), (&json!(20.0), &json!(60.0)));
    }
}
