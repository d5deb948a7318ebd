//! The last tick as text for Prometheus.

use std::fmt::Write;

use fdi_core::likelihood::FaultClass;
use fdi_core::schema::{self, FIELDS, Metric};

use crate::source::Numbers;

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
    for (field, value) in FIELDS.iter().zip(row) {
        let Some(Metric { name, help, label }) = &field.number.metric else { continue };
        let label = if label.is_empty() { String::new() } else { format!("{{{label}}}") };
        put(name, help, "gauge", &label, f64::from(*value));
    }
    let of = |name: &str| schema::field(name).map_or(f32::NAN, |i| row[i]);
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
