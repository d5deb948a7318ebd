//! `--record`: what the board streams, into a file; a cable that is pulled out is a gap that is told.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};

use super::signals::Heed;
use crate::commands::terminal::print;
use pt326_host::board::record::Recorder;
use pt326_host::board::{ALONE, Heard, Session};
use pt326_host::experiment::as_written;

/// So long without a line, and the stream is asked for once more: the board may have been reset.
const SILENCE: Duration = Duration::from_secs(2);
/// Between two attempts to open a port that has gone.
const ANOTHER: Duration = Duration::from_millis(300);

/// Records until Ctrl-C, or for a time.
pub(super) fn run(name: &str, file: &Path, from_start: bool, seconds: Option<f64>) -> anyhow::Result<()> {
    let place = || format!("{} cannot be written", file.display());
    let out = BufWriter::new(File::create(file).with_context(place)?);
    let ended = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&ended);
    // Without it, Ctrl-C ends the program, and the last lines are lost.
    let _heed = Heed::new(move || asked.store(true, Ordering::Relaxed))?;
    let (recorder, is_there) = record(name, out, from_start, seconds, &ended)?;
    print(&format!("{} written to {}\n", recorder.progress(), file.display()))?;
    if recorder.from_start {
        print(&format!("`pt326 replay {}` runs the core over it once more\n", file.display()))?;
    } else {
        print("it does not begin at tick 0, which a replay needs: `--from-start` has it so\n")?;
    }
    if !is_there {
        bail!("the port had gone when the record ended: {ALONE}");
    }
    Ok(())
}

/// Records until `ended`, or for `seconds` of the board's time; and whether the port is there in the end.
///
/// # Errors
/// No board at first, a file that cannot be written.
fn record(
    name: &str,
    out: BufWriter<File>,
    from_start: bool,
    seconds: Option<f64>,
    ended: &AtomicBool,
) -> anyhow::Result<(Recorder<BufWriter<File>>, bool)> {
    let mut session = Session::open(name)?;
    let sample_time = sample_time(&mut session)?;
    let enough = seconds.map(|seconds| (seconds / sample_time).round() as u64);
    let mut recorder = Recorder::new(out);
    if from_start {
        session.order("restart")?;
    } else {
        session.order("stream on")?;
    }
    let style = ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new_spinner().with_style(style);
    let mut last = Instant::now();
    while !ended.load(Ordering::Relaxed) && enough.is_none_or(|enough| recorder.ticks < enough) {
        let Ok(heard) = session.hear() else {
            recorder.remark("the port has gone")?;
            bar.set_message(format!("{}, the port has gone: plug it in again", recorder.progress()));
            let Some(again) = reopen(name, ended) else { break };
            session = again;
            recorder.remark("the port is back")?;
            continue;
        };
        for heard in heard {
            match heard {
                Heard::Line(line) => {
                    last = Instant::now();
                    recorder.line(&line)?;
                }
                Heard::Broken => recorder.broken(),
                Heard::Text(_) => {}
            }
        }
        if last.elapsed() > SILENCE + Duration::from_secs_f64(sample_time) {
            last = Instant::now();
            let _ = session.send(b"\x15stream on\r");
        }
        bar.set_message(recorder.progress());
    }
    bar.finish_and_clear();
    let is_there = session.send(b"\x15stream off\r").is_ok();
    recorder.remark("end of the record")?;
    Ok((recorder, is_there))
}

/// Waits for the port to come back, and has the stream go on; `None` if it is not to go on.
fn reopen(name: &str, ended: &AtomicBool) -> Option<Session> {
    while !ended.load(Ordering::Relaxed) {
        if let Ok(mut session) = Session::open(name)
            && session.ask("stream on").is_ok()
        {
            return Some(session);
        }
        std::thread::sleep(ANOTHER);
    }
    None
}

/// Ts of the board, s.
fn sample_time(session: &mut Session) -> anyhow::Result<f64> {
    let config = pt326_host::board::settings::read(session)?;
    Ok(as_written(config.sample_time.0))
}
