//! The same runs on the emulated target, the host's debug build and the host's release build: the same bits?

use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, bail, ensure};

use crate::{image, qemu, recording};

/// Runs everything on all three and compares.
///
/// # Errors
/// The first line that differs; a build or a program that fails.
pub(crate) fn run() -> anyhow::Result<()> {
    let recording = recording::write()?;
    let target = qemu::run(&image::build("pil-image")?, &recording, &[])?;
    let debug = host("dev", &recording)?;
    let release = host("release", &recording)?;
    same("host debug", &debug, "host release", &release)?;
    same("host release", &release, "Cortex-M4F", &target)?;
    print!("{}", last_lines(&target));
    println!(
        "Host debug, host release and Cortex-M4F (emulated) agree in every bit of {} lines.",
        target.lines().count()
    );
    Ok(())
}

/// The hashes of a host build of the given profile.
fn host(profile: &str, recording: &Path) -> anyhow::Result<String> {
    let output =
        image::cargo(&["run", "--quiet", "--profile", profile, "-p", "pil", "--bin", "pil-image", "--"])
            .arg(recording)
            .stdin(Stdio::null())
            .stderr(Stdio::inherit())
            .output()
            .context("can't run cargo")?;
    ensure!(output.status.success(), "the host's {profile} build failed");
    Ok(String::from_utf8(output.stdout)?)
}

/// Compares line by line.
fn same(name_a: &str, a: &str, name_b: &str, b: &str) -> anyhow::Result<()> {
    ensure!(!a.is_empty(), "{name_a} said nothing");
    for (a, b) in a.lines().zip(b.lines()) {
        if a != b {
            bail!("the bits differ, first here:\n  {name_a:<12} {a}\n  {name_b:<12} {b}");
        }
    }
    let (a, b) = (a.lines().count(), b.lines().count());
    ensure!(a == b, "{name_a} gave {a} lines, {name_b} {b}");
    Ok(())
}

/// The last line of each run.
fn last_lines(text: &str) -> String {
    let run = |line: &str| line.rsplit_once(',').map(|(run, _)| run.to_owned());
    let lines: Vec<&str> = text.lines().collect();
    let is_last = |i: usize| lines.get(i + 1).is_none_or(|next| run(next) != run(lines[i]));
    (0..lines.len()).filter(|&i| is_last(i)).map(|i| format!("{}\n", lines[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pil::digest::Digest;

    #[test]
    fn one_different_line_or_a_missing_one_is_found() {
        let text = "a, b, 500 samples: 01\na, b, 777 samples: 02\nc, d, 500 samples: 03\n";
        same("x", text, "y", text).unwrap();
        let error = same("x", text, "y", &text.replace("02", "12")).unwrap_err().to_string();
        assert!(error.contains("777 samples: 02") && error.contains("777 samples: 12"), "{error}");
        assert!(same("x", text, "y", "a, b, 500 samples: 01\n").is_err());
        assert!(same("x", "", "y", "").is_err());
        assert_eq!(last_lines(text), "a, b, 777 samples: 02\nc, d, 500 samples: 03\n");
    }

    #[test]
    fn one_bit_changes_a_hash_and_nan_has_one() {
        let hash = |x: f32| {
            let mut digest = Digest::default();
            digest.number(x);
            digest.value()
        };
        assert_ne!(hash(1.0), hash(1.0f32.next_up()));
        assert_ne!(hash(0.0), hash(-0.0));
        assert_eq!(hash(f32::NAN), hash(f32::from_bits(0xFFA5_5A5A)));
    }
}
