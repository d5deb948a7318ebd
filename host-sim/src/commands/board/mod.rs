//! `pt326 board`: a real board at the other end of a serial port.

mod actions;
mod attend;
mod commission;
mod keys;
mod recording;
mod signals;
mod terminal;
mod verify;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand as _;
use pt326_rig::Rig;

use crate::commands::experiment::ExperimentArgs;
pub use commission::{Commissioning, Person, commission};
use pt326_host::board::simulate::SimulatedRig;
use pt326_host::board::{Session, find};
use pt326_host::experiment::as_written;
#[cfg(feature = "live")]
pub(super) use signals::Heed;
pub use verify::{Verification, verify};

/// Use a real board over its serial port: its console, a record of what it does, its settings.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Without an action: the board's console, with history (arrow keys) and completion (Tab). Ctrl-C, ESC and ! stop the heater at \
once; Ctrl-D leaves and stops nothing. From a pipe, each line is a command, and `wait SECONDS` waits.

Without PORT: the only ST-LINK that is plugged in.

Examples:
  pt326 board
  pt326 board /dev/ttyACM0 check && echo wired rightly
  pt326 board --record board.log --from-start; pt326 replay board.log
  pt326 board settings save before.toml
  pt326 board commission                    from a wired board to a watched rig
  pt326 board verify                        a bare board without a heater is enough
  pt326 board --simulate                    the whole instrument on a bare board, in real time

Exit code: 0; 1 where the answer is no (a check that has failed, a `status` with a trip or a lockout, `faults` that are there); 2 \
after an error.")]
pub struct BoardArgs {
    /// Its serial port, such as /dev/ttyACM0 or COM4.
    port: Option<String>,
    /// Record what the board streams, until Ctrl-C or for --seconds; the file is one for `pt326 replay`. The heater stays as it is.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// With --record: start the board anew first, so that the record begins at its first tick, as a replay needs. The heater must be off.
    #[arg(long, requires = "record")]
    from_start: bool,
    /// With --record: end after so many seconds of the board's time.
    #[arg(long, requires = "record", value_name = "SECONDS")]
    seconds: Option<f64>,
    /// Run a rig beside the board, which takes its codes from the port and has both outputs locked off until its next reset. The
    /// console also takes `fault ..` and `wire ..` then, as `pt326 console` does.
    #[arg(long, conflicts_with = "record")]
    simulate: bool,
    /// With --simulate: the rig, and what happens to it.
    #[command(flatten)]
    experiment: ExperimentArgs,
    /// With --simulate: seed of the rig's noise.
    #[arg(long, default_value_t = 1, requires = "simulate")]
    seed: u64,
    #[command(subcommand)]
    action: Option<Action>,
}

/// What a script asks for.
#[derive(Clone, Debug, clap::Subcommand)]
enum Action {
    /// Run the self-test, which heats a little; exit code 1 where it finds anything wrong.
    Check,
    /// Print how the board is; exit code 1 while a trip or a lockout is latched.
    Status,
    /// Print what went wrong since its start; exit code 1 where anything did.
    Faults,
    /// Be led from a board that is wired to a rig that is watched: calibration, self-test, tuning of the controller, learning, what can
    /// be told apart. Nothing heats without a yes; exit code 1 where a step has failed.
    Commission {
        /// The file for the report; the board's log goes beside it, with the ending .log.
        #[arg(default_value = "commissioning.html")]
        file: PathBuf,
    },
    /// Run the paper's experiment on the bare board, compare every word with the host, and tell the times of its ticks; exit code 1
    /// where anything is wrong. Its outputs are locked off meanwhile.
    Verify {
        /// The file for what was found, to be kept or sent; the stream goes beside it, with the ending .log.
        #[arg(default_value = "verify.txt")]
        file: PathBuf,
        /// Only the first so many seconds of the 850.
        #[arg(long)]
        seconds: Option<f64>,
    },
    /// Its settings, and a file's.
    #[command(subcommand)]
    Settings(SettingsAction),
}

/// What is done with settings.
#[derive(Clone, Debug, clap::Subcommand)]
enum SettingsAction {
    /// Write the board's settings into a file, as commented TOML for --config.
    Save {
        /// The file.
        file: PathBuf,
    },
    /// Give the board the settings of a file, and have it keep them; what the file leaves out gets its default. The heater must be off.
    Load {
        /// The file.
        file: PathBuf,
    },
}

/// Does what was asked for.
///
/// # Errors
/// No port, no board on it, a file that cannot be read or written, what the board refuses.
pub fn run(args: &BoardArgs) -> anyhow::Result<ExitCode> {
    let name = find(args.port.as_deref())?;
    if let Some(file) = &args.record {
        anyhow::ensure!(args.action.is_none(), "--record is for no action, expected one of both");
        return recording::run(&name, file, args.from_start, args.seconds).map(|()| ExitCode::SUCCESS);
    }
    let mut session = match Session::open(&name) {
        Err(error) if is_mistyped(&name) => {
            return Err(error.context(format!("{name} is neither a port nor {}", actions())));
        }
        opened => opened?,
    };
    let rig = args.simulate.then(|| simulate(&mut session, args)).transpose()?;
    let is_yes = match &args.action {
        None => terminal::run(session, &name, rig.as_ref()).map(|()| true),
        Some(Action::Check) => actions::check(session),
        Some(Action::Status) => actions::status(session),
        Some(Action::Faults) => actions::faults(session),
        Some(Action::Commission { file }) => actions::commission(session, file),
        Some(Action::Verify { file, seconds }) => actions::verify(session, file, *seconds),
        Some(Action::Settings(SettingsAction::Save { file })) => actions::save(session, &name, file),
        Some(Action::Settings(SettingsAction::Load { file })) => actions::load(session, file),
    }?;
    Ok(if is_yes { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// No port is called so on any system: an action was meant.
fn is_mistyped(name: &str) -> bool {
    name.chars().all(|c| c.is_ascii_lowercase())
}

/// The actions, for people.
fn actions() -> String {
    let all = Action::augment_subcommands(clap::Command::new("board"));
    let names: Vec<&str> = all.get_subcommands().map(clap::Command::get_name).collect();
    format!("one of {}", names.join(", "))
}

/// Has the board start anew with a rig beside it.
fn simulate(session: &mut Session, args: &BoardArgs) -> anyhow::Result<SimulatedRig> {
    let (_, scenario) = args.experiment.load_by_hand()?;
    let sample_time = as_written(pt326_host::board::settings::read(session)?.sample_time.0);
    let rig = Rig::new(&scenario.rig, scenario.disturbance, sample_time, args.seed, &scenario.faults);
    let rig = SimulatedRig::new(rig);
    session.simulate(rig.clone());
    session.order("simulate on")?;
    Ok(rig)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_action_is_told_from_a_port() {
        assert!(["commision", "stat"].iter().all(|name| is_mistyped(name)));
        assert!(!["/dev/ttyACM0", "COM4", "ttyUSB1"].iter().any(|name| is_mistyped(name)));
        assert_eq!(actions(), "one of check, status, faults, commission, verify, settings");
    }
}
