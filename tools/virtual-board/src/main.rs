//! `virtual-board`: the paper's experiment on the firmware's image; or the image by itself, behind a serial port.

use std::io::{BufRead, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::mpsc;

use clap::Parser;
use pt326_host::experiment::scenario::Scenario;
use pt326_host::record::files;
use pt326_host::record::summary::Summary;
use pt326_host::record::table;
use virtual_board::live::{self, Live};
use virtual_board::port::Port;
use virtual_board::{board, experiment};

/// Runs the firmware's image, unmodified, on a modelled NUCLEO-F411RE with the simulated rig on its wires: the paper's
/// experiment. Prints and writes what `pt326 run` does, from the log that the image gives.
#[derive(Debug, Parser)]
#[command(version)]
struct Cli {
    /// The image; default: what `cargo fw` has built.
    #[arg(long, value_name = "PATH")]
    elf: Option<PathBuf>,
    /// Length of the run in s; the paper's is 850.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    seconds: Option<u32>,
    /// Seed of the rig's noise and of the phase of the excitation.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for trace.csv, summary.json, the figures, report.html and board.log; made if need be.
    #[arg(long, value_name = "DIR", default_value = "out/virtual-board")]
    out: PathBuf,
    /// No experiment: the board lives against the wall clock, its USART2 a pseudo-terminal, whose name is printed (and linked to,
    /// under LINK). Lines on standard input happen at the desk; `help` lists them.
    #[arg(long, value_name = "LINK", num_args = 0..=1, conflicts_with_all = ["seconds", "seed", "out"])]
    pty: Option<Option<PathBuf>>,
    /// With --pty: how many times faster than the wall clock.
    #[arg(long, default_value_t = 1.0, requires = "pty", value_parser = speed)]
    speed: f64,
}

fn speed(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|speed| (0.01..=100.0).contains(speed)).ok_or("expected 0.01 to 100".into())
}

fn main() -> ExitCode {
    virtual_board::exit_code(carry_out(&Cli::parse()))
}

/// Runs the experiment; whether board and host agree in every word.
fn carry_out(cli: &Cli) -> anyhow::Result<bool> {
    if let Some(link) = &cli.pty {
        return live(cli, link.as_deref()).map(|()| true);
    }
    let mut scenario = Scenario::default();
    if let Some(seconds) = cli.seconds {
        scenario.duration = seconds.into();
    }
    let image = board::load(cli.elf.as_deref())?;
    let done = experiment::run(image, &scenario, cli.seed)?;
    let summary = Summary::new(&done.record);
    let mut out = std::io::stdout().lock();
    write!(out, "{}", table::of_run(&done.record, &summary))?;
    writeln!(
        out,
        "Image                  {} instructions in {:.0} s; armed at its tick {}",
        done.board.cpu.instructions(),
        done.board.now() as f64 / virtual_board::time::SECOND as f64,
        done.idle_ticks
    )?;
    let words = fdi_core::schema::WORDS * (done.idle_ticks + done.record.rows.len());
    writeln!(
        out,
        "Bits                   {} of {words} words of the log differ from the host's",
        done.differences.len()
    )?;
    for d in done.differences.iter().take(10) {
        writeln!(out, "  tick {} {}: board {:#010x}, host {:#010x}", d.tick, d.name, d.board, d.host)?;
    }
    files::write(&done.record, &summary, None, &cli.out)?;
    let log: String = done.board.log.iter().map(|line| format!("{line}\n")).collect();
    std::fs::write(cli.out.join("board.log"), log)?;
    writeln!(out, "\nWritten to {}: what `pt326 run` writes, and board.log", cli.out.display())?;
    Ok(done.differences.is_empty())
}

/// Lets the board live until standard input says `quit`, or the program is ended.
fn live(cli: &Cli, link: Option<&Path>) -> anyhow::Result<()> {
    let port = Port::new(link)?;
    println!("serial port            {}", port.name());
    let (to_board, lines) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if line.trim() == "help" {
                println!("{}", live::HELP);
            } else if to_board.send(line).is_err() {
                break;
            }
        }
    });
    Live::new(board::load(cli.elf.as_deref())?, port, cli.speed)?.run(&lines, |text| println!("{text}"))
}
