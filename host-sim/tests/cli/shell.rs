//! Help, completions and manual pages.

use crate::{arg, folder, pt326, text};

/// The commands, as the help lists them; clap knows no others.
fn commands() -> Vec<String> {
    let help = text(&pt326(&["--help"]).stdout);
    let listed = |heading: &'static str| {
        let lines = help.lines().skip_while(move |line| *line != heading).skip(1);
        lines.take_while(|line| !line.is_empty()).filter_map(|line| line.split_whitespace().next())
    };
    listed("Commands:").chain(listed("For engineers:")).map(str::to_owned).collect()
}

#[test]
fn each_command_has_its_own_help() {
    let commands = commands();
    assert!(commands.len() > 15 && commands.iter().any(|command| command == "isolability"), "{commands:?}");
    for command in &commands {
        let own = text(&pt326(&[command, "--help"]).stdout);
        assert!(own.starts_with(|c: char| c.is_uppercase()) && own.contains("Usage: pt326 "), "{own}");
    }
}

/// The rigs of `run`, and those of `config`, which have settings of their own.
#[test]
fn every_preset_is_named_where_one_is_asked_for() {
    let mut asked: Vec<(&str, Vec<&str>)> = vec![
        ("run", pt326_rig::RigConfig::presets().collect()),
        ("config", pt326_lab::preset::TEXTS.map(|(name, _)| name).to_vec()),
    ];
    if cfg!(feature = "live") {
        asked.push(("live", pt326_rig::RigConfig::presets().collect()));
    }
    for (command, presets) in asked {
        let help = text(&pt326(&[command, "--help"]).stdout);
        for name in presets {
            assert!(help.contains(name), "{command} --help does not name {name}");
        }
    }
}

#[test]
fn a_mistyped_command_is_answered_with_the_right_one() {
    let error = text(&pt326(&["replya"]).stderr);
    assert!(error.contains("'replay'"), "{error}");
}

/// Whoever has not got it is told how to get it.
#[cfg(not(feature = "live"))]
#[test]
fn live_says_which_build_has_it() {
    for arguments in [&["live"][..], &["live", "--board", "--mqtt", "mqtt://broker.local"]] {
        let out = pt326(arguments);
        let error = text(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{error}");
        assert!(error.contains("cargo install --path host-sim --features live"), "{error}");
    }
}

#[test]
fn completions_and_manual_pages_know_the_commands() {
    let commands = commands();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&pt326(&["completions", shell]).stdout);
        assert!(commands.iter().all(|command| script.contains(command)), "{shell}");
    }
    for command in &commands {
        let page = text(&pt326(&["man", command]).stdout);
        assert!(page.contains(&format!("pt326\\-{}", command.replace('-', "\\-"))), "{command}: {page}");
    }
    let page = text(&pt326(&["man"]).stdout);
    assert!(page.contains(".TH pt326 1") && page.contains("diagnose"), "{page}");
    let page = text(&pt326(&["man", "fit-rig"]).stdout);
    assert!(page.contains("pt326\\-fit\\-rig") && page.contains("\\-\\-map"), "{page}");
    assert!(text(&pt326(&["man", "nothing"]).stderr).contains("no command is named nothing"));
}

#[test]
fn all_manual_pages_are_written_into_a_folder() {
    let folder = folder("man").join("man1");
    let output = pt326(&["man", "--out", arg(&folder)]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for page in commands().into_iter().chain(["campaign-define".into()]) {
        assert!(folder.join(format!("pt326-{page}.1")).exists(), "{page}");
    }
    assert!(folder.join("pt326.1").exists());
}
