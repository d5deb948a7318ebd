//! The command as a user calls it, one file a command.

mod bed;
mod clocks;
mod cold;
mod console;
mod core;
mod diagnose;
mod drive;
mod forms;
mod hostile;
mod isolability;
mod lid;
mod made;
mod plant;
mod porting;
mod printer;
mod replay;
mod run;
mod samples;
mod score;
mod shell;
mod teach;
mod training;
#[cfg(all(unix, feature = "live"))]
mod wall;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The command with its standard streams in pipes.
fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pt326"));
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs `pt326` to its end.
fn pt326(args: &[&str]) -> Output {
    command(args).output().expect("pt326 runs")
}

/// The same with `input` on its standard input.
fn pt326_reading(args: &[&str], input: &str) -> Output {
    let mut child = command(args).stdin(Stdio::piped()).spawn().expect("pt326 runs");
    // It may end before it has read everything.
    let _ = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    child.wait_with_output().expect("pt326 ends")
}

/// Runs `pt326` with nobody who reads what it prints: it must end as if all were read.
fn succeeds_into_a_closed_pipe(args: &[&str]) {
    let mut child = command(args).spawn().expect("pt326 runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("pt326 ends");
    let error = text(&output.stderr);
    assert!(output.status.success() && error.is_empty(), "{args:?}: {:?}, {error}", output.status);
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A fresh folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).expect("folder");
    dir
}

/// A path as an argument.
fn arg(path: &Path) -> &str {
    path.to_str().expect("a name in UTF-8")
}

/// A run that takes little time.
const SHORT: &str = "duration = 20.0\nfault = []\n";

/// Monitors are large, and a build without optimization copies them on the stack: a test's own is too small.
fn on_a_large_stack(look: impl FnOnce() + Send + 'static) {
    const STACK: usize = 64 << 20;
    let looked = std::thread::Builder::new().stack_size(STACK).spawn(look).unwrap().join();
    assert!(looked.is_ok());
}
