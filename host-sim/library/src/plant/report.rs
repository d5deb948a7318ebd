//! What a plant's files came to, as Markdown.

use std::fmt::Write as _;

use super::settings::Plant;
use super::{FaultScore, Scored};

impl Scored {
    /// A table of the faults, and the false alarms below it.
    pub fn markdown(&self, plant: &Plant) -> String {
        let mut text = format!("{}\n\n", plant.about);
        text += "| fault | detected | delay, samples | named, from the onset on | named, another run |\n|---|---|---|---|---|\n";
        for (truth, score) in plant.faults.iter().zip(&self.faults) {
            let FaultScore { detected, delay, named: [first, again] } = score;
            let delay = delay.map_or("never".into(), |delay| delay.to_string());
            let names = [first, again].map(|named| names(named, truth.name));
            let _ = writeln!(text, "| {} | {detected:.3} | {delay} | {} |", truth.what, names.join(" | "));
        }
        let mean =
            self.faults.iter().map(|score| score.detected).sum::<f64>() / self.faults.len().max(1) as f64;
        let [normal, before] = self.false_alarms;
        let _ = writeln!(
            text,
            "\nMean of all: {mean:.3}. In alarm without a fault: {:.1} % of {}, {:.1} % before the faults. Names without a fault: {}.\n\nNames:\n",
            100.0 * normal,
            plant.normal,
            100.0 * before,
            names(&self.false_names, None)
        );
        for (number, name) in (1..).zip(&plant.names) {
            let _ = writeln!(text, "{number}. {}", name.says);
        }
        text
    }
}

/// The names that were given, with their share of the samples; the right one in bold, also where it was never given.
fn names(named: &[f64], right: Option<usize>) -> String {
    let given = (1..).zip(named).filter_map(|(number, share)| {
        let percent = 100.0 * share;
        match right == Some(number) {
            true => Some(format!("**{number}: {percent:.0} %**")),
            false => (*share > 0.0).then(|| format!("{number}: {percent:.1} %")),
        }
    });
    let given: Vec<String> = given.collect();
    if given.is_empty() { "none".into() } else { given.join(", ") }
}
