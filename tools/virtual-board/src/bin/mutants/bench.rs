//! Where mutants are made: a copy of the tree in the target folder, with a target folder of its own.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, bail, ensure};

use crate::table::Mutant;

/// What is not copied. The settings of cargo are found in the folders above, and would be merged with themselves.
const LEFT_OUT: [&str; 4] = ["target", ".git", "out", ".cargo"];
const TARGET: &str = "thumbv7em-none-eabihf";

/// What the tests said.
pub(crate) struct Verdict {
    /// The tests that failed.
    pub(crate) killed_by: Vec<String>,
    /// Why there is no verdict: the mutant does not build, or its tests do not run.
    pub(crate) error: Option<anyhow::Error>,
}

/// The copy.
pub(crate) struct Bench {
    root: PathBuf,
    copy: PathBuf,
    target: PathBuf,
    /// The tests of the virtual board as they were at the start: who edits meanwhile does not disturb.
    tests: PathBuf,
}

impl Bench {
    /// Copies the tree as it is, and builds its image and the tests.
    ///
    /// # Errors
    /// It cannot be copied, or does not build.
    pub(crate) fn set_up() -> anyhow::Result<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
        let place = root.join("target/mutants");
        let [copy, target, tests] = ["tree", "target", "tests"].map(|name| place.join(name));
        let bench = Self { root, copy, target, tests };
        mirror(&bench.root, &bench.copy)?;
        bench.build_tests()?;
        bench.build().context("the image without any mutant")?;
        Ok(bench)
    }

    /// Makes a mutant, runs the tests that should see it, and puts the copy back as it was.
    ///
    /// # Errors
    /// Its text is not found once, it does not build, or no test runs.
    pub(crate) fn judge(&self, mutant: &Mutant) -> anyhow::Result<Verdict> {
        let path = self.copy.join(mutant.file);
        let whole = fs::read_to_string(&path).with_context(|| mutant.file.to_owned())?;
        fs::write(&path, mutant.apply(&whole)?)?;
        let verdict = self.build_for(mutant.host).and_then(|()| self.run(mutant.host, mutant.seen_by));
        fs::write(&path, whole)?;
        verdict
    }

    fn cargo(&self) -> Command {
        Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
    }

    fn cargo_of_the_copy(&self) -> Command {
        let mut cargo = self.cargo();
        cargo.current_dir(&self.copy).env("CARGO_TARGET_DIR", &self.target);
        cargo
    }

    /// Tests on the host are built as they run.
    fn build_for(&self, host: &[&str]) -> anyhow::Result<()> {
        if host.is_empty() { self.build() } else { Ok(()) }
    }

    fn build(&self) -> anyhow::Result<()> {
        let mut cargo = self.cargo_of_the_copy();
        // Not by cargo alone: an image without its checksum never heats.
        cargo.args(["run", "--release", "-p", "xtask", "--", "build"]);
        let output = cargo.output()?;
        ensure!(output.status.success(), "does not build:\n{}", tail(&output.stderr));
        Ok(())
    }

    fn build_tests(&self) -> anyhow::Result<()> {
        let mut cargo = self.cargo();
        cargo.current_dir(&self.root).args(["test", "-p", "virtual-board", "--test", "board", "--no-run"]);
        let output = cargo.output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        // cargo says: Executable tests/board/main.rs (target/...)
        let line = said.lines().find(|line| line.trim_start().starts_with("Executable"));
        let path = line.and_then(|line| line.split_once('(')?.1.strip_suffix(')'));
        let path = path.with_context(|| format!("the tests do not build:\n{said}"))?;
        fs::copy(self.root.join(path), &self.tests)?;
        Ok(())
    }

    /// Runs tests, by parts of their names: those of this tree's virtual board on the image of the copy, or those of the copy that `cargo test`
    /// builds with the arguments `host`.
    ///
    /// # Errors
    /// There is none of one of these names.
    pub(crate) fn run(&self, host: &[&str], tests: &[&str]) -> anyhow::Result<Verdict> {
        let mut program = if host.is_empty() {
            let image = self.target.join(TARGET).join("firmware/firmware");
            let mut program = Command::new(&self.tests);
            program.current_dir(&self.root).env("VIRTUAL_BOARD_ELF", image);
            program
        } else {
            let mut cargo = self.cargo_of_the_copy();
            cargo.args(["test", "--no-fail-fast"]).args(host).arg("--");
            cargo
        };
        let output = program.env("RUST_BACKTRACE", "0").args(tests).output()?;
        let said = String::from_utf8_lossy(&output.stdout);
        let ran = || said.lines().filter_map(|line| line.strip_prefix("test "));
        if let Some(absent) = tests.iter().find(|&&test| !ran().any(|name| name.starts_with(test))) {
            bail!("no test is called {absent}:\n{}", told(&output));
        }
        let failed = said.lines().filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"));
        // Tests that run side by side are told in any order.
        let killed_by: BTreeSet<String> = failed.map(str::to_owned).collect();
        if killed_by.is_empty() && !output.status.success() {
            bail!("no test failed, but the run did:\n{}", told(&output));
        }
        Ok(Verdict { killed_by: killed_by.into_iter().collect(), error: None })
    }
}

fn tail(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let lines: Vec<&str> = text.lines().rev().take(30).collect();
    lines.into_iter().rev().collect::<Vec<_>>().join("\n")
}

fn told(output: &Output) -> String {
    tail(&output.stdout) + "\n" + &tail(&output.stderr)
}

/// Makes `to` hold what `from` does. Files that are the same stay untouched, so that cargo does not build them again.
fn mirror(from: &Path, to: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(to)?;
    let mut there: BTreeSet<_> =
        fs::read_dir(to)?.map(|e| e.map(|e| e.file_name())).collect::<Result<_, _>>()?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        if LEFT_OUT.iter().any(|left_out| name == *left_out) {
            continue;
        }
        there.remove(&name);
        let (source, copy) = (entry.path(), to.join(&name));
        if entry.file_type()?.is_dir() {
            mirror(&source, &copy)?;
        } else {
            let content = fs::read(&source)?;
            if fs::read(&copy).ok().as_ref() != Some(&content) {
                fs::write(&copy, content)?;
            }
        }
    }
    for gone in there {
        let path = to.join(gone);
        if path.is_dir() { fs::remove_dir_all(path)? } else { fs::remove_file(path)? }
    }
    Ok(())
}
