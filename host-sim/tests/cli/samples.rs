//! What the documents show as output of a command is what the command prints, and the commands that they show exist.
//!
//! A block of output has a comment above it that names its command:
//!
//! ```text
//! <!-- made by: pt326 run | head -n 5 -->
//! ```
//!
//! `UPDATE_DOCS=1 cargo test -p pt326 --test cli samples` writes the blocks anew. What a command of `tools/` or of cargo makes, that command
//! compares and writes.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::CommandFactory;
use pt326::commands::Cli;
use rayon::prelude::*;

use crate::folder;

const AGAIN: &str = "stale: UPDATE_DOCS=1 cargo test -p pt326 --features live --test cli samples";

/// A block of output: its command, and which lines of the page it is, from 0.
struct Sample<'a> {
    command: &'a str,
    lines: std::ops::Range<usize>,
    /// What each line begins with: a quotation has no fence.
    prefix: &'static str,
}

/// The blocks of a page.
fn samples(page: &str) -> Vec<Sample<'_>> {
    let lines: Vec<&str> = page.lines().collect();
    let marked = lines.iter().enumerate().filter_map(|(at, line)| {
        let command =
            line.strip_prefix("<!-- made by: ")?.strip_suffix(" -->").expect("a comment of one line");
        let quoted = lines.get(at + 1).is_some_and(|line| line.starts_with('>'));
        let (first, prefix, ends): (_, _, fn(&str) -> bool) = match quoted {
            true => (at + 1, "> ", |line| !line.starts_with('>')),
            false => (at + 2, "", |line| line.starts_with("```")),
        };
        let after = lines.iter().skip(first).position(|line| ends(line)).expect("the end of the block");
        Some(Sample { command, lines: first..first + after, prefix })
    });
    marked.collect()
}

/// The page with other blocks, and the first line that is another now, from 1.
fn renewed(page: &str, output: impl Fn(&str) -> String) -> (String, Option<usize>) {
    let lines: Vec<String> = page.lines().map(str::to_owned).collect();
    let (mut new, mut done) = (Vec::new(), 0);
    for Sample { command, lines: block, prefix } in samples(page) {
        new.extend_from_slice(&lines[done..block.start]);
        new.extend(output(command).trim_end().lines().map(|line| format!("{prefix}{line}")));
        done = block.end;
    }
    new.extend_from_slice(&lines[done..]);
    let differs = (0..lines.len().max(new.len())).find(|&at| lines.get(at) != new.get(at));
    (new.join("\n") + "\n", differs.map(|at| at + 1))
}

/// README.md and the pages of docs/ and docs/evidence/, with their texts.
fn pages() -> BTreeMap<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = ["docs", "docs/evidence"].map(|folder| std::fs::read_dir(root.join(folder)).unwrap());
    let docs = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
    let pages = docs.filter(|page| page.extension().is_some_and(|ending| ending == "md"));
    let pages = pages.chain([root.join("README.md")]);
    pages.map(|page| (page.clone(), std::fs::read_to_string(page).unwrap())).collect()
}

/// Whether a command is run here, and this build has it; the server is a feature.
fn is_built(command: &str) -> bool {
    let elsewhere = ["tools/", "cargo "].iter().any(|program| command.starts_with(program));
    !elsewhere && (cfg!(feature = "live") || !command.starts_with("pt326 live"))
}

