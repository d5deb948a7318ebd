//! The numbers of the likelihood diagnosis that are no settings, as tables in Markdown.

use fdi_core::likelihood::Tuning;
use fdi_core::likelihood::tuning::{Entry, Origin};

use super::{markdown::one_line, short};

/// All of them.
pub fn tuning() -> String {
    let entries = || Tuning::PARTS.iter().flat_map(|part| part.entries);
    let of = |origin| entries().filter(|entry| entry.origin == origin).count();
    let mut text = format!(
        "\
# Numbers of the likelihood diagnosis

The [likelihood diagnosis](../diagnosis.md) uses {} numbers that are not settings. {} are *derived*, with a formula or a source; {} are *measured*, and the table says where; {} are *chosen*, and
no measurement of them is kept. On a board they are constants. On a computer a file for `--config` can change them, as it changes settings (a dot begins a
table), and a campaign can vary them:

```sh
pt326 campaign --quick --vary tuning.alarm.raise=2.25,9 --vary tuning.charts.clip=3,12
```

This file is written from their declarations in `fdi-core/src/likelihood/tuning` by `cargo run -- config --tuning > docs/evidence/tuning.md`.
",
        entries().count(),
        of(Origin::Derived),
        of(Origin::Measured),
        of(Origin::Chosen)
    );
    for part in Tuning::PARTS {
        text += &format!("\n## {}\n\n{}\n\n", part.name, one_line(part.about));
        text += "| number | default | unit | what it is | origin |\n|---|--:|---|---|---|\n";
        part.entries.iter().for_each(|entry| text += &row(entry));
    }
    text
}

fn row(entry: &Entry) -> String {
    let origin = match entry.origin {
        Origin::Derived => "derived",
        Origin::Measured => "measured",
        Origin::Chosen => "chosen",
    };
    let colon = if entry.source.is_empty() { "" } else { ": " };
    let (value, about) = (short((entry.value)(&Tuning::DEFAULT)), one_line(entry.about));
    let unit = if entry.unit == "1" { "" } else { entry.unit };
    format!("| `{}` | {value} | {unit} | {about} | {origin}{colon}{} |\n", entry.name, entry.source)
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;
    use toml::Table;

    use super::*;
    use crate::settings::from_table;

    #[test]
    fn the_document_is_not_stale() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/evidence/tuning.md");
        let committed = std::fs::read_to_string(path).unwrap();
        assert!(committed == tuning(), "stale: cargo run -- config --tuning > docs/evidence/tuning.md");
    }

    /// Each number reaches the diagnosis by its name, alone, and is written again as it was read.
    #[test]
    fn every_number_is_read_and_written() {
        let value = |config: &Config, entry: &Entry| (entry.value)(&config.tuning);
        let default = Config::default();
        let entries = || Tuning::PARTS.iter().flat_map(|part| part.entries);
        for entry in entries() {
            let other = 2.0 * value(&default, entry);
            let config = from_table(format!("{} = {other:?}", entry.name).parse().unwrap()).unwrap();
            assert_eq!(value(&config, entry), other, "{}", entry.name);
            let changed = entries().filter(|entry| value(&config, entry) != value(&default, entry)).count();
            assert_eq!(changed, 1, "{}", entry.name);
            let written = Table::try_from(&config).unwrap();
            assert_eq!(from_table(written).unwrap(), config, "{}", entry.name);
        }
        assert!(!toml::to_string(&default).unwrap().contains("clip"));
    }

    #[test]
    fn wrong_names_and_numbers_are_told() {
        let error = |text: &str| format!("{:#}", from_table(text.parse().unwrap()).unwrap_err());
        let unknown = error("tuning.charts.clap = 1");
        assert!(unknown.contains("clap") && unknown.contains("clip"), "{unknown}");
        assert!(error("tuning.charts.clip = inf").contains("tuning.charts.clip is not finite"));
    }
}
