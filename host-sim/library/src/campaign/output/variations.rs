//! `vary.md`: what each value of `--vary` or `--ablate` is worth.

use std::fmt::Write;

use super::text::seconds;
use crate::campaign::definition::Campaign;
use crate::campaign::statistics::variation::{Counts, Variation};

/// The document; `None` where nothing is varied. `hours`: what the runs of one setting simulate.
pub(super) fn of(variations: &[Variation], campaign: &Campaign, hours: f64) -> Option<String> {
    let (plain, values) = variations.split_first()?;
    let Counts { runs, faults, false_alarms, missed, named_wrong, right_at_end, .. } = plain.counts;
    let mut text = format!(
        "\
# What each value is worth

How much does each number of the likelihood diagnosis matter? `pt326 campaign` with `--vary` or `--ablate` wrote this page (vary.md). It changed {} values, one at a time, each over the same {runs} runs
({hours:.0} h of the rig, seeds from {}).

With all values as delivered: {false_alarms} false alarms; of {faults} faults {missed} missed, {named_wrong} named wrong, {right_at_end} named right when they ended; median
delay {} s; {} % of the 95 % intervals hold the true size. The rows say what each value changes in that.

* *differ*: the number of runs in which any recorded value (delays, names, confidences, sizes, ends of alarms, temperatures) differs, even by one bit. None: the value
  has no effect at all on these runs.
* *later*: how much later faults are detected with this value than without it; the geometric mean over the faults that are detected in both cases.
* *wrong*: the fault is detected, and its last name is wrong. *Right at end*: the name is right on the last tick of the fault.

",
        values.len(),
        campaign.seeds_from,
        seconds(plain.delay_s.median),
        percent(&plain.counts),
    );
    let (none, some) =
        by_key(values).into_iter().partition::<Vec<_>, _>(|of_key| of_key.iter().all(|v| v.differ == 0));
    let (little, more) =
        some.into_iter().partition::<Vec<_>, _>(|of_key| of_key.iter().all(|v| is_little(v, plain)));
    let groups = [
        (&none, "no value has any effect"),
        (
            &little,
            "something differs, but no count (false alarms, missed, wrong, right at end), and the mean delay by less than 1 %",
        ),
        (&more, "a count or the delay changes"),
    ];
    for (keys, what) in groups {
        let names: Vec<String> = keys.iter().map(|of_key| format!("`{}`", split(of_key[0]).0)).collect();
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        let _ = writeln!(text, "**{} of {}: {what}.** {names}\n", keys.len(), by_key(values).len());
    }
    text += "| setting | value | differ | false alarms | missed | wrong | right at end | median delay, s | later, % | intervals hold, % |\n";
    text += "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
    values.iter().for_each(|value| row(&mut text, value, plain));
    Some(text)
}

/// The values of each setting.
fn by_key(values: &[Variation]) -> Vec<Vec<&Variation>> {
    values.chunk_by(|a, b| split(a).0 == split(b).0).map(|chunk| chunk.iter().collect()).collect()
}

/// Setting and value.
fn split(variation: &Variation) -> (&str, &str) {
    variation.setting.split_once('=').unwrap_or((&variation.setting, ""))
}

fn is_little(value: &Variation, plain: &Variation) -> bool {
    let counts = |v: &Variation| Counts { intervals: 0, held: 0, ..v.counts };
    counts(value) == counts(plain) && value.later_pct.abs() < 1.0
}

fn row(text: &mut String, value: &Variation, plain: &Variation) {
    let (key, what) = split(value);
    let _ = write!(text, "| `{key}` | {what} | ");
    if value.differ == 0 {
        *text += "none | | | | | | | |\n";
        return;
    }
    let (now, before) = (&value.counts, &plain.counts);
    let change = |of: fn(&Counts) -> usize| match of(now) as i64 - of(before) as i64 {
        0 => String::new(),
        change => format!("{change:+}"),
    };
    let _ = writeln!(
        text,
        "{} | {} | {} | {} | {} | {} | {:+.1} | {} |",
        value.differ,
        change(|c| c.false_alarms as usize),
        change(|c| c.missed),
        change(|c| c.named_wrong),
        change(|c| c.right_at_end),
        seconds(value.delay_s.median),
        value.later_pct,
        percent(now)
    );
}

fn percent(counts: &Counts) -> String {
    counts.held_pct().map_or("-".into(), |x| format!("{x:.1}"))
}
