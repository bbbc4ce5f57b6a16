//! The command line: one file per command.
//!
//! Exit code 0: done. 2: bad usage, unreadable input or an output that cannot be
//! written, with one line on standard error.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::InputError;

pub mod bench;
pub mod campaign;
pub mod live;
pub mod output;
pub mod recover;
pub mod replay;
pub mod simulate;
pub mod stiffness;
pub mod weigh;

/// Friction of sea ice from the force in the cable: replays, simulates, compares.
#[derive(Debug, Parser)]
#[command(name = "floe", version)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Campaign(campaign::Args),
    Bench(bench::Args),
    Live(live::Args),
    Replay(replay::Args),
    Recover(recover::Args),
    Simulate(simulate::Args),
    Stiffness(stiffness::Args),
    Weigh(weigh::Args),
}

/// Runs the command that the process was started with.
#[must_use]
pub fn main() -> ExitCode {
    let result = match Cli::try_parse() {
        Ok(Cli { command: Some(Command::Replay(args)) }) => replay::run(&args),
        Ok(Cli { command: Some(Command::Recover(args)) }) => recover::run(&args),
        Ok(Cli { command: Some(Command::Simulate(args)) }) => simulate::run(&args),
        Ok(Cli { command: Some(Command::Stiffness(args)) }) => stiffness::run(&args),
        Ok(Cli { command: Some(Command::Weigh(args)) }) => weigh::run(&args),
        Ok(Cli { command: Some(Command::Campaign(args)) }) => campaign::run(&args),
        Ok(Cli { command: Some(Command::Bench(args)) }) => bench::run(&args),
        Ok(Cli { command: Some(Command::Live(args)) }) => live::run(&args),
        Ok(Cli { command: None }) => replay::run_bundled(),
        Err(error) if error.use_stderr() => Err(one_line(&error)),
        // Help and version are asked for, not wrong.
        Err(help) => output::print(&help.to_string()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("floe: {error}");
            ExitCode::from(2)
        }
    }
}

/// A usage error without the paragraphs around it.
fn one_line(error: &clap::Error) -> InputError {
    let text = error.to_string();
    let said = text.lines().take_while(|line| !line.starts_with("Usage:"));
    let said: Vec<&str> = said
        .map(|line| line.trim().trim_start_matches("error: "))
        .filter(|line| !line.is_empty() && !line.starts_with("For more information"))
        .collect();
    InputError::new(format!("{} (see --help)", said.join(" ")))
}
