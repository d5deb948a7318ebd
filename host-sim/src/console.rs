//! `host-sim console`: the board's line console, run against the simulated rig instead of a board.
//!
//! On a terminal time passes as on the board (or `--speed` times faster). From a pipe it stands still but for the extra
//! command `wait SECONDS`, so that a script always sees the same.

use std::io::{BufRead, IsTerminal, Write};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use anyhow::Context;
use embassy_futures::block_on;
use fdi_core::control::Controller;
use fdi_core::diagnosis::baseline::Baseline;
use fdi_core::diagnosis::{Diagnosis, DiagnosisState};
use fdi_core::{AdcCode, Command, Config, Feedback, Mode, Percent, RawSample};
use firmware_logic::cadence::Arrival;
use firmware_logic::console::{self, ApplyError, Board};
use firmware_logic::control_loop::{ControlLoop, Denial, Heater, Order};
use firmware_logic::history::{Entry, History};
use firmware_logic::interlock::{Hold, Interlock};
use firmware_logic::settings::store::SaveError;
use firmware_logic::status::Status;

use crate::cli::ConsoleArgs;
use crate::experiment::as_written;
use crate::rig::Rig;
use crate::scenario::Scenario;

/// Runs the console until its input ends.
///
/// # Errors
/// A bad file or value.
pub fn run(args: &ConsoleArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load()?;
    let mut bench = Bench::new(&config, &scenario, args.seed)?;
    if std::io::stdin().is_terminal() {
        println!("The board's console on the simulated rig. Type help; wait SECONDS skips time; quit ends.");
        interactive(&mut bench, args.speed)
    } else {
        scripted(&mut bench, std::io::stdin().lock(), std::io::stdout().lock())
    }
}

