//! `cargo xtask results`: makes the tables and pictures of the book anew and puts them into its pages, each with the commit, the time that it
//! took, and the command that makes it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::image;

const USAGE: &str = "\
Makes the tables and pictures of the book anew: hours. What was interrupted goes on where it stopped.

    cargo xtask results                    all of it, into docs/evidence/
    --only full,physics                    these jobs only
    --seeds 3000000                        first seed of what is reported, in place of 2000000 and 7000000
    --scale 0.01                           so many of the runs, to try it
    --docs FOLDER                          another folder than docs/evidence/, with pages that have the markers
    --fresh                                not on from what another build of pt326 has begun: that is deleted

Jobs: run, full, physics, settings, trade, ablate, records (recordings in the folder that PT326_RECORDS names), mutants.
Pages take their blocks between <!-- NAME --> and <!-- end NAME -->. The pictures of the page: cargo lab, then cargo run -p pt326-lab-browser.
The comparison with other detectors: python/tests/detectors.py, see docs/evidence/records.md.";

/// Where a result goes.
enum Place {
    /// A part of a file: file, what is taken of it, page, block.
    Block(&'static str, fn(&str) -> &str, &'static str, &'static str),
    /// A picture.
    Picture(&'static str),
    /// A whole page: file, page.
    Page(&'static str, &'static str),
}
use Place::{Block, Page, Picture};

/// How a result is made.
struct Job {
    name: &'static str,
    /// Arguments of `pt326`; those of a cargo alias where `cargo` comes first.
    command: &'static [&'static str],
    /// First seed, and the share of the definition's runs.
    runs: Option<(&'static str, f64)>,
    places: &'static [Place],
}

/// What a command has printed.
const PRINTED: &str = "printed.txt";

const JOBS: [Job; 8] = [
    Job { name: "run", command: &["run"], runs: None, places: &[Picture("figure6.svg")] },
    Job {
        name: "full",
        command: &["campaign"],
        runs: Some(("2000000", 1.0)),
        places: &[
            Block("tables.md", str::trim, "results.md", "results"),
            Block("runaway.md", str::trim, "safety-evidence.md", "runaway"),
            Picture("delays.svg"),
            Picture("confusion.svg"),
        ],
    },
    Job {
        name: "physics",
        command: &["campaign", "--physics"],
        runs: Some(("7000000", 0.25)),
        places: &[Block("tables.md", targets, "results.md", "physics")],
    },
    Job {
        name: "settings",
        command: &[
            "campaign",
            "--vary=likelihood.model_uncertainty=0.0",
            "--vary=likelihood.slow_interval=1000.0",
            "--vary=likelihood.fast_allowance=0.5,1.0,2.0",
            "--vary=likelihood.fast_interval=5.0,9.0",
        ],
        runs: Some(("1", 0.1)),
        places: &[Block("tables.md", str::trim, "results.md", "ablation")],
    },
    Job {
        name: "trade",
        command: &[
            "campaign",
            "--vary=likelihood.fast_interval=3.0,4.0,5.0,6.0,9.0,12.0",
            "--vary=diagnosis.sigma_factor=2.5,4.0,5.0,6.0",
        ],
        runs: Some(("1", 0.1)),
        places: &[Picture("trade.svg")],
    },
    Job {
        name: "ablate",
        command: &["campaign", "--ablate"],
        runs: Some(("90000", 1.0)),
        places: &[Page("vary.md", "ablation.md")],
    },
    Job {
        name: "records",
        command: &["campaign", "records"],
        runs: None,
        places: &[Block("records.md", str::trim, "records.md", "results")],
    },
    Job {
        name: "mutants",
        command: &["cargo", "mutants-board", "--markdown"],
        runs: None,
        places: &[Block(PRINTED, table, "safety-evidence.md", "mutants")],
    },
];

/// What was asked for.
struct Asked {
    only: Option<Vec<String>>,
    seeds: Option<String>,
    scale: f64,
    docs: PathBuf,
    fresh: bool,
}

impl Asked {
    fn new(arguments: impl Iterator<Item = OsString>) -> Result<Option<Self>, String> {
        let docs = image::root().join("docs/evidence");
        let mut asked = Self { only: None, seeds: None, scale: 1.0, docs, fresh: false };
        let mut arguments = arguments.map(|word| word.to_string_lossy().into_owned());
        while let Some(option) = arguments.next() {
            if ["--help", "-h"].contains(&option.as_str()) {
                return Ok(None);
            }
            if option == "--fresh" {
                asked.fresh = true;
                continue;
            }
            let value =
                arguments.next().ok_or_else(|| format!("{option} without a value, expected:\n{USAGE}"))?;
            match option.as_str() {
                "--only" => asked.only = Some(value.split(',').map(str::to_owned).collect()),
                "--seeds" => asked.seeds = Some(value),
                "--scale" => {
                    let scale = value.parse().ok().filter(|scale: &f64| *scale > 0.0);
                    asked.scale =
                        scale.ok_or_else(|| format!("--scale {value}, expected a number above 0"))?;
                }
                "--docs" => asked.docs = value.into(),
                _ => return Err(format!("{option}, expected:\n{USAGE}")),
            }
        }
        let known = |name: &&String| JOBS.iter().any(|job| job.name == **name);
        match asked.only.iter().flatten().find(|name| !known(name)) {
            Some(unknown) => Err(format!("no job is named {unknown}, expected:\n{USAGE}")),
            None => Ok(Some(asked)),
        }
    }

    fn wants(&self, job: &Job) -> bool {
        self.only.as_ref().is_none_or(|names| names.iter().any(|name| name == job.name))
    }

    /// The arguments of a job.
    fn arguments(&self, job: &Job) -> Vec<String> {
        let mut arguments: Vec<String> = job.command.iter().map(|word| (*word).to_owned()).collect();
        if let Some((seed, share)) = job.runs {
            let tuned = seed.len() < 6; // what is for tuning stays so
            let seed = self.seeds.as_deref().filter(|_| !tuned).unwrap_or(seed);
            let scale = (share * self.scale).to_string();
            arguments.extend(["--scale", &scale, "--seeds-from", seed].map(str::to_owned));
        }
        if job.name == "records" {
            arguments.push("$PT326_RECORDS".into());
        }
        arguments
    }
}

/// Makes what was asked for.
///
/// # Errors
/// An argument that is none; what could not be made, after all else was.
pub(crate) fn run(arguments: impl Iterator<Item = OsString>) -> Result<(), String> {
    let Some(asked) = Asked::new(arguments)? else {
        println!("{USAGE}");
        return Ok(());
    };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--release", "-p", "pt326"]).current_dir(image::root());
    if !build.status().map_err(|error| format!("cargo cannot be run: {error}"))?.success() {
        return Err("pt326 was not built".into());
    }
    let commit = commit()?;
    let mut failed = Vec::new();
    for job in JOBS.iter().filter(|job| asked.wants(job)) {
        println!("== {}", job.name);
        match make(&asked, job, &commit) {
            Ok(()) => {}
            Err(why) => failed.push(format!("{}: {why}", job.name)),
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("not made:\n{}", failed.join("\n"))) }
}

/// Makes one result and puts it where it belongs.
fn make(asked: &Asked, job: &Job, commit: &str) -> Result<(), String> {
    let out = image::target().join("results").join(format!("{}-{}", job.name, asked.scale));
    std::fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let began = Instant::now();
    let arguments = asked.arguments(job);
    // Not in `arguments`: a page tells those, and they make the same without it.
    let fresh = (asked.fresh && job.runs.is_some()).then(|| "--fresh".to_owned());
    execute(job, &[&arguments[..], fresh.as_slice()].concat(), &out)?;
    let told = match job.command.first() {
        Some(&"cargo") => arguments.join(" "),
        _ => format!("pt326 {}", arguments.join(" ")),
    };
    let about = format!("*Commit {commit}; {}: `{told}`*\n", lasted(began.elapsed().as_secs()));
    job.places.iter().try_for_each(|place| put(place, &out, &asked.docs, &about))
}

/// Runs the command of a job; what it makes is in `out`.
fn execute(job: &Job, arguments: &[String], out: &Path) -> Result<(), String> {
    let (program, arguments) = match job.command.first() {
        Some(&"cargo") => (PathBuf::from("cargo"), &arguments[1..]),
        _ => (image::target().join("release").join("pt326"), arguments),
    };
    let mut command = Command::new(&program);
    for argument in arguments {
        match argument.strip_prefix('$') {
            Some(name) => command.arg(std::env::var_os(name).ok_or_else(|| format!("{name} is not set"))?),
            None => command.arg(argument),
        };
    }
    if job.places.iter().any(|place| matches!(place, Block(PRINTED, ..))) {
        let file = std::fs::File::create(out.join(PRINTED)).map_err(|error| format!("{PRINTED}: {error}"))?;
        command.stdout(Stdio::from(file));
    } else {
        command.arg("--out").arg(out);
    }
    let status = command.current_dir(image::root()).status();
    match status.map_err(|error| format!("{}: {error}", program.display()))?.success() {
        true => Ok(()),
        false => Err("the command has failed".into()),
    }
}

/// Puts a result into the book.
fn put(place: &Place, out: &Path, docs: &Path, about: &str) -> Result<(), String> {
    let read =
        |file: &Path| std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()));
    let write = |file: PathBuf, text: String| {
        println!("{}", file.display());
        std::fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()))
    };
    match *place {
        Block(file, part, page, name) => {
            let text = read(&out.join(file))?;
            let new = format!("{about}\n{}", part(&text));
            let page = docs.join(page);
            let text = replaced(&read(&page)?, name, &new);
            write(page.clone(), text.ok_or_else(|| format!("{} has no block {name}", page.display()))?)
        }
        Picture(file) => {
            println!("{}", docs.join(file).display());
            let copied = std::fs::copy(out.join(file), docs.join(file));
            copied.map(drop).map_err(|error| format!("{}: {error}", out.join(file).display()))
        }
        Page(file, page) => write(docs.join(page), format!("{}\n{about}", read(&out.join(file))?)),
    }
}

