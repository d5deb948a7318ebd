//! When a fault was there, as its maker noted it: `NAME:FROM..TO,FROM..TO`, in s.

use std::str::FromStr;

use anyhow::{Context, ensure};
use fdi_core::name::Name;

/// From when to when, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Begin, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
}

impl Span {
    /// Whether it holds this time.
    pub fn holds(&self, time: f64) -> bool {
        (self.from..=self.to).contains(&time)
    }
}

/// All repetitions of one fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// What its maker calls it.
    pub name: Name,
    /// When it was there.
    pub spans: Vec<Span>,
}

impl Marks {
    /// One of each name, in the order in which they were first named.
    pub fn by_name(marks: &[Self]) -> Vec<Self> {
        let mut together: Vec<Self> = Vec::new();
        for one in marks {
            match together.iter_mut().find(|other| other.name == one.name) {
                Some(other) => other.spans.extend(&one.spans),
                None => together.push(one.clone()),
            }
        }
        together
    }
}

impl FromStr for Marks {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        let (name, spans) = text.split_once(':').context("expected NAME:FROM..TO, such as hand:385..410")?;
        Ok(Self { name: name.parse()?, spans: spans.split(',').map(span).collect::<anyhow::Result<_>>()? })
    }
}

fn span(text: &str) -> anyhow::Result<Span> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite() && *x >= 0.0);
    let ends = text.split_once("..").and_then(|(from, to)| Some((number(from)?, number(to)?)));
    let (from, to) =
        ends.with_context(|| format!("{text:?} given, expected FROM..TO in s, such as 385..410"))?;
    ensure!(to - from >= 2.0, "{from}..{to} is too short, expected at least 2 s");
    Ok(Span { from, to })
}
