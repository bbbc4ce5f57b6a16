//! `floe recover`: every test of a card as files of its own.

use std::fs;
use std::path::{Path, PathBuf};

use crate::card::{self, Found, Test};
use crate::error::InputError;

use super::input::open_file;
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
    let place = args.input.display();
    let read = open_file(&args.input, false).and_then(card::tests);
    let (tests, found) = read.map_err(|e| e.within(&place))?;
    fs::create_dir_all(&args.output)
        .map_err(|e| InputError::new(e.to_string()).within(args.output.display()))?;
    let mut files = Vec::new();
    for test in &tests {
        files.push((name(args, test, "csv"), card::csv(test)));
        files.push((name(args, test, "txt"), card::lines(test).to_string()));
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
    output::print(&summary(&tests, &found))
}

fn name(args: &Args, test: &Test, extension: &str) -> PathBuf {
    args.output.join(format!("{}.{extension}", test.stem))
}

fn refuse_existing(path: &Path) -> Result<(), InputError> {
    // A link that leads nowhere is there too.
    if path.symlink_metadata().is_ok() {
        let message = "is there already; name an empty directory, or remove it";
        return Err(InputError::new(message).within(path.display()));
    }
    Ok(())
}

fn summary(tests: &[Test], found: &Found) -> String {
    let mut text = String::new();
    for test in tests {
        let settings = &test.settings;
        let seconds = test.samples.len() as f64 / f64::from(settings.config.rate_hz);
        let (samples, missing) = (test.samples.len(), test.missing());
        let bad = test.samples.iter().filter(|s| s.reading.is_err()).count();
        text += &format!(
            "{}: {samples} samples ({seconds:.1} s), {missing} missing ({} overruns), {bad} bad, \
             weight {} N\n",
            test.stem, test.overruns, settings.config.weight_n,
        );
    }
    let (whole, damaged, lost) = (found.places.len(), found.damaged, found.lost);
    text += &format!("sectors: {whole} read, {damaged} damaged, {lost} lost");
    for (count, what) in [
        (found.newer, "of a newer version"),
        (found.unsound, "that no logger writes"),
        (found.repeated, "there again"),
    ] {
        if count > 0 {
            text += &format!(", {count} {what}");
        }
    }
    text + "\n" + &conflicts(tests)
}

/// What is not as one logger writes one card.
fn conflicts(tests: &[Test]) -> String {
    let mut text = String::new();
    for test in tests {
        if let Some(why) = test.split {
            text += &format!("{}: taken apart from its number's other samples: {why}\n", test.stem);
        }
    }
    for same in tests.chunk_by(|a, b| a.part.run == b.part.run) {
        let mut identities: Vec<_> = same.iter().map(|test| test.part.id).collect();
        identities.dedup();
        if let (Some(first), true) = (same.first(), identities.len() > 1) {
            let (run, count) = (first.part.run, identities.len());
            text += &format!("number {run} is on the card for {count} different tests\n");
        }
    }
    text
}
