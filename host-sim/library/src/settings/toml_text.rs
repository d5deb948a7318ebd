//! The default settings as TOML that explains itself.

use std::fmt::Write;

use fdi_core::likelihood::taught::{Response, names};
use fdi_core::settings::{About, Value};
use fdi_core::{Config, Setting};

use super::{form, range, table_of};

const HEAD: &str = "\
# The instrument's settings: every key with its default, which is the paper's value where the paper prints one.
# A file for --config needs only the keys that it changes. Behind each value stand its unit and what it may be.
";

const TABLES: &str = "
# Signatures: patterns over { rAP  ry12  rsg1  rsg2  rbw1 }, x is any. fdv is the number of the last row of `detection` that
# matches: 1 additive fault on T2, 2 multiplicative fault on T1 or the process. fiv is the number of the row of `isolation`, of
# which no two may match at once: 1 AFS2, T2 reads too high; 2 MFS1, T1 is clogged; 3 MFP, the air flow is up. A row of your own may have
# a name; `pt326 teach` makes such rows from a recording.
";

/// All settings with their defaults, as commented TOML.
pub fn commented_toml() -> String {
    HEAD.to_owned() + &commented_toml_of(&Config::default())
}

/// All settings with these values, as commented TOML.
pub fn commented_toml_of(config: &Config) -> String {
    let mut text = String::new();
    let mut about = "";
    for group in Config::documented() {
        let table = table_of(group.settings);
        text += "\n";
        if let Some(table) = table {
            if group.about != about {
                comment(&mut text, group.about);
            }
            text += &format!("[{table}]\n");
        }
        about = group.about;
        for (setting, about) in group.settings.iter().zip(group.settings_about) {
            line(&mut text, setting, about, config.get(setting));
        }
        if table == Some("diagnosis") {
            text += TABLES;
            rows(&mut text, "diagnosis.detection", &config.diagnosis.detection);
            rows(&mut text, "diagnosis.isolation", &config.diagnosis.isolation);
        }
        if table == Some("likelihood") {
            taught(&mut text, &config.likelihood.taught);
        }
    }
    text
}

fn comment(text: &mut String, lines: &str) {
    for line in lines.lines() {
        let _ = writeln!(text, "# {}", line.trim());
    }
}

fn line(text: &mut String, setting: &Setting, about: &About, value: Value) {
    comment(text, about.text);
    let key = setting.name.rsplit('.').next().unwrap_or(setting.name);
    let assignment = format!("{key} = {}", toml_value(setting, value));
    let unit = if setting.unit.is_empty() { String::new() } else { format!("{}, ", setting.unit) };
    let _ = writeln!(text, "{assignment:<27} # {unit}{}", range(setting));
}

fn toml_value(setting: &Setting, value: Value) -> String {
    match value {
        Value::Number(x) => format!("{x:?}"),
        Value::Whole(x) => format!("{x}"),
        Value::Switch(on) => format!("{on}"),
        Value::Choice { .. } => match form(setting.kind, value) {
            Some((form, numbers)) if !numbers.is_empty() => {
                let keys = form.numbers.iter().zip(numbers).map(|(n, x)| format!("{} = {x:?}", n.key));
                format!("{{ {} = {{ {} }} }}", form.word, keys.collect::<Vec<_>>().join(", "))
            }
            form => format!("{:?}", form.map_or("", |(form, _)| form.word)),
        },
    }
}

/// Only where there are any.
fn taught(text: &mut String, responses: &[Response]) {
    if responses.is_empty() {
        return;
    }
    let names = names().join(", ");
    comment(
        text,
        &format!(
            "\nFaults that were taught, with what each changes: {names}.\nOffsets in hundredths of a degC, all else in thousandths."
        ),
    );
    for Response { name, effects } in responses {
        let _ = writeln!(text, "[[likelihood.taught]]\nname = \"{name}\"\neffects = {effects:?}");
    }
}

fn rows(text: &mut String, name: &str, rows: &[fdi_core::diagnosis::signature::Signature]) {
    for row in rows {
        let _ = writeln!(text, "[[{name}]]\nnumber = {}\npattern = \"{}\"", row.number, row.pattern);
        if !row.name.is_empty() {
            let _ = writeln!(text, "name = \"{}\"", row.name);
        }
    }
}