/// Time passes; lines come when they come.
fn interactive(bench: &mut Bench, speed: f64) -> anyhow::Result<()> {
    let (lines_in, lines) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if lines_in.send(line).is_err() {
                break;
            }
        }
    });
    let period = Duration::from_secs_f64(bench.sample_time / speed);
    let mut due = Instant::now() + period;
    prompt()?;
    loop {
        match lines.recv_timeout(due.saturating_duration_since(Instant::now())) {
            Ok(line) if line.trim() == "quit" => return Ok(()),
            Ok(line) => {
                print!("{}", bench.answer(&line));
                prompt()?;
            }
            Err(RecvTimeoutError::Timeout) => {
                bench.pass();
                due += period;
            }
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

fn prompt() -> anyhow::Result<()> {
    print!("> ");
    Ok(std::io::stdout().flush()?)
}

/// Answers each line; time passes by `wait` alone.
fn scripted(bench: &mut Bench, input: impl BufRead, mut output: impl Write) -> anyhow::Result<()> {
    for line in input.lines() {
        let line = line.context("the input can't be read")?;
        if line.trim() == "quit" {
            break;
        }
        writeln!(output, "> {line}")?;
        output.write_all(bench.answer(&line).as_bytes())?;
    }
    Ok(())
}

/// The board's halves and the rig, in one place.
struct Bench {
    control: ControlLoop,
    diagnosis: Diagnosis,
    state: DiagnosisState,
    rig: Rig,
    heater: Output,
    config: Config,
    status: Status,
    history: History,
    sample_time: f64,
}

impl Bench {
    fn new(config: &Config, scenario: &Scenario, seed: u64) -> anyhow::Result<Self> {
        let diagnosis = Diagnosis::new(config)?;
        let sample_time = as_written(config.sample_time.0);
        Ok(Self {
            control: ControlLoop::new(Controller::new(config)?, config.setpoint, Interlock::default()),
            state: diagnosis.start(),
            diagnosis,
            rig: Rig::new(&scenario.rig, scenario.wander, sample_time, seed, &scenario.faults),
            heater: Output::default(),
            config: config.clone(),
            status: Status::default(),
            history: History::default(),
            sample_time,
        })
    }

    /// What the console says to a line.
    fn answer(&mut self, line: &str) -> String {
        let mut answer = String::new();
        match line.trim().strip_prefix("wait ") {
            Some(seconds) => match seconds.trim().parse::<f64>() {
                Ok(seconds) if (0.0..=1e6).contains(&seconds) => {
                    (0..(seconds / self.sample_time).round() as u64).for_each(|_| self.pass());
                }
                _ => answer = format!("error: wait: \"{seconds}\", expected seconds, 0 to 1000000\n"),
            },
            None => block_on(console::carry_out(line.trim(), self, &mut answer)),
        }
        answer
    }

    /// One tick in which nothing is asked for.
    fn pass(&mut self) {
        let _ = self.tick(None);
    }

    /// One tick, and what became of the order before it.
    fn tick(&mut self, order: Option<Order>) -> Result<(), Denial> {
        let [t0, t1, t2] = self.rig.sample().map(|code| AdcCode(code as f32));
        let feedback =
            self.status.last.as_ref().map_or_else(Feedback::default, |(_, report)| report.feedback());
        let raw = RawSample { t0, t1, t2 };
        let beat = self.control.tick(raw, Arrival::default(), order, feedback, &mut self.heater);
        self.rig.advance(f64::from(self.heater.given().0));
        let report = self.diagnosis.step(&mut self.state, &beat.tick, beat.applied);
        let tripped = |mode: &Mode| matches!(mode, Mode::Tripped(_));
        let was_tripped = self.status.last.as_ref().is_some_and(|(before, _)| tripped(&before.tick.mode));
        if let (Mode::Tripped(trip), false) = (beat.tick.mode, was_tripped) {
            self.history.push(Entry::Trip(trip));
        }
        report.events.iter().for_each(|event| self.history.event(*event));
        self.status.health.punctuality.count(&beat.arrival);
        let result = beat.outcome.map_or(Ok(()), |outcome| outcome.result);
        self.status.last = Some((beat, report));
        result
    }
}

impl Board for Bench {
    async fn command(&mut self, command: Command) -> Result<(), Denial> {
        self.tick(Some(Order::Command(command)))
    }

    fn stop(&mut self) {
        self.heater.disable();
        let _ = self.tick(Some(Order::Command(Command::Stop)));
    }

    fn status(&self) -> Status {
        self.status.clone()
    }

    fn config(&self) -> Config {
        self.config.clone()
    }

    async fn apply(&mut self, config: &Config) -> Result<(), ApplyError> {
        let controller = Controller::new(config)?;
        let diagnosis = Diagnosis::new(config)?;
        self.tick(Some(Order::Retune(controller)))?;
        self.diagnosis = diagnosis;
        self.config = config.clone();
        Ok(())
    }

    /// There is no flash here: settings live as long as the console. That a running heater forbids it is the same.
    async fn save(&mut self) -> Result<(), SaveError> {
        if self.heater.enabled { Err(SaveError::Heating) } else { Ok(()) }
    }

    /// Nor are there option bytes.
    fn set_brown_out_level(&mut self) -> Result<(), SaveError> {
        if self.heater.enabled { Err(SaveError::Heating) } else { Ok(()) }
    }

    fn baseline(&self) -> Option<Baseline> {
        self.diagnosis.baseline(&self.state).copied()
    }

    fn fault(&self, index: usize) -> Option<Entry> {
        self.history.get(index).copied()
    }
}

/// The heater's output, its break input always closed.
#[derive(Debug, Default)]
pub struct Output {
    power: Percent,
    contactor: bool,
    enabled: bool,
}

impl Output {
    /// What reaches the heater.
    pub fn given(&self) -> Percent {
        if self.enabled && self.contactor { self.power } else { Percent(0.0) }
    }
}

impl Heater for Output {
    fn drive(&mut self, power: Percent) {
        self.power = power;
    }

    fn contactor(&mut self, closed: bool) {
        self.contactor = closed;
    }

    fn enable(&mut self) {
        self.enabled = true;
    }

    fn disable(&mut self) {
        self.enabled = false;
    }

    fn is_enabled(&self) -> bool {
        self.enabled
    }

    fn break_is_open(&self) -> bool {
        false
    }

    fn cut_by(&self) -> Hold {
        Hold::BreakInput
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(script: &str) -> String {
        let mut bench = Bench::new(&Config::default(), &Scenario::default(), 1).unwrap();
        let mut output = Vec::new();
        scripted(&mut bench, script.as_bytes(), &mut output).unwrap();
        String::from_utf8(output).unwrap()
    }

    #[test]
    fn a_session_arms_heats_sets_and_stops() {
        let said = session(
            "wait 1\nstatus\narm\nwait 60\nstatus\nset setpoint 38\nwait 30\nstatus\nsave\nstop\nsave\nstatus\n",
        );
        for word in [
            "mode off",
            "mode settle",
            "of 35.0 degC",
            "setpoint = 38",
            "of 38.0 degC",
            "not while heating",
            "stopped",
        ] {
            assert!(said.contains(word), "{word} in:\n{said}");
        }
        assert!(said.trim_end().rsplit("status").next().unwrap().contains("mode off"), "{said}");
    }

    #[test]
    fn the_papers_first_fault_is_listed() {
        let said = session("arm\nwait 400\nstatus\nfaults\nbaseline\n");
        assert!(said.contains("\nfault: T2 reads 1.") && said.contains(" degC measured, "), "{said}");
        assert!(said.contains("learnt from 1636 samples"), "{said}");
        assert!(said.contains("fdv 1") || said.contains("isolated"), "{said}");
    }

    #[test]
    fn errors_name_what_was_wrong() {
        let said = session("sett x 1\nset pid.kq 1\nset pid.kp -1\nwait forever\n");
        for word in ["unknown command \"sett\"", "pid.kq", "expected", "\"forever\""] {
            assert!(said.contains(word), "{word} in:\n{said}");
        }
    }
}