/// The targets of a campaign, without the delays of each cell: 1,700 lines.
fn targets(text: &str) -> &str {
    text.split("\nDelays in s").next().unwrap_or(text).trim()
}

/// The first table of a text.
fn table(text: &str) -> &str {
    let from = text.find("\n|").map_or(0, |at| at + 1);
    text[from..].split("\n\n").next().unwrap_or(text).trim()
}

/// A page with another text between its markers.
fn replaced(page: &str, name: &str, new: &str) -> Option<String> {
    let (first, last) = (format!("<!-- {name} -->\n"), format!("<!-- end {name} -->"));
    let from = page.find(&first)? + first.len();
    let to = from + page[from..].find(&last)?;
    Some(format!("{}{new}\n{}", &page[..from], &page[to..]))
}

/// The commit, its day, and whether something has changed since.
fn commit() -> Result<String, String> {
    let git = |arguments: &[&str]| {
        let out = Command::new("git").args(arguments).current_dir(image::root()).output();
        out.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned())
            .map_err(|error| format!("git cannot be run: {error}"))
    };
    let changed = git(&["status", "--porcelain", "--untracked-files=no", "--", ":!docs"])?;
    let commit = git(&["log", "-1", "--format=%h of %cs"])?;
    Ok(commit + if changed.is_empty() { "" } else { " with changes" })
}

