//! `pt326 core`.

use std::path::Path;
use std::process::Command;

use crate::{pt326, pt326_reading, text};

#[test]
fn a_bad_line_is_answered_and_ends_it_with_exit_code_2_unless_it_is_to_keep_going() {
    let input = "2160,2160,2160\n2160,oops,2160\n2160,2160,2160\n";
    let output = pt326_reading(&["core"], input);
    assert_eq!(output.status.code(), Some(2));
    let answers = text(&output.stdout);
    assert_eq!(answers.lines().count(), 3, "{answers}");
    for message in [answers.lines().last().unwrap(), &text(&output.stderr)] {
        let words = ["error", "line 2", "oops", "0 to 4095"];
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    let output = pt326_reading(&["core", "--keep-going"], input);
    assert!(output.status.success());
    assert_eq!(text(&output.stdout).lines().count(), 4);
}

/// What `--help` shows is what a user copies.
#[test]
fn the_python_example_of_the_help_runs() {
    let help = text(&pt326(&["core", "--help"]).stdout);
    let example = help.split_once("in Python:").expect("an example").1;
    let program: String =
        example.lines().map(|line| format!("{}\n", line.strip_prefix("  ").unwrap_or(line))).collect();
    let binary = Path::new(env!("CARGO_BIN_EXE_pt326"));
    let path =
        format!("{}:{}", binary.parent().unwrap().display(), std::env::var("PATH").unwrap_or_default());
    let Ok(output) = Command::new("python3").args(["-c", &program]).env("PATH", path).output() else {
        eprintln!("no python3 here: the example was not run");
        return;
    };
    assert!(output.status.success(), "{program}\n{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let words: Vec<&str> = printed.split_whitespace().collect();
    assert_eq!(words[..2], ["2.09", "settle"], "time and mode of the last sample: {printed}");
}
