//! The line console: bytes in, text out. The firmware runs it on its serial port, the host on a terminal; what they have
//! in common is [`Board`]. The text of one answer is at most [`ANSWER`] bytes; line feeds end its lines.

mod alarm;
pub mod board;
mod calibrate;
pub mod follow;
pub mod line;
pub mod request;
pub mod teach;
pub mod tune;

use core::fmt::{self, Display, Write};

use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::residual::ALL;
use fdi_core::tune::Standing;
use fdi_core::{Command, Config, ConfigError, Percent, Seconds};

use crate::calibration::{Calibration, Still};
use crate::control_loop::Denial;
use crate::decimal::{self, Fixed};
use crate::explain::Explained;
use crate::finding::Sentence;
use crate::history::{Entry, EntryText};
use crate::log_line::WIDER;
use crate::reset_cause::Restart;
use crate::self_test::{Progress, step_ticks};
use crate::settings::schema::{Name, Valued};
use crate::settings::store::SaveError;
use crate::settings::{Expected, SetError};
use crate::status::Status;
use crate::teaching::Teaching;
use crate::tuning::Tuner;
use follow::Follow;
use line::{LineReader, Step};
use request::{COMMANDS, Request};

/// Steps that a self-test takes where nothing is wrong, about.
const USUAL_CHECK: f32 = 550.0;

/// Names in the console, where the stored name is not the one of a row of residuals.
const RESIDUAL_NAMES: [&str; ALL.len()] = ["ry1", "ry2", "Pa", "ry12", "sg1", "sg2", "bw1"];

/// Why settings were not put in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ApplyError {
    /// A parameter is out of bounds.
    Config(ConfigError),
    /// The control half did not take them.
    Denied(Denial),
}

impl From<ConfigError> for ApplyError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl From<Denial> for ApplyError {
    fn from(denial: Denial) -> Self {
        Self::Denied(denial)
    }
}

impl Display for ApplyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) => Explained(error).fmt(f),
            Self::Denied(denial) => denial.fmt(f),
        }
    }
}

/// Why a board does not start anew, or send its log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardError {
    /// The heater may be on.
    NotOff,
    /// A trip or a lockout waits for its acknowledgement.
    Latched,
    /// It is no board.
    NoBoard,
}

impl Display for BoardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotOff => "not while the heater may be on, expected `stop` first",
            Self::Latched => "a trip or a lockout is latched, expected `ack` first",
            Self::NoBoard => "only a board has a port of its own",
        })
    }
}

/// What a console can ask of an instrument.
#[expect(async_fn_in_trait, reason = "its implementation does not cross threads")]
pub trait Board {
    /// Has a command carried out on the next tick.
    async fn command(&mut self, command: Command) -> Result<(), Denial>;
    /// Has the self-test begin on the next tick.
    async fn check(&mut self) -> Result<(), Denial>;
    /// What the self-test has told so far.
    fn progress(&self) -> Progress;
    /// Heater off, at once.
    fn stop(&mut self);
    /// What the last tick said.
    fn status(&self) -> Status;
    /// Ts since the start.
    fn sample_time(&self) -> Seconds;
    /// The settings in force, but for the sample time, which is the one of the next start.
    fn config(&self) -> Config;
    /// Puts settings in force on the next tick.
    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError>;
    /// Writes settings and baseline to flash.
    async fn save(&mut self) -> Result<(), SaveError>;
    /// Has the chip hold itself in reset below 2.7 V, from the next power-up.
    fn set_brown_out_level(&mut self) -> Result<(), SaveError>;
    /// Takes the models in force for those of a new commissioning; `false` where there are none.
    fn commission(&mut self) -> bool;
    /// Forgets the commissioning: the next models that are accepted are a new one.
    fn decommission(&mut self);
    /// What was learnt as normal.
    fn baseline(&self) -> Option<Baseline>;
    /// What the thermistors read at rest.
    fn still(&self) -> Still;
    /// The calibration that is under way.
    fn calibration(&mut self) -> &mut Calibration;
    /// How far the experiment of `tune` has come, or how the last one ended.
    fn tuning(&self) -> Option<Standing>;
    /// What is made of its result.
    fn tuner(&mut self) -> &mut Tuner;
    /// Looks at the fault that is being taught, or changes it.
    fn teach<R>(&mut self, change: impl FnOnce(&mut Teaching) -> R) -> R;
    /// Lets others have their turn.
    async fn pause(&mut self);
    /// Sends the log over the port, or no more.
    fn stream(&mut self, on: bool) -> Result<(), BoardError>;
    /// Starts anew; a board does not come back from it.
    async fn restart(&mut self, how: Restart) -> Result<(), BoardError>;
    /// What went wrong, the oldest first.
    fn fault(&self, index: usize) -> Option<Entry>;
}

