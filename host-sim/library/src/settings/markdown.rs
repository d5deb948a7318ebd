//! The settings as a table in Markdown, for the documents.

use fdi_core::settings::{About, Limit, Value, Wider};
use fdi_core::{Config, Setting};

use super::{form, range, table_of};

const HEAD: &str = "\
# Settings

Every setting of the instrument. The same names serve a file for `--config` (TOML; a dot begins a table), the board's console
(`get`, `set NAME VALUE`) and its log. `config` prints all of them as commented TOML. This file is written from their
declarations in `fdi-core` by `cargo run -- config --markdown > docs/settings.md`.

Not in these tables: the rows of the signature tables, `diagnosis.detection.1` and on, `diagnosis.isolation.1` and on
([theory](theory.md), section 7). Such a row is a number, five signs (-1, 0, +1 or x), and a name if the fault is one of your own. `pt326 teach` makes rows ([board](board.md)).
It also makes what the likelihood diagnosis needs to know such a fault: `likelihood.taught.1` and on, a name and eleven whole numbers ([diagnosis](diagnosis.md), section 8).

A *limit* is a setting on which a protection rests ([safety](safety.md)). No limit can be made wider while the heater is on. `status`, the log at each arming, the page and the
report of a commissioning list the limits that are wider than their defaults. For a switch, *above* means on. Limits are bounded by the plant's scale, too:
times by `identification.answer_time`, `supervisor.over_temperature` by twice what `supervisor.setpoint_max` is above a room of 20 degC, and
`supervisor.max_disagreement` by a quarter of what that allows. If an older release has saved a value that is out of its bounds now, the board does not take it over: it starts
with the defaults and says so, with the name of the setting.
";

/// All settings as Markdown.
pub fn markdown() -> String {
    let config = Config::default();
    let groups: Vec<_> = Config::documented().collect();
    let mut text = HEAD.to_owned();
    for alike in groups.chunk_by(|a, b| a.about == b.about) {
        let names: Vec<_> = alike.iter().map(|group| table_of(group.settings).unwrap_or("general")).collect();
        text += &format!("\n## {}\n\n{}\n\n", names.join(", "), one_line(alike[0].about));
        text += "| setting | default | unit | may be | what it is |\n|---|---|---|---|---|\n";
        for (setting, about) in alike[0].settings.iter().zip(alike[0].settings_about) {
            text += &row(setting, about, config.get(setting));
        }
        for name in &names[1..] {
            text += &format!("| `{name}.`.. | | | | The same. |\n");
        }
    }
    text
}

fn row(setting: &Setting, about: &About, value: Value) -> String {
    let value = match value {
        Value::Number(x) => format!("{x}"),
        Value::Whole(x) => format!("{x}"),
        Value::Switch(on) => format!("{on}"),
        Value::Choice { .. } => form(setting.kind, value).map_or(String::new(), |(form, numbers)| {
            form.word.to_owned() + &numbers.iter().map(|x| format!(" {x}")).collect::<String>()
        }),
    };
    let was = about.was.map_or(String::new(), |was| format!(" Was `{was}`."));
    let limit = setting.limit.map_or(String::new(), limit);
    let (unit, range, what) = (setting.unit, range(setting), one_line(about.text));
    format!("| `{}` | {value} | {unit} | {range} | {what}{was}{limit} |\n", setting.name)
}

/// What is said of a limit.
fn limit(limit: Limit) -> String {
    let side = if limit.wider == Wider::Above { "above" } else { "below" };
    let most = match limit.answers {
        0 => String::new(),
        1 => ", at most 1 `identification.answer_time`".into(),
        n => format!(", at most {n} `identification.answer_time`"),
    };
    format!(" *Limit*, wider {side} the default{most}.")
}

pub(super) fn one_line(lines: &str) -> String {
    lines.lines().map(str::trim).collect::<Vec<_>>().join(" ")
}