/// What a command prints, in a folder of its own, which has the documents as `docs`.
fn output(command: &str, folder: &Path) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_pt326")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    std::fs::create_dir_all(folder).unwrap();
    std::os::unix::fs::symlink(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs"), folder.join("docs")).unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).current_dir(folder).env("PATH", path).env("COLUMNS", "100");
    let out = shell.stdin(std::process::Stdio::null()).output().unwrap();
    assert!(out.status.success(), "{command}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

#[test]
fn what_the_documents_show_is_what_the_commands_print() {
    let (pages, folder) = (pages(), folder("samples"));
    let mut commands: Vec<&str> =
        pages.values().flat_map(|page| samples(page)).map(|sample| sample.command).collect();
    commands.sort_unstable();
    commands.dedup();
    commands.retain(|command| is_built(command));
    assert!(commands.len() > 25, "{commands:?}");
    let outputs: BTreeMap<&str, String> = commands
        .par_iter()
        .enumerate()
        .map(|(number, command)| (*command, output(command, &folder.join(number.to_string()))))
        .collect();
    let mut stale = Vec::new();
    for (path, page) in &pages {
        let shown: BTreeMap<&str, String> = samples(page)
            .iter()
            .map(|sample| (sample.command, page.lines().collect::<Vec<_>>()[sample.lines.clone()].join("\n")))
            .collect();
        let (new, differs) = renewed(page, |command| outputs.get(command).unwrap_or(&shown[command]).clone());
        let Some(line) = differs else { continue };
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(path, new).unwrap();
        } else {
            stale.push(format!("{}:{line}", path.display()));
        }
    }
    assert!(stale.is_empty(), "{AGAIN}\n{}", stale.join("\n"));
}

/// `pt326` and all commands below it, as they are typed.
fn typed(command: &clap::Command, before: &str) -> Vec<String> {
    let name = format!("{before}{}", command.get_name());
    let below = command.get_subcommands().filter(|below| below.get_name() != "help");
    let below: Vec<String> = below.flat_map(|below| typed(below, &format!("{name} "))).collect();
    [vec![name], below].concat()
}

#[test]
fn the_page_of_commands_has_every_command() {
    let page = &pages()[&Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/commands.md")];
    let commands = typed(&Cli::command(), "");
    assert!(commands.len() > 25, "{commands:?}");
    // A command below another may be named without the program: `board faults`.
    let is_named = |command: &str| page.contains(command.strip_prefix("pt326 ").unwrap_or(command));
    let missing: Vec<_> = commands.iter().filter(|command| !is_named(command)).collect();
    assert!(missing.is_empty(), "docs/commands.md does not name {missing:?}");
}

/// The lines of shell blocks, each with its place.
fn shell_lines(page: &str) -> Vec<(usize, String)> {
    let (mut is_shell, mut lines, mut open) = (false, Vec::new(), String::new());
    for (number, line) in (1..).zip(page.lines()) {
        let line = line.trim();
        if line.starts_with("```") {
            is_shell = line == "```sh";
        } else if is_shell {
            open += line.trim_end_matches('\\');
            if !line.ends_with('\\') {
                lines.push((number, std::mem::take(&mut open)));
            }
        }
    }
    lines
}

/// Why `pt326` would not take a line of a shell block; of a line without it nothing is said.
fn refusal(line: &str) -> Option<String> {
    let line = line.split(" #").next().unwrap_or(line);
    let parts = line.split(['|', ';', '&']).map(str::trim);
    let mut calls = parts.filter(|part| part.starts_with("pt326 ") && is_built(part));
    calls.find_map(|call| {
        let words = shlex::split(call.split(['>', '<']).next().unwrap_or(call)).expect("closed quotes");
        let refused = Cli::command().try_get_matches_from(words).err()?;
        refused.use_stderr().then(|| refused.to_string().lines().next().unwrap_or_default().to_owned())
    })
}

#[test]
fn the_commands_of_the_documents_are_taken() {
    let (mut refused, mut taken) = (Vec::new(), 0);
    for (path, page) in pages() {
        for (number, line) in shell_lines(&page) {
            taken += usize::from(line.starts_with("pt326 "));
            refused.extend(refusal(&line).map(|why| format!("{}:{number}: {why}", path.display())));
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(taken > 60, "{taken} commands");
    assert!(refusal("pt326 run --sed 7").is_some_and(|why| why.contains("--sed")));
}

#[test]
fn a_block_is_renewed_and_the_rest_stays() {
    let page = "a\n<!-- made by: x -->\n```text\nold\nold\n```\nb\n<!-- made by: y -->\n> old\n\nc\n";
    let new = "a\n<!-- made by: x -->\n```text\nx!\n```\nb\n<!-- made by: y -->\n> y!\n\nc\n";
    assert_eq!(renewed(page, |command| format!("{command}!\n")), (new.to_owned(), Some(4)));
    assert_eq!(renewed(new, |command| format!("{command}!\n")), (new.to_owned(), None));
}
