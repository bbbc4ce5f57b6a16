//! The command line: one file per command.
//!
//! Exit code 0: done. 2: bad usage, unreadable input or an output that cannot be
//! written, with one line on standard error.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::InputError;

mod bench;
mod campaign;
mod completions;
mod input;
mod inspect;
mod json;
mod live;
pub mod output;
mod progress;
mod provenance;
mod recover;
mod replay;
pub mod simulate;
mod stiffness;
mod weigh;

/// Friction of sea ice from the force in the cable: replays, simulates, compares.
#[derive(Debug, Parser)]
#[command(name = "floe", version)]
#[command(after_help = "\
Examples:
  floe inspect pull.csv
  floe replay pull.csv --weight-n 630 --report pull.html
  floe campaign tests --report trends.html
  floe live /dev/ttyACM0

Files: --json FILE, --report FILE and their like write a file; --json alone writes to standard output, and
nothing else goes there. No output is ever an input. A result that was there is replaced once the new one is
whole, and that is said, but for replay --quiet; a simulated log (simulate -o) replaces a simulated one; any other
file that is there and not empty is refused. A recording (live -o, recover -o) replaces nothing.

Exit: 0 done, 2 bad usage or a file that cannot be read or written, with one line that says what to do.

Without a command, the bundled log is replayed.")]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Campaign(campaign::Args),
    Completions(completions::Args),
    Bench(bench::Args),
    Inspect(inspect::Args),
    Live(live::Args),
    Replay(replay::Args),
    Recover(recover::Args),
    Simulate(simulate::Args),
    Stiffness(stiffness::Args),
    Weigh(weigh::Args),
}

impl Command {
    fn run(&self) -> Result<(), InputError> {
        match self {
            Self::Campaign(args) => campaign::run(args),
            Self::Completions(args) => completions::run(args),
            Self::Bench(args) => bench::run(args),
            Self::Inspect(args) => inspect::run(args),
            Self::Live(args) => live::run(args),
            Self::Replay(args) => replay::run(args),
            Self::Recover(args) => recover::run(args),
            Self::Simulate(args) => simulate::run(args),
            Self::Stiffness(args) => stiffness::run(args),
            Self::Weigh(args) => weigh::run(args),
        }
    }
}

/// Runs the command of the process.
#[must_use]
pub fn main() -> ExitCode {
    match run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::say(&error.to_string());
            ExitCode::from(2)
        }
    }
}

/// Runs a command; the first argument is the program's name.
///
/// # Errors
/// One line for the user.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), InputError> {
    match Cli::try_parse_from(plain_help(arguments.into_iter().collect())) {
        Ok(Cli { command: Some(command) }) => command.run(),
        Ok(Cli { command: None }) => replay::run_bundled(),
        Err(error) if error.use_stderr() => Err(one_line(&error)),
        // Requested help or version is not an error.
        Err(help) => output::print(&help.to_string()),
    }
}

/// `floe help --help` is treated as `floe --help`; clap would take `--help` for a command.
fn plain_help(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let asks = |it: &OsString| it == "--help" || it == "-h";
    if arguments.get(1).is_some_and(|it| it == "help") && arguments.get(2).is_some_and(asks) {
        arguments.remove(1);
    }
    arguments
}

/// A usage error as one line, without the surrounding paragraphs.
fn one_line(error: &clap::Error) -> InputError {
    if let Some(said) = in_words(error) {
        return said;
    }
    let text = error.to_string();
    let said = text.lines().take_while(|line| !line.starts_with("Usage:"));
    let said: Vec<&str> = said
        .map(|line| line.trim().trim_start_matches("error: "))
        .filter(|line| !line.is_empty() && !line.starts_with("For more information"))
        // An unknown option is hardly meant as a value.
        .filter(|line| !line.starts_with("tip: to pass"))
        .collect();
    InputError::new(format!("{} (see --help)", said.join(" ").replace(" tip: ", "; ")))
}

/// Clear text for errors that clap words poorly.
fn in_words(error: &clap::Error) -> Option<InputError> {
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    if error.kind() == ErrorKind::InvalidUtf8 {
        let why = "an argument is no text in UTF-8; rename the file, or give it as - < FILE";
        return Some(InputError::new(why));
    }
    let why = std::error::Error::source(error)?.to_string();
    let kind = match why.as_str() {
        "invalid float literal" | "cannot parse float from empty string" => "a number",
        "invalid digit found in string" | "cannot parse integer from empty string" => {
            "a whole number"
        }
        _ => return None,
    };
    if error.kind() != ErrorKind::ValueValidation {
        return None;
    }
    let option = text(ContextKind::InvalidArg)?.split(' ').next()?;
    let value = text(ContextKind::InvalidValue)?;
    let example = match option {
        "--weight-n" => "630",
        "--mass-kg" => "64.2",
        "--rate-hz" => "16",
        _ if kind == "a number" => "1.5",
        _ => "12",
    };
    Some(InputError::new(format!("{option} must be {kind} like {example}, not '{value}'")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(arguments: &[&str]) -> String {
        let error = Cli::try_parse_from([&["floe"], arguments].concat()).unwrap_err();
        one_line(&error).to_string()
    }

    #[test]
    fn errors_are_in_words() {
        let text = said(&["replay", "x.csv", "--weight-n", "abc"]);
        assert_eq!(text, "--weight-n must be a number like 630, not 'abc'");
        let text = said(&["simulate", "x.toml", "-o", "x.csv", "--seed", "1.5"]);
        assert_eq!(text, "--seed must be a whole number like 12, not '1.5'");
        let text = said(&["replay", "x.csv", "--weight-n", ""]);
        assert_eq!(text, "--weight-n must be a number like 630, not ''");
        let text = said(&["replay", "x.csv", "--delimiter", "ab"]);
        assert!(text.contains("must be one character like ;"), "{text}");
        let text = said(&["campaign", "--quiet"]);
        assert_eq!(text, "unexpected argument '--quiet' found (see --help)");
        let text = said(&["replay", "--jsn"]);
        let similar = "unexpected argument '--jsn' found; a similar argument exists: '--json'";
        assert_eq!(text, format!("{similar} (see --help)"));
    }

    #[test]
    fn help_of_the_help_is_the_help() {
        for asked in ["--help", "-h"] {
            let arguments = ["floe", "help", asked].map(OsString::from).to_vec();
            assert_eq!(plain_help(arguments), ["floe", asked]);
        }
        let of_one = ["floe", "help", "replay"].map(OsString::from).to_vec();
        assert_eq!(plain_help(of_one.clone()), of_one);
    }

    #[test]
    fn every_command_shows_examples_that_can_be_typed() {
        let floe = <Cli as clap::CommandFactory>::command();
        for command in floe.get_subcommands().chain([&floe]) {
            let help = command.clone().render_help().to_string();
            let typed = |line: &str| line.starts_with("  floe ").then(|| line.trim().to_string());
            let examples: Vec<String> = help.lines().filter_map(typed).collect();
            assert!(help.contains("Examples:") && !examples.is_empty(), "{}", command.get_name());
            for example in examples {
                let floe = example.split(['|', '>']).next().unwrap_or_default();
                let words = floe.split_whitespace().map(|word| word.trim_matches('\''));
                let parsed = Cli::try_parse_from(words);
                assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
            }
        }
    }

    #[test]
    fn the_definitions_of_the_options_are_sound() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }
}
