//! What was taught, for people.

use std::fmt;

use fdi_core::diagnosis::signature::{Cell, Symptom, WIDTH};
use fdi_core::likelihood::taught::{Response, names};

use super::{Conflict, Lesson, Proposal, Quiet, Trial};

/// The decisive residuals, as the paper calls them.
const RESIDUALS: [&str; WIDTH] = ["rAP", "ry12", "rsg1", "rsg2", "rbw1"];

impl fmt::Display for Lesson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.proposal.fmt(f)?;
        if !self.proposal.tells() {
            writeln!(f, "Not taught: nothing of it is certain that a rig without a fault does not show.")?;
        }
        self.conflicts.iter().try_for_each(|conflict| conflict.fmt(f))?;
        self.quiet.fmt(f)?;
        self.trial.as_ref().map_or(Ok(()), |trial| trial.fmt(f))?;
        f.write_str("The likelihood diagnosis: ")?;
        let Some(response) = &self.proposal.response else {
            return writeln!(
                f,
                "not taught, since not every repetition raised an alarm of it for some seconds."
            );
        };
        writeln!(f, "{}.", changes(response))?;
        self.quiet_recall.fmt(f)?;
        self.recall.as_ref().map_or(Ok(()), |trial| trial.fmt(f))
    }
}

/// What a fault changes.
fn changes(response: &Response) -> String {
    let all = names().into_iter().zip(response.effects).filter(|(_, effect)| *effect != 0);
    let each = all.map(|(name, effect)| {
        let effect = f64::from(effect);
        match name {
            "less flow" => format!("air flow (less) {:+.1} %", air(effect / 1000.0)),
            "more flow" => format!("air flow (more) {:+.1} %", air(effect / 1000.0)),
            _ if name.starts_with("offset") => format!("{name} {:+.2} degC", effect / 100.0),
            _ => format!("{name} {:+.1} %", effect / 10.0),
        }
    });
    each.collect::<Vec<_>>().join(", ")
}

/// How much the air flow f changes, %, where 1/f does by this share. A sum of effects may have more air than there can be: ten times is the most.
fn air(share: f64) -> f64 {
    100.0 * (1.0 / (1.0 + share).max(0.1) - 1.0)
}

impl fmt::Display for Proposal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |head: &str, cells: &[&str]| {
            let cells: String = cells.iter().map(|cell| format!("{cell:>6}")).collect();
            writeln!(f, "{head:<20}{cells}")
        };
        line(self.row.name.as_str(), &RESIDUALS)?;
        for repetition in &self.repetitions {
            let cells = repetition.symptoms.map(|symptom| symptom.map_or("~", sign));
            line(&format!("  {} to {} s", repetition.span.from, repetition.span.to), &cells)?;
        }
        let cells = self.row.pattern.0.map(|cell| match cell {
            Cell::Is(symptom) => sign(symptom),
            Cell::Any => "x",
        });
        line(&format!("  row, fdv and fiv {}", self.row.number), &cells)?;
        if self.repetitions.len() == 1 {
            writeln!(f, "One repetition does not say what comes again: make it three.")?;
        }
        Ok(())
    }
}

fn sign(symptom: Symptom) -> &'static str {
    match symptom {
        Symptom::Low => "-1",
        Symptom::Normal => "0",
        Symptom::High => "+1",
    }
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, row, same } = self;
        let called = if row.name.is_empty() { String::new() } else { format!(", {}", row.name) };
        let how = if *same { "is the same" } else { "matches some of the same symptoms" };
        writeln!(
            f,
            "Not taught: row {} of isolation, {} (fiv {}{called}), {how}.",
            place, row.pattern, row.number
        )
    }
}

impl fmt::Display for Quiet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (named, hours) = (self.named, self.watched / 3600.0);
        match (named, self.watched > 0.0) {
            (0, false) => Ok(()),
            (0, true) => writeln!(f, "0 false in {hours:.1} h without a fault."),
            _ => writeln!(f, "Not taught: {named} false in {hours:.1} h without a fault."),
        }
    }
}

impl fmt::Display for Trial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found: Vec<String> = self.hits.iter().flatten().map(|delay| format!("{delay:.1}")).collect();
        write!(f, "Tried on the recording: found {} of {}", found.len(), self.hits.len())?;
        if !found.is_empty() {
            write!(f, ", after {} s", found.join(", "))?;
        }
        writeln!(f, "; {} false in {:.0} s without a fault.", self.wrong.len(), self.quiet)?;
        self.wrong.iter().try_for_each(|at| writeln!(f, "  false at {at:.1} s"))?;
        self.taken_for
            .iter()
            .try_for_each(|(at, name)| writeln!(f, "  named at {at:.1} s, while {name} was there"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flow_is_told_as_the_change_of_the_air() {
        let told = |effects| changes(&Response { name: fdi_core::name::Name::NONE, effects });
        assert_eq!(told([0, 333, 0, 0, 0, 0, 0, 0, 0, 0, 0]), "air flow (less) -25.0 %");
        assert_eq!(
            told([0, 0, -200, 0, -150, 0, 0, 0, 0, 0, 0]),
            "air flow (more) +25.0 %, offset of T2 -1.50 degC"
        );
        assert_eq!(
            told([-250, 0, -1000, 0, 0, 0, 0, 0, 500, 0, 0]),
            "power -25.0 %, air flow (more) +900.0 %, long lag +50.0 %"
        );
    }
}