/// The longest answer in bytes: all settings at once, with full tables and ten faults taught.
pub const ANSWER: usize = 5632;

/// The console.
#[derive(Clone, Debug, Default)]
pub struct Console {
    reader: LineReader,
    follow: Follow,
}

impl Console {
    /// One byte from the terminal: shows it, and carries out the line that it may have ended. What does not fit into `out` is lost.
    pub async fn push(&mut self, byte: u8, board: &mut impl Board, out: &mut dyn Write) {
        match self.reader.push(byte) {
            Step::Typed(byte) => drop(out.write_char(byte.into())),
            Step::Erased => drop(out.write_str("\x08 \x08")),
            Step::Line => {
                say(out, "\n");
                carry_out(self.reader.line(), board, out).await;
                say(out, "> ");
            }
            Step::Rejected(error) => {
                say(out, "\n");
                fail(out, &error);
                say(out, "> ");
            }
            Step::Stop => {
                stop(board, out);
                say(out, "> ");
            }
            Step::Nothing => {}
        }
    }

    /// Shows what a self-test has told since the last call; what was typed of a line meanwhile is shown again.
    pub fn follow(&mut self, board: &impl Board, out: &mut dyn Write) {
        if self.follow.is_news(board) {
            say(out, "\n");
            self.follow.show(board, out);
            let _ = write!(out, "> {}", self.reader.typed());
        }
    }

    /// Says that the button has stopped it, which no answer tells; what was typed of a line is shown again.
    pub fn pressed(&self, out: &mut dyn Write) {
        let _ = write!(out, "\nstopped by the button\n> {}", self.reader.typed());
    }
}

/// Heater off, by a key.
pub fn stop(board: &mut impl Board, out: &mut dyn Write) {
    board.stop();
    say(out, "\nstopped; what was typed of this line is forgotten\n");
}

/// Writes text; what does not fit is lost.
fn say(out: &mut dyn Write, text: &str) {
    let _ = out.write_str(text);
}

fn fail(out: &mut dyn Write, error: &dyn Display) {
    let _ = writeln!(out, "error: {error}");
}

fn done<E: Display>(out: &mut dyn Write, result: Result<(), E>) {
    match result {
        Ok(()) => say(out, "ok\n"),
        Err(error) => fail(out, &error),
    }
}

