//! `pt326 console`: the board's line console, run against the simulated rig instead of a board.
//!
//! On a terminal time passes as on the board (or `--speed` times faster). From a pipe it stands still but for `wait
//! SECONDS`, and for a `check`, which ends before the next line is read, so that a script always sees the same.

mod bench;
mod flash;
mod output_stage;
pub mod play;

use std::io::{BufRead, IsTerminal, Write};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use anyhow::Context;

use super::experiment::ExperimentArgs;
use super::terminal::{Output, print};
pub use bench::Bench;
pub use output_stage::{Defect, OutputStage};

/// Use the board's console, with the simulated rig in place of a board.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
On a terminal, time passes as on the board. When lines come from a pipe, time passes only in `wait SECONDS` and in \
`check`, which ends before the next line is read: a script always gives the same.

The command `help` lists the commands of the board. Only here, there are also:
  wait SECONDS                      let time pass
  wire swap t1 t2                   wire the rig wrongly; `help` lists what else can be wrong
  wire ok                           repair all wires and end all faults
  fault NAME [tN] SIZE [SECONDS]    let something happen to the rig; `pt326 scenario` has the names.
                                    A --scenario's faults come until your first `fault` or `wire`
  quit                              end

Examples:
  printf 'check\\narm\\nwait 400\\nstatus\\n' | pt326 console
  printf 'wire swap t1 t2\\ncheck\\nwire ok\\ncheck\\n' | pt326 console
  printf 'check\\narm\\nwait 370\\nfault offset t2 1.5 25\\nwait 5\\nstatus\\n' | pt326 console")]
pub struct ConsoleArgs {
    #[command(flatten)]
    /// The rig and the settings to begin with.
    pub experiment: ExperimentArgs,
    /// Seed of the rig's noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// On a terminal: how many times faster than the board.
    #[arg(long, default_value_t = 1.0, value_parser = speed)]
    pub speed: f64,
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(speed) if (0.01..=1000.0).contains(&speed) => Ok(speed),
        _ => Err("expected 0.01 to 1000".into()),
    }
}

