//! The cost bench: counts from the emulated timer, cycles from a trace, both over the whole recorded run.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, ensure};

use crate::trace::{self, Cost};
use crate::{counts, divergence, image, qemu, recording};

/// Name of the interval that measures the measurement.
const NOTHING: &str = "nothing";
/// Names of the two halves, and of their sum in one tick.
const HALVES: [&str; 2] = ["control()", "diagnose()"];
const TICK: &str = "tick: both halves";

/// What a part costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Price {
    /// Instructions of the dearest sample.
    pub(crate) worst: u32,
    /// Mean over the samples.
    pub(crate) mean: f64,
    /// Modelled cycles: of the dearest sample, and their mean.
    pub(crate) cycles: (u32, f64),
}

/// The result: prices and stack depths, in the order in which they were measured.
pub(crate) struct Bench {
    pub(crate) prices: Vec<(String, Price)>,
    pub(crate) stacks: Vec<(String, u32)>,
}

/// Measures everything, prints it, and compares with the committed counts.
///
/// # Errors
/// A program that fails, two ways of counting that disagree, or a count that has risen.
pub(crate) fn run(update: bool) -> anyhow::Result<()> {
    let bench = measure(&recording::write()?)?;
    print!("{}\n{}", table(&bench), divergence::table()?);
    counts::check(&indicator(&bench), update)
}

fn measure(recording: &Path) -> anyhow::Result<Bench> {
    let image = image::build("cost-image")?;
    let counted = Listing::read(&qemu::run(&image, recording, &["-icount", "shift=0"])?)?;
    let intervals = qemu::trace(&image, recording, trace::intervals)?;
    let mut intervals = intervals.into_iter();
    let mut samples: Vec<(String, Vec<Cost>)> = Vec::new();
    let mut keep = |name: &str, costs: Vec<Cost>| match samples.iter_mut().find(|(known, _)| known == name) {
        Some((_, before)) => before.extend(costs),
        None => samples.push((name.to_owned(), costs)),
    };
    let mut nothing = Cost::default();
    let mut timer_overhead = 0;
    for pass in &counted.passes {
        let names = pass.parts.len();
        let costs: Vec<Cost> = intervals.by_ref().take(names * pass.samples).collect();
        ensure!(costs.len() == names * pass.samples, "the trace ends early");
        for (i, part) in pass.parts.iter().enumerate() {
            let own: Vec<Cost> = costs.iter().skip(i).step_by(names).copied().collect();
            if part.name == NOTHING {
                nothing = own[0];
                timer_overhead = part.total / pass.samples as u64;
            }
            agree(part, &own, timer_overhead - u64::from(nothing.instructions))?;
            keep(&part.name, own);
        }
        if pass.parts.iter().map(|p| p.name.as_str()).eq(HALVES) {
            keep(TICK, costs.chunks(names).map(sum).collect());
        }
    }
    ensure!(intervals.next().is_none(), "the trace holds more than was counted");
    let overhead = |name: &str| if name == TICK { sum(&[nothing; 2]) } else { nothing };
    let prices = samples.into_iter().map(|(name, costs)| {
        let price = price(&costs, overhead(&name));
        (name, price)
    });
    Ok(Bench { prices: prices.collect(), stacks: counted.stacks })
}

/// The timer and the trace must have seen the same instructions, but for those between the timer's two readings that
/// lie inside the function that reads it.
fn agree(part: &Part, traced: &[Cost], inside: u64) -> anyhow::Result<()> {
    let total: u64 = traced.iter().map(|cost| u64::from(cost.instructions) + inside).sum();
    ensure!(total == part.total, "{}: the timer counted {}, the trace {total}", part.name, part.total);
    Ok(())
}

fn sum(costs: &[Cost]) -> Cost {
    let mut sum = Cost::default();
    costs.iter().for_each(|&cost| sum += cost);
    sum
}

fn price(costs: &[Cost], nothing: Cost) -> Price {
    let of = |field: fn(&Cost) -> u32| {
        let net = |cost: &Cost| field(cost) - field(&nothing);
        let worst = costs.iter().map(net).max().unwrap_or(0);
        (worst, costs.iter().map(|c| f64::from(net(c))).sum::<f64>() / costs.len() as f64)
    };
    let (worst, mean) = of(|cost| cost.instructions);
    Price { worst, mean, cycles: of(|cost| cost.cycles) }
}

/// What the image printed.
#[derive(Default)]
struct Listing {
    passes: Vec<Pass>,
    stacks: Vec<(String, u32)>,
}

struct Pass {
    names: usize,
    samples: usize,
    parts: Vec<Part>,
}

struct Part {
    name: String,
    total: u64,
}

impl Listing {
    fn read(text: &str) -> anyhow::Result<Self> {
        let mut listing = Self::default();
        for line in text.lines() {
            listing.line(line).with_context(|| format!("the image said {line:?}"))?;
        }
        ensure!(listing.passes.iter().all(|p| p.parts.len() == p.names), "a pass lacks a part");
        Ok(listing)
    }

    fn line(&mut self, line: &str) -> anyhow::Result<()> {
        let (kind, rest) = line.split_once(' ').context("expected two words")?;
        let (first, rest) = rest.split_once(' ').context("expected three words")?;
        match kind {
            "pass" => {
                self.passes.push(Pass { names: first.parse()?, samples: rest.parse()?, parts: Vec::new() })
            }
            "part" => {
                let pass = self.passes.last_mut().context("a part before any pass")?;
                pass.parts.push(Part { name: rest.to_owned(), total: first.parse()? });
            }
            _ => self.stacks.push((rest.to_owned(), first.parse()?)),
        }
        Ok(())
    }
}

/// The table that is printed.
fn table(bench: &Bench) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<40} {:>9} {:>9} | {:>8} {:>8}\n{:<40} {:>9} {:>9} | {:>8} {:>8}",
        "Cortex-M4F (emulated)",
        "instr.",
        "instr.",
        "cycles,",
        "modelled",
        "",
        "worst",
        "mean",
        "worst",
        "mean"
    );
    for (name, price) in bench.prices.iter().filter(|(name, _)| name != NOTHING) {
        let Price { worst, mean, cycles } = price;
        let _ = writeln!(text, "{name:<40} {worst:>9} {mean:>9.1} | {:>8} {:>8.1}", cycles.0, cycles.1);
    }
    for (name, bytes) in &bench.stacks {
        let _ = writeln!(text, "stack of {name:<31} {bytes:>9} bytes");
    }
    text
}

/// The counts that are committed: the worst and the mean of each part, and the stack.
fn indicator(bench: &Bench) -> BTreeMap<String, f64> {
    let mut counts = BTreeMap::new();
    for (name, price) in bench.prices.iter().filter(|(name, _)| name != NOTHING) {
        counts.insert(format!("{name}, worst"), f64::from(price.worst));
        counts.insert(format!("{name}, mean"), (price.mean * 10.0).round() / 10.0);
    }
    for (name, bytes) in &bench.stacks {
        counts.insert(format!("stack of {name}, bytes"), f64::from(*bytes));
    }
    counts
}