/// A command for the next tick, and what is said where it is taken.
type Asked = (Command, &'static str);

const OK: &str = "ok\n";

/// Carries out one line.
pub async fn carry_out(line: &str, board: &mut impl Board, out: &mut dyn Write) {
    let request = match Request::parse(line) {
        Ok(request) => request,
        Err(error) => return fail(out, &error),
    };
    // All of these wait in one place: each place has its code for the wait.
    let asked = match request {
        Request::Arm => Some((Command::Arm, OK)),
        Request::Acknowledge => alarm::acknowledge(board, out),
        Request::Shelve { minutes } => alarm::shelve(minutes, board, out),
        Request::Accept => alarm::accept(board, out),
        Request::Fan { level } => match number("fan", level) {
            Ok(percent) => Some((Command::Fan(Percent(percent)), OK)),
            Err(error) => return fail(out, &error),
        },
        Request::Relearn => Some((Command::Relearn, OK)),
        Request::Tune(tune::Wanted::Start) => Some(tune::START),
        other => return carry_out_other(other, board, out).await,
    };
    let Some((command, told)) = asked else { return };
    match board.command(command).await {
        Ok(()) if command == Command::Arm && !board.status().is_checked() => {
            say(out, "ok, armed without a check\n")
        }
        Ok(()) => say(out, told),
        Err(denial) => fail(out, &denial),
    }
}

/// Carries out what is more than a command.
async fn carry_out_other(request: Request<'_>, board: &mut impl Board, out: &mut dyn Write) {
    match request {
        Request::Help => help(out),
        Request::Status => {
            status(board, out);
            wider(&board.config(), out);
        }
        Request::Get { name } => get(name, &board.config(), out),
        Request::Set { name, value } => set(name, value, board, out).await,
        Request::Save => done(out, board.save().await),
        Request::BrownOut => done(out, board.set_brown_out_level()),
        Request::Defaults => defaults(board, out).await,
        Request::Check => match board.check().await {
            Ok(()) => {
                let _ =
                    writeln!(out, "ok, see below for about {} min; it heats a little", check_minutes(board));
            }
            Err(denial) => fail(out, &denial),
        },
        Request::Stop => {
            board.stop();
            say(out, "stopped\n");
        }
        Request::Baseline => baseline(board.baseline(), out),
        Request::Commission if board.commission() => say(out, "ok, kept once the heater is off\n"),
        Request::Commission => say(out, "error: no models are trained yet, see `status`\n"),
        Request::Decommission => {
            board.decommission();
            say(out, "ok\n");
        }
        Request::Faults => faults(board, out),
        Request::Calibrate { what, celsius } => calibrate::carry_out(what, celsius, board, out).await,
        Request::Teach(wanted) => teach::carry_out(wanted, board, out).await,
        Request::Tune(wanted) => tune::carry_out(wanted, board, out).await,
        Request::Stream { on } => done(out, board.stream(on)),
        Request::Restart => done(out, board.restart(Restart::Streaming).await),
        Request::Simulate => done(out, board.restart(Restart::Simulating).await),
        // An empty line, and what is a command.
        _ => {}
    }
}

fn number<'a>(name: &'a str, given: &'a str) -> Result<f32, SetError<'a>> {
    let expected = Expected::Words(decimal::EXPECTED);
    decimal::parse(given).ok_or(SetError::Value { name, given, expected })
}

/// How long a self-test takes, about.
fn check_minutes(board: &impl Board) -> u32 {
    let ts = board.sample_time();
    let ticks = step_ticks(board.config().identification.answer_time.ticks(ts));
    (USUAL_CHECK * ticks as f32 * ts.0 / 60.0 + 0.5).max(1.0) as u32
}

fn status(board: &impl Board, out: &mut dyn Write) {
    let status = board.status();
    let _ = writeln!(out, "{status}");
    let Some((record, report)) = &status.last else { return };
    let sample_time = board.sample_time().0;
    match &report.likelihood.finding {
        Some(finding) => {
            let told = Sentence {
                finding,
                sample: &record.tick.sample,
                expected: report.likelihood.expected,
                sample_time,
            };
            let priority = if report.likelihood.advice { "advice" } else { "fault" };
            let _ = writeln!(out, "{priority}: {told}");
        }
        None if report.likelihood.alarm => say(out, "fault: something is wrong, too early to say what\n"),
        None => {}
    }
}

/// The limits that are wider than their defaults.
#[inline(never)]
fn wider(config: &Config, out: &mut dyn Write) {
    for limit in Valued::wider_than_default(config) {
        let _ = writeln!(out, "{WIDER}{limit}");
    }
}

fn help(out: &mut dyn Write) {
    for (name, arguments, meaning) in COMMANDS {
        let _ = writeln!(out, "{name} {arguments}\t{meaning}");
    }
}

fn get(beginning: &str, config: &Config, out: &mut dyn Write) {
    let mut any = false;
    for name in Name::all(config).filter(|name| name.starts_with(beginning)) {
        let _ = writeln!(out, "{name} = {}", name.value(config));
        any = true;
    }
    if !any {
        fail(out, &SetError::Unknown(beginning));
    }
}

async fn set(name: &str, value: &str, board: &mut impl Board, out: &mut dyn Write) {
    let mut config = board.config();
    let resolved = match Name::find(name).and_then(|n| n.set(&mut config, name, value).map(|()| n)) {
        Ok(resolved) => resolved,
        Err(error) => return fail(out, &error),
    };
    if let Err(error) = board.apply(&config).await {
        return fail(out, &error);
    }
    // Settings leave the set-point of a running loop alone; here it is what the user has just asked for.
    if name == "setpoint"
        && let Err(error) = board.command(Command::SetPoint(config.setpoint)).await
    {
        return fail(out, &error);
    }
    let _ = writeln!(out, "{resolved} = {}", resolved.value(&config));
    if config.sample_time != board.sample_time() {
        say(out, "sample_time is in force from the next start on, once saved\n");
    }
}

async fn defaults(board: &mut impl Board, out: &mut dyn Write) {
    let config = Config::default();
    if let Err(error) = board.apply(&config).await {
        return fail(out, &error);
    }
    done(out, board.command(Command::SetPoint(config.setpoint)).await);
}

fn baseline(baseline: Option<Baseline>, out: &mut dyn Write) {
    let Some(baseline) = baseline else { return say(out, "nothing learnt yet\n") };
    let _ = writeln!(out, "learnt from {} samples: mean, sigma, sigma filtered", baseline.samples);
    for (i, name) in RESIDUAL_NAMES.iter().enumerate() {
        let [mean, sigma, filtered] =
            [baseline.raw.mean[i], baseline.raw.sigma[i], baseline.filtered.sigma[i]].map(|x| Fixed(x, 4));
        let _ = writeln!(out, "{name} {mean} {sigma} {filtered}");
    }
}

fn faults(board: &impl Board, out: &mut dyn Write) {
    let sample_time = board.sample_time().0;
    let entries = (0..).map_while(|index| board.fault(index));
    let count = entries.map(|entry| writeln!(out, "{}", EntryText { entry: &entry, sample_time })).count();
    if count == 0 {
        say(out, "none\n");
    }
}
