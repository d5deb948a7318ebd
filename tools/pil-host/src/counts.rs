//! Change indicator: the counts as they were committed. A rise is a decision to take, not an accident to find later.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// A count may rise by so much before it counts as risen: compilers move an instruction here and there.
const TOLERANCE: f64 = 0.02;
/// And by this in any case: how a part's arguments get to its call depends on the code around the call.
const AT_THE_CALL: f64 = 2.0;
const HEADER: &str = "# What the instrument costs on a Cortex-M4F: instructions, and bytes of stack. `cargo bench-m4` fails when one rises by\n\
# more than 2 %, and by more than 2 in any case; `cargo bench-m4 --update` writes this file.\n\n";

/// Compares with the committed counts, or writes them.
///
/// # Errors
/// The counts that have risen, or are new or missing.
pub(crate) fn check(now: &BTreeMap<String, f64>, update: bool) -> anyhow::Result<()> {
    let path = path();
    if update {
        return std::fs::write(&path, format!("{HEADER}{}", toml::to_string(now)?)).context("counts.toml");
    }
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let committed: BTreeMap<String, f64> = toml::from_str(&text).context("counts.toml")?;
    let changes = changes(&committed, now);
    if !changes.is_empty() {
        bail!(
            "the cost is not what tools/pil/counts.toml says:\n{}\n\
             If that is meant, `cargo bench-m4 --update` writes the file anew; say why in the commit.",
            changes.join("\n")
        );
    }
    println!("\nNo count has risen by more than {} % against tools/pil/counts.toml.", TOLERANCE * 100.0);
    Ok(())
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../pil/counts.toml")
}

fn changes(committed: &BTreeMap<String, f64>, now: &BTreeMap<String, f64>) -> Vec<String> {
    let mut changes = Vec::new();
    for (name, &is) in now {
        match committed.get(name) {
            None => changes.push(format!("  {name}: {is}, not committed yet")),
            Some(&was) if is > was + AT_THE_CALL.max(was * TOLERANCE) => {
                changes.push(format!("  {name}: was {was}, is {is} ({:+.1} %)", 100.0 * (is / was - 1.0)))
            }
            Some(_) => {}
        }
    }
    let gone = committed.keys().filter(|name| !now.contains_key(*name));
    changes.extend(gone.map(|name| format!("  {name}: no longer measured")));
    changes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_a_new_count_and_a_lost_one_are_reported_and_a_fall_is_not() {
        let counts = |list: &[(&str, f64)]| list.iter().map(|&(n, c)| (n.to_owned(), c)).collect();
        let committed = counts(&[("a", 100.0), ("b", 100.0), ("c", 100.0)]);
        assert!(changes(&committed, &counts(&[("a", 101.9), ("b", 50.0), ("c", 100.0)])).is_empty());
        let found = changes(&committed, &counts(&[("a", 102.1), ("b", 100.0), ("d", 1.0)])).join("\n");
        assert_eq!(found.lines().count(), 3, "{found}");
        assert!(
            found.contains("a: was 100, is 102.1")
                && found.contains("d: 1")
                && found.contains("c: no longer")
        );
    }
}