fn lasted(seconds: u64) -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    match seconds {
        0..120 => format!("{seconds} s on {threads} threads"),
        120..7200 => format!("{} min on {threads} threads", seconds / 60),
        _ => format!("{} h {} min on {threads} threads", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(words: &[&str]) -> Result<Option<Asked>, String> {
        Asked::new(words.iter().map(Into::into))
    }

    #[test]
    fn every_block_has_its_markers_in_the_book() {
        for job in &JOBS {
            for place in job.places {
                let file = match place {
                    Block(_, _, page, _) | Page(_, page) => page,
                    Picture(picture) => picture,
                };
                let file = image::root().join("docs/evidence").join(file);
                assert!(file.is_file(), "{}", file.display());
                if let Block(_, _, page, name) = place {
                    let text = std::fs::read_to_string(&file).unwrap();
                    assert!(replaced(&text, name, "new").is_some(), "{page} has no block {name}");
                }
            }
        }
    }

    #[test]
    fn only_what_stands_between_the_markers_is_replaced() {
        let page = "a\n<!-- x -->\nold\nold\n<!-- end x -->\nb\n";
        assert_eq!(replaced(page, "x", "new").unwrap(), "a\n<!-- x -->\nnew\n<!-- end x -->\nb\n");
        assert_eq!(replaced(page, "y", "new"), None);
        assert_eq!(targets("Targets\n\n| a |\n\nDelays in s\n| b |\n"), "Targets\n\n| a |");
        assert_eq!(table("built\n\n| a |\n| b |\n\n2 seen\n"), "| a |\n| b |");
    }

    #[test]
    fn seeds_for_tuning_stay_and_others_are_those_asked_for() {
        let asked = asked(&["--seeds", "9000000", "--scale", "0.5"]).unwrap().unwrap();
        let of = |name: &str| {
            let job = JOBS.iter().find(|job| job.name == name).unwrap();
            asked.arguments(job).join(" ")
        };
        assert_eq!(of("physics"), "campaign --physics --scale 0.125 --seeds-from 9000000");
        assert!(of("trade").ends_with("--scale 0.05 --seeds-from 1"), "{}", of("trade"));
        assert_eq!(of("run"), "run");
    }

    #[test]
    fn what_is_no_option_or_job_is_refused() {
        for words in [&["--only", "nothing"][..], &["--scale", "0"], &["--docs"], &["x", "y"]] {
            assert!(asked(words).is_err(), "{words:?}");
        }
        assert!(asked(&["--fresh", "--only", "run"]).unwrap().unwrap().fresh);
    }
}
