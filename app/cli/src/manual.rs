//! `mve completions` and `mve man`: what packages of mve ship beside it.

use std::path::PathBuf;

use clap::Command;

use crate::exit::{Exit, Stop};
use crate::out;

/// Print the completions of a shell
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve completions bash > ~/.local/share/bash-completion/completions/mve
  mve completions zsh > ~/.zfunc/_mve
  mve completions fish > ~/.config/fish/completions/mve.fish")]
pub struct CompletionsArgs {
    /// Which shell
    shell: clap_complete::Shell,
}

/// Print the manual page, or write the pages of all commands to a folder
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve man | man -l -
  mve man --dir ~/.local/share/man/man1")]
pub struct ManArgs {
    /// Write a page a command to this folder
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,
}

/// Runs `mve completions`.
pub fn completions(mut command: Command, args: &CompletionsArgs) -> Result<Exit, Stop> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut command, "mve", &mut text);
    out::print(&String::from_utf8_lossy(&text))
}

/// Runs `mve man`.
pub fn pages(command: Command, args: &ManArgs) -> Result<Exit, Stop> {
    let Some(folder) = &args.dir else {
        let mut text = Vec::new();
        let page = clap_mangen::Man::new(command);
        // Rendering to memory cannot fail.
        let _ = page.render(&mut text);
        return out::print(&String::from_utf8_lossy(&text));
    };
    let fail = |error| Stop::file(folder, &error);
    std::fs::create_dir_all(folder).map_err(fail)?;
    clap_mangen::generate_to(command, folder).map_err(fail)?;
    out::print(&format!("wrote the manual pages to {}\n", folder.display()))
}
