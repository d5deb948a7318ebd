//! How does `pt326 diagnose` do on records whose truth is known? Heaters with a lid, and other faults of theirs (docs/evidence/records.md).
//!
//! ```sh
//! cargo run --release -p pt326 --example made-records                    # all faults, 16 records each
//! cargo run --release -p pt326 --example made-records -- lid --room 0.1 --each
//! cargo run --release -p pt326 --example made-records -- --foreign       # heaters of other people
//! ```
//!
//! What is tuned is tuned on seeds 1 to 99999; the results of the book are of others.

mod foreign;
mod rig;
mod score;

use clap::{Parser, ValueEnum};
use fdi_core::Config;
use rayon::prelude::*;
use rig::{Fault, Made};
use score::Score;

/// Faults of foreign heaters.
const FOREIGN: [Fault; 3] = [Fault::None, Fault::Weak, Fault::Offset];
const FOREIGN_COLUMNS: &str = "| fault | room | records | within 100 samples | named at the end | in alarm at the end | size off by | raised without a fault |
|---|---|---|---|---|---|---|---|";
const COLUMNS: &str = "| fault | room | records | seen | named at the end | in alarm within | outside | raised outside | outlives it by |
|---|---|---|---|---|---|---|---|---|";

/// Diagnoses made records of heaters whose truth is known.
#[derive(Parser)]
struct Arguments {
    /// What is wrong for a while; all of them, if none is said.
    fault: Vec<Fault>,
    /// Heaters of other people: hotends, incubators, floors, labs; a fault stays up to the end.
    #[arg(long)]
    foreign: bool,
    /// Standard deviation of a room that wanders within 1000 to 6000 s, degC; a still one and one that wanders by 0.1, if nothing is said.
    #[arg(long)]
    room: Vec<f64>,
    /// The first seed.
    #[arg(long, default_value_t = 8_300_000)]
    seed: u64,
    /// Records.
    #[arg(long, default_value_t = 16)]
    runs: u64,
    /// A setting, or a number of the method, as in tuning.interacting.memory=30.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Tells of each record when there was an alarm, and which.
    #[arg(long)]
    each: bool,
    /// Prints the first record and diagnoses none.
    #[arg(long)]
    csv: bool,
}

fn main() -> anyhow::Result<()> {
    let asked = Arguments::parse();
    let known = if asked.foreign { &FOREIGN } else { Fault::value_variants() };
    let faults = if asked.fault.is_empty() { known } else { &asked.fault };
    if let Some(fault) = faults.iter().find(|fault| !known.contains(fault)) {
        anyhow::bail!("{fault:?} is made of no foreign heater, expected one of {FOREIGN:?}");
    }
    let rooms = if asked.room.is_empty() { &[0.0, 0.1] } else { &*asked.room };
    let config = pt326_host::settings::from_table(asked.settings.join("\n").parse()?)?;
    let made = |seed, fault, room| match asked.foreign {
        true => foreign::made(seed, fault, room),
        false => (Made::new(seed, fault, room), f64::NAN),
    };
    if asked.csv {
        print!("{}", made(asked.seed, faults[0], rooms[0]).0.csv);
        return Ok(());
    }
    println!("Seeds {} to {}\n", asked.seed, asked.seed + asked.runs - 1);
    println!("{}", if asked.foreign { FOREIGN_COLUMNS } else { COLUMNS });
    for fault in faults {
        for room in rooms {
            let done: Vec<Judged> = (asked.seed..asked.seed + asked.runs)
                .into_par_iter()
                .map(|seed| judged(made(seed, *fault, *room), *fault, &config))
                .collect();
            let (mut sum, mut said) = (Score::default(), Vec::new());
            for one in done {
                if asked.each {
                    println!("{}", one.told);
                }
                sum += one.score;
                said.extend(one.said);
            }
            match asked.foreign {
                true => println!("| {fault:?} | {room} | {} |", foreign::cells(&said)),
                false => println!("| {fault:?} | {room} | {sum} |"),
            }
            if asked.each {
                println!("Outside: {}", sum.names());
            }
        }
    }
    Ok(())
}

/// A record, judged.
struct Judged {
    score: Score,
    /// None: nothing could be learnt.
    said: Option<foreign::Said>,
    /// When there was an alarm, and which.
    told: String,
}

fn judged((made, size): (Made, f64), fault: Fault, config: &Config) -> Judged {
    let done = score::diagnosed(&made, config);
    let names = done.as_ref().map(score::names);
    let told = match &names {
        Ok(names) => score::spans(&made, names).join("\n  "),
        Err(error) => format!("{error:#}"),
    };
    Judged {
        score: Score::of(&made, fault, names.as_ref().ok()),
        said: done.as_ref().ok().map(|done| foreign::Said::of(&made, fault, size, done)),
        told: format!("{}\n  {told}", made.rig),
    }
}
