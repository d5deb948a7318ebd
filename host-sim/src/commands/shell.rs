//! `pt326 completions` and `pt326 man`: what a shell and `man` want to know of the command line.

use std::path::PathBuf;

use anyhow::Context;
use clap::Command;
use clap_complete::Shell;

use super::terminal::print;

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  pt326 completions bash > ~/.local/share/bash-completion/completions/pt326
  pt326 completions zsh > ~/.zfunc/_pt326           (with ~/.zfunc in fpath)
  pt326 completions fish > ~/.config/fish/completions/pt326.fish")]
pub struct CompletionsArgs {
    /// Which shell.
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  pt326 man | man -l -
  pt326 man diagnose > ~/.local/share/man/man1/pt326-diagnose.1
  pt326 man --out ~/.local/share/man/man1           (all pages)")]
pub struct ManArgs {
    /// The command to describe; left out: pt326 itself.
    pub command: Option<String>,
    /// Write the pages of all commands into this folder, which is made if it is missing.
    #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
    pub out: Option<PathBuf>,
}

/// Prints the completions of `command` for a shell.
///
/// # Errors
/// Those of standard output.
pub fn completions(args: &CompletionsArgs, mut command: Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "pt326", &mut script);
    print(&String::from_utf8(script)?)
}

/// Prints the manual page of `command` or of one below it, or writes all of them.
///
/// # Errors
/// No such command; a folder that can't be written; those of standard output.
pub fn man(args: &ManArgs, mut command: Command) -> anyhow::Result<()> {
    if let Some(folder) = &args.out {
        let write =
            || std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(command, folder));
        return write().with_context(|| format!("can't write {}", folder.display()));
    }
    command.build();
    if let Some(name) = &args.command {
        let found = command.find_subcommand(name).cloned();
        command = found.with_context(|| format!("no command is named {name}, see `pt326 --help`"))?;
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    print(&String::from_utf8(page)?)
}
