//! The mutants, as data.

mod deaths;
mod guards;
mod host;
mod memory;
mod outputs;
mod sensing;
mod supply;

use anyhow::ensure;

/// One change of the sources.
pub(crate) struct Mutant {
    /// Name, for `--only` and the table.
    pub(crate) name: &'static str,
    /// File, from the root of the tree.
    pub(crate) file: &'static str,
    /// Text that the file has exactly once.
    pub(crate) find: &'static str,
    /// What stands there instead.
    pub(crate) replace: &'static str,
    /// What is wrong with it then.
    pub(crate) breaks: &'static str,
    /// Tests that should fail, by the begin of their names.
    pub(crate) seen_by: &'static [&'static str],
    /// Arguments of `cargo test` for the tests on the host that should; empty: those of the virtual board.
    pub(crate) host: &'static [&'static str],
    /// Why no test can see it, where none can.
    pub(crate) unseen: Option<&'static str>,
}

/// All mutants, by what they break.
pub(crate) const TABLE: &[&[Mutant]] = &[
    outputs::MUTANTS,
    guards::MUTANTS,
    sensing::MUTANTS,
    deaths::MUTANTS,
    supply::MUTANTS,
    memory::MUTANTS,
    host::MUTANTS,
];

/// `find` becomes `replace` in `file`.
const fn mutant(
    name: &'static str,
    breaks: &'static str,
    file: &'static str,
    [find, replace]: [&'static str; 2],
    seen_by: &'static [&'static str],
) -> Mutant {
    Mutant { name, file, find, replace, breaks, seen_by, host: &[], unseen: None }
}

impl Mutant {
    /// One that no test can see.
    const fn unseen(self, why: &'static str) -> Self {
        Self { unseen: Some(why), ..self }
    }

    /// One that tests on the host should see.
    const fn on_host(self, host: &'static [&'static str]) -> Self {
        Self { host, ..self }
    }

    /// The file with the change.
    ///
    /// # Errors
    /// It has not the text to be changed, or has it more than once.
    pub(crate) fn apply(&self, whole: &str) -> anyhow::Result<String> {
        let times = whole.matches(self.find).count();
        ensure!(times == 1, "{} has {times} times, expected once:\n{}", self.file, self.find);
        Ok(whole.replacen(self.find, self.replace, 1))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use super::*;

    #[test]
    fn each_finds_its_text_once_and_has_a_name_of_its_own() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut names = BTreeSet::new();
        for m in TABLE.iter().copied().flatten() {
            assert!(names.insert(m.name), "two are called {}", m.name);
            let whole = std::fs::read_to_string(root.join(m.file)).expect(m.file);
            m.apply(&whole).unwrap_or_else(|e| panic!("{}: {e}", m.name));
        }
    }
}
