//! `floe recover`: writes every test of a card to files.

use std::path::{Path, PathBuf};

use crate::card::{self, Test};
use crate::error::InputError;

use super::input::{STANDARD, open_file};
use super::output;

/// Recover the tests of a logger's card, as CSV
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe recover FLOE.LOG -o tests
  floe recover card.img -o tests --toa5

INPUT is the card's FLOE.LOG, or an image of the whole card (or its device), in whatever
state: every sector stands alone, and what is damaged is left out and counted.")]
pub struct Args {
    /// The log file, or an image of the card
    input: PathBuf,
    /// Directory for the tests; must not hold files of the same names
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Campbell TOA5 files too
    #[arg(long)]
    toa5: bool,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    output::check_folder(&args.output, &[])?;
    if args.input == Path::new(STANDARD) {
        let why = "a card cannot come by standard input: name its FLOE.LOG, or an image of it";
        return output::refuse(&args.input, why);
    }
    let read = open_file(&args.input, false).and_then(card::tests);
    let (tests, found) = read.map_err(|e| e.within(args.input.display()))?;
    output::make_folder(&args.output)?;
    let mut files = Vec::new();
    for test in &tests {
        files.push((name(args, test, "csv"), card::csv(test)));
        files.push((name(args, test, "txt"), test.lines.clone()));
        if args.toa5 {
            files.push((name(args, test, "dat"), card::toa5(test)));
        }
    }
    for (path, _) in &files {
        refuse_existing(path)?;
    }
    for (path, text) in &files {
        output::replace(path, text)?;
    }
    output::print(&card::summary(&tests, &found))
}

fn name(args: &Args, test: &Test, extension: &str) -> PathBuf {
    args.output.join(format!("{}.{extension}", test.stem))
}

fn refuse_existing(path: &Path) -> Result<(), InputError> {
    // A broken link counts as existing.
    if path.symlink_metadata().is_ok() {
        return output::refuse(path, "is there already; name an empty directory, or remove it");
    }
    Ok(())
}