/// Runs the console until its input ends.
///
/// # Errors
/// A bad file or value.
pub fn run(args: &ConsoleArgs) -> anyhow::Result<()> {
    let (config, scenario) = args.experiment.load_by_hand()?;
    let mut bench = Bench::new(&config, &scenario, args.seed)?;
    if std::io::stdin().is_terminal() {
        print("The board's console on the simulated rig. Type help; wait SECONDS skips time; quit ends.\n")?;
        interactive(&mut bench, args.speed)
    } else {
        scripted(&mut bench, std::io::stdin().lock(), Output(std::io::stdout().lock()))
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
    let period = Duration::from_secs_f64(bench.sample_time() / speed);
    let mut due = Instant::now() + period;
    prompt()?;
    loop {
        match lines.recv_timeout(due.saturating_duration_since(Instant::now())) {
            Ok(line) if line.trim() == "quit" => return Ok(()),
            Ok(line) => {
                print(&bench.answer(&line))?;
                prompt()?;
            }
            Err(RecvTimeoutError::Timeout) => {
                bench.pass();
                due += period;
                let news = bench.news();
                if !news.is_empty() {
                    print(&format!("\n{news}"))?;
                    prompt()?;
                }
            }
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

fn prompt() -> anyhow::Result<()> {
    print("> ")
}

/// Answers each line; time passes by `wait` and `check` alone.
fn scripted(bench: &mut Bench, input: impl BufRead, mut output: impl Write) -> anyhow::Result<()> {
    for line in input.lines() {
        let line = line.context("the input can't be read")?;
        if line.trim() == "quit" {
            break;
        }
        writeln!(output, "> {line}")?;
        output.write_all(bench.answer(&line).as_bytes())?;
        output.write_all(bench.news().as_bytes())?;
        while bench.is_checking() {
            bench.pass();
            output.write_all(bench.news().as_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use fdi_core::Config;

    use super::*;
    use pt326_host::experiment::scenario::Scenario;

    fn session(script: &str) -> String {
        let mut bench = Bench::new(&Config::default(), &Scenario::default(), 1).unwrap();
        let mut output = Vec::new();
        scripted(&mut bench, script.as_bytes(), &mut output).unwrap();
        String::from_utf8(output).unwrap()
    }

    #[test]
    fn a_session_arms_heats_sets_and_stops() {
        let said = session(
            "wait 1\nstatus\narm\ncheck\narm\nwait 60\nstatus\nset setpoint 38\nwait 30\nstatus\nsave\nstop\nsave\nstatus\n",
        );
        for word in [
            "mode off",
            "error: no `check` has passed since the start",
            "check: which thermistor answers first\n",
            "check passed\n> arm\nok\n",
            " off -> settle\n",
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
        let said =
            session("set supervisor.check_before_arming false\narm\nwait 400\nstatus\nfaults\nbaseline\n");
        assert!(said.contains("armed without a check"), "{said}");
        assert!(said.contains("\nfault: T2 reads 1.") && said.contains(" degC measured, "), "{said}");
        assert!(said.contains("learnt from 1636 samples"), "{said}");
        assert!(said.contains("fdv 1") || said.contains("isolated"), "{said}");
    }

    #[test]
    fn the_users_faults_stand_in_place_of_the_papers() {
        let own = "set supervisor.check_before_arming false\narm\nwait 370\nfault offset t2 -1.5 8\nwait 430\nfaults\n";
        let said = session(own);
        let (_, listed) = said.split_once("> faults\n").unwrap();
        let alarms: Vec<&str> = listed.lines().filter(|line| line.contains("alarm: ")).collect();
        assert!(matches!(alarms[..], [one] if one.contains("t2_offset -1.")), "{said}");
    }

    #[test]
    fn what_the_board_refuses_is_refused_here() {
        let said = session("set sample_time 9\nget sample_time\nsave\n");
        assert!(said.contains("error: sample_time is 9, expected 0.05 to 5"), "{said}");
        assert!(said.contains("> get sample_time\nsample_time = 0.11"), "{said}");
        assert!(said.ends_with("> save\nok\n"), "{said}");
    }

    #[test]
    fn faults_lists_alarms_and_lockouts_too_and_each_is_told_when_it_comes() {
        let said = session(
            "set supervisor.check_before_arming false\narm\nwait 400\nwire interlock open\nwait 1\nfaults\n",
        );
        let (told, listed) = said.split_once("> faults\n").unwrap();
        for word in [" alarm: t2_offset 1.", " lockout: the interlock on the break input opened"] {
            assert!(listed.contains(word), "{word} in:\n{said}");
        }
        for word in [
            "likelihood: 384.",
            "detected: 38",
            "the interlock on the break input opened",
            "learn -> monitor",
        ] {
            assert!(told.contains(word), "{word} in:\n{said}");
        }
    }

    #[test]
    fn a_wrong_wire_is_told_mended_and_told_no_more() {
        let said = session("wire swap t1 t2\ncheck\narm\nwire ok\ncheck\narm\n!\nstatus\n");
        let (wrong, mended) = said.split_once("> wire ok\n").unwrap();
        assert!(
            wrong.contains("T1 and T2 are swapped") && wrong.contains("check failed: 1 finding"),
            "{said}"
        );
        assert!(wrong.ends_with("waives it\n"), "{said}");
        assert!(mended.contains("check passed\n> arm\nok\n"), "{said}");
        assert!(mended.contains("stopped") && mended.contains("mode off"), "{said}");
    }

    #[test]
    fn a_fault_while_heating_trips_and_ends_after_its_time() {
        let said = session(
            "check\narm\nwait 20\nfault open t1 2\nwait 1\nstatus\nwait 3\nack\narm\nfault offset t2 1.5 25\n",
        );
        assert!(
            said.contains("mode tripped (") && said.trim_end().ends_with("fault offset t2 1.5 25"),
            "{said}"
        );
        let armed = said.matches("> arm\nok\n").count();
        assert!(said.contains("> ack\nok\n") && armed == 2, "{said}");
    }

    #[test]
    fn thermistors_are_calibrated_at_rest_and_uncalibrated_again() {
        let said = session(
            "calibrate t1 22\nwait 20\ncalibrate t1 23.5\ncalibrate all 22\ncalibrate t1 60\ncalibrate t1 22.1\ncalibrate back\ncalibrate apply\nwait 2\n\
             get sensors.t1.offset\ncalibrate undo\nget sensors.t1.offset\ncheck\narm\nwait 1\ncalibrate t1 22\n",
        );
        for word in [
            "error: t1: the thermistor does not stand still",
            "t1 reads 22.5",
            "from 1 point\n",
            "from 2 points, at most 0.75 degC beside them",
            "error: t1: that is gain",
            "in force; `save` keeps it",
            "sensors.t1.offset = 0.197 degC",
            "sensors.t1.offset = 0 degC",
            "error: not while the heater may be on",
        ] {
            assert!(said.contains(word), "{word} in:\n{said}");
        }
    }

    #[test]
    fn the_controller_is_tuned_by_an_experiment_and_put_back() {
        let said = session(
            "tune\ntune apply model\ntune start\ncheck\nwait 5\ntune start\nwait 1\ntune start\ntune\nstatus\nset pid.kp 2\nwait 10\nstatus\nwait 140\n\
             tune\ntune apply quick\nget pid.kp\nget pid.ti\narm\nwait 40\nstatus\ntune undo\nget pid.kp\ntune undo\nstop\n",
        );
        let (before, after) =
            said.split_once("tune: done, the heater is off.").unwrap_or_else(|| panic!("{said}"));
        for word in [
            "nothing yet: `tune start` heats",
            "error: there is no result",
            "error: no `check` has passed since the start",
            "ok, see below; it heats",
            "error: not possible in mode tune",
            "mode tune: at rest",
            "mode tune: constant power until T1 stands still",
            "tune: at rest",
        ] {
            assert!(before.contains(word), "{word} in:\n{said}");
        }
        for word in [
            "relay: kp ",
            "model: kp ",
            "quick: kp ",
            "gain margin 3.",
            "in force: kp 2.4000, ti 0.500 s",
            "mode settle",
            "nothing to take back",
            "pid.kp = 2.4 %/degC",
        ] {
            assert!(after.contains(word), "{word} in:\n{said}");
        }
        assert_eq!(after.matches("`save` keeps it, `tune undo` takes it back").count(), 1, "{said}");
        assert_eq!(
            after.matches("`save` keeps it\n").count(),
            1,
            "what came back does not come back again: {said}"
        );
    }

    #[test]
    fn a_fault_that_is_taught_is_told_by_its_name() {
        let shown =
            |seconds| format!("teach low\nfault offset t2 -1.5 25\nwait {seconds}\nteach end\nwait 60\n");
        let said = session(&format!(
            "teach low\nteach end\nteach show\nset supervisor.check_before_arming false\narm\nwait 515\n{}{}{}teach other\nteach low\nteach low\nwait 1\nteach end\nteach\n\
             teach save\nwait 60\nfault offset t2 -1.5 25\nwait 15\nstatus\nwait 15\nfaults\nget diagnosis.isolation.4\n\
             get likelihood.taught.1\nstop\nwait 1\nsave\n\
             teach save\nteach drop\nteach 2low\n",
            shown(24),
            shown(24),
            shown(20),
        ));
        for word in [
            "> teach low\nerror: only while it monitors",
            "error: no repetition is under way",
            "error: there is nothing yet",
            "low, repetition 1: make it now",
            "repetition 3: 0 +1 0 -1 0\n",
            "error: expected `teach save` or `teach drop` of low first",
            "error: a repetition is under way",
            "error: that was too short",
            "low 3: 0 +1 0 -1 0\nrow: 4 0 +1 0 -1 0 low\nlikelihood: 0 0 0 0 -1",
            "in force\nrow: 4 0 +1 0 -1 0 low\nlikelihood: 0 0 0 0 -1",
            "it heats: `save` keeps it",
            "\nfdv 4 fiv 4 (low)\n",
            "likelihood diagnosis armed: t2_offset (low)\n",
            "fault: fdv 4 fiv 4 (low), detected",
            "diagnosis.isolation.4 = 4 0 +1 0 -1 0 low\n",
            "likelihood.taught.1 = low 0 0 0 0 -1",
            "> save\nok\n",
            "teach: expected NAME (a letter",
        ] {
            assert!(said.contains(word), "{word} in:\n{said}");
        }
    }

    #[test]
    fn errors_name_what_was_wrong() {
        let said = session(
            "sett x 1\nset pid.kq 1\nset pid.kp -1\nwait forever\nwire upside down\nwire swap t1 t3\nwire detached t0\n\
             fault explode\nfault offset t1\n",
        );
        for word in [
            "unknown command \"sett\"",
            "pid.kq",
            "expected",
            "\"forever\"",
            "\"upside down\"",
            "\"t3\"",
            "sensor is t0",
            "no verb \"explode\"",
            "key `size` is missing",
        ] {
            assert!(said.contains(word), "{word} in:\n{said}");
        }
    }
}
