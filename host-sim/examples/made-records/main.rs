//! How does `pt326 diagnose` do on records whose truth is known? Heaters with a lid, and other faults of theirs (docs/records.md).
//!
//! ```sh
//! cargo run --release -p pt326 --example made-records                    # all faults, 16 records each
//! cargo run --release -p pt326 --example made-records -- lid --room 0.1 --each
//! ```
//!
//! What is tuned is tuned on seeds 1 to 99999; the results of the book are of others.

mod rig;
mod score;

use clap::{Parser, ValueEnum};
use rayon::prelude::*;
use rig::{Fault, Made};
use score::Score;

/// Diagnoses made records of heaters whose truth is known.
#[derive(Parser)]
struct Arguments {
    /// What is wrong for a while; all of them, if none is said.
    fault: Vec<Fault>,
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
    let faults = if asked.fault.is_empty() { Fault::value_variants() } else { &asked.fault };
    let rooms = if asked.room.is_empty() { &[0.0, 0.1] } else { &*asked.room };
    let config = pt326::settings::from_table(asked.settings.join("\n").parse()?)?;
    if asked.csv {
        print!("{}", Made::new(asked.seed, faults[0], rooms[0]).csv);
        return Ok(());
    }
    println!("Seeds {} to {}\n", asked.seed, asked.seed + asked.runs - 1);
    println!(
        "| fault | room | records | seen | named at the end | in alarm within | outside | raised outside | outlives it by |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for fault in faults {
        for room in rooms {
            let done: Vec<(Score, String)> = (asked.seed..asked.seed + asked.runs)
                .into_par_iter()
                .map(|seed| {
                    let made = Made::new(seed, *fault, *room);
                    let names = score::names(&made, &config);
                    let score = Score::of(&made, *fault, names.as_ref().ok());
                    let told = match &names {
                        Ok(names) => score::spans(&made, names).join("\n  "),
                        Err(error) => format!("{error:#}"),
                    };
                    (score, format!("{}\n  {told}", made.rig))
                })
                .collect();
            let mut sum = Score::default();
            for (score, told) in done {
                if asked.each {
                    println!("{told}");
                }
                sum += score;
            }
            println!("| {fault:?} | {room} | {sum} |");
            if asked.each {
                println!("Outside: {}", sum.names());
            }
        }
    }
    Ok(())
}
