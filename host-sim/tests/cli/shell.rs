//! Help, completions and manual pages.

use crate::{pt326, text};

const COMMANDS: [&str; 11] = [
    "run",
    "repeat",
    "campaign",
    "core",
    "identify",
    "replay",
    "console",
    "config",
    "scenario",
    "completions",
    "man",
];

#[test]
fn the_help_lists_every_command_and_each_has_its_own() {
    let help = text(&pt326(&["--help"]).stdout);
    for command in COMMANDS {
        assert!(
            help.lines().any(|line| line.trim_start().starts_with(&format!("{command} "))),
            "{command}: {help}"
        );
        let own = text(&pt326(&[command, "--help"]).stdout);
        assert!(own.starts_with(|c: char| c.is_uppercase()) && own.contains("Usage: pt326 "), "{own}");
    }
}

#[test]
fn a_mistyped_command_is_answered_with_the_right_one() {
    let error = text(&pt326(&["replya"]).stderr);
    assert!(error.contains("'replay'"), "{error}");
}

#[test]
fn completions_and_manual_pages_know_the_commands() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&pt326(&["completions", shell]).stdout);
        assert!(COMMANDS.iter().all(|command| script.contains(command)), "{shell}");
    }
    let page = text(&pt326(&["man"]).stdout);
    assert!(page.contains(".TH pt326 1") && page.contains("identify"), "{page}");
    let page = text(&pt326(&["man", "identify"]).stdout);
    assert!(page.contains("pt326\\-identify") && page.contains("\\-\\-detrend"), "{page}");
    assert!(text(&pt326(&["man", "nothing"]).stderr).contains("no command is named nothing"));
}
