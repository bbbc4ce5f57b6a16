//! `floe completions`: completions of commands and options for a shell.

use clap::CommandFactory;
use clap_complete::Shell;

use crate::error::InputError;

use super::output;

/// Print the completions for a shell
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe completions bash > ~/.local/share/bash-completion/completions/floe
  floe completions fish > ~/.config/fish/completions/floe.fish")]
pub struct Args {
    /// The shell
    shell: Shell,
}

/// Runs the command.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(args: &Args) -> Result<(), InputError> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut super::Cli::command(), "floe", &mut text);
    output::print(&String::from_utf8_lossy(&text))
}
