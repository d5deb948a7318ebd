//! What cargo cannot do by its settings alone: the board's image without the paths of this machine, a folder of it to hand on, and the bound
//! of its stack.

mod dist;
mod guide;
mod image;
mod stack;
mod zip;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let verb = arguments.next().unwrap_or_default();
    let done = match verb.to_str() {
        Some(verb @ ("build" | "run" | "attach")) => image::cargo(verb, arguments),
        Some("dist") => dist::write(arguments.next().as_deref()),
        Some("stack") => stack::check(arguments.next().as_deref()),
        _ => Err(format!("{verb:?}, expected build, run, attach, dist [FOLDER] or stack IMAGE")),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("xtask: {why}");
            ExitCode::FAILURE
        }
    }
}
