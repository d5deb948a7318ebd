use std::collections::{BTreeMap, HashSet};

use pt326_lab::protocol;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
use serde_json::json;

use super::*;
use crate::source::{Source, Told};

/// A rig that is watched for so many ticks and then so many more with a fault.
fn watched(fault: &str, after: usize) -> History {
    let mut session = Session::new(Scene::default()).unwrap();
    let about = json!({ "version": "1.2.3", "kind": "live", "name": "a \"rig\"\\\n", "ts": 0.11 });
    let mut history = History::new(about, "id".into());
    let mut run = |session: &mut Session, ticks| {
        for _ in 0..ticks {
            let told = Source::next(session).unwrap();
            history.counts.take(&told);
            let Told::Row(row) = told else { panic!("a row") };
            history.push_row(row);
        }
    };
    run(&mut session, 4000);
    let fault: Order =
        protocol::read(format!("{{\"order\":\"break\",\"fault\":{fault}}}").as_bytes()).unwrap();
    session.order(fault).unwrap();
    run(&mut session, after);
    history
}

/// All samples by name and labels, of a text that keeps to the format: groups, types, names, labels, numbers.
fn parsed(text: &str) -> BTreeMap<String, f64> {
    let (mut samples, mut names) = (BTreeMap::new(), HashSet::new());
    let mut lines = text.lines().peekable();
    assert!(text.ends_with('\n'), "the last line ends, too");
    while let Some(line) = lines.next() {
        let (name, help) = line.strip_prefix("# HELP ").and_then(|rest| rest.split_once(' ')).expect(line);
        assert!(!help.is_empty() && names.insert(name), "{name} has one group and a help");
        assert!(
            name.starts_with("pt326_")
                && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
        );
        let kind = if name.ends_with("_total") { "counter" } else { "gauge" };
        assert_eq!(lines.next(), Some(&*format!("# TYPE {name} {kind}")));
        while let Some(sample) = lines.next_if(|line| !line.starts_with('#')) {
            let (series, value) = sample.rsplit_once(' ').expect(sample);
            let labels = series.strip_prefix(name).expect("a sample of its group");
            assert!(labels.is_empty() || are_labels(labels), "{sample}");
            assert!(
                samples.insert(series.to_owned(), value.parse().expect(sample)).is_none(),
                "{series} twice"
            );
        }
    }
    samples
}

/// `{key="value",..}` with all that must be escaped in a value escaped.
fn are_labels(text: &str) -> bool {
    let Some(mut rest) = text.strip_prefix('{') else { return false };
    loop {
        let Some((key, after)) = rest.split_once("=\"") else { return false };
        let plain = !key.is_empty() && key.bytes().all(|b| b.is_ascii_lowercase() || b == b'_');
        let mut escape = false;
        let end = after.bytes().position(|b| {
            b == b'"' && !std::mem::take(&mut escape) || {
                escape = b == b'\\' && !escape;
                false
            }
        });
        let Some(end) = end.filter(|_| plain) else { return false };
        match &after[end + 1..] {
            "}" => return true,
            more => rest = more.strip_prefix(',').unwrap_or(""),
        }
    }
}

#[test]
fn a_fault_is_told_with_its_class_size_and_age() {
    let text = text(&watched(r#"{"do":"offset","sensor":"t2","size":1.5,"at":0,"for":60}"#, 300), 2);
    let samples = parsed(&text);
    let is = |series: &str, low: f64, high: f64| {
        let value = samples.get(series).unwrap_or_else(|| panic!("no {series} in {text}"));
        assert!((low..=high).contains(value), "{series} is {value}, expected {low} to {high}");
    };
    is("pt326_build_info{version=\"1.2.3\"}", 1.0, 1.0);
    is(r#"pt326_rig_info{kind="live",name="a \"rig\"\\\n"}"#, 1.0, 1.0);
    is("pt326_ticks_total", 4300.0, 4300.0);
    is("pt326_clients", 2.0, 2.0);
    is("pt326_mode", 3.0, 3.0);
    is("pt326_mode_info{mode=\"monitor\"}", 1.0, 1.0);
    is("pt326_readiness_info{readiness=\"armed\"}", 1.0, 1.0);
    is("pt326_temperature_celsius{sensor=\"t1\"}", 34.0, 36.0);
    is("pt326_expected_celsius{sensor=\"t2\"}", 32.0, 35.0);
    is("pt326_setpoint_celsius", 35.0, 35.0);
    is("pt326_power_ratio", 0.2, 0.7);
    is("pt326_alarm", 1.0, 1.0);
    is("pt326_advice", 0.0, 0.0);
    is("pt326_alarms_total", 1.0, 1.0);
    is("pt326_class_info{class=\"t2_offset\"}", 1.0, 1.0);
    is("pt326_confidence_ratio{class=\"t2_offset\"}", 0.9, 1.0);
    is("pt326_magnitude{class=\"t2_offset\",unit=\"degC\"}", 1.2, 1.8);
    is("pt326_half_width{class=\"t2_offset\",unit=\"degC\"}", 0.01, 0.5);
    is("pt326_fault_age_seconds{class=\"t2_offset\"}", 31.0, 35.0);
    is("pt326_explained_ratio{class=\"t2_offset\"}", 0.5, 1.0);
    is("pt326_fdv", 1.0, 1.0);
    is("pt326_residual_ratio{residual=\"ry12\"}", -1000.0, -1.0);
    is("pt326_trips_total{trip=\"t1_open\"}", 0.0, 0.0);
    assert!(
        !text.contains("percent") && !text.contains("pt326_trip_info") && !text.contains("NaN"),
        "{text}"
    );
}

#[test]
fn a_trip_is_told_with_its_reason() {
    let samples = parsed(&text(&watched(r#"{"do":"open","sensor":"t1","at":0,"for":60}"#, 50), 0));
    for series in [
        "pt326_mode_info{mode=\"tripped\"}",
        "pt326_trip_info{trip=\"t1_open\"}",
        "pt326_trips_total{trip=\"t1_open\"}",
    ] {
        assert_eq!(samples.get(series), Some(&1.0), "{series}");
    }
    assert_eq!(samples.keys().filter(|series| series.starts_with("pt326_mode_info")).count(), 1);
    assert!(!samples.contains_key("pt326_temperature_celsius{sensor=\"t1\"}"), "an open wire reads nothing");
}

#[test]
fn before_the_first_tick_there_are_counts_only() {
    let samples = parsed(&text(&History::new(json!({ "ts": 0.5 }), "id".into()), 0));
    assert_eq!((samples["pt326_ticks_total"], samples["pt326_sample_time_seconds"]), (0.0, 0.5));
    assert!(
        !samples.contains_key("pt326_mode") && !samples.contains_key("pt326_last_tick_timestamp_seconds")
    );
}

/// A name that is given here to a field which the schema does not have, or names itself, is given in vain.
#[test]
fn only_fields_without_a_name_in_the_schema_are_named_here() {
    for (of, ..) in UNNAMED {
        let field = FIELDS.iter().find(|field| field.name == of).unwrap_or_else(|| panic!("no field {of}"));
        assert!(field.number.metric.is_none(), "{of}");
    }
}
