//! `pt326 board`: a real board at the other end of a serial port.

mod actions;
mod recording;
mod terminal;

use std::path::PathBuf;
use std::process::ExitCode;

use crate::board::{Session, find};

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
    let session = Session::open(&name)?;
    let is_yes = match &args.action {
        None => terminal::run(session, &name).map(|()| true),
        Some(Action::Check) => actions::check(session),
        Some(Action::Status) => actions::status(session),
        Some(Action::Faults) => actions::faults(session),
        Some(Action::Settings(SettingsAction::Save { file })) => actions::save(session, &name, file),
        Some(Action::Settings(SettingsAction::Load { file })) => actions::load(session, file),
    }?;
    Ok(if is_yes { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
