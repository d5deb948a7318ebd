//! The last tick as text for Prometheus.

use std::fmt::Write;

use fdi_core::likelihood::FaultClass;
use pt326_lab::fields::FIELDS;

use crate::source::Numbers;

/// A value that is shown: its name, what it is, its field, and a label where several share a name.
const SHOWN: [(&str, &str, &str, &str); 12] = [
    ("pt326_temperature_celsius", "What a thermistor reads", "t0", "{sensor=\"t0\"}"),
    ("pt326_temperature_celsius", "", "t1", "{sensor=\"t1\"}"),
    ("pt326_temperature_celsius", "", "t2", "{sensor=\"t2\"}"),
    ("pt326_expected_celsius", "What it should read by the models", "t1_expected", "{sensor=\"t1\"}"),
    ("pt326_expected_celsius", "", "t2_expected", "{sensor=\"t2\"}"),
    ("pt326_setpoint_celsius", "Set-point of T1", "setpoint", ""),
    ("pt326_power_percent", "What drives the heater", "drive", ""),
    ("pt326_mode", "0 off, 1 settle, 2 learn, 3 monitor, 4 tripped, 5 tune", "mode", ""),
    ("pt326_alarm", "Whether the likelihood diagnosis is alarmed", "alarm", ""),
    ("pt326_magnitude", "Estimated size of the fault that is named", "magnitude", ""),
    ("pt326_fdv", "Fault detection vector", "fdv", ""),
    ("pt326_fiv", "Fault isolation vector", "fiv", ""),
];

/// The text of a row; `ticks` so far, for so many clients.
pub(crate) fn text(row: Option<&Numbers>, ticks: usize, clients: usize) -> String {
    let mut text = String::new();
    let mut put = |name: &str, about: &str, kind: &str, label: &str, value: f64| {
        if !about.is_empty() {
            let _ = writeln!(text, "# HELP {name} {about}\n# TYPE {name} {kind}");
        }
        let _ = writeln!(text, "{name}{label} {value}");
    };
    put("pt326_ticks_total", "Ticks since the start", "counter", "", ticks as f64);
    put("pt326_clients", "Pages that watch", "gauge", "", clients as f64);
    let Some(row) = row else { return text };
    let of = |field: &str| FIELDS.iter().position(|f| f.name == field).map_or(f32::NAN, |i| row[i]);
    for (name, about, field, label) in SHOWN {
        put(name, about, "gauge", label, of(field).into());
    }
    let named = FaultClass::ALL.iter().find(|class| class.number() as f32 == of("class"));
    if let Some(class) = named {
        let label = format!("{{class=\"{}\"}}", class.name());
        put(
            "pt326_finding",
            "Confidence in the fault that is named",
            "gauge",
            &label,
            of("confidence").into(),
        );
    }
    text
}
