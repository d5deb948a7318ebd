//! Words and numbers of the tables that are printed.

use std::fmt::Write;

use crate::campaign::results::CellResults;
use crate::campaign::statistics::quantiles::Quantiles;

/// Columns of a terminal.
const WIDTH: usize = 100;

/// A cell's name, with what is unusual about it.
pub(super) fn label(cell: &CellResults) -> String {
    let calm = if cell.disturbance == pt326_rig::Disturbance::Lively {
        String::new()
    } else {
        format!(", {}", cell.disturbance)
    };
    let setting = if cell.setting.is_empty() { String::new() } else { format!(" [{}]", cell.setting) };
    format!("{}{calm}{setting}", cell.name)
}

/// Text in lines that a terminal holds.
pub(super) fn line(text: &mut String, content: &str, indent: &str) {
    let options = textwrap::Options::new(WIDTH).subsequent_indent(indent);
    let _ = writeln!(text, "{}", textwrap::fill(content, options));
}

/// Each name with its count.
pub(super) fn counted(counts: &[(String, usize)]) -> String {
    let counts: Vec<String> = counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
    counts.join(", ")
}

/// Median, 95 % and 99 %.
pub(super) fn delays(q: &Quantiles) -> String {
    if *q == Quantiles::default() {
        return "never".into();
    }
    [q.median, q.p95, q.p99].map(seconds).join(" / ")
}

/// A delay; "-" where there is none.
pub(super) fn seconds(x: Option<f64>) -> String {
    x.map_or("-".into(), |x| format!("{x:.2}"))
}
