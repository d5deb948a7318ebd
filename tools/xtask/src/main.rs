//! What cargo cannot do by its settings alone: the board's image without the paths of this machine, a folder of it to hand on, the bound
//! of its stack, a release, and the tables and pictures of the book.

mod dist;
mod guide;
mod image;
mod release;
mod results;
mod stack;
mod zip;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let verb = arguments.next().unwrap_or_default();
    let done = match verb.to_str() {
        Some(verb @ ("build" | "run" | "attach")) => image::cargo(verb, arguments),
        Some("test") => image::test(arguments),
        Some("dist") => dist::write(arguments.next().as_deref()),
        Some("stack") => stack::check(arguments.next().as_deref()),
        Some("release") => release::run(arguments),
        Some("results") => results::run(arguments),
        _ => Err(format!(
            "{verb:?}, expected build, run, attach, test [--no-run], dist [FOLDER], stack IMAGE, release or results (see --help of these two)"
        )),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("xtask: {why}");
            ExitCode::FAILURE
        }
    }
}
